// The command where the machine sets limits: memory, threads, the size of files.
#include "support/command_fixture.hpp"

namespace goingrate::test {
namespace {

namespace fs = std::filesystem;
using LimitsTest = CommandTest;

TEST_F(LimitsTest, ThreadsThatCannotBeStartedAreDoneWithout) {
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

} // namespace
} // namespace goingrate::test
