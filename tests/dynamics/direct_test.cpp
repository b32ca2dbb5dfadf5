#include "goingrate/dynamics/direct.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/base/scaled_time.hpp"
#include "goingrate/dynamics/stationary.hpp"

#include <gtest/gtest.h>

namespace goingrate {
namespace {

const ClockParameters clock_a{two_pi, 2.5e-4, 2e-5, 0.03};
const ClockParameters clock_c{two_pi, 1.167245e-4, 1.5e-5, 0.03};

Scenario steady(const ClockParameters& clock, std::int64_t periods) {
  Scenario scenario;
  scenario.clock = clock;
  scenario.periods = periods;
  return scenario;
}

TEST(DirectTest, CrossingTimesOfPointC) {
  // Exact period of the limit cycle; each period may be off by its own rounding, 2e-15.
  const long double exact = 6.28318519131337413067658L;
  DirectRun run(steady(clock_c, 20000), 1);
  while (const auto period = run.next()) {
    const auto error = static_cast<double>(static_cast<long double>(period->time_s.hi) -
                                           exact * static_cast<long double>(period->cycle)) +
                       period->time_s.lo;
    ASSERT_LT(std::abs(error), 2e-15 * static_cast<double>(period->cycle) + 1e-15);
  }
}

TEST(DirectTest, LimitCycleDoesNotFreeze) {
  // Started a part in 1e9 off, v must come back to within rounding of the limit cycle: rounding v
  // to a double every period would stop it some 1e-14 short. 30 relaxation times of 1/(4 pi eps)
  // periods.
  const double exact = 0.0495414393471760923604;
  Scenario scenario = steady(clock_c, 20500);
  scenario.start_amplitude = exact * (1 + 1e-9);
  DirectRun run(scenario, 1);
  while (run.next()) {
  }
  EXPECT_NEAR(run.last().velocity / exact, 1.0, 5e-16);
}

TEST(DirectTest, JumpFromAToBGivesTheExactRateAndPhase) {
  Scenario scenario = steady(clock_a, 20150);
  ClockEvent jump;
  jump.at_period = 150;
  jump.mu = 4e-5;
  scenario.events = {jump};
  DirectRun run(scenario, 1);
  double first_rate = 0.0;
  TwoPart<double> at_jump, since;
  while (const auto period = run.next()) {
    if (period->cycle == 150) at_jump = period->time_s;
    if (period->cycle == 151) first_rate = period->rate_excess;
    since = period->time_s;
  }
  since += -at_jump.hi;
  since += -at_jump.lo;
  EXPECT_NEAR(first_rate, 3.2201382327e-04, 1e-14); // the last printed digit
  const double reference = 1.960046634308295e-04;   // exact rate of B
  const double shift = 20000 * two_pi - since.value() * (1 + reference);
  EXPECT_NEAR(shift, 0.29437831, 2e-8); // the printed digits, and 20,000 periods of 1e-13
}

TEST(DirectTest, SecondsAreScaledTimeTimesT0Over2Pi) {
  ClockParameters two_seconds = clock_a;
  two_seconds.nominal_period_s = 2.0;
  DirectRun scaled(steady(clock_a, 100), 1), real(steady(two_seconds, 100), 1);
  while (scaled.next())
    (void)real.next();
  EXPECT_NEAR(real.last().time_s.value(), scaled.last().time_s.value() * 2.0 / two_pi, 1e-12);
}

TEST(DirectTest, AnEventByTimeActsAtTheNextUpwardCrossing) {
  Scenario by_cycle = steady(clock_a, 30), by_time = steady(clock_a, 30);
  ClockEvent event;
  event.mu = 4e-5;
  event.at_period = 10;
  by_cycle.events = {event};
  event.at_period.reset();
  event.at_s = 9.5 * two_pi;
  by_time.events = {event};
  DirectRun a(by_cycle, 1), b(by_time, 1);
  while (const auto period = a.next())
    EXPECT_EQ(period->period_s, b.next()->period_s);
}

TEST(DirectTest, ALengthChangeKeepsThePhysicalSpeed) {
  // Without friction and drive v^2 T0^2 is twice the energy over m l^2: it stays when T0 changes.
  Scenario scenario = steady({2.0, 0.0, 0.0, 0.0, Escapement::none}, 4);
  scenario.start_amplitude = 0.1;
  ClockEvent event;
  event.at_period = 2;
  event.nominal_period_s = 2.2;
  scenario.events = {event};
  DirectRun run(scenario, 1);
  while (run.next()) {
  }
  EXPECT_NEAR(run.last().velocity / 2.2, 0.1 / 2.0, 1e-15);
}

TEST(DirectTest, AClockWhoseDriveIsTooWeakStallsAndSaysWhen) {
  Scenario scenario = steady({2.0, 1e-2, 1e-4, 0.03}, 100000);
  scenario.start_amplitude = 0.05;
  DirectRun run(scenario, 1);
  std::int64_t periods = 0;
  while (run.next())
    ++periods;
  EXPECT_EQ(run.status(), SwingStatus::stalled);
  EXPECT_EQ(run.last().cycle, periods);
  EXPECT_GT(periods, 10);
}

TEST(DirectTest, NoisyDriveDependsOnTheSeedOnly) {
  Scenario scenario = steady(clock_c, 50);
  scenario.drive.fast_rms = 0.3;
  DirectRun a(scenario, 5), b(scenario, 5), c(scenario, 6);
  while (const auto period = a.next()) {
    EXPECT_EQ(period->time_s.value(), b.next()->time_s.value());
    EXPECT_NE(period->time_s.value(), c.next()->time_s.value());
  }
}

TEST(DirectTest, AskingForAStationaryStartThatDoesNotExistIsAnError) {
  EXPECT_THROW(DirectRun(steady({2.0, 1e-3, 0.0, 0.0, Escapement::none}, 3), 1), ArgumentError);
}

} // namespace
} // namespace goingrate
