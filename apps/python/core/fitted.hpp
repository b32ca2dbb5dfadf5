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

/// The C++ side of Python's class _core.Fit.
struct Fitted {
  FitSummary summary{};
  FitOptions asked{};
  TimingData data{};            ///< the beats that were fitted
  std::int64_t first_cycle = 0; ///< number of the first beat in the log
  double nominal_period_s = 0.0;
};

/// The request for a fit, from the dict that the Python package makes of the user's options.
FitRequest fit_request_of(const pybind11::dict& asked);

/// For each cycle, as the log counts them: the time at which the fitted clock passes the vertical
/// upwards, s after the first beat, and its amplitude then, rad (NaN if the fit has none). At a
/// beat of the log the time is the beat's minus its residual; between beats it is interpolated
/// linearly; past the end of the log the equations of the fit are run on. They are not run
/// backwards: throws ArgumentError for a cycle before the first. Throws NumericsError if the fit
/// does not determine the clock beyond the log.
struct Prediction {
  std::vector<double> time_s, amplitude_rad;
};
Prediction predict(const Fitted& fit, const std::vector<std::int64_t>& cycles);

/// The standard deviations of the times that predict() gives, s, from the parameters with their
/// correlations and from the origin of time, to first order. Throws as predict() does, and
/// NumericsError if a parameter is undetermined or the drive is noisy.
std::vector<double> predict_sigma(const Fitted& fit, const std::vector<std::int64_t>& cycles);

/// Throws ArgumentError for a cycle before the first.
void check_cycles(const Fitted& fit, const std::vector<std::int64_t>& cycles);

/// Throws NumericsError for a fit with a term that is known only within the log: a rate that
/// depends on something outside the clock, a sensor offset, or an amplitude scale.
void refuse_what_lies_outside(const Fitted& fit);

/// The clock of the fit. Each parameter is `value(name, absent)`, where `absent` is its value if
/// the model does not have it.
template <class Value> ClockParameters clock_of(const Fitted& fit, Value value) {
  ClockParameters clock;
  clock.escapement = fit.summary.model.escapement;
  clock.nominal_period_s = value("T0", fit.nominal_period_s);
  clock.epsilon = value("epsilon", 0.0);
  clock.mu = value("mu", 0.0);
  clock.phi0 = value("phi0", 0.0);
  clock.quadratic_drag = value("quadratic_drag", 0.0);
  clock.dry_friction = value("dry_friction", 0.0);
  clock.gravity_share = value("gravity_share", 1.0);
  clock.impulse = value("impulse", 0.0);
  clock.impulse_angle = value("impulse_angle", 0.0);
  return clock;
}

/// The method by which a run solves the fit's equations.
Method method_of(FitDynamics dynamics);

} // namespace goingrate::python
