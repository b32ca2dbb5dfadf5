#include "goingrate/fit/clock_fit.hpp"

#include "support/fit_scenes.hpp"

#include <gtest/gtest.h>

namespace goingrate {
namespace {

// A clock of Q 500 under a drive that varies from beat to beat, whose amplitudes are seen so well
// that first order is not enough.
FitSummary fitted_with_slow_drive(double slow_rms) {
  Scenario s;
  s.clock = {1.0, 1e-3, 2e-4, 0.04};
  s.periods = 10000;
  s.drive.fast_rms = 0.2;
  s.drive.slow_rms = slow_rms;
  s.drive.slow_time_s = 300.0;
  s.sensor.jitter_rms_s = 1e-5;
  s.sensor.amplitude_rms = 2e-5;
  FitOptions options;
  options.fixed["T0"] = 1.0;
  return fit_clock(timing_data(test::simulated_beats(s, 3141)), 1.0, options);
}

TEST(NoiseChoice, SlowDriveIsNamedWhereThereIsSome) {
  EXPECT_TRUE(fitted_with_slow_drive(0.1).model.slow);
}

// Where the fits with and without it were of different dynamics, their difference passed for slow
// drive.
TEST(NoiseChoice, SlowDriveIsNotNamedWhereThereIsNone) {
  const FitSummary fit = fitted_with_slow_drive(0.0);
  EXPECT_TRUE(fit.model.drive);
  EXPECT_FALSE(fit.model.slow);
}

// Amplitudes under drive noise ask for second order also where all beats are used: first order is
// off by several sigma of T0.
TEST(NoiseChoice, DynamicsAreJudgedAfterTheNoise) {
  Scenario s;
  s.clock = {1.0, 2.5e-4, 5e-5, 0.04};
  s.periods = 10000;
  s.drive.fast_rms = 0.2;
  s.sensor.jitter_rms_s = 1e-5;
  s.sensor.amplitude_rms = 2e-5;
  const FitSummary fit = fit_clock(timing_data(test::simulated_beats(s, 2718)), 1.0, {});
  EXPECT_TRUE(fit.model.drive);
  EXPECT_NE(fit.dynamics, FitDynamics::averaged1);
}

} // namespace
} // namespace goingrate
