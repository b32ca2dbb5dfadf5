// Stationary operation over a grid of friction and torque (Hoyng, fig. rate).
#pragma once

#include "goingrate/dynamics/operating_point.hpp"

#include <cstddef>
#include <vector>

namespace goingrate {

/// Stationary rate over a grid of epsilon and mu.
struct RateMap {
  double phi0 = 0.0; ///< rad
  std::vector<double> epsilon, mu;
  std::vector<std::vector<double>> rate_excess; ///< [mu][epsilon]; NaN where the clock stalls
};

/// The rate excess at every pair of `epsilon` and `mu`, each from 1e-15 to 1, for the
/// escapement angle `phi0` (0 to pi rad): stationary_rate_first_order, or that of limit_cycle at
/// some 0.1 ms a point. Throws ArgumentError for values outside these ranges.
RateMap rate_map(double phi0, std::vector<double> epsilon, std::vector<double> mu,
                 Equations equations);

/// `points` numbers (2 or more) from `low` to `high`, each by the same factor larger than the one
/// before. Throws ArgumentError unless 0 < low < high.
std::vector<double> log_grid(double low, double high, std::size_t points);

} // namespace goingrate
