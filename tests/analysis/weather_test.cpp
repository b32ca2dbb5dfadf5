#include "support/scratch_folder.hpp"
#include "support/simulated.hpp"
#include "support/weathered_logs.hpp"

#include "analysis/fitted_weather.hpp"
#include "goingrate/analysis/fit_request.hpp"

#include <cmath>

namespace goingrate {
namespace {

using WeatherStudy = test::ScratchFolderTest;

TEST_F(WeatherStudy, ShortForm) {
  for (const test::Thermometer& thermometer : test::thermometers) {
    test::WeatherScore score;
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      test::WeatheredLog log(thermometer, seed);
      score.add(log, path("w.csv"));
    }
    // 95 % of 6 less two and a half standard deviations; the long form has the figures.
    EXPECT_GE(score.within95, 5) << thermometer.name;
    EXPECT_LT(score.z2 / score.logs, 2.7) << thermometer.name; // 1 and three standard deviations
  }
}

// Weather that is smooth between readings, as the simulator's is.
TEST_F(WeatherStudy, TenMinutesTellWhatEveryBeatTells) {
  constexpr test::Thermometer smooth{.name = "smooth", .wander_k = 0.0};
  test::WeatherScore score;
  for (std::uint64_t seed = 101; seed <= 115; ++seed) {
    test::WeatheredLog log(smooth, seed);
    score.add(log, path("w.csv"));
  }
  EXPECT_LT(score.worst_shift, 0.2); // sigma
}

// A clock whose amplitudes tell its drive, so that the errors of its thermometer, 0.1 K in each
// reading, are the greatest there are: without them in the sigmas the squares of misses are ten
// times too large.
TEST(WeatherTest, TheErrorsOfAThermometerAreInTheSigmas) {
  Scenario scenario = test::at_point_b(10000);
  scenario.drive.fast_rms = 0.02;
  scenario.length.temperature_coefficient = 1.15e-5;
  scenario.temperature.sines = {{1.5, 86400.0}};
  scenario.sensor.jitter_rms_s = 2e-5;
  scenario.sensor.amplitude_rms = 2e-5;
  scenario.sensor.temperature_rms = 0.1;
  double z2_temperature = 0.0, z2_phi0 = 0.0, stated = 0.0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const NumberedLog loaded = load_events(test::simulated_log(scenario, seed), {});
    FitRequest request;
    request.escapement = "constant-torque";
    request.events = {"none"};
    const FitSummary fit =
        fit_clock(fit_data(loaded), loaded.nominal_period_s, fit_options(request, loaded));
    const FittedParameter *warmth = fit.find("temperature"), *phi0 = fit.find("phi0");
    ASSERT_TRUE(warmth != nullptr && phi0 != nullptr);
    if (!std::isfinite(warmth->sigma) || !std::isfinite(phi0->sigma)) continue;
    ++stated;
    z2_temperature += std::pow((warmth->value + 0.575e-5) / warmth->sigma, 2);
    z2_phi0 += std::pow((phi0->value - 0.03) / phi0->sigma, 2);
  }
  EXPECT_GE(stated, 3.0);                  // of 4: in some the errors leave the clock open
  EXPECT_LT(z2_temperature / stated, 3.8); // 1, and four standard deviations of a mean of four
  EXPECT_LT(z2_phi0 / stated, 3.8);
}

// Beside a step the rate alone gives the temperature's answer a wrong sign and a wide σ; the fit,
// which knows the step, knows better. What is known better without it stays.
TEST(WeatherTest, WhatTheFitKnowsBetterIsTold) {
  FitSummary fit;
  fit.residual_s.assign(1000, 0.0);
  FittedParameter warmth;
  warmth.name = "temperature";
  warmth.value = -8e-6;
  warmth.sigma = 1e-7;
  warmth.status = ParameterStatus::free;
  fit.parameters.push_back(warmth);
  std::vector<Suspicion> named(1);
  named.front().cause = Cause::temperature;
  named.front().numbers.size = 7e-6;
  named.front().numbers.sigma = 1.5e-5;
  const auto seen = weather_seen_by_fit(fit, named);
  ASSERT_EQ(seen.size(), 1U);
  EXPECT_EQ(seen.front().numbers.size, -8e-6);
  named.front().numbers.sigma = 1e-8;
  EXPECT_TRUE(weather_seen_by_fit(fit, named).empty());
  // A drive whose noise the log leaves open may wander as much.
  FittedParameter drive;
  drive.name = "drive_rms";
  drive.status = ParameterStatus::undetermined;
  fit.parameters.push_back(drive);
  EXPECT_TRUE(weather_seen_by_fit(fit, {}).empty());
}

} // namespace
} // namespace goingrate
