#include "goingrate/fit/clock_fit.hpp"

#include "base/workers.hpp"
#include "goingrate/base/errors.hpp"
#include "goingrate/base/random.hpp"
#include "support/fit_scenes.hpp"

#include <bit>
#include <gtest/gtest.h>
#include <map>

namespace goingrate {
namespace {

void expect_within(const FitSummary& fit, const std::string& name, double truth, double sigmas) {
  const FittedParameter& p = fit[name];
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
    EXPECT_NE(fit.dynamics, FitDynamics::averaged1) << "first order is off by many sigma here";
    // 50 comparisons: one beyond 3.3 sigma in a thousand.
    expect_within(fit, "epsilon", 2.5e-4, 3.3);
    expect_within(fit, "mu", 2e-5, 3.3);
    expect_within(fit, "phi0", 0.03, 3.3);
    expect_within(fit, "mu@1", 4e-5, 3.3);
    expect_within(fit, "lambda0", velocity_a, 3.3);
    EXPECT_GT(fit.quality.p_value, 1e-4);
    EXPECT_NEAR(fit.jitter_s, 1e-5, 1e-6); // six standard errors
    EXPECT_EQ(fit["T0"].status, ParameterStatus::fixed);
  }
}

// What is left is the noise.
TEST(ClockFitTest, EveryParameterOfTheClockMayBeHeld) {
  const Scenario scenario = test::jump_from_a_to_b(2000, 1e-5);
  FitOptions options;
  options.events = {{150, {"mu"}}};
  const FitSummary fitted = fit_of(scenario, 1, options);
  for (const FittedParameter& parameter : fitted.parameters)
    if (parameter.name != "jitter_rms") options.fixed[parameter.name] = parameter.value;
  const FitSummary held = fit_of(scenario, 1, options);
  ASSERT_EQ(held.status, FitStatus::converged) << held.termination;
  expect_within(held, "jitter_rms", 1e-5, 3.0);
  for (const FittedParameter& parameter : held.parameters) {
    const bool is_noise = parameter.name.find("_rms") != std::string::npos;
    EXPECT_EQ(parameter.status == ParameterStatus::fixed, !is_noise) << parameter.name;
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
    const FittedParameter& p = fit["epsilon"];
    ASSERT_EQ(p.status, ParameterStatus::free);
    sum2 += std::pow((p.value - 2.5e-4) / p.sigma, 2) / 30;
  }
  EXPECT_NEAR(sum2, 1.0, 4 * std::sqrt(2.0 / 30));
}

// The slow way round is a fit for each point. Returns how even the most lopsided interval is.
double evenness_of_profiles(const Scenario& scenario, const FitOptions& options,
                            std::initializer_list<const char*> names) {
  const FitSummary fit = fit_of(scenario, 101, options);
  const double minus_one_parameter = std::log(static_cast<double>(fit.residual_s.size() - 1));
  double least_even = 1.0;
  for (const char* name : names) {
    const FittedParameter& p = fit[name];
    EXPECT_EQ(p.profile.size(), 11u) << name; // five on each side
    if (p.profile.size() != 11u) continue;
    EXPECT_LT(p.profile.front().value, p.low95);
    EXPECT_GT(p.profile.back().value, p.high95);
    least_even = std::min(least_even, (p.value - p.low95) / (p.high95 - p.value));
    if (p.name == "jitter_rms") continue; // cannot be held
    for (const ProfilePoint& point : p.profile) {
      FitOptions held = options;
      held.profiles = false;
      held.fixed[name] = point.value;
      const double fall =
          fit_of(scenario, 101, held).quality.bic - fit.quality.bic + minus_one_parameter;
      const double widened = fit.time_widening * fit.time_widening;
      // the searches stop when a step gains less than 0.01 of L; the rest is the look's share
      EXPECT_NEAR(point.fall * widened, fall, 0.05 + 0.02 * fall) << name << " at " << point.value;
    }
  }
  return least_even;
}

TEST(ClockFitTest, AProfileIsThatOfFitsWithTheParameterHeld) {
  // Few beats and much jitter: the profiles lean.
  FitOptions options;
  options.dynamics = FitDynamics::averaged1;
  options.noise = FitNoise::jitter;
  options.fixed["T0"] = 2.0;
  options.events = {{150, {"mu"}}};
  options.profiles = true;
  EXPECT_LT(evenness_of_profiles(test::jump_from_a_to_b(500, 2e-4), options,
                                 {"epsilon", "phi0", "mu@1", "jitter_rms"}),
            0.95);
}

TEST(ClockFitTest, SoIsItWhereTheDriveIsRough) {
  FitOptions options;
  options.dynamics = FitDynamics::averaged1;
  options.noise = FitNoise::both;
  options.fixed["T0"] = 2.0;
  options.events = {{150, {"mu"}}};
  options.profiles = true;
  Scenario scenario = test::jump_from_a_to_b(1500, 1e-5);
  scenario.drive.fast_rms = 0.03;
  EXPECT_LT(evenness_of_profiles(scenario, options, {"epsilon", "phi0", "mu", "drive_rms"}), 0.95);
}

// All numbers of a fit, to the last bit.
std::vector<std::uint64_t> bits_of(const FitSummary& fit) {
  std::vector<std::uint64_t> bits{fit.alternatives.size(), fit.twins.size()};
  const auto add = [&](double number) { bits.push_back(std::bit_cast<std::uint64_t>(number)); };
  for (const FittedParameter& p : fit.parameters) {
    for (const double number : {p.value, p.sigma, p.low68, p.high68, p.low95, p.high95})
      add(number);
    for (const ProfilePoint& point : p.profile)
      for (const double number : {point.value, point.fall})
        add(number);
  }
  for (const double residual : fit.residual_s)
    add(residual);
  return bits;
}

TEST(ClockFitTest, TheNumberOfThreadsChangesNothing) {
  FitOptions options;
  options.events = {{150, {"mu"}}};
  options.profiles = true;
  Scenario rough = test::jump_from_a_to_b(1500, 1e-5);
  rough.drive.fast_rms = 0.03;
  for (const Scenario& scenario : {test::jump_from_a_to_b(1500, 1e-4), rough}) {
    const auto shared = bits_of(fit_of(scenario, 7, options));
    std::vector<std::vector<std::uint64_t>> alone(2); // a part of shared work has one thread
    share(2, 2, [&](std::size_t i) { alone[i] = bits_of(fit_of(scenario, 7, options)); });
    EXPECT_EQ(alone[0], shared);
    EXPECT_EQ(alone[1], shared);
  }
}

TEST(ClockFitTest, FirstOrderAloneIsShownToBeOff) {
  FitOptions options;
  options.fixed["T0"] = 2.0;
  options.events = {{150, {"mu"}}};
  options.dynamics = FitDynamics::averaged1;
  const FitSummary fit = fit_of(test::jump_from_a_to_b(2000, 1e-5), 1, options);
  EXPECT_EQ(fit.dynamics, FitDynamics::averaged1);
  const FittedParameter& mu = fit["mu"];
  EXPECT_GT(std::abs(mu.model_shift), 5.0);
  // What it says it is off by is what it is off by.
  EXPECT_NEAR((mu.value - 2e-5) / mu.sigma, mu.model_shift, 3.5);
}

TEST(ClockFitTest, RingDownOverTenSeeds) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    const FitSummary fit = fit_of(test::ring_down(2000, 1e-5), seed, {});
    ASSERT_EQ(fit.status, FitStatus::converged);
    EXPECT_EQ(fit.model.escapement, Escapement::none);
    expect_within(fit, "T0", 2.0, 3.3);
    expect_within(fit, "epsilon", 2.5e-4, 3.3);
    expect_within(fit, "lambda0", 0.1, 3.3);
    EXPECT_NEAR(fit.q_factor.value, 2000.0, 5 * fit.q_factor.sigma);
  }
}

