#include "goingrate/report/figure.hpp"

#include <cmath>
#include <fmt/format.h>

namespace goingrate {

std::string figure_csv(const Figure& figure) {
  const auto field = [](const std::vector<double>& values, std::size_t i) {
    return i < values.size() && std::isfinite(values[i]) ? fmt::format("{:.9g}", values[i])
                                                         : std::string();
  };
  std::string text = "series,x,y,low,high\n";
  for (const Series& series : figure.series)
    for (std::size_t i = 0; i < series.x.size(); ++i)
      text += fmt::format("\"{}\",{},{},{},{}\n", series.label, field(series.x, i),
                          field(series.y, i), field(series.low, i), field(series.high, i));
  return text;
}

} // namespace goingrate
