// Role and unit of a log's column, recognised from its name.
#pragma once

#include "goingrate/log/clock_log.hpp"

#include <optional>
#include <string_view>

namespace goingrate {

/// A column with the role and unit that its name states.
struct NamedColumn {
  LogColumn column;
  bool has_unit = false; ///< the name states a unit that suits the role
};

/// Recognises names such as "Time (s)", "time_s", "Angle/rad", "pulse width us" or
/// "Temperature [°C]", in upper or lower case. The name may be in any encoding that extends ASCII.
NamedColumn column_named(std::string_view name);

/// Columns of dates and of the clock's error at them.
struct DatedPhases {
  LogColumn date, phase;
};

/// Recognises "mjd" beside "phase_s", "Phase (ns)" or "phase"; nullopt for other names, since a
/// phase without such dates, or in degrees, need not be a clock's.
std::optional<DatedPhases> dated_phases_named(std::string_view date, std::string_view phase);

/// Sets the unit of a column from the unit's name ("ms", "mrad", "degC", "hPa" ...). Returns false,
/// and changes nothing, if the unit is unknown or does not suit the column's role.
bool set_unit(LogColumn& column, std::string_view unit);

/// The names of the units that suit a role, in words; empty if it has none.
std::string_view units_of(ColumnRole role);

/// The short name of a unit: "s", "ms", "us" ...; "?" for a unit without one.
std::string_view name_of(TimeUnit unit);

/// Whether a column of this name may hold the state of a light gate: "GateState", "state". Its 0
/// and 1 say whether the flag is in the gate, and not in which direction it goes.
bool names_gate_state(std::string_view name);

/// Whether a name or unit says that a column is a speed of turning: "Gyroscope x (rad/s)".
bool names_turning_speed(std::string_view name);

/// The direction that a word in an edge column stands for. Up: up, rising, right, R, tick, 1; down:
/// down, falling, left, L, tock, 0; nothing for any other word. Case and whatever follows a hyphen
/// ("up-in") are ignored.
std::optional<Edge> edge_named(std::string_view word);

} // namespace goingrate
