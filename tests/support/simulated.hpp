// Logs whose truth is known: the simulator and its sensor, in memory.
#pragma once

#include "goingrate/dynamics/clock_run.hpp"
#include "goingrate/log/beats.hpp"
#include "goingrate/log/sensor.hpp"

#include <utility>

namespace goingrate::test {

inline ClockLog simulated_log(const Scenario& scenario, std::uint64_t seed) {
  ClockRun run(scenario, seed);
  Sensor sensor(scenario, seed);
  sensor.see(run.last());
  while (const auto period = run.next())
    sensor.see(*period);
  return sensor.log(scenario.clock.nominal_period_s);
}

inline std::vector<Beat> simulated_beats(const Scenario& scenario, std::uint64_t seed) {
  return number_beats(simulated_log(scenario, seed)).longest_segment();
}

/// Beats at exactly these times, `cycles` apart.
inline std::vector<Beat> even_beats(int count, std::int64_t cycles, double period_s) {
  std::vector<Beat> beats;
  for (std::int64_t i = 0; i < count; ++i) {
    beats.push_back(event_at(Instant::from_seconds(static_cast<double>(i * cycles) * period_s)));
    beats.back().cycle = i * cycles;
  }
  return beats;
}

/// The paper's points with T0 = 2 s; run.periods is set, the rest is the default.
inline Scenario at_point_a(std::int64_t periods) {
  Scenario scenario;
  scenario.clock = {2.0, 2.5e-4, 2e-5, 0.03};
  scenario.periods = periods;
  return scenario;
}

inline Scenario at_point_b(std::int64_t periods) {
  Scenario scenario = at_point_a(periods);
  scenario.clock.mu = 4e-5;
  return scenario;
}

inline Scenario jump_from_a_to_b(std::int64_t periods, double jitter_s) {
  Scenario scenario = at_point_a(periods);
  ClockEvent event;
  event.at_period = 150;
  event.mu = 4e-5;
  scenario.events = {event};
  scenario.sensor.jitter_rms_s = jitter_s;
  return scenario;
}

inline Scenario ring_down(std::int64_t periods, double jitter_s) {
  Scenario scenario;
  scenario.clock = {2.0, 2.5e-4, 0.0, 0.0, Escapement::none};
  scenario.start_amplitude = 0.1;
  scenario.periods = periods;
  scenario.sensor.jitter_rms_s = jitter_s;
  return scenario;
}

} // namespace goingrate::test
