// The time of a line: as written, as a sum of periods, or as a place on a grid.
#include "row_reader.hpp"

#include "base/special_values.hpp"
#include "beginning.hpp"
#include "calendar.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace goingrate {

std::optional<Instant> RowReader::time_of(const Line& line) {
  if (period_) return accumulated_time(line, *period_);
  if (half_period_) return accumulated_time(line, *half_period_);
  return written_time(line);
}

DateOrder RowReader::date_order() const {
  return layout_.month_first ? DateOrder::month_first : DateOrder::day_first;
}

// The text of the time, after that of the date if it has a column of its own; of a date alone, that
// of its midnight.
Field RowReader::time_field() {
  const Field& time = fields_[*time_];
  if (days_alone_) {
    date_and_time_.assign(time.text).append(midnight);
    return {date_and_time_, time.column};
  }
  if (!date_ || layout_.date_begins_run) return time;
  const Field& date = fields_[*date_];
  date_and_time_.assign(date.text).append(" ").append(time.text);
  return {date_and_time_, date.column};
}

std::optional<Instant> RowReader::parsed_time(std::string_view text) {
  if (!layout_.calendar) {
    const auto count = parse_instant(text, layout_.columns[*time_].unit, layout_.point);
    if (!layout_.date_begins_run) return count;
    const auto date = parse_calendar(fields_[*date_].text, layout_.point, date_order());
    if (!count || !date) return {};
    const Instant sum = date->time + count->fraction;
    return Instant{sum.seconds + count->seconds, sum.fraction};
  }
  const auto time = parse_calendar(text, layout_.point, date_order());
  if (!time) return {};
  if (time->has_date && time->has_zone && !log_.zone_s) log_.zone_s = time->zone_s;
  const bool moves = zone_s_ != 0.0 && time->has_date && !time->has_zone;
  return moves ? time->time + -zone_s_ : time->time;
}

// All nines in place of a time, far from the neighbouring times, mean that there is no time.
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

// What a time should have been; of what may be a date in another form, the forms that are read.
std::string_view RowReader::expected_time(std::string_view text) const {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  const bool has_letters = std::any_of(text.begin(), text.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
  });
  constexpr std::ptrdiff_t fewest_digits = 4; // of a day and an hour
  if (days_alone_) return "a date";
  if (!has_letters || std::count_if(text.begin(), text.end(), is_digit) < fewest_digits)
    return layout_.calendar ? "a date and time" : "a time in seconds";
  return "a time in seconds, or a date such as 2013-02-22 23:38:00, 22.02.2013 23:38 or 22 Feb "
         "2013 23:38";
}

std::optional<Instant> RowReader::written_time(const Line& line) {
  const Field field = time_field();
  auto time = parsed_time(field.text);
  if (!time) {
    reject_field(line, days_alone_ ? fields_[*time_] : field, expected_time(field.text));
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
    if (!is_possible_error(error_s)) {
      reject(line, fields_[*error_].column, IssueKind::out_of_range,
             fmt::format("an error of {} s", error_s));
      return {};
    }
    time = *time + -error_s;
    clock_error_s_ = error_s;
  }
  return time;
}

// How much later a line's own time stamp is than one period after the line before, if that is more
// than the stamps' resolution of a second explains.
Instant RowReader::pause_before(const Instant& period) {
  if (!layout_.coarse_time) return {};
  const std::string_view text = fields_[*layout_.coarse_time].text;
  const auto calendar = parse_calendar(text, layout_.point, date_order());
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

// Periods are added up; for one that cannot be read, the one before is taken, to keep the count.
std::optional<Instant> RowReader::accumulated_time(const Line& line, std::size_t column) {
  const LogColumn& meaning = layout_.columns[column];
  auto period = parse_instant(fields_[column].text, meaning.unit, layout_.point);
  const double size = period ? period->to_double() : not_known;
  const bool usable =
      size > 0.0 && size < longest_period_s && !is_mark(column, fields_[column].text, size);
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
  wait(pause_before(*period));
  wait(*period);
  return accumulated();
}

void RowReader::wait(const Instant& interval) {
  whole_s_ += interval.seconds;
  part_s_ += interval.fraction;
  if (part_s_.hi >= 1.0) {
    part_s_ += -1.0;
    ++whole_s_;
  }
}

Instant RowReader::accumulated() const { return Instant{whole_s_, 0.0} + part_s_.value(); }

// An empty place of the grid.
void RowReader::leave_place(const Line& line, std::size_t column, IssueKind kind,
                            std::string found) {
  issues_.add(line.number, column, kind, std::move(found), "taken as missing");
  log_.grid->phase_s.push_back(not_known);
}

// The event that should have come at n tau0; an error x > 0 is that of a fast clock, which is
// early.
void RowReader::add_phase(std::uint32_t line, double error_s) {
  const auto n = static_cast<std::int64_t>(log_.grid->phase_s.size());
  log_.grid->phase_s.push_back(error_s);
  if (phases_alone_ && log_.events.size() >= events_of_phases_alone) return;
  const Instant origin{};
  const double late = residual_from_grid(origin, origin, n, layout_.tau0_s);
  const Instant elapsed = Instant::from_seconds(-late) + -error_s;
  const Instant time =
      Instant{grid_begin_.seconds + elapsed.seconds, elapsed.fraction} + grid_begin_.fraction;
  Beat beat = event_at(time, Edge::up, line);
  beat.cycle = n;
  log_.events.push_back(beat);
}

// The first value's date, where there is one, is that of the grid.
void RowReader::begin_grid() {
  const auto first = time_ ? parsed_time(time_field().text) : std::nullopt;
  if (first && origin_of(layout_, *first) != TimeOrigin::none) grid_begin_ = *first;
}

void RowReader::add_on_grid(const Line& line, std::size_t column) {
  if (log_.grid->phase_s.empty()) begin_grid();
  const Field& field = fields_[column];
  const auto value = parse_number(field.text, layout_.point);
  if (!value && !says_nothing(field.text)) {
    reject_field(line, field, "a number");
    log_.grid->phase_s.push_back(not_known);
    return;
  }
  const bool empty =
      layout_.format == LogFormat::phase && !log_.grid->phase_s.empty() && value == 0.0;
  if (!value || empty || is_mark(column, field.text, *value)) {
    --data_lines_; // left empty on purpose: no sign of a wrong format
    return leave_place(line, field.column, IssueKind::gap,
                       empty ? "an exact zero, which stands for a gap" : "no value");
  }
  const double scaled = *value * layout_.columns[column].scale;
  if (frequency_) part_s_ += scaled * layout_.tau0_s;
  const double error = frequency_ ? part_s_.value() : scaled;
  if (!is_possible_error(error)) {
    ++rejected_;
    return leave_place(line, field.column, IssueKind::out_of_range,
                       fmt::format("an error of {} s", error));
  }
  add_phase(line.number, error);
}

} // namespace goingrate