TEST(ClockFitTest, AWideRingDownIsFollowedByTheFullEquation) {
  // Far beyond first order: its first fit is off by thousands of sigma.
  Scenario scenario = test::ring_down(1000, 1e-6);
  scenario.start_amplitude = 0.6;
  const FitSummary fit = fit_of(scenario, 1, {});
  EXPECT_EQ(fit.dynamics, FitDynamics::map);
  EXPECT_EQ(fit.model.friction(), "linear");
  EXPECT_EQ(fit.model.noise(), "jitter");
  expect_within(fit, "lambda0", 0.6, 3.3); // one comparison in a thousand
  expect_within(fit, "epsilon", 2.5e-4, 3.3);
  EXPECT_NEAR(fit.jitter_s, 1e-6, 1e-7); // four standard errors
}

TEST(ClockFitTest, AStationaryNoiselessLogDeterminesItsRateAndNothingElse) {
  for (const bool known_T0 : {false, true}) {
    FitOptions options;
    if (known_T0) options.fixed["T0"] = 2.0;
    const FitSummary fit = fit_of(test::at_point_a(2000), 1, options);
    ASSERT_EQ(fit.status, FitStatus::converged);
    for (const char* name : {"epsilon", "mu", "phi0", "lambda0"}) {
      EXPECT_EQ(fit[name].status, ParameterStatus::undetermined) << name;
      EXPECT_TRUE(std::isnan(fit[name].value)) << name;
      EXPECT_TRUE(std::isnan(fit[name].sigma)) << name;
    }
    if (!known_T0) {
      EXPECT_EQ(fit["T0"].status, ParameterStatus::undetermined);
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
  EXPECT_EQ(fit["epsilon"].status, ParameterStatus::undetermined);
  expect_within(fit, "lambda0", velocity_a, 4.0);
  EXPECT_TRUE(std::isnan(fit.stationary_amplitude.value)) << "where it tends hangs on the friction";
}

TEST(ClockFitTest, WhatHangsOnAnUndeterminedFrictionIsNotStated) {
  // Sixty beats with a jump: the friction is never told, and linear sigmas of what follows from it
  // are too small by far.
  Scenario scenario = test::at_point_a(60);
  scenario.clock = {2.0, 2e-3, 2e-4, 0.03};
  ClockEvent event;
  event.at_period = 20;
  event.mu = 4e-4;
  scenario.events = {event};
  scenario.sensor.jitter_rms_s = 1e-4;
  FitOptions options;
  options.fixed["T0"] = 2.0;
  options.events = {{20, {"mu"}}};
  int undetermined = 0;
  for (std::uint64_t seed = 5000; seed < 5020; ++seed) {
    SCOPED_TRACE(seed);
    const FitSummary fit = fit_of(scenario, seed, options);
    if (fit["epsilon"].status != ParameterStatus::undetermined) continue;
    ++undetermined;
    for (const DerivedQuantity* quantity :
         {&fit.q_factor, &fit.decay_time, &fit.stationary_amplitude})
      EXPECT_TRUE(std::isnan(quantity->value)) << quantity->name;
    for (const char* name : {"relaxation time", "fast gain", "slow gain"})
      EXPECT_EQ(fit.combination(name), nullptr) << name;
  }
  EXPECT_GT(undetermined, 0);
}

TEST(ClockFitTest, AT0ThatNoSwingCanHaveIsRefused) {
  const auto data = timing_data(test::simulated_beats(test::at_point_a(300), 1));
  for (const double T0_s : {1.0, 3.0, 2.0 / 60.0}) { // of 2 s: beats, another clock, another unit
    FitOptions options;
    options.fixed["T0"] = T0_s;
    EXPECT_THROW((void)fit_clock(data, 2.0, options), ArgumentError) << T0_s;
  }
}

TEST(ClockFitTest, TimesAndAmplitudesTogetherFreeT0) {
  Scenario scenario = test::jump_from_a_to_b(1000, 1e-5);
  FitOptions options;
  options.events = {{150, {"mu"}}};
  const double without = fit_of(scenario, 2, options)["T0"].sigma;
  scenario.sensor.amplitude_rms = 2e-6;
  const FitSummary fit = fit_of(scenario, 2, options);
  expect_within(fit, "T0", 2.0, 3.5);
  expect_within(fit, "epsilon", 2.5e-4, 3.5);
  expect_within(fit, "mu@1", 4e-5, 3.5);
  expect_within(fit, "lambda0", velocity_a, 3.5);
  const double with = fit["T0"].sigma;
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

TEST(ClockFitTest, DriveNoiseIsSeenForWhatItIs) {
  Scenario scenario = test::at_point_b(20000);
  scenario.drive.fast_rms = 0.3;
  scenario.sensor.jitter_rms_s = 1e-6;
  FitOptions options;
  options.fixed["T0"] = 2.0;
  const FitSummary fit = fit_of(scenario, 1, options);
  EXPECT_TRUE(fit.model.drive) << fit.model.noise();
  // Its mean rate is known only as well as the walk allows.
  EXPECT_LT(std::abs(fit.rate_s_per_day.value - 86400 * 1.96005e-4), 4 * fit.rate_s_per_day.sigma);
}

TEST(ClockFitTest, AWanderThatNeighbouringBeatsHideIsTakenForNoise) {
  // Far below the jitter from beat to beat, far above it over the log; without noise the full
  // equation chases it at every beat.
  Scenario scenario = test::at_point_b(6000);
  scenario.drive.slow_rms = 0.02;
  scenario.drive.slow_time_s = 600.0;
  scenario.sensor.jitter_rms_s = 1e-3;
  scenario.sensor.amplitude_rms = 1e-5;
  const FitSummary fit = fit_of(scenario, 1, {});
  EXPECT_EQ(fit.model.noise(), "jitter + drive + slow drive");
  for (const FitAlternative& tried : fit.alternatives)
    EXPECT_TRUE(tried.model.rfind("map", 0) != 0 || tried.model.find("drive") != std::string::npos)
        << tried.model;
  EXPECT_NEAR(fit.jitter_s, 1e-3, 4e-5); // six standard errors
  const std::map<std::string, double> truth{
      {"epsilon", 2.5e-4}, {"mu", 4e-5}, {"phi0", 0.03}, {"slow_rms", 0.02}, {"slow_time", 600.0}};
  for (const FittedParameter& p : fit.parameters)
    if (truth.contains(p.name) && p.status == ParameterStatus::free) {
      EXPECT_LT(std::abs(p.value - truth.at(p.name)), 4.0 * p.sigma) << p.name;
    }
}

TEST(ClockFitTest, SigmaIsTheCramerRaoBoundOfTheFullSimulator) {
  for (const test::FitScene& scene :
       {test::jump_scene("jump", 2000, 1e-6, false), test::ring_down_scene(1000, 1e-5)}) {
    const FitSummary fit = test::fit_scene(scene, 3);
    for (const auto& [name, bound] : test::cramer_rao(scene))
      EXPECT_NEAR(fit[name].sigma / bound, 1.0, 0.1) // the jitter is known to 1.6 %
          << name;
  }
}

// How far a parameter of a listed clock is from the truth, in its sigma.
double pull_of(const ClockTwin& clock, const std::string& name, double truth) {
  for (std::size_t i = 0; i < clock.parameters.size(); ++i)
    if (clock.parameters[i].first == name)
      return std::abs(clock.parameters[i].second - truth) / clock.sigma[i].second;
  return std::numeric_limits<double>::infinity();
}

TEST(ClockFitTest, TwoClocksFitAStationaryLogUnderDriveNoise) {
  const FitSummary blind = test::fit_scene(test::noisy_scene(100000, false), 1001);
  EXPECT_EQ(blind["mu"].status, ParameterStatus::undetermined);
  ASSERT_FALSE(blind.notes.empty());
  EXPECT_EQ(blind.notes.front().kind, NoteKind::twin);
  ASSERT_FALSE(blind.twins.empty());
  EXPECT_LT(blind.twins.front().delta_2logL, 2.0); // one of the two is the true clock
  EXPECT_GE(blind.twins.front().delta_2logL, 0.0);
  EXPECT_EQ(blind.twins.front().parameters.front().first, "epsilon"); // T0 is known
  ASSERT_TRUE(blind.likeliest_twin);
  EXPECT_LT(std::min(pull_of(*blind.likeliest_twin, "mu", 4e-5),
                     pull_of(blind.twins.front(), "mu", 4e-5)),
            4.0); // sigma of chance
  const FitSummary seen = test::fit_scene(test::noisy_scene(100000, true), 1001);
  expect_within(seen, "mu", 4e-5, 4.0);
  EXPECT_NEAR(seen["epsilon"].value, blind["epsilon"].value, 0.5 * blind["epsilon"].sigma);
}

TEST(ClockFitTest, AModelThatRunsSlowIsNotPreferredForShrinkingTheNoise) {
  // The likelihood at the fit is at least that at the truth, and hardly better: with five
  // parameters chi-squared falls by some five, not by the per cents a slow clock would take off
  // every residual.
  const Scenario scenario = test::ring_down(2000, 1e-4);
  const FitSummary fit = fit_of(scenario, 12, {});
  EXPECT_NEAR(fit.quality.rms_s, 1.017e-4, 0.01e-4); // of the simulated jitter itself, seed 12
  EXPECT_NEAR(fit["lambda0"].value, 0.1, 1e-4);
}

TEST(ClockFitTest, APriorEntersTheResult) {
  Scenario scenario = test::jump_from_a_to_b(300, 1e-4);
  FitOptions options;
  options.fixed["T0"] = 2.0;
  options.events = {{150, {"mu"}}};
  options.priors = {{"epsilon", 2.5e-4, 1e-8}};
  const FitSummary fit = fit_of(scenario, 1, options);
  const FittedParameter& epsilon = fit["epsilon"];
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

TEST(ClockFitTest, AThousandExactTimesHaveNoNoiseToTest) {
  FitOptions options;
  options.fixed["T0"] = 2.0;
  const FitSummary fit = fit_clock(timing_data(test::even_beats(1000, 1, 2.0)), 2.0, options);
  EXPECT_TRUE(std::isnan(fit.quality.whiteness_p));
  EXPECT_EQ(fit.time_widening, 1.0);
  for (const char* name : {"epsilon", "mu", "phi0", "lambda0"})
    EXPECT_EQ(fit[name].status, ParameterStatus::undetermined) << name;
}

TEST(ClockFitTest, ALogOfFewBeatsFarApartDeterminesNothing) {
  const FitSummary fit = fit_clock(timing_data(test::even_beats(20, 100, 2.0)), 2.0, {});
  for (const FittedParameter& p : fit.parameters)
    if (p.name != "jitter_rms") {
      EXPECT_EQ(p.status, ParameterStatus::undetermined) << p.name << " = " << p.value;
    }
}

TEST(ClockFitTest, APriorThatTheLogRulesOutIsLeftOutAndNamed) {
  FitOptions options;
  options.fixed["T0"] = 2.0;
  options.events = {{150, {"mu"}}};
  options.priors = {{"epsilon", 5e-4, 1e-8}, {"mu", 2e-5, 1e-7}};
  const FitSummary fit = fit_of(test::jump_from_a_to_b(2000, 1e-5), 1, options);
  expect_within(fit, "epsilon", 2.5e-4, 3.3); // one comparison in a thousand
  EXPECT_EQ(fit["mu"].status, ParameterStatus::prior);
  ASSERT_FALSE(fit.notes.empty());
  EXPECT_EQ(fit.notes.front().kind, NoteKind::prior);
  EXPECT_NE(fit.notes.front().text.find("prior on epsilon"), std::string::npos)
      << fit.notes.front().text;
}

TEST(ClockFitTest, NoiseThatIsNamedIsFitted) {
  FitOptions options;
  options.fixed = {{"T0", 2.0}, {"drive_rms", 0.01}};
  options.events = {{150, {"mu"}}};
  const Scenario scenario = test::jump_from_a_to_b(600, 1e-4);
  const FitSummary fit = fit_of(scenario, 1, options);
  EXPECT_EQ(fit["drive_rms"].status, ParameterStatus::fixed);
  options.noise = FitNoise::jitter;
  EXPECT_THROW((void)fit_of(scenario, 1, options), ArgumentError);
  options.noise = FitNoise::both;
  options.freed = {"slow_rms"};
  EXPECT_THROW((void)fit_of(scenario, 1, options), ArgumentError);
  options = {};
  options.fixed["T0"] = 2.0;
  options.events = {{150, {"mu"}}};
  options.freed = {"dry_friction"};
  EXPECT_EQ(fit_of(scenario, 1, options).model.friction(), "linear + dry");
}

TEST(ClockFitTest, SlowDriveIsFittedToShortLogsToo) {
  for (const int beats : {3, 5, 10, 20, 31}) {
    FitOptions options;
    options.noise = FitNoise::slow;
    const auto fit = fit_clock(timing_data(test::even_beats(beats, 1, 2.0001)), 2.0, options);
    for (const FittedParameter& parameter : fit.parameters)
      if (parameter.name != "jitter_rms") {
        EXPECT_NE(parameter.status, ParameterStatus::free) << parameter.name << " of " << beats;
      }
  }
}

TEST(ClockFitTest, ManyTermsOnFewBeatsAreFittedInFewSteps) {
  // Below the amplitude at which the clock stalls the course runs away from it. Steps of the wrong
  // sign there would never arrive: a run of the test that hangs is a failure.
  auto beats = test::even_beats(50, 1, 2.0002);
  RandomStream random(1, StreamPurpose::jitter);
  for (Beat& beat : beats)
    beat.time = beat.time + 1e-4 * random.normal();
  FitOptions options;
  options.freed = {"quadratic_drag", "dry_friction", "offset", "drift"};
  EXPECT_EQ(fit_clock(timing_data(beats), 2.0, options).status, FitStatus::converged);
}

} // namespace
} // namespace goingrate
