#include "goingrate/log/writing.hpp"

#include "base/decimal.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>

namespace goingrate {

NativeColumns native_columns(const SensorSettings& sensor, const ClockParameters& clock) {
  NativeColumns columns;
  columns.edge = sensor.edges != SensorEdges::up;
  columns.width = sensor.edges == SensorEdges::gate;
  columns.amplitude = sensor.amplitude_rms.has_value();
  columns.temperature = sensor.temperature_rms.has_value();
  columns.decimals = decimals_for(sensor);
  columns.nominal_period_s = clock.nominal_period_s;
  if (clock.gravity_share != 1.0) columns.gravity_share = clock.gravity_share;
  if (sensor.flag_width_rad > 0.0) columns.flag_width_rad = sensor.flag_width_rad;
  return columns;
}

std::string native_log_header(const NativeColumns& columns) {
  std::string text = "# goingrate log: 1\n";
  const auto out = std::back_inserter(text);
  if (columns.nominal_period_s)
    fmt::format_to(out, "# nominal_period_s: {}\n", *columns.nominal_period_s);
  if (columns.flag_width_rad)
    fmt::format_to(out, "# flag_width_rad: {}\n", *columns.flag_width_rad);
  if (columns.gravity_share)
    fmt::format_to(out, "# gravity_share: {}\n", *columns.gravity_share);
  text += "time_s";
  if (columns.edge) text += ",edge";
  if (columns.width) text += ",width_s";
  if (columns.amplitude) text += ",amplitude_rad";
  if (columns.temperature) text += ",temperature_c";
  if (columns.pressure) text += ",pressure_mbar";
  if (columns.humidity) text += ",humidity_percent";
  text += '\n';
  return text;
}

namespace {

// An unknown value is an empty field.
void append_value(DecimalText& line, double value, int digits) {
  line.put(',');
  if (!std::isnan(value)) append_general(line, value, digits);
}

std::string_view edge_word(const SensedEvent& event) {
  using Part = SensedEvent::Part;
  const bool up = event.beat.edge == Edge::up;
  switch (event.part) {
  case Part::in:
    return up ? ",up-in" : ",down-in";
  case Part::out:
    return up ? ",up-out" : ",down-out";
  case Part::whole:
    break;
  }
  return up ? ",up" : ",down";
}

void append_line(std::string& text, const SensedEvent& event, const EventValues& air,
                 const NativeColumns& columns) {
  DecimalText line;
  append_instant(line, event.beat.time, columns.decimals);
  if (columns.edge) line.put(edge_word(event));
  if (columns.width) {
    line.put(',');
    if (!std::isnan(event.width_s))
      append_instant(line, Instant::from_seconds(event.width_s), columns.decimals);
  }
  if (columns.amplitude) append_value(line, event.beat.amplitude_rad, 9);
  if (columns.temperature) append_value(line, event.temperature_c, 6);
  if (columns.pressure) append_value(line, air.pressure_mbar, 7);
  if (columns.humidity) append_value(line, air.humidity_percent, 6);
  line.put('\n');
  text += line.view();
}

} // namespace

void append_native_line(std::string& text, const SensedEvent& event, const NativeColumns& columns) {
  append_line(text, event, {}, columns);
}

void append_native_line(std::string& text, const Beat& event, const EventValues& values,
                        const NativeColumns& columns) {
  SensedEvent sensed;
  sensed.beat = event;
  sensed.width_s = values.width_s;
  sensed.temperature_c = values.temperature_c;
  if (columns.width && !std::isnan(values.width_s))
    sensed.beat.time = event.time + -0.5 * values.width_s; // the leading edge
  append_line(text, sensed, values, columns);
}

std::string native_log_text(const ClockLog& log, int decimals) {
  NativeColumns columns;
  columns.edge = std::any_of(log.events.begin(), log.events.end(),
                             [](const Beat& e) { return e.edge == Edge::down; });
  columns.width = !log.columns.width_s.empty();
  columns.amplitude = log.has_amplitude;
  columns.temperature = !log.columns.temperature_c.empty();
  columns.pressure = !log.columns.pressure_mbar.empty();
  columns.humidity = !log.columns.humidity_percent.empty();
  columns.decimals = decimals;
  columns.nominal_period_s = log.nominal_period_s;
  columns.flag_width_rad = log.flag_width_rad;
  columns.gravity_share = log.gravity_share;
  std::string text = native_log_header(columns);
  for (std::size_t i = 0; i < log.events.size(); ++i) {
    EventValues values;
    if (columns.width) values.width_s = log.columns.width_s[i];
    if (columns.temperature) values.temperature_c = log.columns.temperature_c[i];
    if (columns.pressure) values.pressure_mbar = log.columns.pressure_mbar[i];
    if (columns.humidity) values.humidity_percent = log.columns.humidity_percent[i];
    append_native_line(text, log.events[i], values, columns);
  }
  return text;
}

std::string stable32_text(std::span<const Beat> beats, double nominal_period_s) {
  std::string text =
      fmt::format("# phase data, s; tau0 {} s; an exact 0 is a gap\n", nominal_period_s);
  const auto errors = on_every_cycle(beats, clock_error(beats, nominal_period_s));
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const bool gap = std::isnan(errors[i]);
    // A beat that is on time to the last bit must not look like a gap.
    const double value = gap ? 0.0 : errors[i] == 0.0 && i > 0 ? 1e-300 : errors[i];
    fmt::format_to(std::back_inserter(text), "{:.17e}\n", value);
  }
  return text;
}

std::string ticc_text(std::span<const Beat> beats) {
  std::string text = "# TAPR TICC\n# timestamp (seconds with 11 decimal places)\n";
  const std::int64_t start = beats.empty() ? 0 : beats.front().time.seconds;
  for (const Beat& beat : beats) {
    const Instant time{beat.time.seconds - start, beat.time.fraction};
    text += format_instant(time, 11);
    text += beat.edge == Edge::up ? " chA\n" : " chB\n";
  }
  return text;
}

std::string par_text(const RateSummary& summary, const Beats& beats) {
  std::string text = "# name value fit sigma\n";
  const auto out = std::back_inserter(text);
  const auto& first = beats.beats.front();
  fmt::format_to(out, "START {} 0\n", format_instant(first.time, 9));
  fmt::format_to(out, "FINISH {} 0\n", format_instant(first.time + summary.duration_s, 9));
  fmt::format_to(out, "T0 {:.17g} 0\n", summary.nominal_period_s);
  fmt::format_to(out, "PERIOD {:.17g} 1 {:.3g}\n", summary.mean_period_s,
                 summary.mean_period_sigma_s);
  fmt::format_to(out, "RATE {:.12g} 1 {:.3g}\n", summary.rate_excess, summary.rate_excess_sigma);
  fmt::format_to(out, "NBEATS {} 0\nNMISSED {} 0\nNSPURIOUS {} 0\nNSEGMENTS {} 0\n",
                 summary.crossings, beats.missed, beats.spurious, beats.segments);
  return text;
}

} // namespace goingrate
