#include "goingrate/log/sensor.hpp"

#include "support/simulated.hpp"

#include <gtest/gtest.h>

namespace goingrate {
namespace {

TEST(SensorTest, APerfectSensorReportsTheTruth) {
  const Scenario scenario = test::at_point_a(50);
  const ClockLog log = test::simulated_log(scenario, 1);
  ClockRun run(scenario, 1);
  ASSERT_EQ(log.events.size(), 51u);
  EXPECT_EQ(log.events[0].time, Instant{});
  for (std::size_t i = 1; i < log.events.size(); ++i)
    // A rounding of 100 s.
    EXPECT_NEAR(log.events[i].time.to_double(), run.next()->time_s.value(), 1e-14);
}

TEST(SensorTest, JitterHasItsSizeAndIsWhite) {
  Scenario scenario = test::at_point_a(20000);
  const ClockLog truth = test::simulated_log(scenario, 1);
  scenario.sensor.jitter_rms_s = 1e-4;
  const ClockLog log = test::simulated_log(scenario, 1);
  double sum2 = 0.0, product = 0.0, last = 0.0;
  for (std::size_t i = 0; i < log.events.size(); ++i) {
    const double e = log.events[i].time - truth.events[i].time;
    sum2 += e * e;
    product += e * last;
    last = e;
  }
  const double n = 20001;
  EXPECT_NEAR(std::sqrt(sum2 / n), 1e-4, 4e-4 / std::sqrt(2 * n)); // four standard errors
  EXPECT_NEAR(product / sum2, 0.0, 4 / std::sqrt(n));
}

TEST(SensorTest, MissedAndSpuriousComeAtTheirRates) {
  Scenario scenario = test::at_point_a(20000);
  scenario.sensor.missed = 0.1;
  const auto with_missed = static_cast<double>(test::simulated_log(scenario, 1).events.size());
  EXPECT_NEAR(with_missed, 0.9 * 20001, 4 * std::sqrt(20001 * 0.09));
  scenario.sensor.missed = 0.0;
  scenario.sensor.spurious = 0.1;
  const auto with_spurious = static_cast<double>(test::simulated_log(scenario, 1).events.size());
  EXPECT_NEAR(with_spurious, 1.1 * 20001, 4 * std::sqrt(20001 * 0.09));
}

TEST(SensorTest, ResolutionRoundsTheTimes) {
  for (const double resolution : {1e-3, 0.3, 3.0}) { // divides a second, does not, is longer
    Scenario scenario = test::at_point_a(100);
    const ClockLog exact = test::simulated_log(scenario, 1);
    scenario.sensor.resolution_s = resolution;
    const ClockLog log = test::simulated_log(scenario, 1);
    for (std::size_t i = 0; i < log.events.size(); ++i) {
      const double multiple = log.events[i].time.to_double() / resolution;
      EXPECT_NEAR(multiple, std::round(multiple), 1e-10); // roundings of 2e5 multiples
      EXPECT_LE(std::abs(log.events[i].time - exact.events[i].time), 0.5 * resolution * (1 + 1e-9));
    }
  }
}

TEST(SensorTest, AmplitudesAreTheTurningAnglesOfTheVelocity) {
  Scenario scenario = test::at_point_a(5);
  scenario.sensor.amplitude_rms = 0.0;
  const ClockLog log = test::simulated_log(scenario, 1);
  EXPECT_TRUE(log.has_amplitude);
  for (const Beat& event : log.events)
    // A few roundings of 0.04.
    EXPECT_NEAR(event.amplitude_rad, 2.0 * std::asin(0.5 * 0.0390886300401325), 3e-17);
}

TEST(SensorTest, OneFaultDoesNotChangeTheDrawsOfAnother) {
  Scenario scenario = test::at_point_a(100);
  scenario.sensor.jitter_rms_s = 1e-4;
  const ClockLog clean = test::simulated_log(scenario, 1);
  scenario.sensor.spurious = 0.2;
  std::size_t found = 0;
  for (const Beat& event : test::simulated_log(scenario, 1).events)
    for (const Beat& other : clean.events)
      found += event.time == other.time ? 1 : 0;
  EXPECT_EQ(found, clean.events.size());
}

TEST(SensorTest, DecimalsFollowTheNoise) {
  EXPECT_EQ(decimals_for({}), 15);
  SensorSettings sensor;
  sensor.jitter_rms_s = 1e-5;
  EXPECT_EQ(decimals_for(sensor), 8);
  sensor.resolution_s = 1e-2;
  EXPECT_EQ(decimals_for(sensor), 6);
}

// The model escapement by the classical Runge-Kutta method in steps that end at its switches: times
// (scaled) at which phi falls through `angle` from the crossing with phi' = `velocity` on.
std::vector<long double> falls_through(const ClockParameters& clock, long double velocity,
                                       long double angle, int periods) {
  using T = long double;
  struct State {
    T phi, speed;
  };
  T torque = clock.mu, time = 0.0L;
  State now{0.0L, velocity};
  const auto slope = [&](const State& s) {
    return State{s.speed, torque - 2.0L * clock.epsilon * s.speed - std::sin(s.phi)};
  };
  const auto after = [&](T h) {
    const auto moved = [&](const State& k, T part) {
      return State{now.phi + part * k.phi, now.speed + part * k.speed};
    };
    const State k1 = slope(now), k2 = slope(moved(k1, h / 2)), k3 = slope(moved(k2, h / 2)),
                k4 = slope(moved(k3, h));
    return State{now.phi + h / 6 * (k1.phi + 2 * k2.phi + 2 * k3.phi + k4.phi),
                 now.speed + h / 6 * (k1.speed + 2 * k2.speed + 2 * k3.speed + k4.speed)};
  };
  // The part of a step after which phi is at `place`, which it passes within the step.
  const auto time_to = [&](T place, T h) {
    T low = 0.0L, high = h;
    const bool rises = after(h).phi > now.phi;
    for (int i = 0; i < 70; ++i) {
      const T middle = (low + high) / 2;
      ((after(middle).phi < place) == rises ? low : high) = middle;
    }
    return (low + high) / 2;
  };
  std::vector<T> times;
  while (static_cast<int>(times.size()) < periods) {
    T h = 1e-3L; // an error of 1e-14 per period
    const T next = after(h).phi, place = torque > 0.0L ? clock.phi0 : -clock.phi0;
    const bool switches =
        torque > 0.0L ? now.phi < place && next >= place : now.phi > place && next <= place;
    if (now.phi > angle && next <= angle) times.push_back(time + time_to(angle, h));
    if (switches) h = time_to(place, h);
    now = after(h);
    time += h;
    if (switches) torque = -torque;
  }
  return times;
}

TEST(SensorTest, ABeamOffTheVerticalSeesTheDownwardPassageExactly) {
  // 0.3 rad off, a swing of 0.5 rad, friction that takes 3 % a period: every passage to 1e-11 s,
  // the rounding of the reference; the mean of the speeds at both ends of the period would be 1e-5
  // s off.
  Scenario scenario;
  scenario.clock = {6.283185307179586, 2e-3, 4e-3, 0.05};
  scenario.start_amplitude = 0.5;
  scenario.periods = 6;
  scenario.method.method = Method::direct;
  scenario.sensor.edges = SensorEdges::both;
  scenario.sensor.offset_rad = 0.3;
  std::vector<double> seen;
  for (const Beat& event : test::simulated_log(scenario, 1).events)
    if (event.edge == Edge::down) seen.push_back(event.time.to_double());
  const auto expected = falls_through(scenario.clock, 0.5L, 0.3L, 6);
  ASSERT_EQ(seen.size(), expected.size());
  for (std::size_t i = 0; i < seen.size(); ++i)
    EXPECT_NEAR(seen[i], static_cast<double>(expected[i]), 1e-11) << i;
}

TEST(SensorTest, EventsTakenPieceByPieceAreTheWholeLog) {
  Scenario scenario = test::at_point_a(500);
  scenario.sensor.edges = SensorEdges::both;
  scenario.sensor.jitter_rms_s = 0.02; // neighbours change places
  scenario.sensor.spurious = 0.3;
  scenario.sensor.missed = 0.1;
  const ClockLog whole = test::simulated_log(scenario, 3);
  ClockRun run(scenario, 3);
  Sensor sensor(scenario, 3);
  sensor.see(run.last());
  std::vector<Beat> pieces;
  const auto take = [&](bool at_end) {
    for (const SensedEvent& event : sensor.take(at_end))
      pieces.push_back(event.beat);
  };
  while (const auto period = run.next()) {
    sensor.see(*period);
    if (period->cycle % 7 == 0) take(false);
  }
  EXPECT_GT(pieces.size(), 900u); // it does not keep all to the end
  take(true);
  ASSERT_EQ(pieces.size(), whole.events.size());
  for (std::size_t i = 0; i < pieces.size(); ++i)
    EXPECT_EQ(pieces[i].time, whole.events[i].time) << i;
}

} // namespace
} // namespace goingrate
