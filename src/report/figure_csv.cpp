#include "goingrate/report/figure.hpp"

#include <cmath>
#include <fmt/format.h>

namespace goingrate {

namespace {

// "rate (s/day)", quoted: labels may have commas.
std::string head_of(const std::string& label, const std::string& unit) {
  return fmt::format("\"{}{}\"", label, unit.empty() ? "" : " (" + unit + ")");
}

} // namespace

std::string figure_csv(const Figure& figure) {
  const auto field = [](const std::vector<double>& values, std::size_t i) {
    return i < values.size() && std::isfinite(values[i])
               ? fmt::format("{:.9g}", values[i] + 0.0) // no -0
               : std::string();
  };
  const Axis &x = figure.x, &y = figure.y;
  std::string text =
      fmt::format("series,{},{},{},{}\n", head_of(x.label, x.unit), head_of(y.label, y.unit),
                  head_of("low", y.unit), head_of("high", y.unit));
  for (const Series& series : figure.series)
    for (std::size_t i = 0; i < series.x.size(); ++i)
      text += fmt::format("\"{}\",{},{},{},{}\n", series.label, field(series.x, i),
                          field(series.y, i), field(series.low, i), field(series.high, i));
  return text;
}

} // namespace goingrate
