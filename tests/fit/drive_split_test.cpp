#include "goingrate/fit/drive_split.hpp"

#include "goingrate/log/rates.hpp"
#include "support/simulated.hpp"

#include <gtest/gtest.h>
#include <numbers>

namespace goingrate {
namespace {

DriveSplit split_of(const Scenario& scenario, std::uint64_t seed) {
  const auto rates = rate_on_every_cycle(test::simulated_beats(scenario, seed), 2.0);
  const Spectrum spectrum =
      welch_spectrum(rates, 2.0, {.segment = rates.size(), .detrend_linear = false});
  return split_drive(spectrum, 2.0, *drive_response(scenario.clock));
}

TEST(DriveSplitTest, RecoversBothParts) {
  // Slow drive of six relaxation times (1/(4 pi eps) = 318 periods = 637 s) beside 30 % fast drive.
  double fast = 0.0, slow = 0.0;
  int fast_inside = 0;
  const int logs = 20;
  for (std::uint64_t seed = 1; seed <= logs; ++seed) {
    Scenario scenario = test::at_point_b(40000);
    scenario.drive = {0.3, 0.1, 4000.0};
    scenario.sensor.jitter_rms_s = 1e-6;
    const DriveSplit split = split_of(scenario, seed);
    fast += split.fast.rms / logs;
    slow += split.slow.rms / logs;
    fast_inside += split.fast.low68 <= 0.3 && split.fast.high68 >= 0.3 ? 1 : 0;
  }
  EXPECT_NEAR(fast, 0.3, 0.004); // 1.2 % each, twenty logs
  EXPECT_NEAR(slow, 0.1, 0.02);  // some six independent values a log, twenty logs
  EXPECT_GE(fast_inside, 8);     // 14 expected, within three standard deviations
  EXPECT_LE(fast_inside, 19);
}

TEST(DriveSplitTest, JitterIsToldFromDrive) {
  Scenario scenario = test::at_point_b(20000);
  scenario.drive.fast_rms = 0.1;
  scenario.sensor.jitter_rms_s = 1e-4;
  const DriveSplit split = split_of(scenario, 3);
  EXPECT_NEAR(split.jitter_s.rms, 1e-4, 3e-6); // 3 %, four standard errors
  EXPECT_NEAR(split.fast.rms, 0.1, 0.02);
}

TEST(DriveSplitTest, ALineIsNoFastDrive) {
  // A wheel that turns once in 9 periods and doubles the rate's variance.
  Scenario scenario = test::at_point_b(20000);
  scenario.drive.fast_rms = 0.1;
  auto rates = rate_on_every_cycle(test::simulated_beats(scenario, 3), 2.0);
  const auto options = SpectrumOptions{.segment = rates.size(), .detrend_linear = false};
  const DriveResponse response = *drive_response(scenario.clock);
  const double clean = split_drive(welch_spectrum(rates, 2.0, options), 2.0, response).fast.rms;
  for (std::size_t i = 0; i < rates.size(); ++i)
    rates[i] += 5e-5 * std::sin(2.0 * std::numbers::pi * static_cast<double>(i) / 9.0);
  const double with_line = split_drive(welch_spectrum(rates, 2.0, options), 2.0, response).fast.rms;
  EXPECT_NEAR(with_line, clean, 0.02 * clean);
}

TEST(DriveSplitTest, JitterThatHidesTheDriveGivesAnUpperLimit) {
  Scenario scenario = test::at_point_b(4000);
  scenario.drive.fast_rms = 0.001;
  scenario.sensor.jitter_rms_s = 1e-3;
  const DriveSplit split = split_of(scenario, 1);
  EXPECT_EQ(split.fast.low68, 0.0);
  EXPECT_GT(split.fast.high68, 0.001);
  EXPECT_FALSE(split.note.empty());
}

TEST(DriveSplitTest, ALogShorterThanThreeCornersHasNoSlowPart) {
  Scenario scenario = test::at_point_b(2000);
  scenario.drive.fast_rms = 0.3;
  EXPECT_TRUE(std::isnan(split_of(scenario, 1).slow.rms));
}

} // namespace
} // namespace goingrate
