#include "goingrate/drive/error_budget.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/dynamics/ensemble.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <vector>

namespace goingrate {
namespace {

constexpr double day = 86400.0;

Scenario clock_that_varies() {
  Scenario scenario;
  scenario.clock = {.epsilon = 2.5e-4, .mu = 3.7e-5, .phi0 = 0.03};
  scenario.periods = 20'000;
  scenario.method.method = Method::map;
  scenario.drive.fast_rms = 0.1;
  return scenario;
}

// The rms over simulated clocks of how far each is from the mean of all.
double simulated_error(const Scenario& scenario) {
  constexpr std::size_t clocks = 300;
  double sum = 0.0, sum2 = 0.0;
  for (const Period& last : final_periods(scenario, {.seed = 77, .realisations = clocks})) {
    const double off = last.time_s.value() - 2.0 * static_cast<double>(*scenario.periods);
    sum += off;
    sum2 += off * off;
  }
  return std::sqrt((sum2 - sum * sum / clocks) / (clocks - 1.0));
}

TEST(ErrorBudgetTest, AgreesWithSimulatedClocks) {
  // The rms of 300 is known to 4 %: three standard deviations.
  constexpr double tolerance = 0.12;
  Scenario fast = clock_that_varies();
  EXPECT_NEAR(simulated_error(fast) / error_budget(fast, 40'000.0).all_s(), 1.0, tolerance);
  Scenario slow = clock_that_varies();
  slow.drive.fast_rms = 0.0;
  slow.drive.slow_rms = 0.02;
  slow.drive.slow_time_s = 1500.0;
  EXPECT_NEAR(simulated_error(slow) / error_budget(slow, 40'000.0).all_s(), 1.0, tolerance);
}

TEST(ErrorBudgetTest, AnEscapementThatRestsRepaysItsNoise) {
  Scenario seldom = clock_that_varies();
  seldom.clock.mu *= 10.0;
  seldom.clock.every = 10;
  EXPECT_NEAR(simulated_error(seldom) / error_budget(seldom, 40'000.0).all_s(), 1.0,
              0.12); // likewise
}

ClockParameters hipp() {
  ClockParameters clock{.epsilon = 1e-4};
  clock.escapement = Escapement::single_impulse;
  clock.impulse = 3e-4; // lambda^2 grows by half
  clock.impulse_angle = 0.005;
  clock.below = 0.035;
  return clock;
}

TEST(ErrorBudgetTest, AnEscapementThatWaitsForgetsTheImpulseBefore) {
  Scenario fast = clock_that_varies();
  fast.clock = hipp();
  EXPECT_NEAR(simulated_error(fast) / error_budget(fast, 40'000.0).all_s(), 1.0, 0.12);
  Scenario slow = fast;
  slow.drive.fast_rms = 0.0;
  slow.drive.slow_rms = 0.05;
  slow.drive.slow_time_s = 3000.0; // some five waits
  EXPECT_NEAR(simulated_error(slow) / error_budget(slow, 40'000.0).all_s(), 1.0, 0.12);
}

TEST(ErrorBudgetTest, AllCausesReducedAlikeKeepTheError) {
  Scenario scenario = clock_that_varies();
  scenario.drive.slow_rms = 0.02;
  scenario.drive.slow_time_s = 7000.0;
  scenario.length.temperature_coefficient = 1.2e-5;
  scenario.temperature.sines = {{1.5, day}, {2.0, 3.0 * day}};
  const ErrorBudget now = error_budget(scenario, 30.0 * day);
  const double most = 0.3 * now.all_s(), share = now.share_below(most);
  for (const Requirement& one : requirements(scenario, most, 30.0 * day))
    EXPECT_FALSE(one.limit && one.key != "amplitude" && one.key != "clock.epsilon") << one.key;
  scenario.drive.fast_rms *= share;
  scenario.drive.slow_rms *= share;
  scenario.length.temperature_coefficient *= share;
  // Linear in the conditions: to rounding.
  EXPECT_NEAR(error_budget(scenario, 30.0 * day).all_s() / most, 1.0, 1e-12);
}

TEST(ErrorBudgetTest, OfAClockThatWaitsTheLimitIsAsked) {
  Scenario scenario = clock_that_varies();
  scenario.clock = hipp();
  const double now = error_budget(scenario, 7.0 * day).all_s();
  bool seen = false;
  for (const Requirement& one : requirements(scenario, 0.7 * now, 7.0 * day)) {
    EXPECT_NE(one.key, "amplitude");
    if (one.key != "clock.below") continue;
    seen = true;
    EXPECT_EQ(one.present, 0.035);
    ASSERT_TRUE(one.limit);
    scenario.clock.below = *one.limit;
    EXPECT_NEAR(error_budget(scenario, 7.0 * day).all_s() / (0.7 * now), 1.0, 1e-3);
  }
  EXPECT_TRUE(seen);
}

TEST(ErrorBudgetTest, OtherLawsAnswerByTheirOwnMoments) {
  Scenario scenario = clock_that_varies();
  scenario.clock = {.epsilon = 2.5e-4};
  scenario.clock.escapement = Escapement::single_impulse;
  scenario.clock.impulse = 2.0 * M_PI * 2.5e-4 * 0.04 * 0.04;
  scenario.clock.impulse_angle = 0.01;
  scenario.clock.gravity_share = 0.8;
  scenario.clock.quadratic_drag = 2e-3;
  EXPECT_NEAR(simulated_error(scenario) / error_budget(scenario, 40'000.0).all_s(), 1.0,
              0.12); // likewise
}

TEST(ErrorBudgetTest, SinesAndDriftsAreWhatTheySay) {
  Scenario scenario = clock_that_varies();
  scenario.drive = {};
  scenario.length.temperature_coefficient = 1.2e-5;
  scenario.temperature.sines = {{2.0, day}};
  // Half a turn of a rate of 12 ppm: 12e-6 86400/(sqrt 2 pi).
  EXPECT_NEAR(error_budget(scenario, 7.0 * day).all_s(), 1.2e-5 * day / (std::sqrt(2.0) * M_PI),
              1e-12);
  scenario.temperature = {};
  scenario.length = {};
  scenario.length.drift_per_day = 1e-6;
  // Rounding.
  EXPECT_NEAR(error_budget(scenario, 7.0 * day).all_s(), 0.5 * 0.5e-6 * 49.0 * day, 1e-12);
}

TEST(ErrorBudgetTest, LimitsKeepTheError) {
  Scenario scenario = clock_that_varies();
  scenario.drive.slow_rms = 0.02;
  scenario.drive.slow_time_s = 3600.0;
  const double week = 7.0 * day, now = error_budget(scenario, week).all_s();
  for (const double most : {0.7 * now, 1.4 * now})
    for (const Requirement& one : requirements(scenario, most, week)) {
      if (!one.limit) continue;
      Scenario other = scenario;
      const double share = *one.limit / one.present;
      if (one.key == "clock.epsilon") {
        other.clock.epsilon *= share;
        other.clock.mu *= share;
      } else if (one.key == "amplitude") {
        other.clock.mu *= share * share;
      } else if (one.key == "drive.fast_rms") {
        other.drive.fast_rms *= share;
      } else {
        other.drive.slow_rms *= share;
      }
      // Ten times what limits are good to.
      EXPECT_NEAR(error_budget(other, week).all_s() / most, 1.0, 1e-3) << one.key << ' ' << most;
    }
}

// What a compensation leaves is no multiple of the rod's coefficient, nor of its own.
TEST(ErrorBudgetTest, LimitsOfACompensatedRodKeepTheError) {
  Scenario scenario = clock_that_varies();
  scenario.drive = {};
  scenario.length.temperature_coefficient = 1.2e-5;
  scenario.temperature.sines = {{2.0, day}};
  for (const double lag_s : {0.0, 3600.0}) {
    scenario.length.compensation = 1.1e-5;
    scenario.length.compensation_lag_s = lag_s;
    const double week = 7.0 * day, now = error_budget(scenario, week).all_s();
    for (const double most : {0.7 * now, 1.4 * now}) {
      int limits = 0;
      for (const Requirement& one : requirements(scenario, most, week)) {
        if (!one.limit || !one.key.starts_with("length.")) continue;
        ++limits;
        Scenario other = scenario;
        (one.key == "length.compensation" ? other.length.compensation
                                          : other.length.temperature_coefficient) = *one.limit;
        // A step of 0.1 % halved 20 times, of which the error is a hundredth or so.
        EXPECT_NEAR(error_budget(other, week).all_s() / most, 1.0, 1e-4) << one.key << ' ' << lag_s;
      }
      // What lags by an hour leaves three quarters of that whatever its size.
      EXPECT_EQ(limits, lag_s > 0.0 && most < now ? 0 : 2) << lag_s << ' ' << most;
    }
  }
}

// No drive varies by more than itself, and below phi0 there is no swing.
TEST(ErrorBudgetTest, LimitsAreThoseOfAClock) {
  const Scenario scenario = clock_that_varies();
  const double week = 7.0 * day, now = error_budget(scenario, week).all_s();
  bool seen = false;
  for (const Requirement& one : requirements(scenario, 1e3 * now, week)) {
    if (one.key.starts_with("drive.")) {
      EXPECT_FALSE(one.limit) << one.key;
    }
    if (one.key != "amplitude") continue;
    seen = true;
    EXPECT_TRUE(one.stops);
    EXPECT_GE(one.limit.value_or(0.0), scenario.clock.phi0);
    EXPECT_LT(one.limit.value_or(1.0), 1.01 * scenario.clock.phi0); // good to 1e-4 of the drive
  }
  EXPECT_TRUE(seen);
}

TEST(ErrorBudgetTest, WhatHasNoLinearResponseIsRefused) {
  Scenario scenario = clock_that_varies();
  scenario.clock.mu = 0.0;
  EXPECT_THROW((void)error_budget(scenario, day), ArgumentError);
  scenario = clock_that_varies();
  scenario.drive = {};
  scenario.drive.series = std::make_shared<const std::vector<double>>(3, 1.0);
  EXPECT_THROW((void)error_budget(scenario, day), ArgumentError);
  scenario = clock_that_varies();
  scenario.events.emplace_back();
  EXPECT_THROW((void)error_budget(scenario, day), ArgumentError);
  scenario = clock_that_varies();
  scenario.clock.epsilon = 0.0;
  scenario.clock.quadratic_drag = 1e-2; // no friction to vary, and an answer all the same
  for (const Requirement& one : requirements(scenario, 2.0, day))
    EXPECT_NE(one.key, "clock.epsilon");
  EXPECT_THROW((void)error_budget(clock_that_varies(), 0.0), ArgumentError);
  EXPECT_THROW((void)requirements(clock_that_varies(), 0.0, day), ArgumentError);
}

} // namespace
} // namespace goingrate
