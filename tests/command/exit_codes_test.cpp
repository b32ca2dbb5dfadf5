// How the command fails: exit codes, messages, and that nothing is overwritten.
#include "support/command_fixture.hpp"

#include <initializer_list>
#include <string>
#include <utility>

namespace {

using namespace goingrate::test;
namespace fs = std::filesystem;

TEST_F(CommandTest, UnusableInputIsExitThreeWithFileLineAndColumn) {
  put("empty.log", "");
  put("one.log", "12.5\n");
  put("binary.log", std::string("\x00\x01\x02", 3));
  put("words.log", "once upon a time\n");
  fs::create_directories(folder_ / "folder");
  for (const char* command : {"rate", "fit", "spectrum", "stability", "report"}) {
    for (const auto& [file, place] : std::initializer_list<std::pair<const char*, const char*>>{
             {"empty.log", "empty.log:1:1: "},
             {"one.log", "one.log:1:1: "},
             {"binary.log", "binary.log:1:1: "},
             {"words.log", "words.log:1:1: "},
             {"absent.log", "absent.log: "},
             {"folder", "folder: found an empty folder"},
             {".", "./one.log:1:1: "}}) { // the only log in it
      const Outcome outcome = run(fmt::format("{} {}", command, file));
      EXPECT_EQ(outcome.code, 3) << command << " " << file << outcome.err;
      EXPECT_NE(outcome.err.find(place), std::string::npos) << outcome.err;
      EXPECT_NE(outcome.err.find("expected"), std::string::npos) << outcome.err;
      EXPECT_EQ(outcome.out, "");
    }
  }
}

TEST_F(CommandTest, AFailureOverwritesNothing) {
  put("empty.log", "");
  for (const char* file : {"out.html", "out.json", "out.csv", "truth.csv"})
    put(file, "precious");
  EXPECT_EQ(run("report empty.log -o out.html --json out.json").code, 3);
  EXPECT_EQ(run("rate empty.log -o out.csv --json out.json").code, 3);
  EXPECT_EQ(run("simulate empty.log -o out.csv --truth truth.csv").code, 3);
  for (const char* file : {"out.html", "out.json", "out.csv", "truth.csv"})
    EXPECT_EQ(content(folder_ / file), "precious") << file;
  for (const auto& entry : fs::directory_iterator(folder_))
    EXPECT_EQ(entry.path().string().find(".part-"), std::string::npos) << entry.path();
}

TEST_F(CommandTest, OneOutputThatCannotBeWrittenLeavesTheOthersAsTheyWere) {
  put("truth.csv", "precious");
  put("out.json", "precious");
  EXPECT_EQ(run("simulate " + scenario("jump") + " --truth truth.csv -o no/such/log.csv").code, 5);
  run("simulate " + scenario("jump") + " -o log.csv");
  EXPECT_EQ(run("report log.csv --json out.json -o no/such/page.html").code, 5);
  EXPECT_EQ(content(folder_ / "truth.csv"), "precious");
  EXPECT_EQ(content(folder_ / "out.json"), "precious");
  EXPECT_EQ(run("report log.csv -o - --json -").code, 2) << "two results on one stream";
}

TEST_F(CommandTest, AnUnwritableStandardErrorIsNoCrash) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full on this system";
  const std::string line = fmt::format("'{}' rate no-such-file 2> /dev/full", GOINGRATE_COMMAND);
  EXPECT_EQ(WEXITSTATUS(std::system(line.c_str())), 3);
}

TEST_F(CommandTest, OutputThatCannotBeWrittenIsExitFive) {
  EXPECT_EQ(run("simulate " + scenario("jump") + " -o no/such/folder/log.csv").code, 5);
  EXPECT_EQ(run("map -o no/such/map.csv").code, 5);
  EXPECT_EQ(run("paper --json no/such/paper.json").code, 5);
  EXPECT_EQ(run("compare one.csv other.csv -o no/such/table.txt").code, 5) << "before it reads";
  if (!fs::exists("/dev/full")) return;
  EXPECT_EQ(run("simulate " + scenario("jump") + " -o /dev/full").code, 5);
}

TEST_F(CommandTest, WithoutArgumentsItSaysWhatItCanDo) {
  const Outcome outcome = run("");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.out, "");
  EXPECT_NE(outcome.err.find("report"), std::string::npos) << outcome.err;
}

TEST_F(CommandTest, WrongUsageIsExitTwo) {
  EXPECT_EQ(run("tick").code, 2);
  EXPECT_EQ(run("rate").code, 2);
  run("simulate " + scenario("jump") + " -o log.csv");
  EXPECT_EQ(run("rate log.csv --format sundial").code, 2);
  EXPECT_EQ(run("fit log.csv --fix eps=1").code, 2);
  EXPECT_EQ(run("fit log.csv --event 99999:mu").code, 2);
  EXPECT_EQ(run("stability log.csv --taus 3").code, 2) << "no multiple of 2 s";
}

TEST_F(CommandTest, ABadScenarioIsExitThreeAndABadOptionTwo) {
  put("bad.toml", "[clock]\nepsilom = 1\n");
  const Outcome outcome = run("simulate bad.toml");
  EXPECT_EQ(outcome.code, 3);
  EXPECT_NE(outcome.err.find("bad.toml:2:1"), std::string::npos) << outcome.err;
  EXPECT_EQ(run("simulate " + scenario("jump") + " --set clock.mu=lots").code, 2)
      << "that is an option";
}

TEST_F(CommandTest, AStalledClockIsExitFourAndOverwritesNothing) {
  put("log.csv", "precious");
  const Outcome outcome = run("simulate " + scenario("jump") +
                              " -o log.csv --set clock.epsilon=0.01 "
                              "--set start.amplitude=0.05");
  EXPECT_EQ(outcome.code, 4) << outcome.err;
  EXPECT_NE(outcome.err.find("stalled"), std::string::npos);
  EXPECT_EQ(content(folder_ / "log.csv"), "precious");
}

TEST_F(CommandTest, AFailedRealisationLeavesNothingBehind) {
  const std::string stalling =
      scenario("noisy-drive") + " --set clock.epsilon=1e-2 --set start.amplitude=0.04";
  EXPECT_EQ(run("simulate " + stalling + " --realisations 9 -o log.csv").code, 4);
  for (const auto& file : fs::directory_iterator(folder_))
    EXPECT_EQ(file.path().filename().string().find("log"), std::string::npos) << file.path();
}

} // namespace
