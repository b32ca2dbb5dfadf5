#include "goingrate/fit/clock_fit.hpp"

#include "goingrate/base/random.hpp"
#include "support/fit_scenes.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <string>
#include <vector>

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

// Sizes of what walks besides the drive, a cycle.
struct Walks {
  double late_s = 0.0; ///< of the times, as of pushes that come early or late
  double rate = 0.0;   ///< of the clock's own rate, relative
};

// A clock under a drive that varies, with these walks, of which the swing does not tell.
FitSummary fitted_with(const Walks& walks, std::uint64_t seed) {
  Scenario s = test::at_point_b(6000);
  s.drive.fast_rms = 0.3;
  s.sensor.jitter_rms_s = 1e-5;
  s.sensor.amplitude_rms = 1e-5;
  TimingData data = timing_data(test::simulated_beats(s, seed));
  RandomStream random(seed, StreamPurpose::temperature_noise);
  double late = 0.0, slow = 0.0;
  for (std::size_t i = 1; i < data.size(); ++i) {
    late += walks.late_s * random.normal() + 2.0 * slow;
    slow += walks.rate * random.normal();
    data.lateness_s[i] += late;
    data.elapsed_s[i] += late;
  }
  FitOptions options;
  options.fixed["T0"] = 2.0;
  return fit_clock(data, 2.0, options);
}

// How far the fits of four logs are off, where they state a parameter, and what noise they name.
struct Told {
  double mean_square = 0.0, stated = 0.0;
  std::vector<std::string> noises;
};
Told told_under(const Walks& walks) {
  const std::map<std::string, double> truth{
      {"epsilon", 2.5e-4},      {"mu", 4e-5},       {"phi0", 0.03},      {"walk_rms", walks.late_s},
      {"rate_rms", walks.rate}, {"drive_rms", 0.3}, {"jitter_rms", 1e-5}};
  Told told;
  for (const std::uint64_t seed : {271, 272, 273, 274}) {
    const FitSummary fit = fitted_with(walks, seed);
    told.noises.push_back(fit.model.noise());
    for (const auto& [name, value] : truth) {
      const FittedParameter* found = fit.find(name);
      if (found == nullptr || !std::isfinite(found->sigma)) continue;
      told.mean_square += std::pow((found->value - value) / found->sigma, 2);
      ++told.stated;
    }
  }
  told.mean_square /= told.stated;
  return told;
}
constexpr double least_stated = 16.0; // of 24: most are determined
// One in a thousand by chance for 16 squares.
constexpr double largest_mean_square = 2.5;

TEST(NoiseChoice, TimesThatWalkUnderADriveThatVaries) {
  const Told told = told_under({.late_s = 2e-5});
  EXPECT_EQ(told.noises, std::vector<std::string>(4, "jitter + random walk + drive"));
  EXPECT_GE(told.stated, least_stated);
  EXPECT_LT(told.mean_square, largest_mean_square);
}

TEST(NoiseChoice, ARateThatWalksUnderADriveThatVaries) {
  const Told told = told_under({.rate = 1e-7});
  EXPECT_EQ(told.noises, std::vector<std::string>(4, "jitter + drive + wandering rate"));
  EXPECT_GE(told.stated, least_stated);
  EXPECT_LT(told.mean_square, largest_mean_square);
}

TEST(NoiseChoice, TimesDoNotWalkBesidesWhatTheDriveDoes) {
  for (const std::uint64_t seed : {281, 282, 283, 284})
    EXPECT_EQ(fitted_with({}, seed).model.noise(), "jitter + drive") << seed;
}

} // namespace
} // namespace goingrate
