// The command where the machine sets limits: memory, threads, the size of files.
#include "support/command_fixture.hpp"
#include "support/sanitizers.hpp"

namespace goingrate::test {
namespace {

namespace fs = std::filesystem;
using LimitsTest = CommandTest;

TEST_F(LimitsTest, ThreadsThatCannotBeStartedAreDoneWithout) {
  GOINGRATE_NEEDS_MEMORY_LIMITS();
  const std::string many =
      "simulate " + scenario("noisy-drive") + " --set run.periods=300 --quiet --realisations 70";
  ASSERT_EQ(run(many + " --threads 1 -o one.csv").code, 0);
  const Outcome little = run(many + " --threads 64 -o log.csv", "ulimit -v 120000;");
  ASSERT_EQ(little.code, 0) << little.err;
  for (int k = 0; k < 70; ++k)
    EXPECT_EQ(content(folder_ / fmt::format("log-{:02}.csv", k)),
              content(folder_ / fmt::format("one-{:02}.csv", k)))
        << k;
}

TEST_F(LimitsTest, AFileThatMayNotGrowIsExitFive) {
  put("log.csv", "precious");
  const std::string command = "simulate " + scenario("jump") + " --set run.periods=100000 -o ";
  const Outcome outcome = run(command + "log.csv", "ulimit -f 100;");
  EXPECT_EQ(outcome.code, 5);
  EXPECT_NE(outcome.err.find("cannot write log.csv: File too large"), std::string::npos)
      << outcome.err;
  EXPECT_EQ(content(folder_ / "log.csv"), "precious");
  EXPECT_EQ(run(command + "-", "ulimit -f 100;").code, 5);
  for (const auto& file : fs::directory_iterator(folder_))
    EXPECT_EQ(file.path().filename().string().find(".part-"), std::string::npos) << file.path();
}

TEST_F(LimitsTest, TooLittleMemoryIsExitThreeAndSaysWhatToDo) {
  GOINGRATE_NEEDS_MEMORY_LIMITS();
  std::string text;
  for (int i = 0; i < 3000000; ++i)
    text += fmt::format("{}.0\n", 2 * i);
  put("long.log", text);
  for (const char* arguments : {"rate long.log -o t.csv", "stability long.log -o t.csv"}) {
    const Outcome outcome = run(arguments, "ulimit -v 120000;");
    EXPECT_EQ(outcome.code, 3) << arguments;
    EXPECT_NE(outcome.err.find("more memory than there is: take a part of the log"),
              std::string::npos)
        << outcome.err;
    EXPECT_FALSE(fs::exists(folder_ / "t.csv"));
  }
}

TEST_F(LimitsTest, APackedLogMayUnpackToSoMuchAndNoMore) {
  std::string text;
  for (int i = 0; i < 200000; ++i)
    text += fmt::format("{}.0\n", 2 * i);
  put("a.log", text);
  ASSERT_EQ(std::system(fmt::format("cd '{}' && gzip -k a.log", folder_.string()).c_str()), 0);
  for (const std::string log :
       {"rate a.log.gz -o t.csv", "rate - -o t.csv < a.log.gz", "stability a.log.gz -o t.csv"}) {
    const Outcome refused = run("--quiet " + log + " --unpacked-limit 0.001");
    EXPECT_EQ(refused.code, 3) << log;
    EXPECT_NE(refused.err.find("unpack to more than 1073741 bytes"), std::string::npos)
        << refused.err;
    EXPECT_EQ(run("--quiet " + log + " --unpacked-limit 0.01").code, 0) << log;
  }
  EXPECT_EQ(run("rate a.log -o t.csv --unpacked-limit 0.001").code, 0) << "nothing is packed";
  EXPECT_EQ(run("rate a.log -o t.csv --unpacked-limit nan").code, 2);
}

} // namespace
} // namespace goingrate::test
