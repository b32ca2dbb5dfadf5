// Weeks of clocks that are healthy or have one fault.
#pragma once

#include "goingrate/base/random.hpp"
#include "goingrate/base/scaled_time.hpp"
#include "goingrate/fit/diagnosis.hpp"
#include "goingrate/log/rates.hpp"
#include "support/simulated.hpp"

#include <cmath>
#include <optional>

namespace goingrate::test {

/// Seconds pendulum at point B: 2 % of fast drive, jitter 20 us, a daily 2 K and weather of 10 mbar
/// seen by instruments; `cause`: its one fault. Its size (half to twice the usual one) and date
/// come from the seed.
struct SickClock {
  std::optional<Cause> cause;
  std::int64_t periods = 302400; // a week
  std::uint64_t seed = 1;
};

inline std::vector<Suspicion> diagnosed(const SickClock& clock) {
  RandomStream chance(clock.seed, StreamPurpose::amplitude_noise);
  Scenario scenario = at_point_b(clock.periods);
  scenario.drive.fast_rms = 0.02;
  scenario.sensor.jitter_rms_s = 2e-5;
  const auto somewhere = static_cast<std::int64_t>(static_cast<double>(clock.periods) *
                                                   (0.2 + 0.6 * chance.uniform()));
  const double severity = std::exp2(2.0 * chance.uniform() - 1.0); // half to twice
  ClockEvent event;
  event.at_period = somewhere;
  if (clock.cause == Cause::slow_drive) {
    scenario.drive.slow_rms = 0.05 * severity;
    scenario.drive.slow_time_s = 14400.0;
  }
  if (clock.cause == Cause::rough_drive) scenario.drive.fast_rms = 0.3 * severity;
  if (clock.cause == Cause::wheel) scenario.drive.sines = {{0.05 * severity, 480.0}};
  if (clock.cause == Cause::drive_step) event.mu = 4e-5 * (1.0 + 0.1 * severity);
  if (clock.cause == Cause::length_step) event.nominal_period_s = 2.0 * (1.0 + 5e-6 * severity);
  if (clock.cause == Cause::drive_step || clock.cause == Cause::length_step)
    scenario.events = {event};
  if (clock.cause == Cause::growing_friction)
    for (int k = 1; k < 84; ++k) {
      ClockEvent grown;
      grown.at_period = clock.periods * k / 84;
      grown.epsilon = 2.5e-4 * (1.0 + 0.1 * severity * k / 84.0);
      scenario.events.push_back(grown);
    }
  if (clock.cause == Cause::missed_beats) scenario.sensor.missed = 0.005 * severity;
  ClockLog log = simulated_log(scenario, clock.seed);
  // Weather: the temperature of days, and a pressure that wanders; the rate answers if it is the
  // fault.
  std::vector<double> temperature, pressure;
  double late = 0.0, mbar = 0.0, before = 0.0;
  const double answer_t = clock.cause == Cause::temperature ? -5e-6 * severity : 0.0;
  const double answer_p = clock.cause == Cause::pressure ? -2e-7 * severity : 0.0;
  RandomStream weather(clock.seed, StreamPurpose::temperature_noise);
  const double day_phase = two_pi * chance.uniform();
  for (std::size_t i = 0; i < log.events.size(); ++i) {
    const double t = log.events[i].time - log.events.front().time;
    const double step = t - before;
    before = t;
    mbar +=
        -mbar * step / 2e5 + 10.0 * std::sqrt(2.0 * std::max(0.0, step) / 2e5) * weather.normal();
    temperature.push_back(2.0 * std::sin(two_pi * t / 86400.0 + day_phase));
    pressure.push_back(mbar);
    late -= step * (answer_t * temperature.back() + answer_p * mbar);
    double moved = late;
    if (clock.cause == Cause::sensor_shift && static_cast<std::int64_t>(i) > somewhere)
      moved += 4e-4 * severity;
    log.events[i].time = log.events[i].time + moved;
  }
  const Beats numbered = number_beats(log);
  const auto beats = numbered.longest_segment();
  TimingData data = timing_data(beats);
  // The instruments are read at the beats; a missed beat has none.
  const auto on_beats = [&](const std::vector<double>& values) {
    std::vector<double> kept;
    std::size_t k = 0;
    for (const Beat& beat : beats) {
      while (k + 1 < log.events.size() && log.events[k].time < beat.time)
        ++k;
      kept.push_back(values[k]);
    }
    return kept;
  };
  data.terms.push_back(rate_term("temperature", "1/K", data, on_beats(temperature)));
  data.terms.push_back(rate_term("pressure", "1/mbar", data, on_beats(pressure)));
  DiagnosisInput input;
  input.data = &data;
  input.nominal_period_s = 2.0;
  const double cycles = data.cycle.back() + 1.0;
  input.missed_share = 1.0 - static_cast<double>(data.size()) / cycles;
  const auto rates = rate_on_every_cycle(beats, 2.0);
  input.lines = find_lines(rates, 2.0, {.most = 5});
  return diagnose(input);
}

} // namespace goingrate::test
