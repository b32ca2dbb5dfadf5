// What a column's name says about it.
#pragma once

#include "goingrate/log/clock_log.hpp"

#include <optional>
#include <string_view>

namespace goingrate {

/// A column's meaning as far as its name tells.
struct NamedColumn {
  LogColumn column;
  bool has_unit = false; ///< the name states a unit that its role knows
};

/// From names such as "Time (s)", "time_s", "Angle/rad", "pulse width us" or "Temperature [°C]".
/// Case does not matter, bytes outside ASCII (of whatever encoding) count as letters.
NamedColumn column_named(std::string_view name);

/// Sets a column's unit from its name ("ms", "mrad", "degC", "hPa" ...); false if its role does not
/// know it.
bool set_unit(LogColumn& column, std::string_view unit);

std::string_view name_of(TimeUnit unit);

/// The direction that a word of an edge column tells: up, rising, right, R, tick, 1 or down,
/// falling, left, L, tock, 0 (also "up-in" and the like).
std::optional<Edge> edge_named(std::string_view word);

} // namespace goingrate
