// The two ways to add up Theo1's terms, separate so that a test can compare them.
#pragma once

#include <cstddef>
#include <span>

namespace goingrate {

// sum_{i=0}^{N-m-1} sum_{d=0}^{h-1} [x_i + x_{i+m} - x_{i+h-d} - x_{i+h+d}]^2 / (h - d), h = m/2,
// as it stands: O((N - m) m).
double theo1_sum_directly(std::span<const double> x, std::size_t m);

// The same from convolutions: O(N log N + m log^2 m). Loses about log10(x^2 / term^2) of 16 digits,
// so x should have no trend.
double theo1_sum_by_transform(std::span<const double> x, std::size_t m);

} // namespace goingrate
