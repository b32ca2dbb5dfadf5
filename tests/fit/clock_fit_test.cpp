#include "goingrate/fit/clock_fit.hpp"

#include "goingrate/base/errors.hpp"
#include "support/simulated.hpp"

#include <gtest/gtest.h>

namespace goingrate {
namespace {

const FittedParameter& parameter(const FitSummary& fit, const std::string& name) {
  for (const FittedParameter& p : fit.parameters)
    if (p.name == name) return p;
  throw std::runtime_error("no parameter " + name);
}

void expect_within(const FitSummary& fit, const std::string& name, double truth, double sigmas) {
  const FittedParameter& p = parameter(fit, name);
  EXPECT_EQ(p.status, ParameterStatus::free) << name;
  EXPECT_LT(std::abs(p.value - truth), sigmas * p.sigma)
      << name << " = " << p.value << " +- " << p.sigma;
}

FitSummary fit_of(const Scenario& scenario, std::uint64_t seed, const FitOptions& options) {
  return fit_clock(timing_data(test::simulated_beats(scenario, seed)),
                   scenario.clock.nominal_period_s, options);
}

constexpr double velocity_a = 0.0390886300401325; // exact, of the limit cycle at A

TEST(ClockFitTest, JumpOverTenSeeds) {
  FitOptions options;
  options.fixed["T0"] = 2.0;
  options.events = {{150, {"mu"}}};
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    const FitSummary fit = fit_of(test::jump_from_a_to_b(2000, 1e-5), seed, options);
    ASSERT_EQ(fit.status, FitStatus::converged);
    EXPECT_EQ(fit.dynamics, "direct") << "first order is off by many sigma here";
    // 50 comparisons: one beyond 3.3 sigma in a thousand.
    expect_within(fit, "epsilon", 2.5e-4, 3.3);
    expect_within(fit, "mu", 2e-5, 3.3);
    expect_within(fit, "phi0", 0.03, 3.3);
    expect_within(fit, "mu@1", 4e-5, 3.3);
    expect_within(fit, "lambda0", velocity_a, 3.3);
    EXPECT_GT(fit.quality.p_value, 1e-4);
    EXPECT_NEAR(fit.timing_noise.jitter_s, 1e-5, 1e-6); // six standard errors
    EXPECT_EQ(parameter(fit, "T0").status, ParameterStatus::fixed);
  }
}

TEST(ClockFitTest, SigmaIsTheScatterOfManyFits) {
  // epsilon from 30 logs: the scatter of its normalised error is 1 to within 4 standard errors.
  FitOptions options;
  options.fixed["T0"] = 2.0;
  options.events = {{150, {"mu"}}};
  double sum2 = 0.0;
  for (std::uint64_t seed = 101; seed <= 130; ++seed) {
    const FitSummary fit = fit_of(test::jump_from_a_to_b(600, 1e-4), seed, options);
    const FittedParameter& p = parameter(fit, "epsilon");
    ASSERT_EQ(p.status, ParameterStatus::free);
    sum2 += std::pow((p.value - 2.5e-4) / p.sigma, 2) / 30;
  }
  EXPECT_NEAR(sum2, 1.0, 4 * std::sqrt(2.0 / 30));
}

TEST(ClockFitTest, FirstOrderAloneIsShownToBeOff) {
  FitOptions options;
  options.fixed["T0"] = 2.0;
  options.events = {{150, {"mu"}}};
  options.dynamics = FitDynamics::averaged1;
  const FitSummary fit = fit_of(test::jump_from_a_to_b(2000, 1e-5), 1, options);
  EXPECT_EQ(fit.dynamics, "averaged1");
  const FittedParameter& mu = parameter(fit, "mu");
  EXPECT_GT(std::abs(mu.model_shift), 5.0);
  // What it says it is off by is what it is off by.
  EXPECT_NEAR((mu.value - 2e-5) / mu.sigma, mu.model_shift, 3.5);
}

TEST(ClockFitTest, RingDownOverTenSeeds) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    const FitSummary fit = fit_of(test::ring_down(2000, 1e-5), seed, {});
    ASSERT_EQ(fit.status, FitStatus::converged);
    EXPECT_EQ(fit.escapement, "none");
    expect_within(fit, "T0", 2.0, 3.3);
    expect_within(fit, "epsilon", 2.5e-4, 3.3);
    expect_within(fit, "lambda0", 0.1, 3.3);
    EXPECT_NEAR(fit.q_factor.value, 2000.0, 5 * fit.q_factor.sigma);
  }
}

