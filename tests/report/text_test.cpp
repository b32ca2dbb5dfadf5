#include "goingrate/report/tables.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace goingrate {
namespace {

TEST(TextTest, AValueIsRoundedToTwoDigitsOfItsSigma) {
  EXPECT_EQ(with_sigma(2.00031234, 0.000123), "2.00031 +- 0.00012");
  EXPECT_EQ(with_sigma(1273.262, 13.4), "1273 +- 13");
  EXPECT_EQ(with_sigma(-0.5, 0.25), "-0.50 +- 0.25");
  EXPECT_EQ(with_sigma(2.49995e-4, 2.1e-8), "(2.49995 +- 0.00021)e-4");
  EXPECT_EQ(with_sigma(0.0, 3e-9), "(0.0 +- 3.0)e-9");
}

TEST(TextTest, WithoutASigmaThereIsNone) {
  EXPECT_EQ(with_sigma(1.5, 0.0), "1.5");
  EXPECT_EQ(with_sigma(1.5, NAN), "1.5");
}

Beat beat(std::int64_t cycle, double t, BeatFlag flag = BeatFlag::good, std::uint16_t segment = 0) {
  return {Instant::from_seconds(t), cycle, NAN, 0, segment, flag};
}

TEST(TextTest, TheRateTableHasARowForEveryEventAndEveryMissingBeat) {
  Beats beats;
  beats.beats = {beat(0, 0.0),    beat(0, 0.4, BeatFlag::spurious),  beat(1, 2.0), beat(3, 6.0),
                 beat(53, 106.0), beat(54, 108.5, BeatFlag::good, 1)};
  const std::string table = rate_table(beats, 2.0);
  EXPECT_EQ(table, "cycle,time_s,period_s,rate_excess,rate_s_per_day,amplitude_rad,flags\n"
                   "0,0.000000000,,,,,\n"
                   ",0.400000000,,,,,spurious\n"
                   "1,2.000000000,2,0.000000e+00,0.000000,,\n"
                   "2,,,,,,missed\n"
                   "3,6.000000000,2,0.000000e+00,0.000000,,\n"
                   "4,,,,,,gap of 49\n"
                   "53,106.000000000,2,0.000000e+00,0.000000,,\n"
                   "54,108.500000000,,,,,split\n");
}

TEST(TextTest, TheRateTableTellsAStepFromOtherSplitsAndShowsRivals) {
  Beats beats;
  beats.beats = {beat(0, 0.0), beat(1, 2.0), beat(1, 2.001, BeatFlag::rival),
                 beat(2, 4.7, BeatFlag::good, 1), beat(3, 6.7, BeatFlag::good, 1)};
  beats.gaps = {{1, 0, 0.0, false, GapKind::step}};
  const std::string table = rate_table(beats, 2.0);
  EXPECT_NE(table.find("2,4.700000000,,,,,step\n"), std::string::npos) << table;
  EXPECT_NE(table.find(",2.001000000,,,,,rival\n"), std::string::npos) << table;
  EXPECT_EQ(table.find("split"), std::string::npos) << table;
}

TEST(TextTest, AnUndeterminedParameterIsAWord) {
  FitSummary fit;
  fit.parameters = {{"epsilon", "", ParameterStatus::undetermined, NAN, NAN, NAN}};
  const std::string text = fit_text(fit);
  EXPECT_NE(text.find("epsilon        undetermined"), std::string::npos);
  EXPECT_EQ(text.find("nan"), std::string::npos) << text;
}

TEST(TextTest, AnHonestMissIsNoTable) {
  FitSummary fit;
  fit.status = FitStatus::no_valid_model;
  fit.termination = "why";
  EXPECT_EQ(fit_text(fit), "no fit: why\n");
}

} // namespace
} // namespace goingrate
