#include "goingrate/log/writing.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>

namespace goingrate {

std::string native_log_header(const NativeColumns& columns,
                              std::optional<double> nominal_period_s) {
  std::string text = "# goingrate log: 1\n";
  if (nominal_period_s)
    fmt::format_to(std::back_inserter(text), "# nominal_period_s: {}\n", *nominal_period_s);
  text += "time_s";
  if (columns.edge) text += ",edge";
  if (columns.amplitude) text += ",amplitude_rad";
  text += '\n';
  return text;
}

void append_native_line(std::string& text, const Beat& event, const NativeColumns& columns) {
  text += format_instant(event.time, columns.decimals);
  if (columns.edge) text += event.edge == Edge::up ? ",up" : ",down";
  if (columns.amplitude) text += ',';
  if (columns.amplitude && !std::isnan(event.amplitude_rad))
    fmt::format_to(std::back_inserter(text), "{:.9g}", event.amplitude_rad);
  text += '\n';
}

std::string native_log_text(const ClockLog& log, int decimals) {
  const bool both_edges = std::any_of(log.events.begin(), log.events.end(),
                                      [](const Beat& e) { return e.edge == Edge::down; });
  const NativeColumns columns{both_edges, log.has_amplitude, decimals};
  std::string text = native_log_header(columns, log.nominal_period_s);
  for (const Beat& event : log.events)
    append_native_line(text, event, columns);
  return text;
}

} // namespace goingrate
