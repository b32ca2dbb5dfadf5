// The mean squares whose roots are the deviations. Each function prepares the parts that all
// averaging factors share and returns a function that gives the mean squares for factors, which
// must increase; that may be called from several threads at once.
//
// Notation: x phase in s (NaN = gap; `known`: there is none), N phases, tau0 sampling interval, m
// averaging factor, n terms averaged. A mean square is in s^2: a deviation of frequency is its root
// over tau, one of time its root. Equations: W. J. Riley, NIST SP 1065 (2008), section 5.2.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <span>
#include <vector>

namespace goingrate {

struct MeanSquare {
  double value = std::numeric_limits<double>::quiet_NaN(); // NaN if n is 0
  std::size_t n = 0;
};

using MeanSquareAt = std::function<MeanSquare(std::size_t m)>;
using MeanSquares = std::function<std::vector<MeanSquare>(std::span<const std::size_t> factors)>;

// For kinds that gain nothing by taking several factors together.
MeanSquares one_by_one(MeanSquareAt at);

inline MeanSquare at_one(const MeanSquares& means, std::size_t m) { return means({&m, 1})[0]; }

// x[i+m] - x[i] (order 1), x[i+2m] - 2 x[i+m] + x[i] (2) or the third difference (3), the sum of
// squares over n times 1, 2 or 6; i in steps of 1 (overlapped) or m. The span must outlive the
// result, here and below.
MeanSquares phase_differences(std::span<const double> x, bool known, std::size_t order,
                              bool overlapped);

// Second differences of the means of m neighbouring phases. With gaps a mean is that of the known
// phases of its window if they are at least half of it; otherwise the difference is left out.
MeanSquares mean_phase_differences(std::span<const double> x, bool known);

// PVAR: differences of the slopes of lines fitted to m phases; no gaps. N - 2m terms.
MeanSquares slope_differences(std::span<const double> x);

// Square of the largest range of x within m + 1 neighbouring samples; NaN ignored.
MeanSquares largest_ranges(std::span<const double> x);

// Second differences centred on every inner phase, x reflected through its first and last value.
MeanSquares reflected_differences(std::span<const double> x, bool known);

// Modified total: within each run of 3m phases the line through the means of its halves is removed,
// the run is continued by its mirror images, and 6m second differences of means are averaged.
MeanSquares modified_total(std::span<const double> x);

// Hadamard total: the same on runs of 3m frequencies; m = 1 is the overlapping Hadamard variance.
MeanSquares hadamard_total(std::span<const double> x);

// Theo1 at its even factor m, tau = 0.75 m tau0; n counts (N - m) m/2 terms; no gaps.
MeanSquares theo1_differences(std::span<const double> x);

} // namespace goingrate
