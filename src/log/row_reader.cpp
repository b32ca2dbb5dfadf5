#include "row_reader.hpp"

#include "calendar.hpp"
#include "column_names.hpp"

#include "base/decimal.hpp"
#include "base/large_pages.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numbers>
#include <utility>

namespace goingrate {

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
constexpr double largest_error_s = 1e9;  // thirty years: a clock that is further off was never set
constexpr double longest_period_s = 1e6; // no pendulum takes so long

} // namespace

RowReader::RowReader(const Layout& layout, const ReadingOptions& options, ClockLog& log)
    : layout_(layout), log_(log), issues_(log, options.strict),
      unwrap_(unwrapping(layout, options.nominal_period_s)), time_(layout.find(ColumnRole::time)),
      date_(layout.find(ColumnRole::date)), period_(layout.find(ColumnRole::period)),
      half_period_(layout.find(ColumnRole::half_period)),
      error_(layout.find(ColumnRole::clock_error)), phase_(layout.find(ColumnRole::phase)),
      frequency_(layout.find(ColumnRole::frequency)),
      amplitude_(layout.find(ColumnRole::amplitude)), angle_(layout.find(ColumnRole::angle)),
      width_(layout.find(ColumnRole::width)), edge_(layout.find(ColumnRole::edge)),
      temperature_(layout.find(ColumnRole::temperature)),
      pressure_(layout.find(ColumnRole::pressure)), channel_(layout.find(ColumnRole::channel)) {
  if (!angle_) angle_ = layout.find(ColumnRole::position);
  plain_ = layout.columns.size() == 1 && time_ && !layout.calendar &&
           layout.columns[*time_].unit == in_seconds;
  if (!phase_ && !frequency_) return;
  log.grid.emplace();
  log.grid->tau0_s = layout.tau0_s;
  if (frequency_) add_phase(layout.first_line, 0.0); // where the first interval begins
}

void RowReader::reserve(std::size_t lines) {
  if (layout_.format == LogFormat::angle)
    reserve_large(samples_, lines);
  else
    reserve_large(log_.events, lines);
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
    if (log_.grid) log_.grid->phase_s.push_back(unknown); // its place stays
    return;
  }
  if (channel_ && !layout_.channel.empty() && fields_[*channel_].text != layout_.channel) {
    ++other_channels_;
    --data_lines_;
    return;
  }
  if (phase_) return add_on_grid(line, *phase_);
  if (frequency_) return add_on_grid(line, *frequency_);
  const auto time = time_of(line);
  if (!time) return;
  if (angle_) {
    const double angle = number_at(line, angle_, "an angle");
    if (std::isnan(angle)) {
      ++rejected_;
      const Field& field = fields_[*angle_];
      if (says_nothing(field.text))
        issues_.add(line.number, field.column, IssueKind::no_value, "no angle", "sample left out");
    } else {
      samples_.push_back({*time, angle * layout_.columns[*angle_].scale, line.number});
    }
    return;
  }
  Beat beat = event_at(*time, half_period_ && row_++ % 2 == 1 ? Edge::down : Edge::up, line.number);
  if (edge_ && !read_edge(line, beat)) return;
  beat.amplitude_rad = amplitude_at(line);
  accept(line, beat);
}

RowReader::Taken RowReader::add_plain_times(std::string_view text, std::uint32_t number) {
  if (!plain_ || number < layout_.first_line) return {};
  const char* const end = text.data() + text.size();
  Taken taken;
  for (const char* c = text.data(); c != end && *c >= '0' && *c <= '8'; ++taken.lines) {
    Instant raw;
    const char* const line = c;
    if (!take_plain_seconds(c, end, layout_.point, raw)) break;
    const auto length = static_cast<std::size_t>(c - line);
    if (c != end && *c == '\r') ++c;
    if (c == end || *c != '\n') break;
    time_length_ = length;
    push(event_at(unwrap_(raw, [this] { return typical_step_s(); }), Edge::up, number++));
    taken.bytes = static_cast<std::size_t>(++c - text.data());
  }
  data_lines_ += taken.lines;
  return taken;
}

void RowReader::push(const Beat& beat) {
  in_order_ = in_order_ && (log_.events.empty() || log_.events.back().time <= beat.time);
  log_.events.push_back(beat);
}

