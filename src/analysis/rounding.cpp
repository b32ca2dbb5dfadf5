#include "rounding.hpp"

#include "base/time_grain.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace goingrate {

namespace {

using std::numbers::pi;

// The logger's steps, s; 0 for times that lie on no grid of decimals.
double logger_grain(const TimingData& times) {
  return time_grain(std::min(times.size(), times_for_grain), times.reference_period_s,
                    [&](std::size_t i) { return times.elapsed_s[i]; });
}

// The steps of the last lateness, s: it is the difference of two times, each with those of a double.
double double_grain(const TimingData& times) {
  const double last_s = std::abs(times.elapsed_s.back());
  return 2.0 * (std::nextafter(last_s, std::numeric_limits<double>::infinity()) - last_s);
}

// The slope of the straight line through the latenesses, seconds per cycle.
double slope_of(const TimingData& times) {
  const auto n = static_cast<double>(times.size());
  double cycle = 0.0, late = 0.0, both = 0.0, square = 0.0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    cycle += times.cycle[i] / n;
    late += times.lateness_s[i] / n;
  }
  for (std::size_t i = 0; i < times.size(); ++i) {
    both += (times.cycle[i] - cycle) * (times.lateness_s[i] - late);
    square += (times.cycle[i] - cycle) * (times.cycle[i] - cycle);
  }
  return both / square;
}

// By how much the latenesses spread about a straight line, s.
double spread_about_line(const TimingData& times) {
  const double slope = slope_of(times);
  double least = times.lateness_s[0], most = least;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double rest = times.lateness_s[i] - slope * times.cycle[i];
    least = std::min(least, rest);
    most = std::max(most, rest);
  }
  return most - least;
}

} // namespace

bool rounding_explains(const TimingData& times) {
  constexpr double allowed_steps = 1.05; // more than 1: the least-squares line is not the best one
  const double grain_s = std::max(logger_grain(times), double_grain(times));
  return spread_about_line(times) <= allowed_steps * grain_s;
}

std::vector<SpectralLine> without_rounding(std::vector<SpectralLine> lines,
                                           const TimingData& times) {
  const double grain_s = logger_grain(times), period_s = times.reference_period_s;
  if (grain_s == 0.0) return lines;
  const double cycles = std::max(1.0, times.cycle.back());
  // A walk whose rms is a third of its range and s steps turns the k-th wave by ks in the log: its
  // line has a half width of π (ks)² turns per log.
  const double strayed_steps = spread_about_line(times) / grain_s / 3.0;
  std::erase_if(lines, [&](const SpectralLine& line) {
    const double steps_late = line.amplitude * period_s / grain_s /
                              (2.0 * std::abs(std::sin(pi * line.frequency_hz * period_s)));
    constexpr int multiples = 20; // higher ones are too dense to distinguish from lines of a wheel
    for (int k = 1; k <= multiples; ++k) {
      const double half_width = pi * std::pow(k * strayed_steps, 2); // turns per log
      // A saw-tooth of one step has waves of 1/πk. Spread over a width they are a noise as large,
      // of which the largest of some thousand values stands out 2.5 times.
      constexpr double largest_share = 2.5;
      if (steps_late > largest_share / (pi * k) / std::sqrt(std::max(1.0, half_width))) break;
      const double turns = std::abs(std::remainder(k * period_s / grain_s, 1.0));
      const double off = std::abs(line.frequency_hz * period_s - turns);
      constexpr double wing = 16.0; // half widths: 4 % of a line's power lie beyond
      if (off * cycles < 1.0 + std::max(0.5 * k, wing * half_width)) return true;
    }
    return false;
  });
  return lines;
}

} // namespace goingrate
