// The cheapest method that is accurate enough for a scene.
#pragma once

#include "goingrate/clock/scenario.hpp"

#include <string>
#include <vector>

namespace goingrate {

/// A method, its expected error, and the reason for choosing it.
struct MethodChoice {
  Method method = Method::direct;
  double error_bound_s = 0.0; ///< largest error of a crossing time over the run; 0: to rounding
  double tolerance_s = 0.0;   ///< the tolerance asked for; 0: to rounding only
  std::string reason;         ///< in words
};

/// The expected cost and error of one method over the scene.
struct MethodEstimate {
  Method method;
  double error_bound_s;
  double seconds; ///< of computing, order of magnitude
};

/// Bounds for the methods that know the scene's clock laws.
///
/// The error of one period of a method is measured: at amplitudes over the range that the scene
/// runs through and at the drive's extremes its change of lambda^2 and its T - 2 pi are compared
/// with direct integration. The bound over the run is
///   N max|dT| + N (pi/8 + slope) min(N, 1/(4 pi eps)) max|d lambda^2|,
/// where the second term is the effect on the period of errors of the amplitude collected over a
/// relaxation time; both are multiplied by a safety factor of 2. The bound of exact methods is that
/// of rounding.
std::vector<MethodEstimate> estimate_methods(const Scenario& scenario);

/// The scenario's own method, or for automatic the cheapest whose bound is below the tolerance:
/// the scenario's, else a tenth of the sensor's jitter or resolution (the larger), else rounding.
/// MethodChoiceTest.AutomaticKeepsItsPromise tests it over epsilon, amplitude and tolerance.
MethodChoice choose_method(const Scenario& scenario);

} // namespace goingrate
