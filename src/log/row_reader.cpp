#include "row_reader.hpp"

#include "column_names.hpp"

#include "base/decimal.hpp"
#include "base/large_pages.hpp"
#include "base/special_values.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace goingrate {

RowReader::RowReader(const Layout& layout, const ReadingOptions& options, ClockLog& log)
    : layout_(layout), log_(log), issues_(log, options.strict),
      unwrap_(unwrapping(layout, options.nominal_period_s)), time_(layout.find(ColumnRole::time)),
      date_(layout.find(ColumnRole::date)), period_(layout.find(ColumnRole::period)),
      half_period_(layout.find(ColumnRole::half_period)),
      error_(layout.find(ColumnRole::clock_error)), phase_(layout.find(ColumnRole::phase)),
      frequency_(layout.find(ColumnRole::frequency)),
      amplitude_(layout.find(ColumnRole::amplitude)), angle_(layout.find(ColumnRole::angle)),
      width_(layout.find(ColumnRole::width)), edge_(layout.find(ColumnRole::edge)),
      channel_(layout.find(ColumnRole::channel)), ranges_(layout.columns.size()),
      zone_s_(options.zone_s), phases_alone_(options.phases_alone) {
  if (!angle_) {
    angle_ = layout.find(ColumnRole::position);
    if (angle_) height_ = layout.find(ColumnRole::height);
  }
  for (std::size_t i = 0; i < weather_.size(); ++i)
    weather_[i] = layout.find(weather_quantities[i].role);
  gate_state_ = edge_ && names_gate_state(layout.columns[*edge_].name);
  days_alone_ = time_ && layout.calendar && layout.columns[*time_].unit == in_days;
  plain_ = layout.columns.size() == 1 && time_ && !layout.calendar &&
           layout.columns[*time_].unit == in_seconds;
  if (!phase_ && !frequency_) return;
  log.grid.emplace();
  log.grid->tau0_s = layout.tau0_s;
  if (frequency_) add_phase(layout.first_line, 0.0); // where the first interval begins
}

inline void RowReader::push(const Beat& beat) {
  in_order_ = in_order_ && (log_.events.empty() || !is_before(beat.time, log_.events.back().time));
  log_.events.push_back(beat);
  if (error_) clock_errors_.push_back(clock_error_s_);
}

void RowReader::reserve(std::size_t lines) {
  if (layout_.format == LogFormat::angle)
    reserve_large(samples_, lines);
  else if (!(log_.grid && phases_alone_))
    reserve_large(log_.events, layout_.format == LogFormat::ticktock ? 2 * lines : lines);
  if (log_.grid) reserve_large(log_.grid->phase_s, lines);
}

void RowReader::reject(const Line& line, std::size_t column, IssueKind kind, std::string found) {
  ++rejected_;
  issues_.add(line.number, column, kind, std::move(found), "line left out");
}

void RowReader::reject_field(const Line& line, const Field& field, std::string_view expected) {
  if (!line.ended) {
    reject(line, field.column, IssueKind::truncated,
           fmt::format("a last line that breaks off: {}", shown(line.text)));
  } else if (field.text.empty()) {
    reject(line, field.column, IssueKind::missing,
           fmt::format("found nothing, expected {}", expected));
  } else {
    reject(line, field.column,
           says_nothing(field.text) ? IssueKind::no_value : IssueKind::unreadable,
           fmt::format("found {}, expected {}", shown(field.text), expected));
  }
}

bool RowReader::only_a_comment(const Line& line) const {
  const std::size_t start = line.text.find_first_not_of(" \t\f");
  return start == std::string_view::npos || line.text[start] == '#' || line.text[start] == '%';
}

void RowReader::add(const Line& line) {
  if (line.number < layout_.first_line) return;
  if (only_a_comment(line)) return;
  ++data_lines_;
  split_fields(line.text, layout_.separator, fields_);
  if (!row_fits(line)) {
    if (log_.grid) log_.grid->phase_s.push_back(not_known); // keeps its place on the grid
    if (oscillation_ && is_begun_row()) pass_oscillation();
    return;
  }
  if (channel_ && !layout_.channel.empty() && fields_[*channel_].text != layout_.channel) {
    ++other_channels_;
    --data_lines_;
    return;
  }
  if (layout_.format == LogFormat::ticktock) return add_oscillation(line);
  if (phase_) return add_on_grid(line, *phase_);
  if (frequency_) return add_on_grid(line, *frequency_);
  const auto time = time_of(line);
  if (!time) return;
  if (angle_) {
    add_sample(line, *time);
    return;
  }
  Beat beat = event_at(*time, half_period_ && row_++ % 2 == 1 ? Edge::down : Edge::up, line.number);
  if (edge_ && !read_edge(line, beat)) return;
  beat.amplitude_rad = amplitude_at(line);
  accept(line, beat);
}

