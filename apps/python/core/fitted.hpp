// A fit together with its request and its log.
#pragma once

#include "goingrate/analysis/fit_request.hpp"
#include "goingrate/clock/scenario.hpp"
#include "goingrate/fit/clock_fit.hpp"
#include "goingrate/fit/timing_data.hpp"

#include <cstdint>
#include <pybind11/pybind11.h>
#include <vector>

namespace goingrate::python {

/// What _core.Fit is.
struct Fitted {
  FitSummary summary{};
  FitOptions asked{};
  TimingData data{};            ///< what was fitted
  std::int64_t first_cycle = 0; ///< of the first beat, as the log numbers them
  double nominal_period_s = 0.0;
};

/// The request as the package has laid it out.
FitRequest fit_request_of(const pybind11::dict& asked);

/// When the fitted clock passes the vertical upwards, s after the first beat, and the amplitude it
/// then has, rad (NaN if the fit has none): for each cycle, counted as the log does. Within the log
/// the beat less its residual, between beats a straight line; beyond its ends the equations of the
/// fit, run on (back is not possible). Throws ArgumentError for a cycle before the first,
/// NumericsError where the fit does not determine the clock that would have to run on.
struct Prediction {
  std::vector<double> time_s, amplitude_rad;
};
Prediction predict(const Fitted& fit, const std::vector<std::int64_t>& cycles);

/// The standard deviation of these times, s: that of the parameters, with their correlations, and
/// of the origin; to first order in them. Throws as predict() does, and NumericsError where a
/// parameter is undetermined or the drive is noisy.
std::vector<double> predict_sigma(const Fitted& fit, const std::vector<std::int64_t>& cycles);

/// Throws ArgumentError for a cycle before the first.
void check_cycles(const Fitted& fit, const std::vector<std::int64_t>& cycles);

/// Rates that follow something outside the clock, and sensors off the vertical or off in scale, are
/// known within the log only: throws NumericsError for a fit that has such terms.
void refuse_what_lies_outside(const Fitted& fit);

/// The clock of the fit, every parameter being `value(name, absent)`, where `absent` stands for one
/// that the model lacks.
template <class Value> ClockParameters clock_of(const Fitted& fit, Value value) {
  ClockParameters clock;
  clock.escapement = fit.summary.model.escapement;
  clock.nominal_period_s = value("T0", fit.nominal_period_s);
  clock.epsilon = value("epsilon", 0.0);
  clock.mu = value("mu", 0.0);
  clock.phi0 = value("phi0", 0.0);
  clock.quadratic_drag = value("quadratic_drag", 0.0);
  clock.dry_friction = value("dry_friction", 0.0);
  clock.impulse = value("impulse", 0.0);
  clock.impulse_angle = value("impulse_angle", 0.0);
  return clock;
}

/// The method of a run by which the fit's equations are solved.
Method method_of(FitDynamics dynamics);

} // namespace goingrate::python
