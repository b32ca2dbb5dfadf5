// The search for the maximum of the likelihood, by Ceres. Private to the fit room.
//
// Ceres minimises sums of squares, and L is not one. However, half the sum of squares of the n + 1
// residuals
//   r = (Q'r, rho),  rho^2 = 2 (L + C) - |Q'r|^2,  with Jacobian (R, 0)
// equals L + C; its gradient is that of L, and its Gauss-Newton matrix is the expected information.
// Levenberg-Marquardt then is Fisher scoring with a trust region.
// The search moves in coordinates that straighten the valley of the likelihood (valley.hpp).
#pragma once

#include "likelihood.hpp"

#include <limits>
#include <string>

namespace goingrate::timing_model {

/// The outcome of a search.
struct Minimum {
  bool usable = false;
  bool converged = false;
  double value = std::numeric_limits<double>::infinity(); ///< L
  std::vector<double> x;
  std::string termination;
};
inline bool by_value(const Minimum& a, const Minimum& b) { return a.value < b.value; }

struct SearchLimits {
  int iterations = 60;
  double least_gain = 1e-4; ///< of L: a step that gains less ends the search (0.014 sigma)
  /// Ceres' trust region, relative: most searches start near the minimum, where its default of 1e4
  /// would only slow them down.
  double first_radius = 1e8;
};

/// Minimises L from `start`; not usable if the model does not hold there.
Minimum minimise(const FitProblem& problem, std::vector<double> start,
                 const SearchLimits& limits = {});

} // namespace goingrate::timing_model
