// Which averaging factors a table has.
#include "goingrate/spectra/stability.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "goingrate/base/errors.hpp"

namespace goingrate {
namespace {

constexpr std::size_t least_theo1_factor = 10; // SP 1065 section 5.2.15

void check_points(std::size_t phase_points) {
  if (phase_points < 3)
    throw ArgumentError("phase_points", static_cast<double>(phase_points), "3 or more");
}

// first, first * ratio, ... while at most `largest`.
std::vector<std::size_t> geometric(std::size_t first, std::size_t ratio, std::size_t largest) {
  std::vector<std::size_t> factors;
  for (std::size_t m = first; m <= largest; m *= ratio)
    factors.push_back(m);
  return factors;
}

} // namespace

std::size_t largest_factor(DeviationKind kind, std::size_t phase_points) {
  const std::size_t n = phase_points;
  if (n < 3) return 0;
  switch (kind) {
  case DeviationKind::mdev:
  case DeviationKind::tdev:
  case DeviationKind::mtotdev:
  case DeviationKind::ttotdev:
    return n / 3;
  case DeviationKind::hdev:
  case DeviationKind::ohdev:
  case DeviationKind::htotdev:
    return (n - 1) / 3;
  case DeviationKind::totdev:
  case DeviationKind::mtie:
  case DeviationKind::tierms:
    return n - 1;
  case DeviationKind::theo1: {
    const std::size_t even = (n - 1) / 2 * 2;
    return even >= least_theo1_factor ? even : 0;
  }
  case DeviationKind::theoh: // beyond (n-1)/10 the times are Theo1's; its scale needs 19 phases
    return n >= 19 ? (n - 1) / 2 * 2 * 3 / 4 : 0;
  default:
    return (n - 1) / 2;
  }
}

std::vector<std::size_t> octave_factors(std::size_t phase_points, DeviationKind kind) {
  check_points(phase_points);
  return geometric(kind == DeviationKind::theo1 ? 16 : 1, 2, largest_factor(kind, phase_points));
}

std::vector<std::size_t> decade_factors(std::size_t phase_points, DeviationKind kind) {
  check_points(phase_points);
  const std::size_t largest = largest_factor(kind, phase_points);
  std::vector<std::size_t> factors;
  for (std::size_t decade : geometric(kind == DeviationKind::theo1 ? 10 : 1, 10, largest))
    for (std::size_t step : {1, 2, 4})
      if (step * decade <= largest) factors.push_back(step * decade);
  return factors;
}

std::vector<std::size_t> all_factors(std::size_t phase_points, DeviationKind kind) {
  check_points(phase_points);
  const std::size_t largest = largest_factor(kind, phase_points);
  const bool theo1 = kind == DeviationKind::theo1;
  std::vector<std::size_t> factors;
  for (std::size_t m = theo1 ? least_theo1_factor : 1; m <= largest; m += theo1 ? 2 : 1)
    factors.push_back(m);
  return factors;
}

std::optional<std::vector<std::size_t>>
factors_named(std::string_view name, std::size_t phase_points, DeviationKind kind) {
  if (name == "octave") return octave_factors(phase_points, kind);
  if (name == "decade") return decade_factors(phase_points, kind);
  if (name == "all") return all_factors(phase_points, kind);
  return {};
}

std::vector<std::size_t> factors_for(std::span<const double> taus_s, std::size_t phase_points,
                                     double tau0_s, DeviationKind kind) {
  const bool theo1 = kind == DeviationKind::theo1;
  const double unit = theo1 ? 1.5 * tau0_s : tau0_s; // of Theo1 two steps of m
  const double largest = static_cast<double>(largest_factor(kind, phase_points));
  std::vector<std::size_t> factors;
  for (const double tau : taus_s) {
    const double units = std::round(tau / unit), m = theo1 ? 2.0 * units : units;
    const bool multiple = std::abs(units * unit - tau) <= 1e-6 * tau;
    const double least = theo1 ? static_cast<double>(least_theo1_factor) : 1.0;
    const double per_factor = theo1 ? 0.75 * tau0_s : tau0_s;
    if (!multiple || !(m >= least) || !(m <= largest))
      throw ArgumentError("tau", tau,
                          "a multiple of " + std::to_string(unit) + " s, at most " +
                              std::to_string(largest * per_factor) + " s for " +
                              std::string(name_of(kind)) + " of this much data");
    factors.push_back(static_cast<std::size_t>(m));
  }
  std::sort(factors.begin(), factors.end());
  factors.erase(std::unique(factors.begin(), factors.end()), factors.end());
  return factors;
}

} // namespace goingrate
