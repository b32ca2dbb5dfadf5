// The time error that a rate of known density makes. Private to the drive room.
#pragma once

#include <cmath>
#include <numbers>

namespace goingrate {

/// The rms time error after t of a rate with density S. Beyond ten turns in t, sin^2 is replaced by
/// its mean.
template <class Density> double time_error(const Density& density, double t, double period_s) {
  constexpr int steps = 3000;
  const double first = 1e-4 / t, last = 0.5 / period_s;
  const double ratio = std::pow(last / first, 1.0 / steps);
  double sum = density(first) * t * t * first; // below the grid, sin x = x
  double f = first * std::sqrt(ratio);
  for (int i = 0; i < steps; ++i, f *= ratio) {
    const double turns = f * t;
    const double s = std::sin(std::numbers::pi * turns);
    const double size = turns > 10.0 ? 0.5 : s * s;
    const double width = f * (std::sqrt(ratio) - 1.0 / std::sqrt(ratio));
    sum += density(f) * size / std::pow(std::numbers::pi * f, 2) * width;
  }
  return std::sqrt(sum);
}

} // namespace goingrate