TEST(ClockFitTest, AStationaryNoiselessLogDeterminesItsRateAndNothingElse) {
  for (const bool known_T0 : {false, true}) {
    FitOptions options;
    if (known_T0) options.fixed["T0"] = 2.0;
    const FitSummary fit = fit_of(test::at_point_a(2000), 1, options);
    ASSERT_EQ(fit.status, FitStatus::converged);
    for (const char* name : {"epsilon", "mu", "phi0", "lambda0"}) {
      EXPECT_EQ(parameter(fit, name).status, ParameterStatus::undetermined) << name;
      EXPECT_TRUE(std::isnan(parameter(fit, name).value)) << name;
      EXPECT_TRUE(std::isnan(parameter(fit, name).sigma)) << name;
    }
    if (!known_T0) {
      EXPECT_EQ(parameter(fit, "T0").status, ParameterStatus::undetermined);
    }
    EXPECT_EQ(fit.combinations.front().name, "mean period");
    EXPECT_NEAR(fit.combinations.front().value, 2.0 * 6.28247333681895236 / 6.28318530717958648,
                1e-10);
    EXPECT_TRUE(std::isnan(fit.q_factor.value));
    EXPECT_FALSE(fitted_clock(fit));
  }
}

TEST(ClockFitTest, AnAmplitudeColumnTellsTheAmplitudeOfAStationaryClockButNotItsFriction) {
  Scenario scenario = test::at_point_a(2000);
  scenario.sensor.jitter_rms_s = 1e-5;
  scenario.sensor.amplitude_rms = 1e-5;
  FitOptions options;
  options.fixed["T0"] = 2.0;
  const FitSummary fit = fit_of(scenario, 1, options);
  EXPECT_EQ(parameter(fit, "epsilon").status, ParameterStatus::undetermined);
  expect_within(fit, "lambda0", velocity_a, 4.0);
  EXPECT_TRUE(std::isnan(fit.stationary_amplitude.value)) << "where it tends hangs on the friction";
}

TEST(ClockFitTest, TimesAndAmplitudesTogetherFreeT0) {
  Scenario scenario = test::jump_from_a_to_b(1000, 1e-5);
  const FitOptions options{FitDynamics::automatic, {{150, {"mu"}}}, {}, {}};
  const double without = parameter(fit_of(scenario, 2, options), "T0").sigma;
  scenario.sensor.amplitude_rms = 2e-6;
  const FitSummary fit = fit_of(scenario, 2, options);
  expect_within(fit, "T0", 2.0, 3.5);
  expect_within(fit, "epsilon", 2.5e-4, 3.5);
  expect_within(fit, "mu@1", 4e-5, 3.5);
  expect_within(fit, "lambda0", velocity_a, 3.5);
  const double with = parameter(fit, "T0").sigma;
  EXPECT_LT(with, 0.3 * without) << "the amplitudes must have helped";
}

TEST(ClockFitTest, MissedAndSpuriousBeatsDoNotSpoilIt) {
  Scenario scenario = test::jump_from_a_to_b(2000, 1e-5);
  scenario.sensor.missed = 0.05;
  FitOptions options;
  options.fixed["T0"] = 2.0;
  options.events = {{150, {"mu"}}};
  const FitSummary fit = fit_of(scenario, 4, options);
  expect_within(fit, "epsilon", 2.5e-4, 3.5);
  expect_within(fit, "phi0", 0.03, 3.5);
}

TEST(ClockFitTest, DriveNoiseIsSeenAsARandomWalk) {
  Scenario scenario = test::at_point_b(5000);
  scenario.drive.fast_rms = 0.3;
  scenario.sensor.jitter_rms_s = 1e-6;
  FitOptions options;
  options.fixed["T0"] = 2.0;
  const FitSummary fit = fit_of(scenario, 1, options);
  EXPECT_EQ(fit.noise, "jitter + random walk");
  EXPECT_NEAR(fit.timing_noise.walk_s, 2.0 * 0.3 * 3.86919e-4, 0.05 * 2.4e-4); // T0 rms x fast gain
  // Its mean rate is known only as well as the walk allows.
  EXPECT_LT(std::abs(fit.rate_s_per_day.value - 86400 * 1.96005e-4), 4 * fit.rate_s_per_day.sigma);
}

// Scenes that determine much or little; what is called determined must be right. Truth lies within
// four sigma always (a hundred or two comparisons a scene), and the scatter of the normalised
// errors is that of honest sigmas, or smaller where the check for other minima has widened them.
struct Scene {
  const char* name;
  Scenario scenario;
  FitOptions options;
  bool determines_all;
};

class HonestSigma : public testing::TestWithParam<int> {};

Scene scene(int index) {
  Scenario start_up = test::at_point_a(3000), amplitudes = test::at_point_a(2000);
  start_up.start_amplitude = 0.035;
  start_up.sensor.jitter_rms_s = 1e-5;
  amplitudes.sensor.jitter_rms_s = 1e-5;
  amplitudes.sensor.amplitude_rms = 1e-5;
  Scenario noisy = test::at_point_a(2000);
  noisy.drive.fast_rms = 0.3;
  noisy.sensor.jitter_rms_s = 1e-5;
  const FitOptions jump{FitDynamics::automatic, {{150, {"mu"}}}, {}, {}};
  const std::vector<Scene> scenes{
      {"JumpWithT0Free", test::jump_from_a_to_b(2000, 1e-4), jump, true},
      {"StartUp", start_up, {}, false},
      {"RingDownUnderJitter", test::ring_down(2000, 1e-4), {}, true},
      {"StationaryWithAmplitudes", amplitudes, {}, false},
      {"StationaryUnderDriveNoise", noisy, {}, false},
  };
  return scenes[static_cast<std::size_t>(index)];
}

