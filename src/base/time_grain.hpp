// The steps in which a logger states its times, and the error that they cause.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>

namespace goingrate {

/// How many times are searched for a grain: so many that none appears by chance.
inline constexpr std::size_t times_for_grain = 4096;

/// The greatest step of which the first `count` times are whole multiples after the first of them,
/// s: 1e-3 for a logger that counts milliseconds. `elapsed_s(i)` is rising or nearly so. A step
/// longer than a sixteenth of `period_s`, as in a log of steady beats, may be the clock's own: the
/// greatest power of ten that divides it is taken. 0 for times that lie on no grid of decimals.
/// (TimeGrainTest)
template <class Elapsed>
double time_grain(std::size_t count, double period_s, const Elapsed& elapsed_s) {
  double longest_s = 0.0;
  for (std::size_t i = 0; i < count; ++i)
    longest_s = std::max(longest_s, std::abs(elapsed_s(i)));
  // The finest decimal unit that a double resolves at such times, 1 ns at the finest.
  constexpr double finest_s = 1e-9, resolution = 1e-13;
  const double unit_s = std::max(
      finest_s, std::pow(10.0, std::ceil(std::log10(resolution * std::max(1.0, longest_s)))));
  std::int64_t step = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double units = elapsed_s(i) / unit_s, whole = std::round(units);
    constexpr double rounding = 0.05; // units
    if (!(std::abs(units - whole) <= rounding)) return 0.0;
    step = std::gcd(step, static_cast<std::int64_t>(whole));
    if (step == 1) break;
  }
  constexpr double fewest_in_period = 16.0;
  if (static_cast<double>(step) * unit_s * fewest_in_period <= period_s)
    return static_cast<double>(step) * unit_s;
  std::int64_t decimal = 1;
  while (step % (10 * decimal) == 0 && step > 0)
    decimal *= 10;
  return static_cast<double>(decimal) * unit_s;
}

/// Standard deviation of the error of rounding to `grain_s`: it is uniform over a step, with a
/// variance of a twelfth of the step's square.
inline double rounding_sigma(double grain_s) { return grain_s / std::sqrt(12.0); }

} // namespace goingrate
