#include "robust.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace goingrate {

double median(std::span<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double robust_sigma(std::span<double> values) {
  constexpr double sigma_per_mad = 1.4826; // standard deviation over median absolute deviation
  const double middle = median(values);
  for (double& value : values)
    value = std::abs(value - middle);
  return sigma_per_mad * median(values);
}

double trimmed_mean(std::span<double> values) {
  constexpr std::size_t tenth = 10;
  const std::size_t cut = values.size() / tenth;
  const auto first = values.begin() + static_cast<std::ptrdiff_t>(cut);
  const auto last = values.end() - static_cast<std::ptrdiff_t>(cut);
  if (cut > 0) {
    std::nth_element(values.begin(), first, values.end());
    std::nth_element(first, last, values.end());
  }
  return std::accumulate(first, last, 0.0) / static_cast<double>(last - first);
}

} // namespace goingrate
