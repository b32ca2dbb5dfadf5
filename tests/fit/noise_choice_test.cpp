#include "goingrate/fit/clock_fit.hpp"

#include "goingrate/base/random.hpp"
#include "support/fit_scenes.hpp"

#include <cmath>
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

// A clock under a drive that varies, whose pushes also come early or late: the times walk by
// `walk_s` a cycle and the swing stays as it is.
FitSummary fitted_with_walk(double walk_s, std::uint64_t seed) {
  Scenario s = test::at_point_b(6000);
  s.drive.fast_rms = 0.3;
  s.sensor.jitter_rms_s = 1e-5;
  s.sensor.amplitude_rms = 1e-5;
  TimingData data = timing_data(test::simulated_beats(s, seed));
  RandomStream random(seed, StreamPurpose::temperature_noise);
  double late = 0.0;
  for (std::size_t i = 1; i < data.size(); ++i) {
    late += walk_s * random.normal();
    data.lateness_s[i] += late;
    data.elapsed_s[i] += late;
  }
  FitOptions options;
  options.fixed["T0"] = 2.0;
  return fit_clock(data, 2.0, options);
}

TEST(NoiseChoice, TimesThatWalkUnderADriveThatVaries) {
  const std::map<std::string, double> truth{{"epsilon", 2.5e-4}, {"mu", 4e-5},
                                            {"phi0", 0.03},      {"walk_rms", 2e-5},
                                            {"drive_rms", 0.3},  {"jitter_rms", 1e-5}};
  double squares = 0.0, stated = 0.0;
  for (const std::uint64_t seed : {271, 272, 273, 274}) {
    const FitSummary fit = fitted_with_walk(2e-5, seed);
    EXPECT_EQ(fit.model.noise(), "jitter + random walk + drive") << seed;
    for (const auto& [name, value] : truth) {
      const FittedParameter* found = fit.find(name);
      if (found == nullptr || !std::isfinite(found->sigma)) continue;
      squares += std::pow((found->value - value) / found->sigma, 2);
      ++stated;
    }
  }
  EXPECT_GE(stated, 16.0); // of 24: most are determined
  // One in a thousand by chance for 16 squares: 2.5 of their mean.
  EXPECT_LT(squares / stated, 2.5);
}

TEST(NoiseChoice, TimesDoNotWalkBesidesWhatTheDriveDoes) {
  for (const std::uint64_t seed : {281, 282, 283, 284})
    EXPECT_FALSE(fitted_with_walk(0.0, seed).model.walk) << seed;
}

} // namespace
} // namespace goingrate