void RowReader::add_sample(const Line& line, const Instant& time) {
  const double angle = number_at(line, angle_, height_ ? "a position" : "an angle");
  const double height = height_ ? number_at(line, height_, "a height") : 0.0;
  if (std::isnan(angle) || std::isnan(height)) {
    ++rejected_;
    const Field& field = fields_[std::isnan(angle) ? *angle_ : *height_];
    if (says_nothing(field.text))
      issues_.add(line.number, field.column, IssueKind::no_value,
                  height_ ? "no position of the bob" : "no angle", "sample left out");
    return;
  }
  samples_.push_back({time, angle * layout_.columns[*angle_].scale, line.number});
  if (height_) heights_.push_back(height);
}

RowReader::Taken RowReader::add_plain(std::string_view text, std::uint32_t number) {
  if (number < layout_.first_line) return {};
  if (plain_) return add_plain_times(text, number);
  return phase_ && layout_.columns.size() == 1 ? add_plain_phases(text, number) : Taken{};
}

RowReader::Taken RowReader::add_plain_times(std::string_view text, std::uint32_t number) {
  const char* const end = text.data() + text.size();
  Taken taken;
  for (const char* c = text.data(); c != end && *c >= '0' && *c <= '9'; ++taken.lines) {
    Instant raw;
    const char* const line = c;
    if (!take_plain_seconds(c, end, layout_.point, raw)) break;
    const auto length = static_cast<std::size_t>(c - line);
    if (*line == '9' && all_nines({line, length})) break; // perhaps a mark: add() decides that
    if (c != end && *c == '\r') ++c;
    if (c == end || *c != '\n') break;
    time_length_ = length;
    push(event_at(unwrap_(raw, [this] { return typical_step_s(); }), Edge::up, number++));
    taken.bytes = static_cast<std::size_t>(++c - text.data());
  }
  data_lines_ += taken.lines;
  return taken;
}

RowReader::Taken RowReader::add_plain_phases(std::string_view text, std::uint32_t number) {
  const char* const end = text.data() + text.size();
  const double scale = layout_.columns[*phase_].scale;
  Taken taken;
  for (const char* c = text.data(); c != end; ++taken.lines) {
    double value = 0.0;
    const char* const line = c;
    c = number_in(c, end, layout_.point, value);
    if (c == line) break;
    // All nines, or a zero, may stand for a missing value; add() decides that.
    const char first = line[*line == '-' ? 1 : 0];
    if (first == '9' && all_nines({line, static_cast<std::size_t>(c - line)})) break;
    if (c != end && *c == '\r') ++c;
    if (c == end || *c != '\n' || value == 0.0 || !is_possible_error(value * scale)) break;
    ranges_[*phase_].widen_to(value);
    add_phase(number++, value * scale);
    taken.bytes = static_cast<std::size_t>(++c - text.data());
  }
  data_lines_ += taken.lines;
  return taken;
}

// Whether the line has the right number of fields and no binary bytes; rejects it if not.
bool RowReader::row_fits(const Line& line) {
  const std::size_t columns = layout_.columns.size();
  if (fields_.size() == columns && !has_binary(line.text)) return true;
  if (has_binary(line.text)) {
    reject(line, 1, IssueKind::binary,
           fmt::format("bytes that are not text: {}", shown(line.text)));
  } else if (!line.ended && fields_.size() < columns) {
    reject(line, line.text.size() + 1, IssueKind::truncated,
           fmt::format("a last line that breaks off: {}", shown(line.text)));
  } else if (fields_.size() < columns) {
    reject(line, line.text.size() + 1, IssueKind::missing,
           fmt::format("found {} of {} columns", fields_.size(), columns));
  } else {
    const Field& extra = fields_[columns];
    reject(line, extra.column, IssueKind::missing,
           columns == 1
               ? fmt::format("found {}, expected nothing after the time", shown(extra.text))
               : fmt::format("found {} columns, expected {}", fields_.size(), columns));
  }
  return false;
}

// Whether a value stands for none: it is all nines and lies outside of what the column held so far,
// by more than its values may still spread.
bool RowReader::is_mark(std::size_t column, std::string_view text, double value) {
  constexpr double margin = 0.25, // of the range
      slight = 0.01;              // of the value: of a column that hardly changes
  Range& range = ranges_[column];
  if (all_nines(text)) {
    const double spread = std::max(margin * (range.most - range.least), slight * std::abs(value));
    const bool is_within = value >= range.least - spread && value <= range.most + spread;
    if (range.values == 0 || !is_within) return true;
  }
  range.widen_to(value);
  return false;
}

double RowReader::number_at(const Line& line, const Place& place, std::string_view expected) {
  if (!place) return not_known;
  const Field& field = fields_[*place];
  const auto value = parse_number(field.text, layout_.point);
  // As a pressure or a humidity nines can be real in any log: 999.9 mbar, 99.99 %.
  constexpr double most_mbar = 1100.0, most_percent = 100.0;
  const bool can_be_real = value && ((place == weather_[1] && *value < most_mbar) ||
                                     (place == weather_[2] && *value <= most_percent));
  if (value && (can_be_real || !is_mark(*place, field.text, *value))) return *value;
  if (!says_nothing(field.text)) // an empty field or NaN says so itself: no issue
    issues_.add(line.number, field.column, value ? IssueKind::no_value : IssueKind::unreadable,
                fmt::format("found {}, expected {}", shown(field.text), expected),
                "taken as unknown");
  return not_known;
}

