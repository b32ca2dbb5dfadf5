#include "goingrate/fit/impulse_cycle.hpp"

#include "fit/push_shapes.hpp"
#include "goingrate/analysis/analyse.hpp"
#include "goingrate/analysis/simulated_logs.hpp"
#include "goingrate/dynamics/intermittent.hpp"
#include "support/simulated.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <sstream>

namespace goingrate {
namespace {

NumberedLog simulated(const Scenario& scenario, std::uint64_t seed) {
  SimulatedLogs logs(scenario);
  const std::array<std::uint64_t, 1> seeds{seed};
  return load_text(logs.make(seeds).front().text, {});
}

TimingData times_of(const Scenario& scenario, std::uint64_t seed) {
  return fit_data(simulated(scenario, seed));
}

Scenario clock_with_rests(std::int64_t every, double amplitude_rms) {
  Scenario scenario;
  ClockParameters& clock = scenario.clock;
  clock.epsilon = 5e-5;
  clock.escapement = Escapement::single_impulse;
  clock.impulse = 2.8e-7 * static_cast<double>(every);
  clock.every = every;
  scenario.periods = 3000;
  scenario.sensor.jitter_rms_s = 2e-6;
  if (amplitude_rms > 0.0) scenario.sensor.amplitude_rms = amplitude_rms;
  return scenario;
}

TEST(ImpulseCycleTest, CountsTheSwingsBetweenPushes) {
  for (const std::int64_t every : {2, 5, 15, 30, 60}) {
    const TimingData data = times_of(clock_with_rests(every, 5e-6), 3);
    ASSERT_TRUE(data.impulses) << every;
    EXPECT_TRUE(data.impulses->is_regular);
    EXPECT_EQ(data.impulses->periods, static_cast<double>(every));
    EXPECT_EQ(std::fmod(data.impulses->first, static_cast<double>(every)), 0.0);
    const auto& epsilon = data.impulses->epsilon;
    ASSERT_TRUE(epsilon);
    EXPECT_LT(std::abs(epsilon->value - 5e-5), 4.0 * epsilon->sigma) << every;
    EXPECT_LT(epsilon->sigma, 5e-5) << every;
  }
}

// Under little noise every overtone of a saw-tooth is a line of its own, and may stand out more
// than the pushes do.
TEST(ImpulseCycleTest, OvertonesOfPushesAreNoWheels) {
  for (const double angle : {-0.01, 0.005, 0.01}) {
    Scenario scenario = clock_with_rests(47, 3.5e-6);
    scenario.clock.nominal_period_s = 1.234;
    scenario.clock.epsilon = 1.37e-4;
    scenario.clock.impulse = 1.41e-6 * 47.0; // an amplitude of 0.04
    scenario.clock.impulse_angle = angle;
    scenario.drive.fast_rms = 0.0045;
    scenario.sensor.jitter_rms_s = 6.6e-7;
    scenario.periods = 7000;
    const TimingData data = times_of(scenario, 3);
    ASSERT_TRUE(data.impulses) << angle;
    EXPECT_TRUE(data.wheels.empty()) << angle;
    ASSERT_TRUE(data.impulses->epsilon) << angle;
    const auto& epsilon = *data.impulses->epsilon;
    EXPECT_LT(std::abs(epsilon.value - 1.37e-4), 4.0 * epsilon.sigma) << angle;
    EXPECT_LT(epsilon.sigma, 1e-3 * epsilon.value) << angle;
  }
}

// A torque cannot set the clock back at each push, as one after the middle does.
TEST(ImpulseCycleTest, WhatIsPushedIsFittedWithImpulses) {
  Scenario scenario = clock_with_rests(15, 5e-6);
  scenario.clock.impulse_angle = 0.006;
  scenario.drive.fast_rms = 0.01;
  const FitSummary fit = fit_clock(times_of(scenario, 11), 2.0, {});
  EXPECT_EQ(fit.status, FitStatus::converged);
  EXPECT_EQ(fit.model.escapement, Escapement::single_impulse);
  FitOptions told;
  told.fixed["phi0"] = 0.006;
  EXPECT_EQ(fit_clock(times_of(scenario, 11), 2.0, told).model.escapement,
            Escapement::constant_torque);
}

TEST(ImpulseCycleTest, TimesAloneShowThemToo) {
  const TimingData data = times_of(clock_with_rests(30, 0.0), 4);
  ASSERT_TRUE(data.impulses);
  EXPECT_EQ(data.impulses->periods, 30.0);
  EXPECT_FALSE(data.impulses->epsilon);
  // s L T0 N / (16 x 8), L = 4 pi eps N lambda^2, lambda^2 = J / (2 pi eps N).
  const double peak = 2.0 * 2.8e-7 * 30.0 * 2.0 * 30.0 / 128.0;
  EXPECT_NEAR(data.impulses->lateness.value, peak, 4.0 * data.impulses->lateness.sigma);
}

// The phase psi = atan(phi/phi') before a push less that after it, for a swing that has fallen by
// exp(-4 pi epsilon N) since the last; through the circular error the push does 1.05 us a period.
TEST(ImpulseCycleTest, APushByItselfIsToldFromItsCircularError) {
  for (const double angle : {-0.015, -0.005, 0.0, 0.005, 0.015}) {
    Scenario scenario = clock_with_rests(15, 0.0);
    scenario.clock.impulse_angle = angle;
    scenario.sensor.jitter_rms_s = 1e-8;
    const TimingData data = times_of(scenario, 4);
    ASSERT_TRUE(data.impulses) << angle;
    const double rise = 2.0 * scenario.clock.impulse;
    const double kept = std::exp(-4.0 * std::numbers::pi * scenario.clock.epsilon * 15.0);
    const double low2 = rise * kept / (1.0 - kept) - angle * angle; // phi'^2 at the angle
    const double truth =
        (std::atan2(angle, std::sqrt(low2)) - std::atan2(angle, std::sqrt(low2 + rise))) /
        std::numbers::pi;
    const auto kick = push_shapes::kick_alone(*data.impulses);
    EXPECT_NEAR(kick.value, truth, 3.0 * kick.sigma) << angle;
    EXPECT_LT(kick.sigma, 0.11e-6) << angle; // a tenth of what it does through the circular error
  }
}

// The mean drive of a clock at rest does not tell its angle while T0 is free; the pushes do.
TEST(ImpulseCycleTest, APushTellsItsAngle) {
  for (const double angle : {-0.006, 0.012}) {
    Scenario scenario = clock_with_rests(15, 5e-6);
    scenario.clock.impulse_angle = angle;
    const FitSummary fit = fit_clock(times_of(scenario, 17), 2.0, {});
    const FittedParameter* found = fit.find("impulse_angle");
    ASSERT_NE(found, nullptr);
    EXPECT_NEAR(found->value, angle, 3.0 * found->sigma);
    EXPECT_LT(found->sigma, 1e-4);
  }
}

// Half of a cycle that is longer than those sought explains much of what is seen, and is not it.
TEST(ImpulseCycleTest, CyclesLongerThanThoseSoughtAreUndetermined) {
  for (const std::int64_t every : {62, 90, 100, 150})
    EXPECT_FALSE(times_of(clock_with_rests(every, 0.0), 5).impulses) << every;
}

// A clock that swings up to its rest, and is pushed harder from the middle of the log on.
TEST(ImpulseCycleTest, PushesMayGrowOnTheWay) {
  Scenario scenario = clock_with_rests(15, 5e-6);
  scenario.periods = 9000;
  scenario.start_amplitude = 0.02; // of 0.03
  ClockEvent event;
  event.at_period = 4500;
  event.impulse = 1.5 * scenario.clock.impulse;
  scenario.events = {event};
  for (const std::uint64_t seed : {13U, 14U, 15U}) {
    const TimingData data = times_of(scenario, seed);
    ASSERT_TRUE(data.impulses) << seed;
    EXPECT_EQ(data.impulses->periods, 15.0) << seed;
    const auto& epsilon = data.impulses->epsilon;
    EXPECT_NEAR(epsilon->value, 5e-5, 4.0 * epsilon->sigma) << seed;
    EXPECT_LT(epsilon->sigma, 0.1 * 5e-5) << seed; // steps that vary by half, 600 of them
  }
}

// Pushes that slip by one swing of sixteen in the last eighth of the log leave a tooth of 0.65
// there.
TEST(ImpulseCycleTest, AToothThatComesAndGoesTellsNoFriction) {
  TimingData data = timing_data(simulated(clock_with_rests(16, 3e-5), 6).good);
  const auto whole = find_impulse_cycle(data);
  ASSERT_TRUE(whole);
  EXPECT_TRUE(whole->epsilon);
  const auto slips =
      data.amplitude_rad.begin() + static_cast<std::ptrdiff_t>(7 * data.amplitude_rad.size() / 8);
  std::rotate(slips, slips + 1, data.amplitude_rad.end());
  const auto slipped = find_impulse_cycle(data);
  ASSERT_TRUE(slipped);
  EXPECT_TRUE(slipped->is_regular);
  EXPECT_FALSE(slipped->epsilon);
}

// A drive that waits for the swing to fall holds the amplitude, which no steady drive does.
TEST(ImpulseCycleTest, WhereNoClockExplainsTheLogNoneIsListed) {
  Scenario scenario;
  scenario.clock.nominal_period_s = 1.7;
  scenario.clock.epsilon = 2.2e-4;
  scenario.clock.escapement = Escapement::single_impulse;
  scenario.clock.impulse = 1.1e-5;
  scenario.clock.below = 0.031;
  scenario.periods = 9000;
  scenario.drive.fast_rms = 0.03;
  scenario.sensor.jitter_rms_s = 2e-5;
  scenario.sensor.amplitude_rms = 1e-5;
  const FitSummary fit = fit_clock(times_of(scenario, 771), 1.7, {});
  ASSERT_EQ(fit.status, FitStatus::contradicts_log);
  for (const char* name : {"T0", "epsilon", "impulse", "impulse_angle", "lambda0"})
    EXPECT_FALSE(std::isfinite(fit.find(name)->sigma)) << name;
  EXPECT_TRUE(fit.twins.empty());
  EXPECT_FALSE(fit.likeliest_twin);
}

// What a fit with the mean drive of such a clock finds may lie several sigma off without looking
// wrong; what its pushes do to the times is no knock.
TEST(ImpulseCycleTest, AFitOfAClockThatWaitsStatesNothing) {
  Scenario scenario;
  scenario.clock.nominal_period_s = 1.3;
  scenario.clock.epsilon = 2e-4;
  scenario.clock.escapement = Escapement::single_impulse;
  scenario.clock.impulse_angle = 0.004;
  scenario.clock.impulse = 2.5e-5;
  scenario.clock.below = 0.03;
  scenario.periods = 9000;
  scenario.drive.fast_rms = 0.05;
  scenario.sensor.jitter_rms_s = 5e-6;
  scenario.sensor.amplitude_rms = 2e-5;
  const Analysis clock = analyse(simulated(scenario, 2), {});
  ASSERT_TRUE(clock.fit.impulses && clock.fit.impulses->epsilon);
  const auto& epsilon = *clock.fit.impulses->epsilon;
  EXPECT_NEAR(epsilon.value, 2e-4, 4.0 * epsilon.sigma);
  EXPECT_EQ(clock.fit.status, FitStatus::contradicts_log);
  for (const char* name : {"T0", "epsilon", "impulse", "impulse_angle"})
    EXPECT_FALSE(std::isfinite(clock.fit.find(name)->sigma)) << name;
  for (const Suspicion& suspicion : clock.suspicions)
    EXPECT_NE(suspicion.cause, Cause::knock) << suspicion.evidence;
}

// The times of a Hipp have the overtones of a mean interval that is no whole number, as a train of
// wheels would: the pushes are found, and what is left is the noise of the sensor.
TEST(ImpulseCycleTest, PushesThatWaitAreFoundFromTimesAlone) {
  Scenario scenario;
  scenario.clock.nominal_period_s = 1.2;
  scenario.clock.epsilon = 3e-4;
  scenario.clock.escapement = Escapement::single_impulse;
  scenario.clock.impulse = 4e-5;
  scenario.clock.impulse_angle = 0.003;
  scenario.periods = 8000;
  scenario.sensor.jitter_rms_s = 1e-5;
  for (const double below : {0.0275, 0.03}) {
    scenario.clock.below = below;
    const TimingData data = times_of(scenario, 1);
    ASSERT_TRUE(data.impulses) << below;
    EXPECT_FALSE(data.impulses->is_regular);
    EXPECT_TRUE(data.wheels.empty());
    const double mean = std::log1p(2.0 * 4e-5 / (below * below)) / (4.0 * std::numbers::pi * 3e-4);
    EXPECT_NEAR(data.impulses->periods, mean, 1.0); // half a swing of overshoot on either side
    double squares = 0.0; // of second differences, in which each time's noise is seen six-fold
    for (std::size_t i = 1; i + 1 < data.size(); ++i)
      squares +=
          std::pow(data.lateness_s[i + 1] - 2.0 * data.lateness_s[i] + data.lateness_s[i - 1], 2);
    const double noise = std::sqrt(squares / (6.0 * static_cast<double>(data.size() - 2)));
    EXPECT_LT(noise, 1.3e-5); // the jitter is 1e-5; with the saw-tooth it is 1.7e-5 or more
  }
}

// At the vertical the arm of a gravity escapement is half-way: that crossing belongs to the push.
TEST(ImpulseCycleTest, APushThroughTheVerticalIsSeenInTwoSteps) {
  Scenario scenario;
  scenario.clock.nominal_period_s = 2.0;
  scenario.clock.epsilon = 1e-4;
  scenario.clock.escapement = Escapement::profile;
  scenario.clock.rising.points = {
      {-0.0031, 0.0}, {-0.003, 5.08e-3}, {0.003, 5.08e-3}, {0.0031, 0.0}};
  scenario.clock.below = 0.035;
  scenario.periods = 12'000;
  scenario.sensor.jitter_rms_s = 5e-6;
  scenario.sensor.amplitude_rms = 1e-5;
  const TimingData data = times_of(scenario, 5);
  ASSERT_TRUE(data.impulses && data.impulses->epsilon);
  EXPECT_NEAR(data.impulses->epsilon->value, 1e-4, 4.0 * data.impulses->epsilon->sigma);
  EXPECT_LT(data.impulses->epsilon->sigma, 1e-7);
  // The half of the push that is done makes the crossing 0.17 ms early.
  EXPECT_LT(data.impulses->middle.value, -100.0 * data.impulses->middle.sigma);
}

// A push after the crossing leaves that crossing alone, however sharp the log: between the pushes
// the swing falls along an exponential, not along a straight line.
TEST(ImpulseCycleTest, APushAfterTheCrossingIsNotInItsMidst) {
  Scenario scenario;
  scenario.clock.nominal_period_s = 1.5;
  scenario.clock.epsilon = 1.1e-4;
  scenario.clock.escapement = Escapement::single_impulse;
  scenario.clock.impulse = 8.4e-5;
  scenario.clock.impulse_angle = 0.007;
  scenario.clock.every = 60;
  scenario.periods = 20'000;
  scenario.sensor.jitter_rms_s = 3e-6;
  scenario.sensor.amplitude_rms = 1e-5;
  for (const std::uint64_t seed : {71, 72, 73}) {
    const TimingData data = times_of(scenario, seed);
    ASSERT_TRUE(data.impulses && data.impulses->epsilon) << seed;
    EXPECT_LT(std::abs(data.impulses->middle.value), 3e-6)
        << seed; // the push sets it back by 1.6 ms
    EXPECT_NEAR(data.impulses->epsilon->value, 1.1e-4, 4.0 * data.impulses->epsilon->sigma);
    EXPECT_LT(data.impulses->epsilon->sigma, 3e-8); // 1.4e-8
  }
}

// Each push sets this clock ahead by 16 ms in 2.5 s: that is no setting of the reference.
TEST(ImpulseCycleTest, StepsThatRecurDoNotSplitTheLog) {
  Scenario scenario;
  scenario.clock = {2.5, 2.2e-4, 60.0 * 2.2e-5, 0.025};
  scenario.clock.every = 60;
  scenario.periods = 6000;
  scenario.sensor.jitter_rms_s = 5e-6;
  scenario.sensor.amplitude_rms = 2e-5;
  const NumberedLog loaded = simulated(scenario, 3);
  EXPECT_EQ(loaded.beats.segments, 1);
  const TimingData data = fit_data(loaded);
  ASSERT_TRUE(data.impulses);
  EXPECT_EQ(data.impulses->periods, 60.0);
}

// Decays between pushes to a relative 1e-4: at 0.05 rad the amplitude alone makes 3e-4.
TEST(ImpulseCycleTest, AWideSwingLosesMore) {
  Scenario scenario = clock_with_rests(1, 1e-7);
  scenario.clock.impulse = 7e-5;
  scenario.clock.below = 0.05;
  const TimingData data = times_of(scenario, 8);
  ASSERT_TRUE(data.impulses && data.impulses->epsilon);
  EXPECT_LT(data.impulses->epsilon->sigma, 1e-4 * 5e-5);
  EXPECT_NEAR(data.impulses->epsilon->value, 5e-5, 4.0 * data.impulses->epsilon->sigma);
}

TEST(ImpulseCycleTest, AHippIsTakenOffPushByPush) {
  Scenario scenario = clock_with_rests(1, 5e-6);
  scenario.clock.impulse = 2e-5;
  scenario.clock.below = 0.03;
  const TimingData data = times_of(scenario, 5);
  ASSERT_TRUE(data.impulses);
  EXPECT_FALSE(data.impulses->is_regular);
  EXPECT_NEAR(data.impulses->periods, std::log1p(4e-5 / 9e-4) / (4.0 * std::numbers::pi * 5e-5),
              1.0);
  EXPECT_NEAR(data.impulses->epsilon->value, 5e-5, 4.0 * data.impulses->epsilon->sigma);
  // The unfinished intervals at both ends are taken off too: no amplitude is far from the others.
  const auto [low, high] =
      std::minmax_element(data.amplitude_rad.begin(), data.amplitude_rad.end());
  EXPECT_LT(*high - *low, 1.5e-4); // a push is 6.6e-4; the interval differs by one of 35, 2e-5
}

// Rounded values leave most second differences at 0.
TEST(ImpulseCycleTest, RoundedValuesAreNoCertainty) {
  Scenario scenario = clock_with_rests(15, 5e-6);
  scenario.sensor.jitter_rms_s = 0.0;
  scenario.sensor.resolution_s = 1e-3;
  const TimingData data = times_of(scenario, 8);
  ASSERT_TRUE(data.impulses);
  EXPECT_EQ(data.impulses->periods, 15.0);
}

Scenario shortt(double jitter_s, std::int64_t periods) {
  std::ifstream in(GOINGRATE_SOURCE_DIR "/data/scenarios/clocks/shortt.toml");
  std::stringstream text;
  text << in.rdbuf();
  Scenario scenario = parse_scenario(text.str(), "shortt.toml");
  scenario.drive = {};
  scenario.length = {};
  scenario.sensor.temperature_rms.reset();
  scenario.sensor.jitter_rms_s = jitter_s;
  scenario.duration_s.reset();
  scenario.periods = periods;
  scenario.method.method = Method::map;
  return scenario;
}
// Its push as an impulse at the vertical, which has no width for a sensor to see.
Scenario shortt_of_no_width(double jitter_s, std::int64_t periods) {
  Scenario scenario = shortt(jitter_s, periods);
  scenario.clock.impulse = energy_of_period(scenario.clock, 0.016);
  scenario.clock.escapement = Escapement::single_impulse;
  scenario.clock.rising = {};
  return scenario;
}

TEST(ImpulseCycleTest, AShorttsSawToothIsTooFineForADay) {
  constexpr std::int64_t day = 43'200; // periods
  const auto tooth = saw_tooth(shortt(1e-8, day).clock);
  ASSERT_TRUE(tooth);
  // L^2/(8 <lambda^2> 32 eps) T0/2 pi with L = 4 pi eps N lambda^2: (4 pi N)^2 eps 0.016^2/(256
  // pi).
  EXPECT_NEAR(tooth->peak_lateness_s, 5.1e-8, 0.1e-8);
  EXPECT_FALSE(times_of(shortt_of_no_width(1e-5, day), 21).impulses); // a gain of some 0.3
  const TimingData fine = times_of(shortt_of_no_width(1e-8, day / 4), 22);
  ASSERT_TRUE(fine.impulses);
  EXPECT_EQ(fine.impulses->periods, 15.0);
  EXPECT_NEAR(fine.impulses->lateness.value, tooth->peak_lateness_s,
              4.0 * fine.impulses->lateness.sigma);
}

// An arm that is on the pendulum while it passes the vertical: that crossing comes early by what
// the arm has done so far, a/2 t^2/lambda scaled, a = 2.675e-5 for t = 0.002/lambda; less a
// fifteenth.
TEST(ImpulseCycleTest, TheCrossingInTheMidstOfAPushShowsFirst) {
  const TimingData day = times_of(shortt(1e-5, 43'200), 23);
  ASSERT_TRUE(day.impulses);
  EXPECT_EQ(day.impulses->periods, 15.0);
  const double time = 0.00205 / 0.016, early = 0.5 * 2.675e-5 * time * time / 0.016 / M_PI;
  EXPECT_NEAR(day.impulses->middle.value, -early, 4.0 * day.impulses->middle.sigma);
  EXPECT_FALSE(times_of(shortt(1e-5, 1000), 24).impulses); // 66 pushes
  // And what is under way is not part of the step: the friction is that of the clock.
  Scenario with_swing = shortt(1e-8, 20'000);
  with_swing.sensor.amplitude_rms = 1e-7;
  const TimingData swing = times_of(with_swing, 25);
  ASSERT_TRUE(swing.impulses && swing.impulses->epsilon);
  EXPECT_NEAR(swing.impulses->epsilon->value, 4.545e-6, 4.0 * swing.impulses->epsilon->sigma);
  EXPECT_LT(swing.impulses->epsilon->sigma, 4.545e-8);
}

// What is left is as smooth as the sensor allows.
TEST(ImpulseCycleTest, LevellingLeavesTheNoiseOfTheSensor) {
  const TimingData data = times_of(clock_with_rests(15, 5e-6), 6);
  ASSERT_TRUE(data.impulses);
  const auto roughness = [](const std::vector<double>& values) {
    double sum = 0.0;
    for (std::size_t i = 2; i < values.size(); ++i)
      sum += std::pow(values[i] - 2.0 * values[i - 1] + values[i - 2], 2);
    return std::sqrt(sum / (6.0 * static_cast<double>(values.size() - 2)));
  };
  // An rms of 3000 values is known to 1.3 %, second differences a little worse: 8 % are four sigma.
  EXPECT_NEAR(roughness(data.lateness_s), 2e-6, 0.08 * 2e-6);
  EXPECT_NEAR(roughness(data.amplitude_rad), 5e-6, 0.08 * 5e-6);
}

TEST(ImpulseCycleTest, WheelsAndNoiseAreNoPushes) {
  Scenario wheel;
  wheel.clock = {.epsilon = 2.5e-4, .mu = 2e-5, .phi0 = 0.03};
  wheel.periods = 3000;
  wheel.sensor.jitter_rms_s = 1e-5;
  wheel.sensor.amplitude_rms = 5e-6;
  wheel.drive.sines = {{0.1, 60.0}}; // a wheel of 30 teeth that is not round
  EXPECT_FALSE(times_of(wheel, 7).impulses);
  wheel.drive = {};
  wheel.drive.fast_rms = 0.3;
  EXPECT_FALSE(times_of(wheel, 8).impulses);
}

// White jitter, a random walk of the times, amplitudes with noise: 400 logs, where one in some
// thousand may show pushes by chance.
// The period of a wide swing under dry friction falls ever more slowly: what a mean over 60 swings
// leaves of that drifts.
TEST(ImpulseCycleTest, ABentCourseShowsNone) {
  Scenario scenario;
  scenario.clock.epsilon = 0.0;
  scenario.clock.escapement = Escapement::none;
  scenario.clock.dry_friction = 6e-5;
  scenario.start_amplitude = 0.3;
  scenario.periods = 1000;
  scenario.sensor.jitter_rms_s = 1e-4;
  for (std::uint64_t seed = 1; seed <= 4; ++seed)
    EXPECT_FALSE(find_impulse_cycle(timing_data(test::simulated_beats(scenario, seed)))) << seed;
}

TEST(ImpulseCycleTest, NoiseShowsNoPushes) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  std::size_t alarms = 0;
  for (int log = 0; log < 400; ++log) {
    TimingData data;
    data.reference_period_s = 2.0;
    double walk = 0.0, swing = 0.0;
    for (int i = 0; i < 1000; ++i) {
      walk += log % 3 == 0 ? 0.0 : 1e-5 * normal(random);
      swing = 0.99 * swing + 1e-5 * normal(random);
      data.cycle.push_back(i);
      data.elapsed_s.push_back(2.0 * i);
      data.lateness_s.push_back(walk + 1e-5 * normal(random));
      if (log % 2 == 0) data.amplitude_rad.push_back(0.04 + swing + 1e-6 * normal(random));
    }
    alarms += find_impulse_cycle(data) ? 1 : 0;
  }
  EXPECT_LE(alarms, 1u);
}

TEST(ImpulseCycleTest, AFewBeatsShowNothing) {
  TimingData data;
  data.reference_period_s = 2.0;
  for (int i = 0; i < 5; ++i) {
    data.cycle.push_back(i);
    data.elapsed_s.push_back(2.0 * i);
    data.lateness_s.push_back(0.0);
  }
  EXPECT_FALSE(find_impulse_cycle(data));
}

} // namespace
} // namespace goingrate
