// Applies what the user states about columns.
#include "column_names.hpp"
#include "layout_detection.hpp"

#include "base/spelling.hpp"
#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <optional>

namespace goingrate {

namespace {

constexpr std::size_t most_names = 20; // in a message

// The column of this number, from 1, or name; nothing if there is none.
std::optional<std::size_t> place_named(std::string_view place, const LogHead& head) {
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(place.data(), place.data() + place.size(), number);
  if (error == std::errc() && end == place.data() + place.size())
    return number >= 1 && number <= head.columns ? std::optional(number - 1) : std::nullopt;
  const auto name = std::find(head.names.begin(), head.names.end(), place);
  if (name == head.names.end()) return {};
  return static_cast<std::size_t>(name - head.names.begin());
}

[[noreturn]] void refuse_place(std::string_view place, const LogHead& head,
                               const std::string& word) {
  if (!place.empty() && place.find_first_not_of("0123456789") == std::string_view::npos)
    throw ArgumentError("column", word, fmt::format("a place from 1 to {}", head.columns));
  throw ArgumentError(
      "column", word,
      head.names.empty()
          ? "a number from 1 (the columns have no names)"
          : fmt::format("a number from 1, or one of {}",
                        fmt::join(head.names.begin(),
                                  head.names.begin() + static_cast<std::ptrdiff_t>(
                                                           std::min(head.names.size(), most_names)),
                                  ", ")));
}

[[noreturn]] void refuse_unit(ColumnRole role, std::string_view unit, const std::string& word) {
  const std::string_view units = units_of(role);
  throw ArgumentError(
      "column", word,
      units.empty()
          ? fmt::format("without a unit, which this role has not: not {}", shown(unit))
          : fmt::format("with a unit that suits the role, one of {}: not {}{}", units, shown(unit),
                        names_turning_speed(unit) ? ", a speed of turning" : ""));
}

// A speed of turning is no angle, unless its unit is said to be that of one.
void refuse_turning_speed(const LogColumn& column, std::size_t at, const std::string& word) {
  if (column.role != ColumnRole::angle || !names_turning_speed(column.name)) return;
  throw ArgumentError("column", word,
                      fmt::format("of an angle: column {}, {}, is a speed of turning; position={} "
                                  "times its zeros, without amplitudes",
                                  at + 1, shown(column.name), at + 1));
}

[[noreturn]] void refuse_role(const std::string& word, std::string_view role) {
  const std::vector<std::string> known = role_names();
  throw ArgumentError("column", word,
                      fmt::format("ROLE=PLACE[:UNIT], role one of {}{}", fmt::join(known, ", "),
                                  meant_instead(role, known)));
}

} // namespace

void apply_columns(const std::vector<std::string>& columns, const LogHead& head, Layout& layout) {
  for (const std::string& word : columns) {
    const std::size_t equals = word.find('=');
    const auto role = role_named(std::string_view(word).substr(0, equals));
    if (equals == std::string::npos || !role)
      refuse_role(word, std::string_view(word).substr(0, equals));
    std::string_view place = std::string_view(word).substr(equals + 1);
    const std::size_t colon = place.rfind(':');
    const std::string_view unit =
        colon == std::string_view::npos ? std::string_view{} : place.substr(colon + 1);
    LogColumn column;
    column.role = *role;
    const bool has_unit = !unit.empty() && set_unit(column, unit);
    if (has_unit) place = place.substr(0, colon);
    const auto named_place = place_named(place, head);
    if (!named_place && !unit.empty() && !has_unit && place_named(place.substr(0, colon), head))
      refuse_unit(*role, unit, word);
    if (!named_place) refuse_place(place, head, word);
    const std::size_t at = *named_place;
    if (!has_unit) { // the header's unit for the new role, if it states one
      const NamedColumn named = column_named(layout.columns[at].name);
      if (named.column.role == *role) column = named.column;
    }
    column.name = layout.columns[at].name;
    if (!has_unit) refuse_turning_speed(column, at, word);
    for (LogColumn& other : layout.columns)
      if (other.role == *role && *role != ColumnRole::ignored) other.role = ColumnRole::ignored;
    layout.columns[at] = column;
  }
}

} // namespace goingrate
