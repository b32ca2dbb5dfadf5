#include "column_names.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

namespace goingrate {

namespace {

std::string lower(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return result;
}

// Micro and degree come in UTF-8 (two code points of micro) and in Latin-1.
std::string plain_unit(std::string_view text) {
  std::string unit = lower(text);
  const auto replace = [&](std::string_view what, std::string_view with) {
    if (const auto at = unit.find(what); at != std::string::npos)
      unit.replace(at, what.size(), with);
  };
  replace("\xc2\xb5", "u");
  replace("\xce\xbc", "u");
  replace("\xb5", "u");
  replace("\xc2\xb0", "deg");
  replace("\xb0", "deg");
  std::erase(unit, ' ');
  return unit;
}

struct TimeName {
  std::string_view name;
  TimeUnit unit;
};
constexpr std::array<TimeName, 22> time_names{{{"s", in_seconds},
                                               {"ms", in_milliseconds},
                                               {"us", in_microseconds},
                                               {"ns", in_nanoseconds},
                                               {"min", in_minutes},
                                               {"h", in_hours},
                                               {"d", in_days},
                                               {"sec", in_seconds},
                                               {"secs", in_seconds},
                                               {"second", in_seconds},
                                               {"seconds", in_seconds},
                                               {"msec", in_milliseconds},
                                               {"millis", in_milliseconds},
                                               {"milliseconds", in_milliseconds},
                                               {"usec", in_microseconds},
                                               {"micros", in_microseconds},
                                               {"microseconds", in_microseconds},
                                               {"minutes", in_minutes},
                                               {"hours", in_hours},
                                               {"day", in_days},
                                               {"days", in_days},
                                               {"mjd", in_days}}};

struct ScaleName {
  std::string_view name;
  double scale;
  double offset = 0.0;
};
constexpr double degree = std::numbers::pi / 180.0;
constexpr std::array<ScaleName, 7> angle_names{{{"rad", 1.0},
                                                {"radians", 1.0},
                                                {"mrad", 1e-3},
                                                {"urad", 1e-6},
                                                {"deg", degree},
                                                {"degree", degree},
                                                {"degrees", degree}}};
constexpr double inch_of_mercury = 33.86389, millimetre_of_mercury = 1.333224; // mbar
constexpr std::array<ScaleName, 8> pressure_names{{{"mbar", 1.0},
                                                   {"hpa", 1.0},
                                                   {"pa", 1e-2},
                                                   {"kpa", 10.0},
                                                   {"bar", 1e3},
                                                   {"inhg", inch_of_mercury},
                                                   {"mmhg", millimetre_of_mercury},
                                                   {"torr", millimetre_of_mercury}}};
constexpr double fahrenheit = 5.0 / 9.0, zero_fahrenheit_c = -32.0 * fahrenheit,
                 zero_kelvin_c = -273.15;
constexpr std::array<ScaleName, 9> temperature_names{
    {{"c", 1.0},
     {"degc", 1.0},
     {"celsius", 1.0},
     {"degcelsius", 1.0},
     {"f", fahrenheit, zero_fahrenheit_c},
     {"degf", fahrenheit, zero_fahrenheit_c},
     {"fahrenheit", fahrenheit, zero_fahrenheit_c},
     {"k", 1.0, zero_kelvin_c},
     {"kelvin", 1.0, zero_kelvin_c}}};
constexpr std::array<ScaleName, 4> humidity_names{
    {{"%", 1.0}, {"percent", 1.0}, {"%rh", 1.0}, {"1", 100.0}}};

template <class Names>
bool set_scale(LogColumn& column, const Names& names, std::string_view unit) {
  const auto entry = std::find_if(names.begin(), names.end(),
                                  [&](const ScaleName& known) { return known.name == unit; });
  if (entry == names.end()) return false;
  column.scale = entry->scale;
  column.offset = entry->offset;
  return true;
}

bool is_time_role(ColumnRole role) {
  return role == ColumnRole::time || role == ColumnRole::period || role == ColumnRole::half_period;
}

bool is_time_scale_role(ColumnRole role) {
  return role == ColumnRole::clock_error || role == ColumnRole::phase || role == ColumnRole::width;
}

// "Time (s)", "Angle/rad", "t [ms]" come apart by their signs; "time_s" and "width us" by the last
// word, if it is a unit.
std::pair<std::string, std::string> name_and_unit(std::string_view text) {
  const std::size_t open = text.find_first_of("([");
  if (open != std::string_view::npos) {
    const std::size_t close = std::min(text.find_first_of(")]", open), text.size());
    return {lower(text.substr(0, open)), plain_unit(text.substr(open + 1, close - open - 1))};
  }
  if (const std::size_t slash = text.rfind('/'); slash != std::string_view::npos)
    return {lower(text.substr(0, slash)), plain_unit(text.substr(slash + 1))};
  if (const std::size_t gap = text.find_last_of("_ "); gap != std::string_view::npos)
    return {lower(text), plain_unit(text.substr(gap + 1))};
  return {lower(text), plain_unit(text)};
}

struct RoleWord {
  std::string_view word;
  ColumnRole role;
};
// The first that the name contains counts; the longer come before those they contain.
constexpr std::array<RoleWord, 50> role_words{{{"uncertainty", ColumnRole::ignored},
                                               {"standard", ColumnRole::ignored}, // deviation
                                               {"dew", ColumnRole::ignored},
                                               {"wind", ColumnRole::ignored},
                                               {"sigma", ColumnRole::ignored},
                                               {"residual", ColumnRole::ignored},
                                               {"angvel", ColumnRole::ignored},
                                               {"velocity", ColumnRole::ignored},
                                               {"half-period", ColumnRole::half_period},
                                               {"half_period", ColumnRole::half_period},
                                               {"half period", ColumnRole::half_period},
                                               {"halfperiod", ColumnRole::half_period},
                                               {"width", ColumnRole::width},
                                               {"in gate", ColumnRole::width}, // time in gate
                                               {"gate time", ColumnRole::width},
                                               {"dark", ColumnRole::width},
                                               {"dunkel", ColumnRole::width}, // German
                                               {"blocked", ColumnRole::width},
                                               {"interval", ColumnRole::period},
                                               {"period", ColumnRole::period},
                                               {"clock error", ColumnRole::clock_error},
                                               {"clock_error", ColumnRole::clock_error},
                                               {"minus", ColumnRole::clock_error}, // clock minus GPS
                                               {"drift", ColumnRole::clock_error},
                                               {"amplitude", ColumnRole::amplitude},
                                               {"humid", ColumnRole::humidity},
                                               {"feucht", ColumnRole::humidity}, // German
                                               {"temps", ColumnRole::time},      // French
                                               {"temp", ColumnRole::temperature},
                                               {"press", ColumnRole::pressure},
                                               {"baro", ColumnRole::pressure},
                                               {"angle", ColumnRole::angle},
                                               {"theta", ColumnRole::angle},
                                               {"edge", ColumnRole::edge},
                                               {"direction", ColumnRole::edge},
                                               {"time", ColumnRole::time},
                                               {"date", ColumnRole::time},
                                               {"elapsed", ColumnRole::time},
                                               {"zeit", ColumnRole::time}, // German
                                               {"datum", ColumnRole::time},
                                               {"winkel", ColumnRole::angle},
                                               {"druck", ColumnRole::pressure},
                                               {"heure", ColumnRole::time},
                                               {"richtung", ColumnRole::edge},
                                               {"when", ColumnRole::time},
                                               {"fast", ColumnRole::clock_error}, // seconds fast
                                               {"offset", ColumnRole::clock_error},
                                               {"deviation", ColumnRole::clock_error},
                                               {"abweichung", ColumnRole::clock_error}, // German
                                               {"error", ColumnRole::clock_error}}};
constexpr std::array<RoleWord, 16> short_names{{{"t", ColumnRole::time},
                                               {"rh", ColumnRole::humidity},
                                               {"mjd", ColumnRole::time},
                                               {"utc", ColumnRole::time},
                                               {"unix", ColumnRole::time},
                                               {"epoch", ColumnRole::time},
                                               {"phi", ColumnRole::angle},
                                               {"\xce\xb8", ColumnRole::angle}, // theta
                                               {"\xcf\x86", ColumnRole::angle}, // phi
                                               {"tick_block", ColumnRole::tick_dark},
                                               {"tick", ColumnRole::tick_light},
                                               {"tock_block", ColumnRole::tock_dark},
                                               {"tock", ColumnRole::tock_light},
                                               {"tick_total_f_hat_hz", ColumnRole::counter_rate},
                                               {"x", ColumnRole::position},
                                               {"y", ColumnRole::height}}};

ColumnRole role_of(std::string_view name) {
  while (!name.empty() && name.back() == ' ')
    name.remove_suffix(1);
  for (const RoleWord& entry : short_names)
    if (name == entry.word) return entry.role;
  for (const RoleWord& entry : role_words)
    if (name.find(entry.word) != std::string_view::npos) return entry.role;
  return ColumnRole::ignored;
}

} // namespace

std::optional<TimeUnit> unit_named(std::string_view name) {
  const std::string plain = plain_unit(name);
  for (const TimeName& known : time_names)
    if (known.name == plain) return known.unit;
  return {};
}

std::string_view name_of(TimeUnit unit) {
  for (const TimeName& known : time_names)
    if (known.unit == unit) return known.name;
  return "?";
}

bool names_gate_state(std::string_view name) {
  std::string word = lower(name);
  std::erase_if(word, [](char c) { return c == ' ' || c == '_' || c == '-' || c == '"'; });
  return word == "state" || word == "gate" || word.find("gatestate") != word.npos ||
         word.find("photogate") != word.npos || word.find("lightgate") != word.npos;
}

bool names_turning_speed(std::string_view name) {
  const std::string plain = plain_unit(name);
  constexpr std::array<std::string_view, 8> words{"gyro",  "angvel", "angularvel",   "angularspeed",
                                                  "rad/s", "deg/s",  "winkelgeschw", "rads-1"};
  return std::any_of(words.begin(), words.end(),
                     [&](std::string_view word) { return plain.find(word) != plain.npos; });
}

std::optional<Edge> edge_named(std::string_view text) {
  const std::string word = lower(text.substr(0, text.find('-')));
  constexpr std::array<std::string_view, 6> up{"up", "rising", "right", "r", "tick", "1"};
  constexpr std::array<std::string_view, 6> down{"down", "falling", "left", "l", "tock", "0"};
  if (std::find(up.begin(), up.end(), word) != up.end()) return Edge::up;
  if (std::find(down.begin(), down.end(), word) != down.end()) return Edge::down;
  return {};
}

bool set_unit(LogColumn& column, std::string_view text) {
  const std::string unit = plain_unit(text);
  if (is_time_role(column.role) || is_time_scale_role(column.role)) {
    const auto time = unit_named(unit);
    if (!time) return false;
    column.unit = *time;
    column.scale = time->seconds * std::pow(10.0, time->power);
    return true;
  }
  if (column.role == ColumnRole::amplitude || column.role == ColumnRole::angle)
    return set_scale(column, angle_names, unit);
  if (column.role == ColumnRole::temperature) return set_scale(column, temperature_names, unit);
  if (column.role == ColumnRole::pressure) return set_scale(column, pressure_names, unit);
  if (column.role == ColumnRole::humidity) return set_scale(column, humidity_names, unit);
  return false;
}

std::string_view units_of(ColumnRole role) {
  if (is_time_role(role) || is_time_scale_role(role)) return "s, ms, us, ns, min, h, d, mjd";
  switch (role) {
  case ColumnRole::amplitude:
  case ColumnRole::angle:
    return "rad, mrad, urad, deg";
  case ColumnRole::temperature:
    return "degC, degF, K";
  case ColumnRole::pressure:
    return "mbar, hPa, Pa, kPa, bar, inHg, mmHg, torr";
  case ColumnRole::humidity:
    return "%, 1";
  default:
    return {};
  }
}

NamedColumn column_named(std::string_view text) {
  const auto [name, unit] = name_and_unit(text);
  NamedColumn result;
  result.column.name = std::string(text);
  result.column.role = role_of(name);
  auto before_unit = std::string_view(name).substr(0, name.find_last_of("_ "));
  if (before_unit.ends_with(" in")) before_unit.remove_suffix(3);   // "T in s"
  if (unit_named(unit) && role_of(before_unit) == ColumnRole::time) // "unix_s", "t ms"
    result.column.role = ColumnRole::time;
  result.has_unit = set_unit(result.column, unit);
  return result;
}

std::optional<DatedPhases> dated_phases_named(std::string_view date, std::string_view phase) {
  constexpr std::string_view word = "phase";
  const auto [name, unit] = name_and_unit(phase);
  const bool is_mjd = lower(date).starts_with("mjd");
  const NamedColumn time = column_named(date);
  if ((!is_mjd && time.column.role != ColumnRole::time) || !name.starts_with(word)) return {};
  DatedPhases result{time.column, {}};
  result.date.role = ColumnRole::time;
  if (is_mjd) (void)set_unit(result.date, "mjd");
  result.phase.name = std::string(phase);
  result.phase.role = ColumnRole::phase;
  const bool has_unit = set_unit(result.phase, unit);
  // Beside another time than MJD a phase without a unit may be an angle.
  return has_unit || (is_mjd && lower(phase) == word) ? std::optional(result) : std::nullopt;
}

} // namespace goingrate
