// The quantities of the weather that are read. Private to the log room.
#pragma once

#include "goingrate/log/clock_log.hpp"
#include "goingrate/log/layout.hpp"

#include <array>
#include <string_view>

namespace goingrate {

struct WeatherQuantity {
  ColumnRole role;
  std::vector<double> EventColumns::*values;
  std::string_view article_and_name, unit;
};
inline constexpr std::array<WeatherQuantity, 3> weather_quantities{
    {{ColumnRole::temperature, &EventColumns::temperature_c, "a temperature", "°C"},
     {ColumnRole::pressure, &EventColumns::pressure_mbar, "a pressure", "mbar"},
     {ColumnRole::humidity, &EventColumns::humidity_percent, "a humidity", "%"}}};

} // namespace goingrate
