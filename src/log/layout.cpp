#include "goingrate/log/layout.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace goingrate {

namespace {

constexpr std::array<std::pair<LogFormat, std::string_view>, 13> formats{{
    {LogFormat::native, "native"},
    {LogFormat::timestamps, "timestamps"},
    {LogFormat::clock_error, "clock-error"},
    {LogFormat::periods, "periods"},
    {LogFormat::phase, "phase"},
    {LogFormat::frequency, "frequency"},
    {LogFormat::ticc, "ticc"},
    {LogFormat::ticc_interval, "ticc-interval"},
    {LogFormat::table, "table"},
    {LogFormat::angle, "angle"},
    {LogFormat::ticktock, "ticktock"},
    {LogFormat::xy, "xy"},
    {LogFormat::sound, "wav"},
}};

constexpr std::array<std::pair<ColumnRole, std::string_view>, 23> roles{{
    {ColumnRole::ignored, "ignored"},
    {ColumnRole::time, "time"},
    {ColumnRole::date, "date"},
    {ColumnRole::period, "period"},
    {ColumnRole::half_period, "half-period"},
    {ColumnRole::clock_error, "error"},
    {ColumnRole::phase, "phase"},
    {ColumnRole::frequency, "frequency"},
    {ColumnRole::amplitude, "amplitude"},
    {ColumnRole::angle, "angle"},
    {ColumnRole::position, "position"},
    {ColumnRole::height, "height"},
    {ColumnRole::width, "width"},
    {ColumnRole::tick_dark, "tick-dark"},
    {ColumnRole::tick_light, "tick-light"},
    {ColumnRole::tock_dark, "tock-dark"},
    {ColumnRole::tock_light, "tock-light"},
    {ColumnRole::counter_rate, "counter-rate"},
    {ColumnRole::edge, "edge"},
    {ColumnRole::temperature, "temperature"},
    {ColumnRole::pressure, "pressure"},
    {ColumnRole::humidity, "humidity"},
    {ColumnRole::channel, "channel"},
}};

template <class Table, class Value> std::string_view name_in(const Table& table, Value value) {
  const auto* entry = std::find_if(table.begin(), table.end(),
                                   [&](const auto& pair) { return pair.first == value; });
  return entry->second;
}

template <class Table>
auto value_in(const Table& table, std::string_view name)
    -> std::optional<typename Table::value_type::first_type> {
  for (const auto& [value, known] : table)
    if (known == name) return value;
  return {};
}

} // namespace

std::optional<std::size_t> Layout::find(ColumnRole role) const {
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (columns[i].role == role) return i;
  return {};
}

std::string_view name_of(LogFormat format) { return name_in(formats, format); }
std::string_view name_of(ColumnRole role) { return name_in(roles, role); }
std::optional<LogFormat> format_named(std::string_view name) { return value_in(formats, name); }
std::optional<ColumnRole> role_named(std::string_view name) { return value_in(roles, name); }

std::string_view in_words(LogFormat format) {
  switch (format) {
  case LogFormat::native:
    return "a list of crossings";
  case LogFormat::clock_error:
    return "a clock-error log (label s, error s, amplitude mrad)";
  case LogFormat::periods:
    return "one period per line";
  case LogFormat::phase:
    return "phase data: the clock's error in seconds (positive: fast), one value per line";
  case LogFormat::frequency:
    return "frequency data: the relative rate, one value per line";
  case LogFormat::ticc:
    return "TICC timestamps";
  case LogFormat::ticc_interval:
    return "TICC intervals, taken as the clock's error (positive: fast)";
  case LogFormat::table:
    return "columns with names";
  case LogFormat::angle:
    return "samples of the angle";
  case LogFormat::ticktock:
    return "intervals between a light gate's edges, an oscillation a line";
  case LogFormat::xy:
    return "samples of the bob's place";
  case LogFormat::sound:
    return "a recording of sound";
  case LogFormat::timestamps:
    break;
  }
  return "one time per line";
}

std::vector<std::string> format_names() {
  std::vector<std::string> names;
  for (const auto& [format, name] : formats)
    names.emplace_back(name);
  return names;
}

std::vector<std::string> role_names() {
  std::vector<std::string> names;
  for (const auto& [role, name] : roles)
    names.emplace_back(name);
  return names;
}

} // namespace goingrate
