// Rows of a light gate that counts the four intervals of each oscillation.
#include "gate_intervals.hpp"
#include "row_reader.hpp"

#include <cmath>
#include <fmt/format.h>

namespace goingrate {

// The counter's rate from the row's own column, where a reference measured it. If the value is
// broken, that of the row before is used.
double RowReader::counter_rate_at(const Line& line) {
  const auto column = layout_.find(ColumnRole::counter_rate);
  if (!column) return layout_.counter_hz;
  const double rate = number_at(line, column, "the counter's rate");
  if (rate > 0.0 && std::isfinite(rate)) layout_.counter_hz = rate;
  return layout_.counter_hz;
}

// The oscillation in seconds; nothing if a count is missing or cannot be.
std::optional<RowReader::Oscillation> RowReader::oscillation_at(const Line& line) {
  const double rate = counter_rate_at(line);
  Oscillation seconds;
  double whole = 0.0;
  for (std::size_t i = 0; i < seconds.size(); ++i) {
    const Field& field = fields_[*layout_.find(gate_intervals[i])];
    const auto count = parse_number(field.text, layout_.point);
    seconds[i] = count ? *count / rate : 0.0;
    whole += seconds[i];
    if (!(seconds[i] > 0.0 && whole < longest_period_s)) {
      reject_field(line, field, "a count of cycles");
      return {};
    }
  }
  return seconds;
}

// For a row of the wrong length: whether it begins like a row rather than like a program's message.
bool RowReader::is_begun_row() const {
  const std::string_view first = fields_.front().text;
  return parse_number(first, layout_.point) || parse_calendar(first, layout_.point);
}

// A row that cannot be read is taken to last as long as the one before, so that later rows keep
// their times.
void RowReader::pass_oscillation() {
  const auto& [tick_light, tick_dark, tock_light, tock_dark] = *oscillation_;
  wait(Instant::from_seconds(tick_dark + tick_light + tock_dark + tock_light));
}

// Two passages: each the middle of a dark interval, and its length.
void RowReader::add_oscillation(const Line& line) {
  const auto read = oscillation_at(line);
  if (!read && !oscillation_) return;
  const auto& [tick_light, tick_dark, tock_light, tock_dark] = read ? *read : *oscillation_;
  const double half = tick_dark + tick_light, whole = half + tock_dark + tock_light;
  wait(pause_before(Instant::from_seconds(whole)));
  if (read) {
    append(line, event_at(accumulated() + 0.5 * tick_dark, Edge::up, line.number), tick_dark);
    append(line, event_at(accumulated() + (half + 0.5 * tock_dark), Edge::down, line.number),
           tock_dark);
    oscillation_ = read;
  }
  pass_oscillation();
}

} // namespace goingrate
