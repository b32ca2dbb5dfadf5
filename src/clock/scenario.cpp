#include "goingrate/clock/scenario.hpp"

#include "base/scaled_time.hpp"
#include "goingrate/base/errors.hpp"
#include "goingrate/clock/restoring.hpp"

#include <cmath>

namespace goingrate {

ClockParameters ClockEvent::applied_to(ClockParameters clock) const {
  clock.nominal_period_s = nominal_period_s.value_or(clock.nominal_period_s);
  clock.epsilon = epsilon.value_or(clock.epsilon);
  clock.mu = mu.value_or(clock.mu);
  clock.phi0 = phi0.value_or(clock.phi0);
  clock.quadratic_drag = quadratic_drag.value_or(clock.quadratic_drag);
  clock.dry_friction = dry_friction.value_or(clock.dry_friction);
  clock.impulse = impulse.value_or(clock.impulse);
  clock.impulse_angle = impulse_angle.value_or(clock.impulse_angle);
  clock.every = every.value_or(clock.every);
  clock.below = below.value_or(clock.below);
  return clock;
}

double LengthChanges::at(double time_s) const {
  double change = drift_per_day * time_s / seconds_per_day;
  for (const Sine& sine : sines)
    change += sine.amplitude * std::sin(two_pi * time_s / sine.period_s);
  return change;
}

double Temperature::at(double time_s) const { return lagged_at(time_s, 0.0); }

double Temperature::lagged_at(double time_s, double lag_s) const {
  double celsius = mean_c + drift_per_day * (time_s - lag_s) / seconds_per_day;
  for (const Sine& sine : sines) {
    const double lag = two_pi * lag_s / sine.period_s;
    celsius += sine.amplitude * std::sin(two_pi * time_s / sine.period_s - std::atan(lag)) /
               std::hypot(1.0, lag);
  }
  return celsius;
}

double Scenario::length_change_at(double time_s) const {
  const auto warmer = [&](double lag_s) {
    return temperature.lagged_at(time_s, lag_s) - temperature.mean_c;
  };
  return length.at(time_s) + length.temperature_coefficient * warmer(0.0) -
         length.compensation * warmer(length.compensation_lag_s);
}

std::string_view name_of(Method method) {
  switch (method) {
  case Method::automatic:
    return "auto";
  case Method::direct:
    return "direct";
  case Method::map:
    return "map";
  case Method::averaged1:
    return "averaged1";
  case Method::averaged2:
    return "averaged2";
  case Method::rk4:
    break;
  }
  return "rk4";
}

namespace {

void check_sensor(const SensorSettings& sensor) {
  const auto not_negative = [](std::string_view name, double value) {
    if (!(value >= 0.0 && value <= 1e6)) throw ArgumentError(name, value, "between 0 and 1e6");
  };
  const auto probability = [](std::string_view name, double value) {
    if (!(value >= 0.0 && value < 1.0)) throw ArgumentError(name, value, "at least 0 and below 1");
  };
  not_negative("jitter_rms", sensor.jitter_rms_s);
  not_negative("resolution", sensor.resolution_s);
  not_negative("amplitude_rms", sensor.amplitude_rms.value_or(0.0));
  not_negative("temperature_rms", sensor.temperature_rms.value_or(0.0));
  if (!(std::abs(sensor.offset_rad) <= 1.0))
    throw ArgumentError("offset", sensor.offset_rad, "between -1 and 1 rad");
  if (!(sensor.flag_width_rad >= 0.0 && sensor.flag_width_rad <= 1.0))
    throw ArgumentError("flag_width", sensor.flag_width_rad, "between 0 and 1 rad");
  const bool two_edges = sensor.edges == SensorEdges::gate || sensor.edges == SensorEdges::four;
  if (two_edges && sensor.flag_width_rad == 0.0)
    throw ArgumentError("flag_width", 0.0, "above 0 rad: there are no two edges without a flag");
  probability("missed", sensor.missed);
  probability("spurious", sensor.spurious);
}

void check_method(const MethodSettings& method) {
  if (!(method.dt >= 1e-6 && method.dt <= 1.0))
    throw ArgumentError("run.dt", method.dt, "between 1e-6 and 1 (scaled)");
  if (method.tolerance_s && !(*method.tolerance_s >= 0.0))
    throw ArgumentError("run.tolerance", *method.tolerance_s, "not below 0 s");
}

void check_temperature(const Temperature& temperature) {
  const auto bearable = [](std::string_view name, double kelvin) {
    if (!(std::abs(kelvin) <= 100.0)) throw ArgumentError(name, kelvin, "between -100 and 100");
  };
  bearable("temperature.mean", temperature.mean_c);
  bearable("temperature.drift_per_day", temperature.drift_per_day);
  for (const auto& sine : temperature.sines) {
    bearable("temperature.sine.amplitude", sine.amplitude);
    if (!(sine.period_s > 0.0))
      throw ArgumentError("temperature.sine.period", sine.period_s, "a positive number of seconds");
  }
}

void check_length(const LengthChanges& length) {
  const auto small = [](std::string_view name, double change) {
    if (!(std::abs(change) <= 0.1)) throw ArgumentError(name, change, "between -0.1 and 0.1");
  };
  small("length.drift_per_day", length.drift_per_day);
  if (!(std::abs(length.temperature_coefficient) <= 0.01))
    throw ArgumentError("length.temperature_coefficient", length.temperature_coefficient,
                        "between -0.01 and 0.01 per K");
  if (!(std::abs(length.compensation) <= 0.01))
    throw ArgumentError("length.compensation", length.compensation, "between -0.01 and 0.01 per K");
  if (!(length.compensation_lag_s >= 0.0 && std::isfinite(length.compensation_lag_s)))
    throw ArgumentError("length.compensation_lag", length.compensation_lag_s, "not below 0 s");
  for (const auto& sine : length.sines) {
    small("length.sine.amplitude", sine.amplitude);
    if (!(sine.period_s > 0.0 && std::isfinite(sine.period_s)))
      throw ArgumentError("length.sine.period", sine.period_s, "a positive number of seconds");
  }
}

void check_event(const ClockEvent& event, ClockParameters& clock) {
  if (event.at_period.has_value() == event.at_s.has_value())
    throw ArgumentError("event", event.at_s ? "at_period and at" : "neither at_period nor at",
                        "an event dated by at_period or by at, and not by both");
  if (event.at_period && *event.at_period < 0)
    throw ArgumentError("at_period", static_cast<double>(*event.at_period), "not below 0");
  if (event.at_s && !(*event.at_s >= 0.0)) throw ArgumentError("at", *event.at_s, "not below 0");
  clock = event.applied_to(clock);
  check(clock);
}

} // namespace

void check(const Scenario& scenario) {
  check(scenario.clock);
  if (scenario.start_amplitude)
    check_velocity(scenario.clock, *scenario.start_amplitude, "start.amplitude");
  if (scenario.periods.has_value() == scenario.duration_s.has_value())
    throw ArgumentError("run", scenario.periods ? "periods and duration" : "no length",
                        "a run given by periods or by duration, and not by both");
  constexpr double most_periods = 1e12; // periods; a clock that beats seconds takes 60,000 years
  if (scenario.periods &&
      !(*scenario.periods >= 1 && static_cast<double>(*scenario.periods) <= most_periods))
    throw ArgumentError("periods", static_cast<double>(*scenario.periods), "between 1 and 1e12");
  if (scenario.duration_s &&
      !(*scenario.duration_s > 0.0 &&
        *scenario.duration_s <= most_periods * scenario.clock.nominal_period_s))
    throw ArgumentError("duration", *scenario.duration_s,
                        "a positive number of seconds, at most 1e12 periods");
  ClockParameters clock = scenario.clock;
  for (const ClockEvent& event : scenario.events)
    check_event(event, clock);
  check(scenario.drive);
  check_length(scenario.length);
  check_temperature(scenario.temperature);
  check_method(scenario.method);
  check_sensor(scenario.sensor);
}

} // namespace goingrate
