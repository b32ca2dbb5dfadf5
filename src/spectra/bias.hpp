// What the variances of stability.hpp are expected to be, over the variance they stand for.
#pragma once

#include <cstddef>

#include "goingrate/spectra/stability.hpp"

namespace goingrate {

// Expectation of the variance of `kind` over that of AVAR, MVAR or HVAR for noise of exponent
// `alpha`, at the factor m of `points` phases; 1 for kinds without bias and outside the table.
double variance_bias(DeviationKind kind, int alpha, std::size_t m, std::size_t points);

} // namespace goingrate