TEST_P(HonestSigma, WhatIsCalledDeterminedIsRight) {
  const Scene s = scene(GetParam());
  const std::map<std::string, double> truth{
      {"T0", 2.0},    {"epsilon", 2.5e-4},
      {"mu", 2e-5},   {"phi0", 0.03},
      {"mu@1", 4e-5}, {"lambda0", s.scenario.start_amplitude.value_or(velocity_a)}};
  double sum2 = 0.0, count = 0.0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const FitSummary fit = fit_of(s.scenario, seed, s.options);
    ASSERT_EQ(fit.status, FitStatus::converged);
    for (const FittedParameter& p : fit.parameters) {
      if (!std::isfinite(p.sigma)) {
        EXPECT_FALSE(s.determines_all) << seed << ": " << p.name << " should be determined";
        continue;
      }
      const double z = (p.value - truth.at(p.name)) / p.sigma;
      EXPECT_LT(std::abs(z), 4.0) << seed << ": " << p.name << " = " << p.value << " +- "
                                  << p.sigma;
      sum2 += z * z;
      ++count;
    }
  }
  if (count == 0.0) return; // nothing was called determined
  EXPECT_LT(std::sqrt(sum2 / count), 1.35);
  if (s.determines_all) {
    EXPECT_GT(std::sqrt(sum2 / count), 0.65);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, HonestSigma, testing::Range(0, 5),
                         [](const auto& index) { return scene(index.param).name; });

TEST(ClockFitTest, AModelThatRunsSlowIsNotPreferredForShrinkingTheNoise) {
  // The likelihood at the fit is at least that at the truth, and hardly better: with five
  // parameters chi-squared falls by some five, not by the per cents a slow clock would take off
  // every residual.
  const Scenario scenario = test::ring_down(2000, 1e-4);
  const FitSummary fit = fit_of(scenario, 12, {});
  EXPECT_NEAR(fit.quality.rms_s, 1.017e-4, 0.01e-4); // of the simulated jitter itself, seed 12
  EXPECT_NEAR(parameter(fit, "lambda0").value, 0.1, 1e-4);
}

TEST(ClockFitTest, APriorEntersTheResult) {
  Scenario scenario = test::jump_from_a_to_b(300, 1e-4);
  FitOptions options;
  options.fixed["T0"] = 2.0;
  options.events = {{150, {"mu"}}};
  options.priors = {{"epsilon", 2.5e-4, 1e-8}};
  const FitSummary fit = fit_of(scenario, 1, options);
  const FittedParameter& epsilon = parameter(fit, "epsilon");
  EXPECT_EQ(epsilon.status, ParameterStatus::prior);
  EXPECT_NEAR(epsilon.value, 2.5e-4, 4e-8);
  EXPECT_LE(epsilon.sigma, 1.01e-8);
}

TEST(ClockFitTest, TenPeriodsDetermineNothingButTheRate) {
  Scenario scenario = test::at_point_a(10);
  scenario.sensor.jitter_rms_s = 1e-5;
  const FitSummary fit = fit_of(scenario, 1, {});
  for (const FittedParameter& p : fit.parameters)
    EXPECT_EQ(p.status, ParameterStatus::undetermined) << p.name << " = " << p.value;
}

TEST(ClockFitTest, NonsenseIsRefusedByName) {
  const TimingData data = timing_data(test::simulated_beats(test::at_point_a(20), 1));
  const auto with = [&](auto&& change) {
    FitOptions options;
    change(options);
    return fit_clock(data, 2.0, options);
  };
  EXPECT_THROW((void)with([](FitOptions& o) { o.fixed["eps"] = 1; }), ArgumentError);
  EXPECT_THROW((void)with([](FitOptions& o) { o.fixed["epsilon"] = -1; }), ArgumentError);
  EXPECT_THROW((void)with([](FitOptions& o) { o.events = {{30, {"mu"}}}; }), ArgumentError);
  EXPECT_THROW((void)with([](FitOptions& o) { o.events = {{5, {"T0"}}}; }), ArgumentError);
  EXPECT_THROW((void)with([](FitOptions& o) { o.events = {{5, {"mu", "mu"}}}; }), ArgumentError);
  EXPECT_THROW((void)with([](FitOptions& o) {
                 o.fixed["T0"] = 2.0;
                 o.priors = {{"T0", 2.0, 0.1}};
               }),
               ArgumentError);
  EXPECT_THROW((void)with([](FitOptions& o) { o.priors = {{"mu", 1e-5, 0.0}}; }), ArgumentError);
  EXPECT_THROW((void)parse_fit_event("mu"), ArgumentError);
  EXPECT_THROW((void)parse_fit_event("15x:mu"), ArgumentError);
  EXPECT_EQ(parse_fit_event("15:mu,epsilon").names.size(), 2u);
}

} // namespace
} // namespace goingrate
