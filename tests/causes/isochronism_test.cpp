#include "support/varying_amplitudes.hpp"

#include <gtest/gtest.h>

namespace goingrate {
namespace {

TEST(IsochronismStudy, ShortForm) {
  test::SlopeScore score;
  for (std::uint64_t seed = 1; seed <= 40; ++seed)
    score.add(seed, 1);
  EXPECT_GE(score.stated, 30);
  // 95 % less three standard deviations; the long form has the figures.
  EXPECT_GE(score.within95, static_cast<int>(0.95 * score.stated - 4.2));
  EXPECT_LT(score.z2 / score.stated, 2.0); // 1 and three standard deviations of 40, nearly
}

TEST(IsochronismTest, ASteadyAmplitudeTellsNothing) {
  Scenario scenario = test::at_point_b(2000);
  scenario.sensor.amplitude_rms = 1e-4;
  scenario.sensor.jitter_rms_s = 1e-5;
  const auto beats = test::simulated_beats(scenario, 1);
  FitSummary no_fit;
  no_fit.status = FitStatus::no_valid_model;
  EXPECT_FALSE(isochronism(timing_data(beats), no_fit));
}

} // namespace
} // namespace goingrate
