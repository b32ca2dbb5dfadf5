#include "axis_scale.hpp"

#include "markup.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace goingrate {

namespace {

constexpr std::array<double, 3> mantissas{1.0, 2.0, 5.0};
constexpr double wanted_steps = 6.0;

std::string titled(const std::string& label, const std::string& unit) {
  return unit.empty() ? label : fmt::format("{} ({})", label, unit);
}

double nice_step(double span) {
  const double raw = span / wanted_steps;
  const double decade = std::pow(10.0, std::floor(std::log10(raw)));
  const double m = raw / decade;
  return decade * (m < 1.5 ? 1.0 : m < 3.5 ? 2.0 : m < 7.5 ? 5.0 : 10.0);
}

// How the labels of a linear axis are shortened: shown = (value - offset) / 10^power.
struct Shortening {
  double origin_steps = 0.0; // the offset in steps
  int power = 0;             // a multiple of three
  int decimals = 0;
};

Shortening shorten(double from, double to, double step) {
  Shortening result;
  constexpr double most_steps = 2e5; // steps: labels of more than about five digits
  if (std::max(std::abs(from), std::abs(to)) / step > most_steps)
    result.origin_steps = std::round(0.5 * (from + to) / step / 10.0) * 10.0;
  const double origin = result.origin_steps * step;
  const double largest = std::max(std::abs(from - origin), std::abs(to - origin));
  const double decade = std::floor(std::log10(largest));
  if (decade >= 4.0 || decade < -2.0)
    result.power = static_cast<int>(3.0 * std::floor(decade / 3.0));
  const double place = std::floor(std::log10(step) + 1e-9) - result.power; // 1e-9: log10 of 10^k
  result.decimals = std::max(0, static_cast<int>(-place));
  return result;
}

std::string linear_title(const Axis& axis, const Shortening& shortening, double step) {
  std::string label = axis.label;
  if (shortening.origin_steps != 0.0) {
    const double offset = shortening.origin_steps * step;
    label += fmt::format(" {} {}{}{}", offset < 0.0 ? "+" : "−",
                         typeset(fmt::format("{:.15g}", std::abs(offset))),
                         axis.unit.empty() ? "" : " ", axis.unit);
  }
  if (shortening.power == 0) return titled(label, axis.unit);
  return fmt::format("{} (10{}{}{})", label, superscript(shortening.power),
                     axis.unit.empty() ? "" : " ", axis.unit);
}

AxisScale scale_linear(const Axis& axis, double lowest, double highest, double margin) {
  AxisScale scale;
  double span = highest - lowest;
  const double size = std::max(std::abs(lowest), std::abs(highest));
  if (!(span > std::max(1e-13 * size, 1e-150))) { // all equal to within the rounding of a double
    span = size > 1e-150 ? 0.4 * size : 2.0;
    lowest = 0.5 * (lowest + highest) - 0.5 * span;
    highest = lowest + span;
  }
  scale.from = lowest - margin * span;
  scale.to = highest + margin * span;
  const double step = nice_step(scale.to - scale.from);
  const Shortening shortening = shorten(scale.from, scale.to, step);
  const double first = std::ceil(scale.from / step);
  const double last = std::floor(scale.to / step);
  const double unit = step / std::pow(10.0, shortening.power);
  for (double k = first; k <= last; k += 1.0) {
    const double shown = (k - shortening.origin_steps) * unit + 0.0; // + 0.0: no negative zero
    scale.ticks.push_back(
        {scale.place(k * step), typeset(fmt::format("{:.{}f}", shown, shortening.decimals))});
  }
  scale.title = linear_title(axis, shortening, step);
  return scale;
}

struct LogTick {
  double mantissa = 1.0;
  int decade = 0;
  [[nodiscard]] double logarithm() const { return decade + std::log10(mantissa); }
};

// The logarithm of the nearest 1, 2 or 5 times a power of ten, at or above `logarithm` if `up`,
// else at or below it.
double round_outward(double logarithm, bool up) {
  constexpr double rounding = 1e-9;
  const int decade = static_cast<int>(std::floor(logarithm + (up ? -rounding : rounding)));
  double best = up ? decade + 1.0 : decade;
  for (const double m : mantissas) {
    const double at = LogTick{m, decade}.logarithm();
    if (up && at >= logarithm - rounding) best = std::min(best, at);
    if (!up && at <= logarithm + rounding) best = std::max(best, at);
  }
  return best;
}

std::string log_label(const LogTick& tick, bool as_powers) {
  if (!as_powers)
    return typeset(fmt::format("{:.6g}", tick.mantissa * std::pow(10.0, tick.decade)));
  const std::string power = "10" + superscript(tick.decade);
  return tick.mantissa > 1.0 ? fmt::format("{:.0f}×{}", tick.mantissa, power) : power;
}

void add_log_ticks(AxisScale& scale) {
  const int first = static_cast<int>(std::floor(scale.from));
  const int last = static_cast<int>(std::ceil(scale.to));
  const int decades = last - first;
  constexpr double most_labelled = 8.0; // decades
  constexpr double rounding = 1e-9;     // of a logarithm
  // Limits in decades: numbers below 0.008 or above 12,600 are shorter as powers of ten.
  constexpr double lowest_written = -2.1, highest_written = 4.1;
  const int stride = std::max(1, static_cast<int>(std::ceil(decades / most_labelled)));
  const double powers = std::floor(scale.to + rounding) - std::ceil(scale.from - rounding) + 1.0;
  const bool few = powers < 2.0; // then 2 and 5 need labels as well
  const bool as_powers = scale.from < lowest_written || scale.to > highest_written;
  for (int decade = first; decade <= last; ++decade) {
    for (int m = 1; m <= 9; ++m) {
      const LogTick tick{static_cast<double>(m), decade};
      const double place = (tick.logarithm() - scale.from) / (scale.to - scale.from);
      if (place < -rounding || place > 1.0 + rounding) continue;
      const bool major = (m == 1 && decade % stride == 0) || (few && (m == 2 || m == 5));
      if (major)
        scale.ticks.push_back({place, log_label(tick, as_powers)});
      else if (decades <= 5)
        scale.ticks.push_back({place, ""});
    }
  }
}

// An axis of names has half a place of room at either end, for squares and bars.
AxisScale scale_names(const Axis& axis) {
  AxisScale scale;
  scale.title = titled(axis.label, axis.unit);
  const auto count = static_cast<double>(axis.names.size());
  scale.from = -0.5;
  scale.to = count - 0.5;
  for (std::size_t i = 0; i < axis.names.size(); ++i)
    scale.ticks.push_back({(static_cast<double>(i) + 0.5) / count, axis.names[i]});
  return scale;
}

AxisScale scale_logarithmic(const Axis& axis, double lowest, double highest, double margin) {
  AxisScale scale;
  scale.logarithmic = true;
  scale.title = titled(axis.label, axis.unit);
  const double low = std::log10(lowest);
  const double high = std::log10(highest);
  const double room = margin * (high - low);
  scale.from = round_outward(low - room, false);
  scale.to = round_outward(high + room, true);
  if (scale.to - scale.from < 0.1) { // a single value that is a tick itself
    scale.from = round_outward(low - 0.2, false);
    scale.to = round_outward(high + 0.2, true);
  }
  add_log_ticks(scale);
  return scale;
}

} // namespace

bool can_be_shown(double value, bool logarithmic) {
  return std::abs(value) <= 1e150 && (!logarithmic || value >= 1e-300); // false for NaN
}

double AxisScale::place(double value) const {
  if (!can_be_shown(value, logarithmic)) return std::numeric_limits<double>::quiet_NaN();
  return ((logarithmic ? std::log10(value) : value) - from) / (to - from);
}

AxisScale scale_axis(const Axis& axis, double lowest, double highest, double margin) {
  if (!axis.names.empty()) return scale_names(axis);
  return axis.logarithmic ? scale_logarithmic(axis, lowest, highest, margin)
                          : scale_linear(axis, lowest, highest, margin);
}

AxisScale empty_axis(const Axis& axis) {
  AxisScale scale;
  scale.logarithmic = axis.logarithmic;
  scale.title = titled(axis.label, axis.unit);
  return scale;
}

} // namespace goingrate
