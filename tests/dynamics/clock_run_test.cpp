#include "goingrate/dynamics/clock_run.hpp"

#include "base/scaled_time.hpp"
#include "dynamics/point_c.hpp"
#include "goingrate/base/errors.hpp"
#include "goingrate/dynamics/stationary.hpp"

#include <gtest/gtest.h>

namespace goingrate {
namespace {

const ClockParameters clock_a{two_pi, 2.5e-4, 2e-5, 0.03};
using test::clock_c;

Scenario steady(const ClockParameters& clock, std::int64_t periods) {
  Scenario scenario;
  scenario.clock = clock;
  scenario.periods = periods;
  return scenario;
}

TEST(ClockRunTest, JumpFromAToBGivesTheExactRateAndPhase) {
  Scenario scenario = steady(clock_a, 20150);
  ClockEvent jump;
  jump.at_period = 150;
  jump.mu = 4e-5;
  scenario.events = {jump};
  ClockRun run(scenario, 1);
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

TEST(ClockRunTest, SecondsAreScaledTimeTimesT0Over2Pi) {
  ClockParameters two_seconds = clock_a;
  two_seconds.nominal_period_s = 2.0;
  ClockRun scaled(steady(clock_a, 100), 1), real(steady(two_seconds, 100), 1);
  while (scaled.next())
    (void)real.next();
  // Four roundings of 200 s.
  EXPECT_NEAR(real.last().time_s.value(), scaled.last().time_s.value() * 2.0 / two_pi, 1e-13);
}

TEST(ClockRunTest, AnEventByTimeActsAtTheNextUpwardCrossing) {
  Scenario by_cycle = steady(clock_a, 30), by_time = steady(clock_a, 30);
  ClockEvent event;
  event.mu = 4e-5;
  event.at_period = 10;
  by_cycle.events = {event};
  event.at_period.reset();
  event.at_s = 9.5 * two_pi;
  by_time.events = {event};
  ClockRun a(by_cycle, 1), b(by_time, 1);
  while (const auto period = a.next())
    EXPECT_EQ(period->period_s, b.next()->period_s);
}

TEST(ClockRunTest, ALengthChangeKeepsThePhysicalSpeed) {
  // Without friction and drive v^2 T0^2 is twice the energy over m l^2: it stays when T0 changes.
  Scenario scenario = steady({2.0, 0.0, 0.0, 0.0, Escapement::none}, 4);
  scenario.start_amplitude = 0.1;
  ClockEvent event;
  event.at_period = 2;
  event.nominal_period_s = 2.2;
  scenario.events = {event};
  ClockRun run(scenario, 1);
  while (run.next()) {
  }
  EXPECT_NEAR(run.last().velocity / 2.2, 0.1 / 2.0, 3e-17); // a few roundings of 0.05
}

TEST(ClockRunTest, AClockWhoseDriveIsTooWeakStallsAndSaysWhen) {
  Scenario scenario = steady({2.0, 1e-2, 1e-4, 0.03}, 100000);
  scenario.start_amplitude = 0.05;
  ClockRun run(scenario, 1);
  std::int64_t periods = 0;
  while (run.next())
    ++periods;
  EXPECT_EQ(run.status(), SwingStatus::stalled);
  EXPECT_EQ(run.last().cycle, periods);
  EXPECT_GT(periods, 10);
}

TEST(ClockRunTest, NoisyDriveDependsOnTheSeedOnly) {
  Scenario scenario = steady(clock_c, 50);
  scenario.drive.fast_rms = 0.3;
  ClockRun a(scenario, 5), b(scenario, 5), c(scenario, 6);
  while (const auto period = a.next()) {
    EXPECT_EQ(period->time_s.value(), b.next()->time_s.value());
    EXPECT_NE(period->time_s.value(), c.next()->time_s.value());
  }
}

TEST(ClockRunTest, AskingForAStationaryStartThatDoesNotExistIsAnError) {
  EXPECT_THROW(ClockRun(steady({2.0, 1e-3, 0.0, 0.0, Escapement::none}, 3), 1), ArgumentError);
}

TEST(ClockRunTest, EveryMethodRunsTheSameScenario) {
  // A jump of the torque under a varying drive: the exact methods agree to rounding, the others to
  // what their equations lack (about 1e-8, 2e-11 and, for RK4, 1e-8 of the time).
  Scenario scenario = steady(clock_a, 500);
  ClockEvent jump;
  jump.at_period = 150;
  jump.mu = 4e-5;
  scenario.events = {jump};
  scenario.drive.sines = {{0.05, 300.0}};
  scenario.start_amplitude = 0.039;
  const auto end_by = [&](Method method) {
    scenario.method.method = method;
    scenario.method.dt = 0.01;
    scenario.method.rk4_torque = Rk4Torque::at_switches;
    ClockRun run(scenario, 1);
    while (run.next()) {
    }
    EXPECT_EQ(run.status(), SwingStatus::crossed);
    EXPECT_EQ(run.last().cycle, 500);
    return run.last().time_s.value();
  };
  const double exact = end_by(Method::direct);
  EXPECT_NEAR(end_by(Method::map), exact, 2e-12);      // an ulp of the time is 5e-13
  EXPECT_NEAR(end_by(Method::averaged2), exact, 6e-8); // 2e-11 of 3142 s
  EXPECT_NEAR(end_by(Method::averaged1), exact, 3e-5); // 1e-8 of 3142 s
  EXPECT_NEAR(end_by(Method::rk4), exact, 1e-4);       // a new torque acts up to a step late
}

TEST(ClockRunTest, LengthChangesTheRateByMinusHalfAndNotTheAmplitudeEquation) {
  Scenario scenario = steady({2.0, 2.5e-4, 2e-5, 0.03}, 2000);
  ClockRun before(scenario, 1);
  scenario.length.drift_per_day = 86400.0 * 1e-9; // 1e-9 per second: 4e-6 at the end
  ClockRun drifting(scenario, 1);
  while (before.next())
    (void)drifting.next();
  const double change = scenario.length.at(drifting.last().time_s.value());
  // What the length drifts by within the period.
  EXPECT_NEAR(before.last().period_s / drifting.last().period_s - 1.0, -change / 2.0, 2e-9);
  EXPECT_NEAR(drifting.last().velocity / before.last().velocity, 1.0, 3e-6); // physical speed kept
}

TEST(ClockRunTest, ASeriesGivesOneFactorAPeriodAndMayNotRunOut) {
  Scenario scenario = steady(clock_c, 3);
  scenario.drive.series = std::make_shared<const std::vector<double>>(std::vector{0.5, 2.0});
  ClockRun run(scenario, 1);
  EXPECT_EQ(run.next()->mu, 0.75e-5);
  EXPECT_EQ(run.next()->mu, 3e-5);
  EXPECT_THROW((void)run.next(), ArgumentError);
}

TEST(ClockRunTest, AverageMethodsRefuseLawsTheyDoNotKnow) {
  Scenario scenario = steady(clock_c, 3);
  scenario.clock.quadratic_drag = 0.01;
  scenario.method.method = Method::averaged2;
  EXPECT_THROW(ClockRun(scenario, 1), ArgumentError);
  scenario.method.method = Method::rk4;
  EXPECT_THROW(ClockRun(scenario, 1), ArgumentError);
}

} // namespace
} // namespace goingrate
