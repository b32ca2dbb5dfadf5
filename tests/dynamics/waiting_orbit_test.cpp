#include "goingrate/clock/restoring.hpp"
#include "goingrate/dynamics/clock_run.hpp"
#include "goingrate/dynamics/intermittent.hpp"
#include "goingrate/dynamics/stationary.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace goingrate {
namespace {

using std::numbers::pi;

ClockParameters hipp() {
  ClockParameters clock;
  clock.epsilon = 1e-4;
  clock.escapement = Escapement::single_impulse;
  clock.impulse = 3.1e-5;
  clock.impulse_angle = 0.005;
  clock.below = 0.035;
  return clock;
}

ClockParameters with_drag() {
  ClockParameters clock = hipp();
  clock.quadratic_drag = 2e-3;
  return clock;
}

// A push that runs through the vertical, of the energy 2e-5.
ClockParameters arm() {
  ClockParameters clock = hipp();
  clock.escapement = Escapement::profile;
  clock.rising = {{{-0.004, 0.0}, {-0.003, 1.6e-3}, {0.0085, 1.6e-3}, {0.0095, 0.0}}};
  return clock;
}

struct Means {
  double rate, mean_square, periods;
};

// From a run by the integrator that starts elsewhere, after it has settled.
Means run_from(const ClockParameters& clock, double start) {
  constexpr int settles = 20'000, counted = 40'000; // periods
  Scenario scenario;
  scenario.clock = clock;
  scenario.start_amplitude = start;
  scenario.periods = settles + counted;
  scenario.method.method = Method::direct;
  ClockRun run(scenario, 1);
  double from_s = 0.0, squares = 0.0;
  int impulses = 0;
  while (const auto period = run.next()) {
    if (period->cycle == settles) from_s = period->time_s.value();
    if (period->cycle <= settles) continue;
    squares += period->velocity * period->velocity;
    impulses += period->mu > 0.0 ? 1 : 0;
  }
  return {2.0 * counted / (run.last().time_s.value() - from_s) - 1.0, squares / counted,
          static_cast<double>(counted) / impulses};
}

TEST(WaitingOrbitTest, MeansAreThoseOfALongRun) {
  for (const ClockParameters& clock : {hipp(), with_drag(), arm()}) {
    const auto orbit = waiting_orbit(clock);
    ASSERT_TRUE(orbit);
    const Means run = run_from(clock, 0.05);
    // The ends of the run cut a wait of some 40 periods short, of 40,000, with the push of it: the
    // escapement's share of the rate, eps tan psi1, is all its.
    constexpr double by_pushes = 1e-4 * 0.144;
    const double ends = orbit->periods / 40'000.0;
    const double swing = 2.0 * (run.mean_square - 0.035 * 0.035) / run.mean_square;
    EXPECT_NEAR(orbit->periods / run.periods, 1.0, ends);
    EXPECT_NEAR(orbit->mean_square / run.mean_square, 1.0, ends * swing);
    EXPECT_NEAR(rate_excess_of(orbit->period_excess), run.rate,
                orbit->rate_within + ends * (swing * std::abs(run.rate) + by_pushes));
    EXPECT_LT(orbit->rate_within, 1e-10); // and it says something
  }
}

TEST(WaitingOrbitTest, TheIntervalIsThatOfTheFormula) {
  const ClockParameters clock = hipp();
  const auto orbit = waiting_orbit(clock);
  ASSERT_TRUE(orbit);
  const double interval = std::log1p(2.0 * clock.impulse / (0.035 * 0.035)) / (4.0 * pi * 1e-4);
  // Impulses come up to a period late, in the mean half: 2 pi eps of lambda^2; lambda^2/12 of the
  // limit as an angle.
  EXPECT_NEAR(orbit->periods / interval, 1.0, 4.0 * pi * 1e-4 + 1.1e-4);
}

TEST(WaitingOrbitTest, ItIsTheStationaryRateOfSuchAClock) {
  for (const ClockParameters& clock : {hipp(), with_drag(), arm()}) {
    const auto cycle = limit_cycle(clock);
    ASSERT_TRUE(cycle);
    const double first = *stationary_rate_first_order(clock);
    // Relative order 4 pi eps for every period that an impulse comes late, the arm's up to three.
    EXPECT_NEAR(cycle->rate_excess / first, 1.0, 3.0 * 4.0 * pi * 1e-4);
    EXPECT_LE(cycle->velocity, velocity_of_turning_angle(1.0, clock.below));
  }
}

TEST(WaitingOrbitTest, AWeakOneHasTheCycleOfOneThatAlwaysActs) {
  ClockParameters weak = hipp();
  weak.below = 0.6; // the impulses keep 0.22 rad
  EXPECT_FALSE(waits_for_amplitude(weak));
  ClockParameters always = weak;
  always.below = 0.0;
  EXPECT_EQ(limit_cycle(weak)->rate_excess, limit_cycle(always)->rate_excess);
}

TEST(WaitingOrbitTest, WhatDoesNotWaitHasNone) {
  ClockParameters clock = hipp();
  clock.below = 0.0;
  EXPECT_FALSE(waiting_orbit(clock));
  clock = hipp();
  clock.impulse_angle = 0.04; // out of reach at the limit
  EXPECT_FALSE(limit_cycle(clock));
}

} // namespace
} // namespace goingrate
