// Applies what the user states about columns.
#include "column_names.hpp"
#include "layout_detection.hpp"

#include "base/spelling.hpp"
#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>

namespace goingrate {

namespace {

constexpr std::size_t most_names = 20; // in a message

std::size_t place_of(std::string_view place, const LogHead& head, const std::string& word) {
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(place.data(), place.data() + place.size(), number);
  if (error == std::errc() && end == place.data() + place.size()) {
    if (number >= 1 && number <= head.columns) return number - 1;
    throw ArgumentError("column", word, fmt::format("a place from 1 to {}", head.columns));
  }
  for (std::size_t i = 0; i < head.names.size(); ++i)
    if (head.names[i] == place) return i;
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
    const std::size_t at = place_of(place, head, word);
    if (!has_unit) { // the header's unit for the new role, if it states one
      const NamedColumn named = column_named(layout.columns[at].name);
      if (named.column.role == *role) column = named.column;
    }
    column.name = layout.columns[at].name;
    for (LogColumn& other : layout.columns)
      if (other.role == *role && *role != ColumnRole::ignored) other.role = ColumnRole::ignored;
    layout.columns[at] = column;
  }
}

} // namespace goingrate
