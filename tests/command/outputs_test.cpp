// What the command may write and what it must not touch.
#include "support/command_fixture.hpp"

#include <chrono>

namespace goingrate::test {
namespace {

namespace fs = std::filesystem;

class OutputsTest : public CommandTest {
protected:
  void SetUp() override {
    CommandTest::SetUp();
    std::string factors;
    for (int i = 0; i < 400; ++i)
      factors += i % 2 == 0 ? "1.01\n" : "0.99\n";
    put("drive.csv", factors);
    put("s.toml", content(scenario("jump")) + "\n[drive]\nseries = \"drive.csv\"\n");
    ASSERT_EQ(run("simulate " + scenario("jump") + " --set run.periods=400 -o log.csv").code, 0);
    ASSERT_EQ(run("fit log.csv --fix T0=2 --par p.par").code, 0);
    put("phase.txt", "0.1\n0.2\n0.1\n0.3\n0.2\n0.25\n");
    for (const char* name : {"log.csv", "p.par", "s.toml", "drive.csv", "phase.txt"})
      fs::copy_file(folder_ / name, folder_ / (std::string("kept-") + name));
  }
  void expect_refused(const std::string& arguments) const {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 2) << arguments << '\n' << outcome.err;
    for (const char* name : {"log.csv", "p.par", "s.toml", "drive.csv", "phase.txt"})
      EXPECT_EQ(content(folder_ / name), content(folder_ / (std::string("kept-") + name)))
          << arguments << ": " << name;
    for (const auto& file : fs::directory_iterator(folder_))
      EXPECT_EQ(file.path().filename().string().find(".part-"), std::string::npos) << file.path();
  }
};

TEST_F(OutputsTest, WhatIsReadIsNeverWritten) {
  fs::create_symlink("log.csv", folder_ / "link.csv");
  fs::create_directory(folder_ / "d");
  fs::create_hard_link(folder_ / "log.csv", folder_ / "d" / "rates.csv");
  fs::create_hard_link(folder_ / "log.csv", folder_ / "d" / "paper.md");
  const std::string periods = " --set run.periods=300";
  for (const std::string arguments :
       {"rate log.csv -o log.csv", "rate log.csv --json link.csv", "rate - -o log.csv < log.csv",
        "rate link.csv --native ./log.csv", "fit log.csv --from p.par --json p.par",
        "fit log.csv --from p.par --par p.par", "fit - --fix T0=2 --csv log.csv < log.csv",
        "report log.csv --tables d", "spectrum log.csv --fix T0=2 --json log.csv",
        "stability log.csv -o log.csv", "stability phase.txt --data phase --json phase.txt"})
    expect_refused(arguments);
  for (const std::string output :
       {"-o s.toml", "-o drive.csv", "--truth drive.csv -o a.csv", "-o a.csv --plot drive.csv"})
    expect_refused("simulate s.toml" + periods + " " + output);
  expect_refused("simulate - -o s.toml --set drive.fast_rms=0 < s.toml");
  fs::rename(folder_ / "s.toml", folder_ / "s-0.toml");
  fs::create_symlink("s-0.toml", folder_ / "s.toml");
  expect_refused("simulate s.toml" + periods + " --realisations 2 -o s.toml");
}

TEST_F(OutputsTest, StandardOutputAtTheEndOfTheLogIsRefused) {
  const std::string line = fmt::format("cd '{}' && '{}' rate log.csv >> log.csv 2> err.txt",
                                       folder_.string(), GOINGRATE_COMMAND);
  EXPECT_EQ(WEXITSTATUS(std::system(line.c_str())), 2);
  EXPECT_EQ(content(folder_ / "log.csv"), content(folder_ / "kept-log.csv"));
}

TEST_F(OutputsTest, EveryNameOfStandardOutputIsTheSame) {
  for (const char* output : {"-o -", "-o /dev/stdout", "--output=/dev/stdout", "-o /dev/fd/1"}) {
    const Outcome outcome = run(fmt::format("report log.csv {}", output));
    EXPECT_EQ(outcome.code, 0) << output << '\n' << outcome.err;
    EXPECT_TRUE(outcome.out.starts_with("<!DOCTYPE html>")) << output;
    EXPECT_TRUE(outcome.out.ends_with("</html>\n")) << output; // no summary follows the page
  }
}

TEST_F(OutputsTest, TwoOutputsOfOneNameAreWrongUsage) {
  fs::create_symlink("b.csv", folder_ / "link.csv"); // to nothing yet
  for (const std::string arguments :
       {"rate log.csv -o b.csv --json ./b.csv", "rate log.csv --native b.csv --par link.csv",
        "rate log.csv --phase b.svg --plot b.svg", "fit log.csv --fix T0=2 --par b.csv --csv b.csv",
        "spectrum log.csv --fix T0=2 -o b.csv --json link.csv",
        "stability log.csv -o b.csv --json b.csv", "report log.csv -o b.csv --json b.csv",
        "report log.csv -o d/rates.csv --tables d", "simulate s.toml -o b.csv --truth ./b.csv",
        "simulate s.toml -o b.svg --plot b.svg", "map --solve amplitude=0.05 rate=0 -o b --json b",
        "simulate s.toml -o b.csv --truth b.csv --realisations 3",
        "rate log.csv --json - -o /dev/stdout"}) {
    fs::create_directories(folder_ / "d");
    expect_refused(arguments);
    for (const char* name : {"b", "b.csv", "b.svg", "b-0.csv", "d/rates.csv"})
      EXPECT_FALSE(fs::exists(folder_ / name)) << arguments << ": " << name;
  }
}

TEST_F(OutputsTest, AFolderInTheWayLeavesTheOtherFileAsItWas) {
  put("a.json", "precious");
  fs::create_directory(folder_ / "adir");
  for (const char* arguments :
       {"fit log.csv --fix T0=2 --json a.json --csv adir", "rate log.csv --json a.json -o adir",
        "simulate s.toml -o a.json --truth adir"}) {
    EXPECT_EQ(run(arguments).code, 5) << arguments;
    EXPECT_EQ(content(folder_ / "a.json"), "precious") << arguments;
  }
}

TEST_F(OutputsTest, NothingFromOutsideSteersTheTerminal) {
  const std::string evil = "\x1b]0;t\x07\x1b[31mred\nline";
  put("header.csv", "time (s),\x1b[31mred\x9b (x),edge\x1b[1m\n"
                    "1,2,up\n3,\x1b[2J,up\n5,3,up\n7,2,up\n");
  put(evil, content(folder_ / "log.csv"));
  put("evil.toml", "[clock]\n\"\x5cu001b[31m\" = 1\n");
  put("evil.par", "# goingrate par 1\n\x1b[31m 1 0\n");
  put("evil2.toml", "[drive]\nseries = \"\\u001b[31m\"\n");
  for (const std::string& arguments :
       {fmt::format("rate '{}' -o t.csv", evil),
        fmt::format("report '{}' -o r.html", evil),
        fmt::format("rate 'no{}'", evil),
        fmt::format("rate log.csv -o 'no{0}/{0}'", evil),
        fmt::format("rate log.csv '{}'", evil),
        fmt::format("rate log.csv '--{}'", evil),
        fmt::format("rate log.csv --format '{}'", evil),
        fmt::format("'{}'", evil),
        fmt::format("rate log.csv --alarm '{}'", evil),
        fmt::format("help '{}'", evil),
        fmt::format("rate log.csv --nominal-period '{}'", evil),
        fmt::format("rate header.csv --column '{}=2'", evil),
        fmt::format("rate header.csv --column 'amplitude={}'", evil),
        fmt::format("rate log.csv --plot '{}'", evil),
        fmt::format("fit log.csv --fix '{}=2'", evil),
        fmt::format("fit log.csv --fix 'T0={}'", evil),
        fmt::format("fit log.csv --event '{}'", evil),
        fmt::format("fit log.csv --event '3:{}'", evil),
        fmt::format("fit log.csv --free '{}'", evil),
        fmt::format("fit log.csv --prior '{}=1+-1'", evil),
        fmt::format("map --solve '{}=1' mu=1", evil),
        fmt::format("stability log.csv --taus '{}'", evil),
        fmt::format("simulate s.toml --set '{}=1'", evil),
        fmt::format("simulate s.toml --set 'run.method={}'", evil),
        fmt::format("paper -o p --periods 10000 --figure '{}'", evil),
        std::string("rate header.csv -o t.csv"),
        std::string("simulate evil.toml"),
        std::string("simulate evil2.toml"),
        std::string("fit log.csv --from evil.par")}) {
    const Outcome outcome = run(arguments);
    for (const std::string& text : {outcome.out, outcome.err})
      for (const char byte : {'\x1b', '\x07', '\x9b'})
        EXPECT_EQ(text.find(byte), std::string::npos) << arguments << '\n' << text;
    EXPECT_EQ(outcome.err.find("\nline"), std::string::npos) << outcome.err;
    EXPECT_FALSE(outcome.err.empty()) << arguments;
  }
}

TEST_F(OutputsTest, AReaderThatLeavesIsExitZeroAndTheFilesAreWritten) {
  for (const std::string arguments :
       {"rate log.csv --json a.json", "stability log.csv --json a.json", "--help", "help formats",
        "fit log.csv --fix T0=2 --json a.json", "rate log.csv --json - -o a.json",
        "simulate s.toml --set run.periods=300 --truth a.json", "report log.csv -o a.json",
        "rate log.csv --follow"}) {
    fs::remove(folder_ / "a.json");
    const bool writes = arguments.find("a.json") != std::string::npos;
    const bool endless = arguments.ends_with("--follow");
    run( // nobody reads when the command writes
        "", fmt::format("(sleep 0.2; {} '{}' {} --quiet; echo $? > code.txt) 2> said.txt | true;",
                        endless ? "timeout 10" : "", GOINGRATE_COMMAND, arguments));
    EXPECT_EQ(content(folder_ / "code.txt"), "0\n") << arguments;
    EXPECT_EQ(content(folder_ / "said.txt"), "") << arguments;
    EXPECT_EQ(fs::exists(folder_ / "a.json"), writes) << arguments;
  }
  const auto began = std::chrono::steady_clock::now();
  run("",
      fmt::format("'{}' simulate {} --quiet --set run.periods=1000000000 | head -3 > first.txt;",
                  GOINGRATE_COMMAND, scenario("jump")));
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(20)) << "went on alone";
}

} // namespace
} // namespace goingrate::test
