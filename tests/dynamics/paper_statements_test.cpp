// Statements that the paper makes in words, checked with the full equation of motion.
#include "goingrate/dynamics/clock_run.hpp"
#include "goingrate/dynamics/operating_point.hpp"
#include "goingrate/dynamics/stationary.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace goingrate {
namespace {

double rate(double epsilon, double mu) {
  return limit_cycle({2.0, epsilon, mu, 0.03})->rate_excess;
}

TEST(PaperStatementsTest, FirstOrderIsOffBySecondOrder) {
  // All small terms shrink together (epsilon, mu/lambda and lambda^2 as s): the rate is of order s,
  // its error of order s^2.
  double before = 0.0;
  for (const double s : {1.0 / 16, 1.0 / 32, 1.0 / 64}) {
    const ClockParameters clock{2.0, 2.5e-4 * s, 4e-5 * std::pow(s, 1.5), 0.03 * std::sqrt(s)};
    const double error = *stationary_rate_first_order(clock) - limit_cycle(clock)->rate_excess;
    if (before != 0.0) {
      EXPECT_NEAR(std::log2(before / error), 2.0, 0.02); // next order: s
    }
    before = error;
  }
}

TEST(PaperStatementsTest, MoreTorqueLosesOnTheLeftAndGainsOnTheRight) { // sec. losgain
  EXPECT_LT(rate(3e-5, 1.1e-5), rate(3e-5, 1e-5));
  EXPECT_GT(rate(4e-4, 4.4e-5), rate(4e-4, 4e-5));
}

TEST(PaperStatementsTest, MoreFrictionMayMakeTheClockFaster) { // sec. losgain
  EXPECT_GT(rate(2.4e-4, 2e-5), rate(2.0e-4, 2e-5));
  EXPECT_LT(rate(3.5e-4, 2e-5), rate(2.6e-4, 2e-5));
}

TEST(PaperStatementsTest, TheLeastTorqueIsHalfPiEpsilonPhi0) { // sec. statop
  EXPECT_NEAR(*exact_stall_torque(2.5e-4, 0.03) / (0.5 * std::numbers::pi * 2.5e-4 * 0.03), 1.0,
              1e-4); // second order: 5 phi0^2/96
}

TEST(PaperStatementsTest, TheRateJumpsWithTheTorqueButNotWithTheFriction) { // sec. such
  Scenario scenario;
  scenario.clock = {2.0, 2.5e-4, 2e-5, 0.03};
  scenario.periods = 152;
  ClockEvent torque, friction;
  torque.at_period = friction.at_period = 150;
  torque.mu = 4e-5;
  friction.epsilon = 2e-4;
  const auto jump = [&](const ClockEvent& event) {
    scenario.events = {event};
    ClockRun run(scenario, 1);
    double before = 0.0;
    while (const auto period = run.next()) {
      if (period->cycle == 150) before = period->rate_excess;
      if (period->cycle == 151) return period->rate_excess - before;
    }
    return 0.0;
  };
  EXPECT_NEAR(jump(torque), 3.2e-4 - 1.13e-4, 0.05e-4); // half the last digit of 3.2e-4
  EXPECT_LT(std::abs(jump(friction)), 1e-6);
}

TEST(PaperStatementsTest, AnImpulseBeforeTheVerticalGainsAndAfterItLoses) { // app. appblow
  ClockParameters clock;
  clock.epsilon = 1e-4;
  clock.escapement = Escapement::single_impulse;
  clock.impulse = 1.5e-6;
  const auto at = [&](double angle) {
    clock.impulse_angle = angle;
    return limit_cycle(clock)->rate_excess;
  };
  EXPECT_GT(at(-0.01), at(0.0));
  EXPECT_LT(at(0.01), at(0.0));
}

TEST(PaperStatementsTest, AtNominalRateFastAndSlowDriveActInOppositeDirections) {
  const auto response = drive_response({2.0, 1.167245e-4, 1.5e-5, 0.03});
  EXPECT_GT(response->fast_gain, 0.0);
  EXPECT_LT(response->slow_gain, 0.0);
}

} // namespace
} // namespace goingrate
