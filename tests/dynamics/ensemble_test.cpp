#include "goingrate/dynamics/ensemble.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <gtest/gtest.h>

namespace goingrate {
namespace {

Scenario noisy_c(std::int64_t periods) {
  Scenario scenario;
  scenario.clock = {2.0, 1.167245e-4, 1.5e-5, 0.03};
  scenario.periods = periods;
  scenario.drive.fast_rms = 0.3;
  scenario.drive.slow_rms = 0.05;
  scenario.drive.slow_time_s = 500.0;
  scenario.method.method = Method::map;
  return scenario;
}

// Every realisation must be, to the last bit, what ClockRun gives alone.
void expect_single_runs(const Scenario& scenario, const EnsembleOptions& options) {
  std::vector<std::vector<Period>> seen(options.realisations);
  const auto status = run_ensemble(
      scenario, options, [&](std::size_t k, const Period& period) { seen[k].push_back(period); });
  const auto last = final_periods(scenario, options);
  for (std::size_t k = 0; k < options.realisations; ++k) {
    ClockRun alone(scenario, options.seed + k);
    std::size_t i = 0;
    while (const auto period = alone.next()) {
      ASSERT_LT(i, seen[k].size()) << k;
      ASSERT_EQ(seen[k][i].time_s.hi, period->time_s.hi) << k << ' ' << i;
      ASSERT_EQ(seen[k][i].time_s.lo, period->time_s.lo);
      ASSERT_EQ(seen[k][i].velocity, period->velocity);
      ASSERT_EQ(seen[k][i].period_s, period->period_s);
      ASSERT_EQ(seen[k][i].mu, period->mu);
      ASSERT_EQ(seen[k][i].cycle, period->cycle);
      ++i;
    }
    EXPECT_EQ(i, seen[k].size());
    EXPECT_EQ(status[k], alone.status());
    EXPECT_EQ(last[k].time_s.hi, alone.last().time_s.hi);
    EXPECT_EQ(last[k].cycle, alone.last().cycle);
  }
}

TEST(EnsembleTest, RealisationsAreSingleRunsWhateverTheThreads) {
  for (const std::size_t threads : {1u, 2u, 5u})
    expect_single_runs(noisy_c(400), {7, 19, threads});
}

TEST(EnsembleTest, AnySeedsInAnyCompany) {
  Scenario scenario = noisy_c(200);
  for (const Method method : {Method::map, Method::averaged1}) {
    scenario.method.method = method;
    Realisations all(scenario);
    Realisations other = all;
    const std::vector<std::uint64_t> many{3, 99, 4, 1000000, 7, 8, 21, 5, 6, 3}, few{99, 6};
    std::vector<Period> last(many.size()), again(few.size());
    all.run(many, [&](std::size_t k, const Period& period) { last[k] = period; });
    other.run(few, [&](std::size_t k, const Period& period) { again[k] = period; });
    EXPECT_EQ(last[0].time_s.hi, last[9].time_s.hi);
    EXPECT_EQ(last[1].time_s.lo, again[0].time_s.lo);
    EXPECT_EQ(last[8].velocity, again[1].velocity);
    ClockRun alone(scenario, 1000000);
    while (alone.next()) {
    }
    EXPECT_EQ(last[3].time_s.hi, alone.last().time_s.hi);
    EXPECT_EQ(last[3].velocity, alone.last().velocity);
    EXPECT_EQ(all.start().velocity, alone.start_velocity());
  }
}

TEST(EnsembleTest, LanesPartWhereTheirStatesDo) {
  // A jump of the torque sends all lanes through many patches at slightly different times; a start
  // far away does too.
  Scenario scenario = noisy_c(300);
  ClockEvent jump;
  jump.at_period = 50;
  jump.mu = 4e-5;
  scenario.events = {jump};
  scenario.start_amplitude = 0.06;
  expect_single_runs(scenario, {3, 11, 2});
}

TEST(EnsembleTest, RealisationsThatStallEndAlone) {
  // Little above the switching angle under a noisy drive: some stall, some do not.
  Scenario scenario = noisy_c(3000);
  scenario.clock = {2.0, 1e-2, 5.8e-4, 0.03};
  scenario.drive.slow_rms = 0.0;
  scenario.drive.fast_rms = 0.25;
  const EnsembleOptions options{1, 16, 2};
  const auto status = run_ensemble(scenario, options, [](std::size_t, const Period&) {});
  const auto stalled = std::count(status.begin(), status.end(), SwingStatus::stalled);
  EXPECT_GT(stalled, 0);
  EXPECT_LT(stalled, 16);
  expect_single_runs(scenario, options);
}

TEST(EnsembleTest, OtherMethodsAndTimedEventsRunOneByOne) {
  Scenario scenario = noisy_c(100);
  ClockEvent event;
  event.at_s = 51.0;
  event.mu = 2e-5;
  scenario.events = {event};
  expect_single_runs(scenario, {1, 5, 2});
  scenario.method.method = Method::averaged2;
  expect_single_runs(scenario, {1, 5, 2});
}

TEST(EnsembleTest, AnErrorOfARealisationIsThrown) {
  Scenario scenario = noisy_c(100);
  scenario.drive = {};
  scenario.drive.series = std::make_shared<const std::vector<double>>(50, 1.0);
  EXPECT_THROW((void)final_periods(scenario, {1, 20, 2}), ArgumentError);
}

} // namespace
} // namespace goingrate