// The right number of fields, of text.
bool RowReader::row_fits(const Line& line) {
  const std::size_t columns = layout_.columns.size();
  if (fields_.size() == columns && !has_binary(line.text)) return true;
  if (has_binary(line.text)) {
    reject(line, 1, IssueKind::binary, fmt::format("bytes that are not text: {}", shown(line.text)));
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

// ---- times

std::optional<Instant> RowReader::time_of(const Line& line) {
  if (period_) return accumulated_time(line, *period_);
  if (half_period_) return accumulated_time(line, *half_period_);
  return written_time(line);
}

// The text of the time, after that of the date if it has a column of its own.
Field RowReader::time_field() {
  const Field& time = fields_[*time_];
  if (!date_ || layout_.date_begins_run) return time;
  const Field& date = fields_[*date_];
  date_and_time_.assign(date.text).append(" ").append(time.text);
  return {date_and_time_, date.column};
}

std::optional<Instant> RowReader::parsed_time(std::string_view text) const {
  if (!layout_.calendar) {
    const auto count = parse_instant(text, layout_.columns[*time_].unit, layout_.point);
    if (!layout_.date_begins_run) return count;
    const auto date = parse_calendar(fields_[*date_].text, layout_.point);
    if (!count || !date) return {};
    const Instant sum = date->time + count->fraction;
    return Instant{sum.seconds + count->seconds, sum.fraction};
  }
  const auto time = parse_calendar(text, layout_.point);
  return time ? std::optional(time->time) : std::nullopt;
}

// All nines where a time should be, and far from the times around: no time.
bool RowReader::is_sentinel(std::string_view text, const Instant& time) const {
  const auto before = time_before(0);
  if (!before || text.front() != '9' || !all_nines(text)) return false;
  const double step = time - *before;
  return step < 0.0 || step > 100.0 * typical_step_s();
}

// A last line without line end whose time is shorter than the one before has lost some of it.
bool RowReader::is_cut_short(const Line& line, std::string_view text) {
  const std::size_t before = time_length_;
  time_length_ = text.size();
  return !line.ended && time_before(0) && text.size() < before;
}

// The last time, or that many before it.
std::optional<Instant> RowReader::time_before(std::size_t back) const {
  const auto& events = log_.events;
  if (angle_)
    return back < samples_.size() ? std::optional(samples_[samples_.size() - 1 - back].time)
                                  : std::nullopt;
  return back < events.size() ? std::optional(events[events.size() - 1 - back].time) : std::nullopt;
}

// The mean step forward of the last eight times: enough to know a step from a jump.
double RowReader::typical_step_s() const {
  double sum = 0.0, count = 0.0;
  for (std::size_t back = 0; back < 7; ++back) {
    const auto later = time_before(back), earlier = time_before(back + 1);
    if (!earlier) break;
    const double step = *later - *earlier;
    if (step <= 0.0) continue;
    sum += step;
    ++count;
  }
  return count > 0.0 ? sum / count : 0.0;
}

std::optional<Instant> RowReader::written_time(const Line& line) {
  const Field field = time_field();
  auto time = parsed_time(field.text);
  if (!time) {
    reject_field(line, field, layout_.calendar ? "a date and time" : "a time in seconds");
    return {};
  }
  if (is_sentinel(field.text, *time)) {
    reject(line, field.column, IssueKind::no_value,
           fmt::format("{}, which stands for no value", shown(field.text)));
    return {};
  }
  if (is_cut_short(line, field.text)) {
    reject(line, field.column, IssueKind::truncated,
           fmt::format("a last line that breaks off: {}", shown(line.text)));
    return {};
  }
  if (std::abs(time->to_double()) > 4e18) { // differences of two such would not fit
    reject(line, field.column, IssueKind::out_of_range, "a time beyond 4e18 s");
    return {};
  }
  if (!error_) {
    time = unwrap_(*time, [this] { return typical_step_s(); });
  } else {
    const double error = number_at(line, error_, "a clock error in seconds");
    if (std::isnan(error)) {
      ++rejected_;
      return {};
    }
    // The clock shows `label` when true time is label - error: a positive error is a fast clock.
    const double error_s = error * layout_.columns[*error_].scale;
    if (!(std::abs(error_s) < largest_error_s)) {
      reject(line, fields_[*error_].column, IssueKind::out_of_range,
             fmt::format("an error of {} s", error_s));
      return {};
    }
    time = *time + -error_s;
  }
  return time;
}

// How much later than a period after the line before a line's own time stamp is, if that is more
// than its resolution of a second explains.
Instant RowReader::pause_before(const Instant& period) {
  if (!layout_.coarse_time) return {};
  const std::string_view text = fields_[*layout_.coarse_time].text;
  const auto calendar = parse_calendar(text, layout_.point);
  const auto stamp =
      calendar ? std::optional(calendar->time)
               : parse_instant(text, layout_.columns[*layout_.coarse_time].unit, layout_.point);
  if (!stamp) return {};
  const auto before = std::exchange(stamp_, stamp);
  if (!before) return {};
  const double pause_s = *stamp - *before - period.to_double();
  constexpr double explained_s =
      1.5; // both stamps are cut to a second, the counter has its own rate
  return pause_s > explained_s ? Instant{std::llround(pause_s), 0.0} : Instant{};
}

// Periods are added up; of one that cannot be read the one before is taken, to keep the count.
std::optional<Instant> RowReader::accumulated_time(const Line& line, std::size_t column) {
  const LogColumn& meaning = layout_.columns[column];
  auto period = parse_instant(fields_[column].text, meaning.unit, layout_.point);
  const double size = period ? period->to_double() : unknown;
  const bool usable = size > 0.0 && size < longest_period_s && !all_nines(fields_[column].text);
  if (!usable) {
    if (!line.ended) {
      reject_field(line, fields_[column], "a period");
      return {};
    }
    issues_.add(line.number, fields_[column].column, IssueKind::no_value,
                fmt::format("found {}, expected a period", shown(fields_[column].text)),
                "the period before it taken, to keep the count");
    period = Instant::from_seconds(last_period_s_);
  } else {
    last_period_s_ = size;
  }
  const Instant pause = pause_before(*period);
  whole_s_ += period->seconds + pause.seconds;
  part_s_ += period->fraction;
  if (part_s_.hi >= 1.0) {
    part_s_ += -1.0;
    ++whole_s_;
  }
  return Instant{whole_s_, 0.0} + part_s_.value();
}

// An empty place of the grid.
void RowReader::leave_place(const Line& line, std::size_t column, IssueKind kind,
                            std::string found) {
  issues_.add(line.number, column, kind, std::move(found), "taken as missing");
  log_.grid->phase_s.push_back(unknown);
}

// The event that should have come at n tau0; an error x > 0 is that of a fast clock, which is
// early.
void RowReader::add_phase(std::uint32_t line, double error_s) {
  const auto n = static_cast<std::int64_t>(log_.grid->phase_s.size());
  log_.grid->phase_s.push_back(error_s);
  const Instant origin{};
  const double late = residual_from_grid(origin, origin, n, layout_.tau0_s);
  Beat beat = event_at(Instant::from_seconds(-late) + -error_s, Edge::up, line);
  beat.cycle = n;
  log_.events.push_back(beat);
}

void RowReader::add_on_grid(const Line& line, std::size_t column) {
  const Field& field = fields_[column];
  const auto value = parse_number(field.text, layout_.point);
  if (!value && !says_nothing(field.text)) {
    reject_field(line, field, "a number");
    log_.grid->phase_s.push_back(unknown);
    return;
  }
  const bool empty =
      layout_.format == LogFormat::phase && !log_.grid->phase_s.empty() && value == 0.0;
  if (!value || empty || all_nines(field.text)) {
    --data_lines_; // left empty on purpose: no sign of a wrong format
    return leave_place(line, field.column, IssueKind::gap,
                       empty ? "an exact zero, which stands for a gap" : "no value");
  }
  const double scaled = *value * layout_.columns[column].scale;
  if (frequency_) part_s_ += scaled * layout_.tau0_s;
  const double error = frequency_ ? part_s_.value() : scaled;
  if (!(std::abs(error) < largest_error_s)) {
    ++rejected_;
    return leave_place(line, field.column, IssueKind::out_of_range,
                       fmt::format("an error of {} s", error));
  }
  add_phase(line.number, error);
}

// ---- the other columns

double RowReader::number_at(const Line& line, const Place& place, std::string_view expected) {
  if (!place) return unknown;
  const Field& field = fields_[*place];
  const auto value = parse_number(field.text, layout_.point);
  // 999.9 mbar is weather like any other.
  const bool no_value = all_nines(field.text) && !(place == pressure_ && value && *value < 1100.0);
  if (value && !no_value) return *value;
  if (!says_nothing(field.text)) // empty or NaN: the file's own word for it
    issues_.add(line.number, field.column, value ? IssueKind::no_value : IssueKind::unreadable,
                fmt::format("found {}, expected {}", shown(field.text), expected),
                "taken as unknown");
  return unknown;
}

double RowReader::amplitude_at(const Line& line) {
  if (!amplitude_) return unknown;
  const double amplitude =
      number_at(line, amplitude_, "an amplitude") * layout_.columns[*amplitude_].scale;
  if (std::isnan(amplitude) || (amplitude > 0.0 && amplitude < std::numbers::pi)) return amplitude;
  issues_.add(line.number, fields_[*amplitude_].column, IssueKind::out_of_range,
              fmt::format("an amplitude of {} rad", amplitude), "amplitude taken as unknown");
  return unknown;
}

bool RowReader::read_edge(const Line& line, Beat& beat) {
  const Field& field = fields_[*edge_];
  const std::string_view word = field.text;
  const auto edge = edge_named(word);
  if (!edge) {
    reject_field(line, field, "up or down");
    return false;
  }
  beat.edge = *edge;
  if (!word.ends_with("-in") && !word.ends_with("-out")) return true;
  accept_gate_edge(line, beat, word);
  return false;
}

// The two edges of one passage become its middle and its width.
void RowReader::accept_gate_edge(const Line& line, const Beat& beat, std::string_view word) {
  const auto incomplete = [&](std::size_t number, std::string_view which) {
    ++rejected_;
    issues_.add(number, 1, IssueKind::incomplete,
                fmt::format("one edge of a passage without its {}", which), "edge left out");
  };
  if (word.ends_with("-in")) {
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
  append(middle, width, number_at(line, temperature_, "a temperature"),
         number_at(line, pressure_, "a pressure"));
}

void RowReader::accept(const Line& line, Beat beat) {
  double width = number_at(line, width_, "a width");
  if (!std::isnan(width)) width *= layout_.columns[*width_].scale;
  if (!(std::isnan(width) || (width >= 0.0 && width < longest_period_s))) {
    issues_.add(line.number, fields_[*width_].column, IssueKind::out_of_range,
                fmt::format("a width of {} s", width), "width taken as unknown");
    width = unknown;
  }
  if (!std::isnan(width)) {
    beat.time = beat.time + 0.5 * width; // the log has the leading edge
  }
  append(beat, width, number_at(line, temperature_, "a temperature"),
         number_at(line, pressure_, "a pressure"));
}

void RowReader::append(const Beat& beat, double width_s, double temperature_c,
                       double pressure_mbar) {
  push(beat);
  log_.has_amplitude = log_.has_amplitude || !std::isnan(beat.amplitude_rad);
  const bool widths = width_ || !log_.columns.width_s.empty() || !std::isnan(width_s);
  if (widths) { // the first width may come late
    log_.columns.width_s.resize(log_.events.size() - 1, unknown);
    log_.columns.width_s.push_back(width_s);
  }
  if (temperature_)
    log_.columns.temperature_c.push_back(temperature_c * layout_.columns[*temperature_].scale);
  if (pressure_)
    log_.columns.pressure_mbar.push_back(pressure_mbar * layout_.columns[*pressure_].scale);
}

void RowReader::finish() {
  if (unwrap_.wraps() > 0)
    log_.assumptions.push_back(
        {fmt::format("the times begin again {} time{}, every {:.12g} s", unwrap_.wraps(),
                     unwrap_.wraps() == 1 ? "" : "s", unwrap_.wrap_s()),
         Setting::wrap});
  if (other_channels_ > 0)
    log_.assumptions.push_back(
        {fmt::format("{} lines of other channels than {}", other_channels_, layout_.channel),
         Setting::channel});
  if (width_ || !log_.columns.width_s.empty())
    log_.assumptions.push_back(
        {"times are those of the flag's leading edge; half its width is added to each"});
}

} // namespace goingrate
