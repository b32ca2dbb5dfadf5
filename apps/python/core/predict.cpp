#include "fitted.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/base/pulse.hpp"
#include "goingrate/clock/restoring.hpp"
#include "goingrate/dynamics/clock_run.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace goingrate::python {

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

// Time and turning angle of the model's pendulum at beat i of the data.
double model_time(const Fitted& fit, std::size_t i) {
  return fit.data.elapsed_s[i] - fit.summary.residual_s[i];
}
double model_amplitude(const Fitted& fit, std::size_t i) {
  const auto& amplitude = fit.summary.model_amplitude_rad;
  return i < amplitude.size() ? amplitude[i] : unknown;
}

// The value of a parameter after its last change; `absent` if the model does not have it.
double last_value(const Fitted& fit, const std::string& name, double absent) {
  for (std::size_t k = fit.summary.events.size() + 1; k-- > 0;) {
    const FittedParameter* found = fit.summary.find(k == 0 ? name : fmt::format("{}@{}", name, k));
    if (found == nullptr) continue;
    if (!std::isfinite(found->value))
      throw NumericsError(fmt::format(
          "the fit does not determine {}: it cannot predict beyond the log", found->name));
    return found->value;
  }
  return absent;
}

// The fitted clock from the last beat of the log on.
Scenario clock_going_on(const Fitted& fit, std::int64_t periods) {
  refuse_what_lies_outside(fit);
  Scenario scenario;
  scenario.clock =
      clock_of(fit, [&](const char* name, double absent) { return last_value(fit, name, absent); });
  const double amplitude = model_amplitude(fit, fit.data.size() - 1);
  if (!std::isfinite(amplitude))
    throw NumericsError("the fit has no amplitude: it cannot predict beyond the log");
  scenario.start_amplitude = velocity_of_turning_angle(scenario.clock.gravity_share, amplitude);
  scenario.periods = periods;
  scenario.method.method = method_of(fit.summary.dynamics);
  return scenario;
}

// Times of the cycles after the last beat of the log; the first entry is the last beat itself.
Prediction run_on(const Fitted& fit, std::int64_t periods) {
  constexpr std::int64_t between_pulses = 4096;
  ClockRun run(clock_going_on(fit, periods), 1);
  const double start_s = model_time(fit, fit.data.size() - 1);
  Prediction ahead{{start_s}, {model_amplitude(fit, fit.data.size() - 1)}};
  while (const auto period = run.next()) {
    if (period->cycle % between_pulses == 0) pulse();
    ahead.time_s.push_back(start_s + (period->time_s.hi + period->time_s.lo));
    ahead.amplitude_rad.push_back(period->amplitude_rad);
  }
  if (run.status() != SwingStatus::crossed)
    throw NumericsError(
        fmt::format("{} {} periods after the log", words_for(run.status()), run.last().cycle));
  return ahead;
}

// Adds the values at a cycle within the log, counted from the first beat; interpolated linearly
// between beats.
void add_within(const Fitted& fit, double cycle, Prediction& result) {
  const std::vector<double>& cycles = fit.data.cycle;
  const auto after = std::lower_bound(cycles.begin(), cycles.end(), cycle);
  const auto j = static_cast<std::size_t>(after - cycles.begin());
  const std::size_t i = *after == cycle ? j : j - 1;
  const double share = i == j ? 0.0 : (cycle - cycles[i]) / (cycles[j] - cycles[i]);
  result.time_s.push_back(std::lerp(model_time(fit, i), model_time(fit, j), share));
  result.amplitude_rad.push_back(
      std::lerp(model_amplitude(fit, i), model_amplitude(fit, j), share));
}

} // namespace

void refuse_what_lies_outside(const Fitted& fit) {
  for (const FittedParameter& parameter : fit.summary.parameters)
    for (const char* name :
         {"temperature", "pressure", "humidity", "density", "tide", "drift", "offset", "amplitude_scale"})
      if (parameter.name == name)
        throw NumericsError(
            fmt::format("the fit has the term {}: it cannot predict beyond the log", name));
}

Method method_of(FitDynamics dynamics) {
  switch (dynamics) {
  case FitDynamics::averaged1:
    return Method::averaged1;
  case FitDynamics::averaged2:
    return Method::averaged2;
  case FitDynamics::map:
  case FitDynamics::automatic:
    break;
  }
  return Method::automatic;
}

void check_cycles(const Fitted& fit, const std::vector<std::int64_t>& cycles) {
  for (const std::int64_t cycle : cycles)
    if (cycle < fit.first_cycle)
      throw ArgumentError("cycles", static_cast<double>(cycle),
                          fmt::format("{} or more, the first of the log", fit.first_cycle));
}

Prediction predict(const Fitted& fit, const std::vector<std::int64_t>& cycles) {
  if (fit.summary.residual_s.size() != fit.data.size() || fit.data.size() == 0)
    throw NumericsError("the fit has no course to predict from: " + fit.summary.termination);
  const auto last = static_cast<std::int64_t>(fit.data.cycle.back());
  std::int64_t furthest = last;
  check_cycles(fit, cycles);
  for (const std::int64_t cycle : cycles)
    furthest = std::max(furthest, cycle - fit.first_cycle);
  const Prediction ahead = furthest > last ? run_on(fit, furthest - last) : Prediction{};
  Prediction result;
  for (const std::int64_t cycle : cycles) {
    const std::int64_t n = cycle - fit.first_cycle;
    if (n <= last) {
      add_within(fit, static_cast<double>(n), result);
    } else {
      result.time_s.push_back(ahead.time_s[static_cast<std::size_t>(n - last)]);
      result.amplitude_rad.push_back(ahead.amplitude_rad[static_cast<std::size_t>(n - last)]);
    }
  }
  return result;
}

} // namespace goingrate::python