double RowReader::amplitude_at(const Line& line) {
  if (!amplitude_) return not_known;
  const double amplitude =
      number_at(line, amplitude_, "an amplitude") * layout_.columns[*amplitude_].scale;
  if (std::isnan(amplitude) || (amplitude > 0.0 && amplitude < std::numbers::pi)) return amplitude;
  issues_.add(line.number, fields_[*amplitude_].column, IssueKind::out_of_range,
              fmt::format("an amplitude of {} rad", amplitude), "amplitude taken as unknown");
  return not_known;
}

bool RowReader::read_edge(const Line& line, Beat& beat) {
  const Field& field = fields_[*edge_];
  const std::string_view word = field.text;
  const auto edge = edge_named(word);
  if (!edge) {
    reject_field(line, field, gate_state_ ? "0 or 1" : "up or down");
    return false;
  }
  if (gate_state_ && word.size() == 1) { // the direction is not known
    const bool is_one = word == "1", covers_at_one = layout_.columns[*edge_].scale == 1.0;
    accept_gate_edge(line, beat, is_one == covers_at_one);
    return false;
  }
  beat.edge = *edge;
  if (!word.ends_with("-in") && !word.ends_with("-out")) return true;
  accept_gate_edge(line, beat, word.ends_with("-in"));
  return false;
}

// The two edges of one passage become its middle and its width.
void RowReader::accept_gate_edge(const Line& line, const Beat& beat, bool enters) {
  const auto incomplete = [&](std::size_t number, std::string_view which) {
    ++rejected_;
    issues_.add(number, 1, IssueKind::incomplete,
                fmt::format("one edge of a passage without its {}", which), "edge left out");
  };
  if (enters) {
    if (entered_) incomplete(entered_->line, "second");
    entered_ = beat;
    return;
  }
  const double width = entered_ ? beat.time - entered_->time : 0.0;
  if (!entered_ || entered_->edge != beat.edge || !(width > 0.0)) {
    incomplete(line.number, "first");
    return;
  }
  --data_lines_; // two lines, one event
  const Beat middle = event_at(entered_->time + 0.5 * width, beat.edge, entered_->line);
  entered_.reset();
  append(line, middle, width);
}

void RowReader::accept(const Line& line, Beat beat) {
  double width = number_at(line, width_, "a width");
  if (!std::isnan(width)) width *= layout_.columns[*width_].scale;
  if (!(std::isnan(width) || (width >= 0.0 && width < longest_period_s))) {
    issues_.add(line.number, fields_[*width_].column, IssueKind::out_of_range,
                fmt::format("a width of {} s", width), "width taken as unknown");
    width = not_known;
  }
  if (!std::isnan(width)) {
    beat.time = beat.time + 0.5 * width; // the log gives the time of the leading edge
  }
  append(line, beat, width);
}

void RowReader::append(const Line& line, const Beat& beat, double width_s) {
  push(beat);
  log_.has_amplitude = log_.has_amplitude || !std::isnan(beat.amplitude_rad);
  const bool widths = width_ || !log_.columns.width_s.empty() || !std::isnan(width_s);
  if (widths) { // events before the first width get an unknown one
    log_.columns.width_s.resize(log_.events.size() - 1, not_known);
    log_.columns.width_s.push_back(width_s);
  }
  for (std::size_t i = 0; i < weather_.size(); ++i) {
    if (!weather_[i]) continue;
    const LogColumn& column = layout_.columns[*weather_[i]];
    const WeatherQuantity& quantity = weather_quantities[i];
    const double value = number_at(line, weather_[i], quantity.article_and_name);
    (log_.columns.*quantity.values).push_back(column.scale * value + column.offset);
  }
}

void RowReader::go_on_from(const RowReader& before) {
  data_lines_ += before.data_lines_;
  rejected_ += before.rejected_;
  in_order_ = in_order_ && before.in_order_;
}

void RowReader::finish() {
  if (unwrap_.wraps() > 0)
    log_.assumptions.push_back(
        {fmt::format("the times begin again {} time{}, every {:.12g} s", unwrap_.wraps(),
                     unwrap_.wraps() == 1 ? "" : "s", unwrap_.wrap_s()),
         Setting::wrap});
  if (other_channels_ > 0)
    log_.assumptions.push_back(
        {fmt::format("{} lines of channels other than {} left out", other_channels_,
                     layout_.channel),
         Setting::channel});
  if (layout_.format == LogFormat::ticktock)
    log_.assumptions.push_back({"times are the middles of the intervals in which the flag covers "
                                "the sensor"});
  else if (width_ || !log_.columns.width_s.empty())
    log_.assumptions.push_back(
        {"times are of the flag's leading edge: half of each width is added to them"});
}

} // namespace goingrate
