#include "reading_errors.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace goingrate::timing_model {

namespace {

// Mean power of the upper half of a spectrum, by its median: a line in it is no error.
double level_of_errors(std::span<const double> cosines) {
  std::vector<double> upper;
  for (const double c : cosines.last(cosines.size() / 2))
    upper.push_back(c * c);
  const auto middle = upper.begin() + static_cast<std::ptrdiff_t>(upper.size() / 2);
  std::nth_element(upper.begin(), middle, upper.end());
  constexpr double median_of_a_square = 0.4549; // of a normal variable of unit variance
  return *middle / median_of_a_square;
}

} // namespace

std::vector<double> signal_shares(std::span<const double> cosines) {
  const std::size_t n = cosines.size();
  const double errors = level_of_errors(cosines);
  std::vector<double> sums(n + 1, 0.0); // of the powers before each
  for (std::size_t k = 0; k < n; ++k)
    sums[k + 1] = sums[k] + cosines[k] * cosines[k];
  constexpr double relative_reach = 0.1; // of a frequency, to either side
  constexpr std::size_t least_reach = 2;
  constexpr double sigmas = 3.0; // by which a mean power stands out of the errors
  std::vector<double> shares(n, 0.0);
  for (std::size_t k = 0; k < n; ++k) {
    const auto reach =
        std::max(least_reach, static_cast<std::size_t>(relative_reach * static_cast<double>(k)));
    const std::size_t from = k - std::min(k, reach), to = std::min(n, k + reach + 1);
    const auto count = static_cast<double>(to - from);
    const double power = (sums[to] - sums[from]) / count;
    const double chance = errors * (1.0 + sigmas * std::sqrt(2.0 / count));
    if (power > chance) shares[k] = 1.0 - errors / power;
  }
  return shares;
}

} // namespace goingrate::timing_model
