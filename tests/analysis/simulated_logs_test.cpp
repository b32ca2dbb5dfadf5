#include "goingrate/analysis/simulated_logs.hpp"

#include "support/simulated.hpp"

#include <gtest/gtest.h>

namespace goingrate {
namespace {

TEST(SimulatedLogsTest, TheTruthHasTheNamesOfAFit) {
  Scenario scenario = test::jump_from_a_to_b(300, 1e-6);
  scenario.drive.fast_rms = 0.1;
  const auto truth = true_parameters(scenario);
  const std::map<std::string, double> expected{
      {"gravity_share", 1.0}, {"T0", 2.0},    {"epsilon", 2.5e-4},  {"mu", 2e-5},
      {"phi0", 0.03},         {"mu@1", 4e-5}, {"jitter_rms", 1e-6}, {"drive_rms", 0.1}};
  for (const auto& [name, value] : expected)
    EXPECT_EQ(truth.at(name), value) << name;
  // The limit cycle of point A by 128-bit arithmetic; 1e-12: what direct integration keeps.
  EXPECT_NEAR(truth.at("lambda0"), 0.0390886300401325117, 1e-12);
  EXPECT_EQ(truth.size(), expected.size() + 1);
}

TEST(SimulatedLogsTest, WhatNoNumberTellsIsLeftOut) {
  Scenario scenario = test::ring_down(300, 1e-6);
  scenario.sensor.resolution_s = 1e-3;
  scenario.sensor.offset_rad = 0.001;
  const auto truth = true_parameters(scenario);
  EXPECT_FALSE(truth.contains("jitter_rms"));
  EXPECT_FALSE(truth.contains("mu"));
  EXPECT_EQ(truth.at("offset"), 0.001);
  EXPECT_EQ(truth.at("lambda0"), 0.1);
}

// A fit knows only the mean drive: the impulse over the periods from one impulse to the next.
TEST(SimulatedLogsTest, AnEventMayChangeHowOftenTheEscapementActs) {
  Scenario scenario = test::at_point_a(300);
  scenario.clock.mu *= 5.0;
  scenario.clock.every = 5;
  ClockEvent half_as_often, waits;
  half_as_often.at_period = 100;
  half_as_often.every = 10;
  waits.at_period = 200;
  waits.every = 1;
  waits.below = 0.039;
  scenario.events = {half_as_often, waits};
  const auto truth = true_parameters(scenario);
  EXPECT_DOUBLE_EQ(truth.at("mu"), 2e-5);
  EXPECT_DOUBLE_EQ(truth.at("mu@1"), 1e-5);
  // What friction takes at the limit, mu = pi eps lambda^2/(2 phi0); the saw-tooth lifts the mean
  // lambda^2 some 25 % above the limit.
  EXPECT_NEAR(truth.at("mu@2") / (M_PI * 2.5e-4 * 0.039 * 0.039 / 0.06), 1.0, 0.3);
}

TEST(SimulatedLogsTest, AClockThatStallsSaysWhen) {
  Scenario scenario = test::at_point_a(2000);
  ClockEvent event;
  event.at_period = 100;
  event.dry_friction = 0.01; // brings it to rest within some swings
  scenario.events = {event};
  SimulatedLogs logs(scenario);
  const auto made = logs.make(std::vector<std::uint64_t>{1, 2});
  ASSERT_EQ(made.size(), 2u);
  EXPECT_EQ(made[0].status, SwingStatus::stalled);
  EXPECT_GE(made[0].periods, 100);
  EXPECT_LT(made[0].periods, 110);
  EXPECT_EQ(made[0].text, made[1].text); // without noise
}

} // namespace
} // namespace goingrate
