#include "day_columns.hpp"

#include <array>
#include <cstdlib>
#include <fmt/format.h>
#include <fstream>
#include <limits>
#include <string_view>

namespace goingrate::apps {

namespace {

struct NamedColumn {
  std::string_view name;
  bool NativeColumns::*column;
};
constexpr std::array named_columns{NamedColumn{"edge", &NativeColumns::edge},
                                   NamedColumn{"width_s", &NativeColumns::width},
                                   NamedColumn{"amplitude_rad", &NativeColumns::amplitude},
                                   NamedColumn{"temperature_c", &NativeColumns::temperature},
                                   NamedColumn{"pressure_mbar", &NativeColumns::pressure},
                                   NamedColumn{"humidity_percent", &NativeColumns::humidity}};

constexpr std::string_view period_words = "# nominal_period_s: ";

} // namespace

std::optional<NativeColumns> header_of(const std::string& path) {
  std::ifstream file(path);
  NativeColumns columns;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with(period_words))
      columns.nominal_period_s = std::strtod(line.c_str() + period_words.size(), nullptr);
    if (!line.starts_with("time_s")) continue;
    columns.decimals = archive_decimals;
    for (const auto& [name, column] : named_columns)
      columns.*column = (line + ",").find(fmt::format(",{},", name)) != line.npos;
    return columns;
  }
  return {};
}

EventValues beside(const EventValues& values, const NativeColumns& columns) {
  constexpr double in_its_column = std::numeric_limits<double>::quiet_NaN();
  return {columns.width ? in_its_column : values.width_s,
          columns.temperature ? in_its_column : values.temperature_c,
          columns.pressure ? in_its_column : values.pressure_mbar,
          columns.humidity ? in_its_column : values.humidity_percent};
}

} // namespace goingrate::apps
