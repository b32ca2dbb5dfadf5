// goingrate simulate as a script sees it: logs, the truth, realisations, laws and methods.
#include "support/command_fixture.hpp"

#include <algorithm>
#include <string>

namespace {

using namespace goingrate::test;
namespace fs = std::filesystem;

TEST_F(CommandTest, SimulateWritesALogAndTheTruth) {
  ASSERT_EQ(run("simulate " + scenario("jump") + " -o log.csv --truth truth.csv --seed 3").code, 0);
  const std::string truth = content(folder_ / "truth.csv");
  EXPECT_EQ(truth.substr(0, truth.find('\n')), "cycle,time_s,period_s,velocity,amplitude_rad,mu");
  EXPECT_EQ(std::count(truth.begin(), truth.end(), '\n'), 2001);
  const std::string log = content(folder_ / "log.csv");
  EXPECT_EQ(std::count(log.begin(), log.end(), '\n'), 2001 + 3);
  EXPECT_EQ(run("simulate " + scenario("jump") + " --seed 3").out, log)
      << "standard output is the default";
  EXPECT_NE(run("simulate " + scenario("jump") + " --seed 4").out, log);
}

TEST_F(CommandTest, SimulateReachesTheExactStationaryRates) {
  struct Point {
    const char *epsilon, *mu;
    double rate;
  };
  for (const Point& p : {Point{"2.5e-4", "2e-5", 1.133264436573979e-04},
                         Point{"2.5e-4", "4e-5", 1.960046634308295e-04},
                         Point{"1.167245e-4", "1.5e-5", 1.844068077230375e-08}}) {
    put("s.toml",
        fmt::format("[clock]\nnominal_period=6.283185307179586\nepsilon={}\nmu={}\nphi0=0.03\n"
                    "[run]\nperiods=100\n",
                    p.epsilon, p.mu));
    ASSERT_EQ(run("simulate s.toml -o log.csv --truth truth.csv").code, 0);
    const std::string truth = content(folder_ / "truth.csv");
    const std::size_t row = truth.rfind('\n', truth.size() - 2) + 1;
    const std::size_t comma = truth.find(',', truth.find(',', row) + 1);
    const double period = std::stod(truth.substr(comma + 1));
    EXPECT_NEAR(6.283185307179586477 / period - 1, p.rate, 1e-12);
  }
}

TEST_F(CommandTest, ABareWordInSetIsText) {
  const std::string jump = "simulate " + scenario("jump") + " --set run.periods=20 -o ";
  ASSERT_EQ(run(jump + "a.csv --set run.method=direct").code, 0);
  ASSERT_EQ(run(jump + "b.csv --set \"run.method='direct'\"").code, 0);
  ASSERT_EQ(run(jump + "c.csv --set run.method=averaged1").code, 0);
  EXPECT_EQ(content(folder_ / "a.csv"), content(folder_ / "b.csv"));
  EXPECT_NE(content(folder_ / "a.csv"), content(folder_ / "c.csv"));
}

TEST_F(CommandTest, RealisationsAreTheRunsOfTheirSeeds) {
  const std::string noisy = scenario("noisy-drive") + " --set run.periods=300 --quiet";
  ASSERT_EQ(run("simulate " + noisy + " --realisations 11 --seed 4 -o log.csv").code, 0);
  for (const int k : {0, 7, 10}) {
    ASSERT_EQ(run(fmt::format("simulate {} --seed {} -o one.csv", noisy, 4 + k)).code, 0);
    EXPECT_EQ(content(folder_ / fmt::format("log-{:02}.csv", k)), content(folder_ / "one.csv"));
  }
  EXPECT_EQ(run("simulate " + noisy + " --realisations 3").code, 2); // all to standard output?
  fs::create_directory(folder_ / "logs");
  for (const char* target : {"-o /dev/null", "-o logs", "-o logs/", "-o l.csv --truth /dev/null"}) {
    const Outcome refused = run(fmt::format("simulate {} --realisations 3 {}", noisy, target));
    EXPECT_EQ(refused.code, 2) << target;
    EXPECT_NE(refused.err.find("log.csv becomes log-0.csv"), std::string::npos) << refused.err;
  }
}

TEST_F(CommandTest, EveryClockLawAndMethodRunsFromAScenario) {
  put("laws.toml", "[clock]\nepsilon = 1e-4\nescapement = 'single-impulse'\nimpulse = 1.5e-6\n"
                   "angle = 0.01\nquadratic_drag = 1e-4\ndry_friction = 1e-8\n"
                   "[run]\nperiods = 50\n[length]\ndrift_per_day = 1e-5\n"
                   "[drive]\nseries = 'mu.csv'\nsine = [{amplitude = 0.1, period = 20.0}]\n");
  std::string series = "factor\n";
  for (int i = 0; i < 50; ++i)
    series += fmt::format("{}\n", 1.0 + 0.01 * i);
  put("mu.csv", series);
  EXPECT_EQ(run("simulate laws.toml -o a.csv").code, 0);
  EXPECT_EQ(run("simulate laws.toml -o b.csv --set \"run.method='direct'\"").code, 0);
  EXPECT_EQ(content(folder_ / "a.csv").substr(0, 200), content(folder_ / "b.csv").substr(0, 200));
  EXPECT_EQ(run("simulate laws.toml -o c.csv --set \"run.method='averaged2'\"").code, 2);
  put("profile.toml", "[clock]\nepsilon = 1e-4\nescapement = 'profile'\n"
                      "rising = [[-0.02, 0], [0, 4e-5], [0.02, 0]]\n"
                      "falling = [[-0.02, 0], [0, -4e-5], [0.02, 0]]\n[run]\nperiods = 20\n");
  EXPECT_EQ(run("simulate profile.toml -o d.csv").code, 0);
  put("mu.csv", "factor\n1.0\nx\n");
  const Outcome bad = run("simulate laws.toml");
  EXPECT_EQ(bad.code, 3);
  EXPECT_NE(bad.err.find("mu.csv:3:1"), std::string::npos) << bad.err;
}

} // namespace
