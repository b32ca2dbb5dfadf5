#include "goingrate/dynamics/method_choice.hpp"

#include "goingrate/dynamics/clock_run.hpp"

#include <gtest/gtest.h>
#include <map>
#include <numbers>

namespace goingrate {
namespace {

Scenario at(double epsilon, double amplitude, double ratio, std::int64_t periods) {
  Scenario scenario;
  const double phi0 = amplitude / ratio;
  const double mu = 0.5 * std::numbers::pi * epsilon * amplitude * amplitude / phi0; // statam
  scenario.clock = {2.0, epsilon, std::min(mu, 0.9), phi0};
  scenario.start_amplitude = amplitude;
  scenario.periods = periods;
  return scenario;
}

// Largest difference of a crossing time between the method taken and direct integration; both must
// end alike.
double worst_error(Scenario scenario, Method& taken) {
  ClockRun chosen(scenario, 1);
  taken = chosen.method().method;
  scenario.method.method = Method::direct;
  ClockRun exact(scenario, 1);
  double worst = 0.0;
  for (;;) {
    const auto a = chosen.next(), b = exact.next();
    EXPECT_EQ(a.has_value(), b.has_value());
    if (!a || !b) break;
    worst =
        std::max(worst, std::abs((a->time_s.hi - b->time_s.hi) + (a->time_s.lo - b->time_s.lo)));
  }
  EXPECT_EQ(chosen.status(), exact.status());
  return worst;
}

TEST(MethodChoiceTest, AutomaticKeepsItsPromise) {
  std::map<Method, int> times_taken;
  for (const double epsilon : {1e-6, 1e-4, 1e-3, 1e-2, 0.3})
    for (const double ratio : {1.0, 1.02, 1.1, 1.5, 3.0, 10.0})
      for (const double amplitude : {0.01, 0.05, 0.3, 1.5, 1.95})
        for (const double tolerance : {1e-2, 1e-4, 1e-6, 1e-9}) {
          Scenario scenario = at(epsilon, amplitude, ratio, 200);
          scenario.method.tolerance_s = tolerance;
          Method taken;
          // The exact methods are good to rounding of their own: 1e-13 s here.
          EXPECT_LE(worst_error(scenario, taken), std::max(tolerance, 1e-12))
              << epsilon << ' ' << ratio << ' ' << amplitude << ' ' << name_of(taken);
          ++times_taken[taken];
        }
  // The test would be empty if the exact methods were taken always.
  EXPECT_GT(times_taken[Method::averaged1], 20);
  EXPECT_GT(times_taken[Method::averaged2], 20);
}

TEST(MethodChoiceTest, AutomaticKeepsItsPromiseUnderNoiseAndEvents) {
  std::map<Method, int> times_taken;
  for (const double rms : {0.01, 0.3})
    for (const double tolerance : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8}) {
      Scenario scenario = at(2.5e-4, 0.05, 1.7, 2000);
      scenario.drive.fast_rms = rms;
      ClockEvent event;
      event.at_period = 500;
      event.mu = 2 * scenario.clock.mu;
      scenario.events = {event};
      scenario.method.tolerance_s = tolerance;
      Method taken;
      EXPECT_LE(worst_error(scenario, taken), tolerance) << rms << ' ' << name_of(taken);
      ++times_taken[taken];
    }
  EXPECT_GE(times_taken.size(), 3u);
}

TEST(MethodChoiceTest, ToleranceIsATenthOfTheJitterUnlessGiven) {
  Scenario scenario = at(2.5e-4, 0.05, 1.7, 2000);
  EXPECT_EQ(choose_method(scenario).tolerance_s, 0.0);
  scenario.sensor.jitter_rms_s = 1e-3;
  scenario.sensor.resolution_s = 1e-4;
  EXPECT_EQ(choose_method(scenario).tolerance_s, 1e-4);
  scenario.method.tolerance_s = 1e-8;
  EXPECT_EQ(choose_method(scenario).tolerance_s, 1e-8);
  EXPECT_NE(choose_method(scenario).reason.find("1.0e-08 s"), std::string::npos);
}

TEST(MethodChoiceTest, WhatIsAskedForIsTaken) {
  Scenario scenario = at(2.5e-4, 0.05, 1.7, 2000);
  scenario.method.method = Method::averaged1;
  EXPECT_EQ(choose_method(scenario).method, Method::averaged1);
}

} // namespace
} // namespace goingrate
