#include "goingrate/dynamics/intermittent.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/clock/restoring.hpp"
#include "goingrate/dynamics/clock_run.hpp"
#include "goingrate/dynamics/stationary.hpp"

#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <vector>

namespace goingrate {
namespace {

using std::numbers::pi;

// A Synchronome: an impulse every 30 s keeps some 0.03 rad.
ClockParameters synchronome() {
  ClockParameters clock;
  clock.epsilon = 4e-5;
  clock.escapement = Escapement::single_impulse;
  clock.impulse = 3.4e-6;
  clock.every = 15;
  return clock;
}

ClockParameters spread(const ClockParameters& clock) {
  return with_drive_divided(clock, static_cast<double>(clock.every));
}

Scenario run_of(const ClockParameters& clock, std::int64_t periods, Method method) {
  Scenario scenario;
  scenario.clock = clock;
  scenario.periods = periods;
  scenario.method.method = method;
  return scenario;
}

std::vector<Period> periods_of(const Scenario& scenario) {
  ClockRun run(scenario, 1);
  std::vector<Period> all;
  while (const auto period = run.next())
    all.push_back(*period);
  EXPECT_EQ(all.size(), static_cast<std::size_t>(*scenario.periods));
  return all;
}

double mean_rate(const std::vector<Period>& all, double nominal_period_s) {
  return nominal_period_s * static_cast<double>(all.size()) / all.back().time_s.value() - 1.0;
}

double mean_square(const std::vector<Period>& all) {
  double sum = 0.0;
  for (const Period& period : all)
    sum += period.velocity * period.velocity;
  return sum / static_cast<double>(all.size());
}

TEST(IntermittentTest, EnergyOfACycleBalances) {
  const ClockParameters clock = synchronome();
  const auto all = periods_of(run_of(clock, 15, Method::direct));
  // The cycle closes: it was sought to rounding of 64 bits and is carried in a double's two parts.
  EXPECT_NEAR(all.back().velocity / stationary_start(clock, false).value(), 1.0, 1e-15);
  double highest = 0.0;
  for (const Period& period : all)
    highest = std::max(highest, period.velocity);
  // J = 1/2 lambda_+^2 (1 - exp(-4 pi eps N)); seen first one period after the impulse.
  const double high2 = highest * highest * std::exp(4.0 * pi * clock.epsilon);
  const double balance = 0.5 * high2 * -std::expm1(-4.0 * pi * clock.epsilon * 15.0);
  // The friction of a swing of 0.03 rad differs from that of a small one by lambda^2/32, 3e-5.
  EXPECT_NEAR(balance / clock.impulse, 1.0, 5e-5);
}

// At equal power N changes neither mean amplitude nor mean rate to first order: what is left is of
// relative order pi eps N.
TEST(IntermittentTest, AtEqualPowerTheNumberBuysNothing) {
  for (const Escapement escapement : {Escapement::single_impulse, Escapement::constant_torque}) {
    ClockParameters clock = synchronome();
    clock.escapement = escapement;
    clock.mu = 3.4e-6 / (4.0 * 0.01);
    clock.phi0 = 0.01;
    clock.impulse_angle = 0.005;
    const auto seldom = periods_of(run_of(clock, 3000, Method::direct));
    const auto often = periods_of(run_of(spread(clock), 3000, Method::direct));
    const double order = pi * clock.epsilon * static_cast<double>(clock.every);
    EXPECT_NEAR(mean_square(seldom) / mean_square(often), 1.0, order);
    const double rate = mean_rate(often, 2.0), error = mean_rate(seldom, 2.0) - rate;
    EXPECT_LT(std::abs(error), order * std::abs(rate));
    EXPECT_GT(std::abs(error), 0.0); // and it is not the same clock
    EXPECT_NEAR(mean_rate(seldom, 2.0), *stationary_rate_first_order(clock),
                order * std::abs(rate));
  }
}

// The saw-tooth of lambda^2 is symmetric about its mean to first order in pi eps N, and so the
// impulse falls, in the mean, on the mean swing: what N costs begins with the square.
TEST(IntermittentTest, WhatTheNumberCostsGoesAsItsSquare) {
  const auto cost = [](std::int64_t every) {
    ClockParameters clock = synchronome();
    clock.impulse *= static_cast<double>(every) / 15.0;
    clock.every = every;
    const auto seldom = limit_cycle(clock), often = limit_cycle(spread(clock));
    return seldom->rate_excess / often->rate_excess - 1.0;
  };
  // 0.1 for the next order.
  const double slope = std::log(std::abs(cost(60) / cost(30))) / std::log(2.0);
  EXPECT_NEAR(slope, 2.0, 0.1) << cost(15) << ' ' << cost(30) << ' ' << cost(60);
}

TEST(IntermittentTest, TheMapTellsTheSameStoryAsTheIntegrator) {
  ClockParameters hipp = synchronome();
  hipp.every = 1;
  hipp.below = 0.029;
  ClockParameters gravity_arm = synchronome();
  gravity_arm.escapement = Escapement::profile;
  gravity_arm.falling = {{{-0.01, -2e-4}, {0.01, -2e-4}}};
  for (const ClockParameters& clock : {synchronome(), hipp, gravity_arm}) {
    const auto exact = periods_of(run_of(clock, 2000, Method::direct));
    const auto mapped = periods_of(run_of(clock, 2000, Method::map));
    for (std::size_t i = 0; i < exact.size(); ++i)
      // Rounding of the time itself, 4000 s.
      ASSERT_NEAR(mapped[i].time_s.value(), exact[i].time_s.value(), 2e-12) << i;
  }
}

TEST(IntermittentTest, AveragedEquationsKeepTheSawTooth) {
  const ClockParameters clock = synchronome();
  const auto exact = periods_of(run_of(clock, 1500, Method::direct));
  for (const Method method : {Method::averaged1, Method::averaged2}) {
    const auto averaged = periods_of(run_of(clock, 1500, method));
    const double drift = averaged.back().time_s.value() - exact.back().time_s.value();
    for (std::size_t i = 0; i < exact.size(); ++i) {
      const double share = static_cast<double>(i + 1) / static_cast<double>(exact.size());
      const double off = averaged[i].time_s.value() - exact[i].time_s.value() - drift * share;
      // The saw-tooth is 8e-6 s; within a period the averaged impulse is spread over it.
      ASSERT_LT(std::abs(off), 4e-7) << i;
    }
  }
}

TEST(IntermittentTest, SawToothAgreesWithTheEquationOfMotion) {
  const ClockParameters clock = synchronome();
  const auto tooth = saw_tooth(clock);
  ASSERT_TRUE(tooth);
  const auto all = periods_of(run_of(clock, 1500, Method::direct));
  // The swing before the first crossing after an impulse, and the friction of a swing of 0.03 rad.
  const double order = 2.0 * pi * clock.epsilon + 3e-5;
  EXPECT_NEAR(mean_square(all) / tooth->mean2, 1.0, order);
  const double mean_s = all.back().time_s.value() / 1500.0;
  double latest = 0.0;
  for (const Period& period : all)
    latest = std::max(latest, period.time_s.value() - mean_s * static_cast<double>(period.cycle));
  // A crossing may be half a period from the peak, 15 of a parabola: 4 x (1/30)^2, and as much.
  EXPECT_NEAR(latest / tooth->peak_lateness_s, 1.0, 0.01);
}

TEST(IntermittentTest, HippsIntervalIsThatOfTheFormula) {
  ClockParameters clock = synchronome();
  clock.every = 1;
  clock.below = 0.029;
  const auto all = periods_of(run_of(clock, 20'000, Method::map));
  const auto impulses =
      std::count_if(all.begin(), all.end(), [](const Period& period) { return period.mu > 0.0; });
  const auto tooth = saw_tooth(clock);
  ASSERT_TRUE(tooth);
  // Impulses come up to a period after the limit, in the mean half: relative 2 pi eps of lambda^2,
  // and as much for the crossings that are seen. The limit is a turning angle: A^2/12, 7e-5.
  const double order = 4.0 * pi * clock.epsilon + 7e-5;
  EXPECT_NEAR(20'000.0 / static_cast<double>(impulses) / tooth->periods, 1.0, order);
  EXPECT_NEAR(mean_square(all) / tooth->mean2, 1.0, order);
  EXPECT_NEAR(*stationary_amplitude(clock) * *stationary_amplitude(clock) / tooth->mean2, 1.0,
              1e-12); // quadrature and closed form
  EXPECT_NEAR(mean_rate(all, 2.0), *stationary_rate_first_order(clock), order * 6e-5);
}

TEST(IntermittentTest, AWeakHippActsInEveryPeriod) {
  ClockParameters clock = synchronome();
  clock.every = 1;
  clock.below = 0.2; // above what the impulses keep
  ClockParameters always = clock;
  always.below = 0.0;
  EXPECT_EQ(stationary_start(clock, false), stationary_start(always, false));
  EXPECT_FALSE(saw_tooth(clock));
  EXPECT_FALSE(saw_tooth(always));
}

TEST(IntermittentTest, ContradictionsAreRefused) {
  ClockParameters clock = synchronome();
  clock.below = 0.02;
  EXPECT_THROW(check(clock), ArgumentError);
  clock.every = 0;
  clock.below = 0.0;
  EXPECT_THROW(check(clock), ArgumentError);
  clock.every = 15;
  clock.escapement = Escapement::none;
  EXPECT_THROW(check(clock), ArgumentError);
}

// A restoring torque other than gravity's, by every method that knows it.
TEST(GravityShareTest, AFreeSwingTakesThePeriodOfTheEnergyIntegral) {
  for (const double share : {1.0, 0.9, 0.5, 0.0, -1.5})
    for (const double angle : {0.05, 1.0, 2.8, 3.3, 5.0, 9.4}) {
      if (angle >= 0.95 * top_angle(share)) continue; // slow near the top, and ill conditioned
      ClockParameters clock;
      clock.escapement = Escapement::none;
      clock.gravity_share = share;
      Scenario scenario = run_of(clock, 40, Method::direct);
      scenario.start_amplitude = velocity_of_turning_angle(share, angle);
      const auto all = periods_of(scenario);
      // 40 periods of 2 s: the rounding of the energy integral.
      EXPECT_NEAR(all.back().time_s.value(), 80.0 * free_period_ratio(share, angle), 1e-11)
          << share << ' ' << angle;
      EXPECT_NEAR(all.back().amplitude_rad, angle, 1e-13);
      scenario.method.method = Method::map;
      // Roundings of 80 s.
      EXPECT_NEAR(periods_of(scenario).back().time_s.value(), all.back().time_s.value(), 1e-13);
    }
}

TEST(GravityShareTest, DrivenSwingsAgreeWithTheStationaryRate) {
  for (const double share : {1.0, 0.5, 0.0, -1.0}) {
    ClockParameters clock{.epsilon = 1e-4, .mu = 1.5e-5, .phi0 = 0.03};
    clock.gravity_share = share;
    const auto cycle = limit_cycle(clock);
    ASSERT_TRUE(cycle);
    // Second order is of the size of the square of the first, which is 3.3e-4 at s = -1: 1.1e-7.
    EXPECT_NEAR(cycle->rate_excess, *stationary_rate_first_order(clock), 2e-7) << share;
    const auto averaged = periods_of(run_of(clock, 1000, Method::averaged1));
    EXPECT_NEAR(mean_rate(averaged, 2.0), cycle->rate_excess, 2e-7) << share; // likewise
  }
  ClockParameters clock{.epsilon = 1e-4, .mu = 1.5e-5, .phi0 = 0.03};
  clock.gravity_share = 0.5;
  EXPECT_THROW(periods_of(run_of(clock, 10, Method::averaged2)), ArgumentError);
  EXPECT_THROW(periods_of(run_of(clock, 10, Method::rk4)), ArgumentError);
}

TEST(GravityShareTest, ATorsionClockSwingsWideAndIsIsochronous) {
  ClockParameters clock;
  clock.nominal_period_s = 7.5;
  clock.epsilon = 1e-4;
  clock.gravity_share = 0.0;
  clock.escapement = Escapement::single_impulse;
  clock.impulse = 2.0 * pi * clock.epsilon * 2.5 * 2.5;
  const auto all = periods_of(run_of(clock, 1000, Method::direct));
  EXPECT_NEAR(all.back().amplitude_rad, 2.5, 2.5 * 2.0 * pi * clock.epsilon);
  // Only friction is left: -eps^2/2 of the rate, and rounding.
  EXPECT_NEAR(mean_rate(all, 7.5), -0.5 * clock.epsilon * clock.epsilon, 1e-11);
}

} // namespace
} // namespace goingrate
