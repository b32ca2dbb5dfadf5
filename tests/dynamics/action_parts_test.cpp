// A push that runs through the vertical, of an escapement that rests: one action.
#include "goingrate/dynamics/clock_run.hpp"
#include "goingrate/dynamics/intermittent.hpp"
#include "goingrate/dynamics/stationary.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <vector>

namespace goingrate {
namespace {

constexpr double energy_before = 3.0e-7, energy_after = 1.2e-6; // of phi'^2/2, about the vertical

// An arm that lands at -0.002 rad and leaves at 0.008.
ClockParameters resting_arm() {
  ClockParameters clock;
  clock.epsilon = 2e-5;
  clock.escapement = Escapement::profile;
  clock.rising = {{{-0.002, 1.5e-4}, {0.008, 1.5e-4}}};
  clock.every = 15;
  return clock;
}

std::vector<Period> periods_of(Scenario scenario, Method method) {
  scenario.method.method = method;
  ClockRun run(scenario, 3);
  std::vector<Period> all;
  while (const auto period = run.next())
    all.push_back(*period);
  EXPECT_EQ(all.size(), static_cast<std::size_t>(*scenario.periods));
  return all;
}

Scenario run_of(const ClockParameters& clock, std::int64_t periods) {
  Scenario scenario;
  scenario.clock = clock;
  scenario.periods = periods;
  return scenario;
}

// Without friction v^2 tells the work done: all of it between two turning points on the left.
TEST(ActionPartsTest, OneActionIsOnePush) {
  ClockParameters clock = resting_arm();
  clock.epsilon = 0.0;
  clock.every = 4;
  Scenario scenario = run_of(clock, 10);
  scenario.start_amplitude = 0.03;
  const std::vector<double> work{energy_before, energy_after, 0.0, 0.0,           energy_before,
                                 energy_after,  0.0,          0.0, energy_before, energy_after};
  for (const Method method : {Method::direct, Method::map}) {
    double before2 = 0.03 * 0.03;
    for (const Period& period : periods_of(scenario, method)) {
      const double now2 = period.velocity * period.velocity;
      // Rounding of v^2, 1e-19, and of the map.
      EXPECT_NEAR(0.5 * (now2 - before2), work[static_cast<std::size_t>(period.cycle - 1)], 1e-17)
          << period.cycle;
      before2 = now2;
    }
  }
}

TEST(ActionPartsTest, TheMapTellsTheSameStoryAsTheIntegrator) {
  ClockParameters hipp = resting_arm();
  hipp.every = 1;
  hipp.below = 0.02;
  for (const ClockParameters& clock : {resting_arm(), hipp}) {
    Scenario scenario = run_of(clock, 2000);
    scenario.drive.fast_rms = 0.1; // an action keeps its factor
    const auto exact = periods_of(scenario, Method::direct),
               mapped = periods_of(scenario, Method::map);
    for (std::size_t i = 0; i < exact.size(); ++i)
      ASSERT_NEAR(mapped[i].time_s.value(), exact[i].time_s.value(), 2e-12)
          << i; // rounding, 4000 s
  }
}

TEST(ActionPartsTest, AveragedEquationsKeepBothParts) {
  const auto exact = periods_of(run_of(resting_arm(), 1500), Method::direct),
             averaged = periods_of(run_of(resting_arm(), 1500), Method::averaged1);
  const double drift = averaged.back().time_s.value() - exact.back().time_s.value();
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const double share = static_cast<double>(i + 1) / static_cast<double>(exact.size());
    const double off = averaged[i].time_s.value() - exact[i].time_s.value() - drift * share;
    // The crossing in the midst of a push comes 4.3e-6 s early; averaged, less than that.
    ASSERT_LT(std::abs(off), 4.3e-6) << i;
  }
}

TEST(ActionPartsTest, TheCycleCloses) {
  const auto all = periods_of(run_of(resting_arm(), 15), Method::direct);
  const auto cycle = limit_cycle(resting_arm());
  ASSERT_TRUE(cycle);
  EXPECT_NEAR(all.back().velocity / cycle->velocity, 1.0, 1e-15); // rounding
  EXPECT_NEAR(2.0 * 15.0 / all.back().time_s.value() - 1.0, cycle->rate_excess, 1e-15);
}

// Where nothing acts on the left of the vertical, or nothing on the right, crossings cut nothing.
TEST(ActionPartsTest, OnlyPushesThroughTheVerticalHaveParts) {
  EXPECT_TRUE(action_parts(resting_arm()));
  ClockParameters clock = resting_arm();
  clock.every = 1;
  EXPECT_FALSE(action_parts(clock)); // it does not rest
  clock = resting_arm();
  clock.rising = {{{-0.01, 0.0}, {0.0, 0.0}, {0.008, 1e-4}}};
  EXPECT_FALSE(action_parts(clock));
  clock.rising = {{{-0.01, 1e-4}, {0.0, 1e-4}}};
  EXPECT_FALSE(action_parts(clock));
  clock = resting_arm();
  std::swap(clock.rising, clock.falling); // the swing to the left lies within a period
  EXPECT_FALSE(action_parts(clock));
}

// ---- events ------------------------------------------------------------------------------------

ClockParameters clock_with_arm() {
  ClockParameters clock;
  clock.epsilon = 4e-5;
  clock.escapement = Escapement::single_impulse;
  clock.impulse = 3.4e-6;
  clock.every = 15;
  return clock;
}

std::int64_t impulses(const std::vector<Period>& all, std::size_t from, std::size_t to) {
  std::int64_t count = 0;
  for (std::size_t i = from; i < to; ++i)
    count += all[i].mu > 0.0 ? 1 : 0;
  return count;
}

TEST(RestingEventsTest, EveryAndBelowMayChange) {
  Scenario scenario = run_of(clock_with_arm(), 1200);
  ClockEvent more_often, waits;
  more_often.at_period = 300;
  more_often.every = 5;
  waits.at_period = 600;
  waits.every = 1;
  waits.below = 0.03;
  scenario.events = {more_often, waits};
  const auto exact = periods_of(scenario, Method::direct);
  EXPECT_EQ(impulses(exact, 0, 300), 20);
  EXPECT_EQ(impulses(exact, 300, 600), 60);
  // Three times the power raised lambda^2 from 9.0e-4, the limit, by 2 (1 - exp(-0.15)) of itself,
  // which takes 490 periods to fall; then one in ln(1 + 6.8e-6/9e-4)/(4 pi eps) = 15.
  EXPECT_EQ(impulses(exact, 600, 1080), 0);
  EXPECT_NEAR(static_cast<double>(impulses(exact, 1080, 1200)), 110.0 / 15.0, 1.0);
  const auto mapped = periods_of(scenario, Method::map);
  for (std::size_t i = 0; i < exact.size(); ++i)
    ASSERT_NEAR(mapped[i].time_s.value(), exact[i].time_s.value(), 1e-12) << i;
  const auto averaged = periods_of(scenario, Method::averaged1);
  EXPECT_EQ(impulses(averaged, 0, 600), 80);
  // 2400 s of a rate that first order knows to 1e-8.
  EXPECT_NEAR(averaged.back().time_s.value(), exact.back().time_s.value(), 2.4e-5);
}

// What changes between two impulses shows at the next.
TEST(RestingEventsTest, AnImpulseThatChangesBetweenTwo) {
  Scenario scenario = run_of(clock_with_arm(), 60);
  const auto before = periods_of(scenario, Method::direct);
  ClockEvent event;
  event.at_period = 22;
  event.impulse = 6.8e-6;
  scenario.events = {event};
  for (const Method method : {Method::direct, Method::map, Method::averaged1}) {
    const auto after = periods_of(scenario, method);
    const auto usual =
        method == Method::direct ? before : periods_of(run_of(clock_with_arm(), 60), method);
    for (std::size_t i = 0; i < 30; ++i)
      ASSERT_NEAR(after[i].time_s.value(), usual[i].time_s.value(), 1e-14) << i;
    const double lift =
        after[30].velocity * after[30].velocity - usual[30].velocity * usual[30].velocity;
    // 2 (6.8e-6 - 3.4e-6), less the friction of a period: 4 pi eps; spread, of half.
    EXPECT_NEAR(lift / 6.8e-6, 1.0, 4.0 * M_PI * 4e-5 + 1e-4);
  }
}

} // namespace
} // namespace goingrate
