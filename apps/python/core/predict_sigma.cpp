// Standard deviations of the times that a fit predicts.
#include "fitted.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/base/pulse.hpp"
#include "goingrate/dynamics/clock_run.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <numeric>
#include <optional>

namespace goingrate::python {

namespace {

using Values = std::map<std::string, double>;

// Values of all parameters, the noise's included.
Values values_of(const FitSummary& fit) {
  Values values;
  for (const FittedParameter& parameter : fit.parameters) {
    if (!std::isfinite(parameter.value))
      throw NumericsError(fmt::format(
          "the fit does not determine {}: the uncertainty of its predictions is unknown",
          parameter.name));
    values[parameter.name] = parameter.value;
  }
  return values;
}

void refuse_wandering(const ModelChoice& model) {
  if (model.walk || model.drive || model.slow)
    throw NumericsError("the fit has noise of the drive, which makes the times wander: its "
                        "parameters alone do not say how far");
}

ClockEvent event_of(const FitEvent& event, std::size_t k, const Values& values) {
  ClockEvent change;
  change.at_period = event.cycle;
  const auto put = [&](const char* name, std::optional<double>& to) {
    if (const auto found = values.find(fmt::format("{}@{}", name, k)); found != values.end())
      to = found->second;
  };
  put("T0", change.nominal_period_s);
  put("epsilon", change.epsilon);
  put("mu", change.mu);
  put("phi0", change.phi0);
  put("impulse", change.impulse);
  put("impulse_angle", change.impulse_angle);
  return change;
}

// The fitted clock from the first beat on.
Scenario whole_course(const Fitted& fit, const Values& values, std::int64_t periods) {
  const auto value = [&](const char* name, double absent) {
    const auto found = values.find(name);
    return found == values.end() ? absent : found->second;
  };
  Scenario scenario;
  scenario.clock = clock_of(fit, value);
  scenario.start_amplitude = value("lambda0", 0.0);
  scenario.periods = periods;
  scenario.method.method = method_of(fit.summary.dynamics);
  for (std::size_t k = 0; k < fit.summary.events.size(); ++k)
    scenario.events.push_back(event_of(fit.summary.events[k], k + 1, values));
  return scenario;
}

// When each cycle ends, s after the first beat.
std::vector<double> times_of(const Scenario& scenario) {
  std::vector<double> times{0.0};
  ClockRun run(scenario, 1);
  while (const auto period = run.next())
    times.push_back(period->time_s.hi + period->time_s.lo);
  if (run.status() != SwingStatus::crossed)
    throw NumericsError(
        fmt::format("{} after {} periods", words_for(run.status()), run.last().cycle));
  return times;
}

// How far each time moves per standard deviation of the parameter. The deviation is the one under
// the fit's own law of friction, to which the correlations belong. The mean over the log's beats is
// taken off, because the fit sets the origin of time.
std::vector<double> moved_by(const Fitted& fit, const Values& values,
                             const FittedParameter& parameter, std::int64_t periods) {
  constexpr double step = 0.3; // sigma; so small that the times change linearly
  pulse();
  Values up = values, down = values;
  up[parameter.name] += step * parameter.sigma_by_law;
  down[parameter.name] -= step * parameter.sigma_by_law;
  std::vector<double> moved = times_of(whole_course(fit, up, periods));
  const std::vector<double> other = times_of(whole_course(fit, down, periods));
  double mean = 0.0;
  for (std::size_t n = 0; n < moved.size(); ++n)
    moved[n] = (moved[n] - other[n]) / (2.0 * step);
  for (const double cycle : fit.data.cycle)
    mean += moved[static_cast<std::size_t>(cycle)];
  mean /= static_cast<double>(fit.data.size());
  for (double& time : moved)
    time -= mean;
  return moved;
}

// The variance at one cycle: the sum over i, j of m_i c_ij m_j.
double variance(const std::vector<std::vector<double>>& moved,
                const std::vector<std::vector<double>>& correlation, std::size_t n) {
  double sum = 0.0;
  for (std::size_t i = 0; i < moved.size(); ++i)
    for (std::size_t j = 0; j < moved.size(); ++j)
      if (!moved[i].empty() && !moved[j].empty())
        sum += moved[i][n] * correlation[i][j] * moved[j][n];
  return std::max(0.0, sum);
}

bool is_of_noise(const std::string& name) { return name.ends_with("_rms"); }

} // namespace

std::vector<double> predict_sigma(const Fitted& fit, const std::vector<std::int64_t>& cycles) {
  refuse_what_lies_outside(fit);
  refuse_wandering(fit.summary.model);
  const Values values = values_of(fit.summary);
  check_cycles(fit, cycles);
  const std::int64_t within = static_cast<std::int64_t>(fit.data.cycle.back());
  std::int64_t periods = within;
  for (const std::int64_t cycle : cycles)
    periods = std::max(periods, cycle - fit.first_cycle);
  std::vector<std::vector<double>> moved;
  for (const std::string& name : fit.summary.correlated)
    moved.push_back(is_of_noise(name) ? std::vector<double>{}
                                      : moved_by(fit, values, fit.summary[name], periods));
  const double jitter = std::isfinite(fit.summary.jitter_s) ? fit.summary.jitter_s : 0.0;
  const double of_origin = jitter * jitter / static_cast<double>(fit.data.size());
  std::vector<double> sigma;
  for (const std::int64_t cycle : cycles)
    sigma.push_back(
        std::sqrt(of_origin + variance(moved, fit.summary.correlation,
                                       static_cast<std::size_t>(cycle - fit.first_cycle))));
  return sigma;
}

} // namespace goingrate::python
