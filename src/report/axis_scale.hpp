// Scales an axis: maps values to places on it, and chooses its ticks.
#pragma once

#include "goingrate/report/figure.hpp"

#include <string>
#include <vector>

namespace goingrate {

struct AxisTick {
  double place = 0.0; ///< on the axis, from 0 to 1
  std::string label;  ///< empty for a minor tick
};

/// One axis laid out. Ticks come in steps of 1, 2 or 5; where their labels would be long, an offset
/// or a power of ten goes into the title.
struct AxisScale {
  bool logarithmic = false;
  double from = 0.0; ///< value, or its decimal logarithm, at place 0
  double to = 1.0;   ///< likewise at place 1
  std::vector<AxisTick> ticks;
  std::string title;

  /// NaN for a value that cannot be shown.
  [[nodiscard]] double place(double value) const;
};

/// Whether the value can be drawn at all. Sizes above 1e150 and, on a logarithmic axis, below
/// 1e-300 count as not finite, so that no difference or ratio of values overflows.
bool can_be_shown(double value, bool logarithmic);

/// The axis for values from `lowest` to `highest`, both showable; `margin` is the share of the span
/// left empty on each side. Equal values get a span around them. An axis of names shows all names.
AxisScale scale_axis(const Axis& axis, double lowest, double highest, double margin);

/// The axis of a figure that has no values: no ticks.
AxisScale empty_axis(const Axis& axis);

} // namespace goingrate
