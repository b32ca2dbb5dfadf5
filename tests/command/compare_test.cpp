#include "support/command_fixture.hpp"

#include <string>

namespace {

using namespace goingrate::test;

class CompareCommandTest : public CommandTest {
protected:
  void simulate(const std::string& name, int seed, const std::string& settings) {
    const Outcome made = run("simulate " + scenario("noisy-drive") + " -o " + name + " --seed " +
                             std::to_string(seed) + " --set run.periods=4000 " + settings);
    ASSERT_EQ(made.code, 0) << made.err;
  }
};

TEST_F(CompareCommandTest, ThreeClocksAreToldApart) {
  simulate("a.csv", 1, "--set drive.fast_rms=0.05");
  simulate("b.csv", 2, "--set drive.fast_rms=0.05");
  simulate("c.csv", 3, "--set drive.fast_rms=0.3");
  const Outcome outcome = run("compare a.csv b.csv c.csv --rates rates.csv --json c.json -o c.txt "
                              "--plot c.svg");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto result = json("c.json");
  EXPECT_EQ(result["schema"], "goingrate.compare");
  EXPECT_EQ(result["clocks"].size(), 3u);
  EXPECT_EQ(result["differences"].size(), 3u);
  const auto& alone = result["alone"][0]["clocks"];
  EXPECT_GT(alone[2]["variance"].get<double>(), 4.0 * alone[0]["variance"].get<double>());
  EXPECT_EQ(content(folder_ / "rates.csv").substr(0, 43),
            "time_s,rate_1_s_per_day,rate_2_s_per_day,ra");
  EXPECT_NE(content(folder_ / "c.txt").find("alone, by the differences"), std::string::npos);
  EXPECT_NE(content(folder_ / "c.svg").find("Rates of the clocks"), std::string::npos);
}

TEST_F(CompareCommandTest, WhatCannotBeComparedIsRefused) {
  simulate("a.csv", 1, "");
  const Outcome alone = run("compare a.csv");
  EXPECT_EQ(alone.code, 2);
  EXPECT_NE(alone.err.find("compare needs the logs of two clocks or more; found one"),
            std::string::npos);
  put("dated.csv", "2013-03-30 10:00:00\n2013-03-30 10:00:02\n2013-03-30 10:00:04\n"
                   "2013-03-30 10:00:06\n");
  const Outcome mixed = run("compare a.csv dated.csv");
  EXPECT_EQ(mixed.code, 3);
  EXPECT_NE(mixed.err.find("dated.csv: found dates, expected times without a date, as in a.csv"),
            std::string::npos)
      << mixed.err;
}

TEST_F(CompareCommandTest, AnUnknownWeatherFileIsExitThree) {
  simulate("a.csv", 1, "");
  EXPECT_EQ(run("rate a.csv --weather none.csv -o x.csv").code, 3);
  EXPECT_EQ(run("rate a.csv --weather-zone +01:00 -o x.csv").code, 2) << "without a file";
  put("w.csv", "time_s,temperature_c\n0,20\n100,21\n9000,22\n");
  EXPECT_EQ(run("rate a.csv --weather w.csv --weather-zone Dublin -o x.csv").code, 2);
  EXPECT_EQ(run("rate a.csv --weather w.csv -o w.csv").code, 2) << "what is read is never written";
  EXPECT_EQ(run("rate a.csv --weather w.csv -o x.csv").code, 0);
  EXPECT_NE(content(folder_ / "x.csv").find("temperature_c"), std::string::npos);
}

TEST_F(CompareCommandTest, ADiaryIsCheckedThroughTheReport) {
  put("diary.csv", "time,what,value,sigma,note\n310,weight,1.0,0.1,twice as heavy\n"
                   "2000,rate,0.5,,nobody did it\n");
  const Outcome outcome = run("report " + (source / "data/logs/jump.csv").string() +
                              " --diary diary.csv --diary-out found.csv --json r.json -o p.html");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto kept = json("r.json")["kept_diary"];
  EXPECT_EQ(kept["entries"][0]["verdict"], "as planned");
  EXPECT_NEAR(kept["entries"][0]["found"].get<double>(), 1.0,
              4.0 * kept["entries"][0]["found_sigma"].get<double>());
  EXPECT_NE(outcome.out.find("keeper's diary"), std::string::npos);
  EXPECT_EQ(content(folder_ / "found.csv").substr(0, 27), "time,what,value,sigma,note\n");
  EXPECT_NE(content(folder_ / "p.html").find("diary beside the log"), std::string::npos);
  put("wrong.csv", "time,what\n1,wound\n");
  EXPECT_EQ(
      run("report " + (source / "data/logs/jump.csv").string() + " --diary wrong.csv -o p.html")
          .code,
      3);
}

} // namespace
