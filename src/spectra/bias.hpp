// Expected ratios of the variances of stability.hpp to the variances that they estimate.
#pragma once

#include <cstddef>

#include "goingrate/spectra/stability.hpp"

namespace goingrate {

// Expectation of the variance of `kind` over that of AVAR, MVAR or HVAR for noise of exponent
// `alpha`, at the factor m of `points` phases; 1 for kinds without bias and outside the table.
double variance_bias(DeviationKind kind, int alpha, std::size_t m, std::size_t points);

} // namespace goingrate
