#include "goingrate/log/writing.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>

namespace goingrate {

std::string native_log_text(const ClockLog& log, int decimals) {
  const bool both_edges = std::any_of(log.events.begin(), log.events.end(),
                                      [](const LogEvent& e) { return e.edge == Edge::down; });
  std::string text = "# goingrate log: 1\n";
  auto out = std::back_inserter(text);
  if (log.nominal_period_s) fmt::format_to(out, "# nominal_period_s: {}\n", *log.nominal_period_s);
  text += "time_s";
  if (both_edges) text += ",edge";
  if (log.has_amplitude) text += ",amplitude_rad";
  text += '\n';
  for (const LogEvent& event : log.events) {
    text += format_instant(event.time, decimals);
    if (both_edges) text += event.edge == Edge::up ? ",up" : ",down";
    if (log.has_amplitude) text += ',';
    if (log.has_amplitude && !std::isnan(event.amplitude_rad))
      fmt::format_to(out, "{:.9g}", event.amplitude_rad);
    text += '\n';
  }
  return text;
}

} // namespace goingrate
