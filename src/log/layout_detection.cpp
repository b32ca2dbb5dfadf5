#include "detection.hpp"

#include "column_names.hpp"
#include "gate_intervals.hpp"
#include "issue_list.hpp"
#include "time_columns.hpp"
#include "weather_quantities.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace goingrate {

Layout Detection::run() {
  if (head_.comma_was_guessed) assume("a comma is the decimal point", Setting::decimal_comma);
  if (has_date_in_front() && names_.size() + 1 == head_.columns && !names_.empty())
    names_.insert(names_.begin(),
                  names_.front()); // blanks cut the date from its time, not the name
  const bool named = !names_.empty() && read_names();
  if (options_.weather) return weather();
  if (options_.format)
    layout_.format = *options_.format;
  else
    layout_.format = named ? format_of_names() : format_of_contents();
  if (!named || !options_.columns.empty() || lacks_its_role()) fill_columns(named);
  if (!options_.columns.empty()) {
    apply_columns(options_.columns, head_, layout_);
    if (!options_.format) layout_.format = format_of_names();
  }
  settle_dates();
  if (layout_.format == LogFormat::xy) layout_.format = LogFormat::angle; // from here on the same
  check_needed_columns();
  layout_.tau0_s = options_.tau0_s.value_or(options_.nominal_period_s.value_or(1.0));
  settle_times();
  Assumption format{fmt::format("format: {}{}",
                                layout_.format == LogFormat::table && head_.names.empty()
                                    ? "columns without names"
                                    : in_words(layout_.format),
                                options_.format ? "" : ", found from the first lines")};
  log_.assumptions.insert(log_.assumptions.begin(), std::move(format));
  say_which_time();
  return layout_;
}

// Whether the format is one of values of one kind, and no column has a name of that kind.
bool Detection::lacks_its_role() const {
  const auto lacks = [&](ColumnRole role) { return !layout_.find(role); };
  switch (layout_.format) {
  case LogFormat::periods:
    return lacks(ColumnRole::period) && lacks(ColumnRole::half_period);
  case LogFormat::phase:
    return lacks(ColumnRole::phase);
  case LogFormat::frequency:
    return lacks(ColumnRole::frequency);
  default:
    return false;
  }
}

// A table of the weather, whose header must name what it holds.
Layout Detection::weather() {
  bool has_weather = false;
  for (LogColumn& column : layout_.columns) {
    const bool is_weather =
        std::any_of(weather_quantities.begin(), weather_quantities.end(),
                    [&](const WeatherQuantity& quantity) { return quantity.role == column.role; });
    has_weather = has_weather || is_weather;
    if (!is_weather && column.role != ColumnRole::time && column.role != ColumnRole::date)
      column.role = ColumnRole::ignored;
  }
  if (!has_weather || !layout_.find(ColumnRole::time)) {
    const HeadLine& line = head_.titles.empty() ? head_.rows.front() : head_.titles.back();
    throw InputError(log_.place(line.number), shown(line.text),
                     "a header that names a time, and a temperature, a pressure or a humidity");
  }
  layout_.format = LogFormat::table;
  settle_times();
  return layout_;
}

// Takes roles and units from the header; false if it contains no known name.
bool Detection::read_names() {
  std::size_t known = 0;
  stated_unit_.assign(head_.columns, false);
  for (std::size_t i = 0; i < std::min(head_.columns, names_.size()); ++i) {
    const NamedColumn named = column_named(names_[i]);
    const ColumnRole role = named.column.role;
    const bool taken = layout_.find(role).has_value();
    layout_.columns[i] = named.column;
    if (taken && role != ColumnRole::ignored && role != ColumnRole::time) leave_out(i);
    stated_unit_[i] = named.has_unit;
    known += layout_.columns[i].role != ColumnRole::ignored ? 1 : 0;
  }
  for (const std::size_t i : settle_named_times(samples_, layout_))
    leave_out(i);
  if (settle_dated_phases()) known = 2;
  settle_named_periods();
  known -= settle_intervals();
  known += settle_gate_state();
  refuse_double_commas();
  if (names_.size() != head_.columns && known > 0) {
    const std::size_t line =
        head_.titles.empty() ? head_.rows.front().number - 1 : head_.titles.back().number;
    IssueList(log_, options_.strict)
        .add(line, 1, IssueKind::header,
             fmt::format("a header of {} names over {} columns", names_.size(), head_.columns),
             "names taken from the left");
  }
  return known > 0;
}

// If several columns have the same role, the first is read.
void Detection::leave_out(std::size_t column) {
  assume(fmt::format("column {} {} is not read, an earlier one says the same", column + 1,
                     shown(layout_.columns[column].name)),
         Setting::columns);
  layout_.columns[column].role = ColumnRole::ignored;
}

// Whether all four intervals between a light gate's edges are there.
bool Detection::has_intervals() const {
  return std::all_of(gate_intervals.begin(), gate_intervals.end(),
                     [&](ColumnRole role) { return layout_.find(role).has_value(); });
}

// Whether a column tells when the events came.
bool Detection::is_timed() const {
  return has_intervals() ||
         std::any_of(layout_.columns.begin(), layout_.columns.end(), [](const LogColumn& column) {
           switch (column.role) {
           case ColumnRole::time:
           case ColumnRole::period:
           case ColumnRole::half_period:
           case ColumnRole::phase:
           case ColumnRole::frequency:
             return true;
           default:
             return false;
           }
         });
}

// Fewer than four count as none; returns how many columns lost their role. Next to all four, a time
// column is only the time of the computer that wrote them down.
std::size_t Detection::settle_intervals() {
  const bool whole = has_intervals();
  std::size_t left_out = 0;
  for (LogColumn& column : layout_.columns) {
    const bool part = is_gate_interval(column.role) || column.role == ColumnRole::counter_rate;
    const bool time = column.role == ColumnRole::time || column.role == ColumnRole::date;
    if (whole ? !time : !part) continue;
    column.role = ColumnRole::ignored;
    ++left_out;
  }
  return left_out;
}

LogFormat Detection::format_of_names() const {
  if (has_intervals()) return LogFormat::ticktock;
  if (layout_.find(ColumnRole::angle) || layout_.find(ColumnRole::position))
    return LogFormat::angle; // native logs have no such columns
  if (!head_.names.empty() && layout_.separator == ',' &&
      std::find(head_.names.begin(), head_.names.end(), "time_s") != head_.names.end())
    return LogFormat::native;
  if (layout_.find(ColumnRole::phase)) return LogFormat::phase;
  if (layout_.find(ColumnRole::frequency)) return LogFormat::frequency;
  return LogFormat::table;
}

void Detection::fill_time() {
  if (has_date_in_front()) {
    set(0, ColumnRole::date);
    set(1, ColumnRole::time);
    return;
  }
  guess_time(samples_, layout_);
  for (std::size_t i = 0; i < head_.columns && head_.names.empty(); ++i)
    if (is_edge(i)) set(i, ColumnRole::edge);
}

// Sets the roles of columns that no header names.
void Detection::fill_columns(bool named) {
  if (named && layout_.format != LogFormat::phase && layout_.format != LogFormat::frequency &&
      layout_.format != LogFormat::periods)
    return;
  const std::size_t last = head_.columns - 1;
  switch (layout_.format) {
  case LogFormat::clock_error:
    if (head_.columns < 2) break;
    set(0, ColumnRole::time);
    set(1, ColumnRole::clock_error);
    if (head_.columns > 2) set(2, ColumnRole::amplitude, 1e-3);
    break;
  case LogFormat::periods:
    set(0, ColumnRole::period);
    break;
  case LogFormat::phase:
  case LogFormat::frequency:
    set(std::min<std::size_t>(last, 1),
        layout_.format == LogFormat::phase ? ColumnRole::phase : ColumnRole::frequency);
    break;
  case LogFormat::ticc:
  case LogFormat::ticc_interval:
    set(0, layout_.format == LogFormat::ticc ? ColumnRole::time : ColumnRole::phase);
    if (head_.columns < 2) break;
    set(1, ColumnRole::channel);
    layout_.channel = options_.channel.empty() ? std::string(first_[1].text) : options_.channel;
    assume(fmt::format("channel {}{}", layout_.channel,
                       options_.channel.empty() ? ", the first in the file" : ""),
           Setting::channel);
    break;
  case LogFormat::angle:
    fill_time();
    if (head_.columns > 1) set(1, ColumnRole::angle);
    break;
  case LogFormat::ticktock:
    for (std::size_t i = 0; i < std::min(head_.columns, gate_intervals.size()); ++i)
      set(i, gate_intervals[i]);
    break;
  case LogFormat::xy:
    fill_time();
    if (head_.columns < 3) break;
    set(1, ColumnRole::position);
    set(2, ColumnRole::height);
    break;
  case LogFormat::sound: // no text
  case LogFormat::native:
  case LogFormat::timestamps:
  case LogFormat::table:
    fill_time();
    if (options_.columns.empty()) {
      const std::size_t used = layout_.find(ColumnRole::date) ? 2 : 1;
      if (head_.columns > used)
        assume(fmt::format("{} other column{} not read", head_.columns - used,
                           head_.columns - used == 1 ? " is" : "s are"),
               Setting::columns);
    }
    break;
  }
}

void Detection::check_needed_columns() {
  const auto has = [&](ColumnRole role) { return layout_.find(role).has_value(); };
  // Of times and periods, the finer are used: a logger's own stamps are often whole seconds.
  if (const auto time = layout_.find(ColumnRole::time);
      time && (has(ColumnRole::period) || has(ColumnRole::half_period))) {
    const auto period = has(ColumnRole::period) ? layout_.find(ColumnRole::period)
                                                : layout_.find(ColumnRole::half_period);
    const bool coarse = samples_[*time].whole && !layout_.columns[*period].name.empty();
    const bool forced = std::any_of(options_.columns.begin(), options_.columns.end(),
                                    [](const std::string& c) { return c.starts_with("time="); });
    const bool use_time = forced || !coarse;
    if (use_time)
      assume("times are read, the column of periods is not", Setting::columns, "period=N");
    else
      assume("periods are added up; the column of times, in whole numbers, is used only to find "
             "pauses",
             Setting::columns, "time=N");
    layout_.columns[use_time ? *period : *time].role = ColumnRole::ignored;
    if (!use_time) layout_.coarse_time = time;
  }
  const bool complete =
      is_timed() &&
      (layout_.format != LogFormat::angle || has(ColumnRole::angle) || has(ColumnRole::position)) &&
      (layout_.format != LogFormat::ticktock || has_intervals()) &&
      (layout_.format != LogFormat::clock_error || has(ColumnRole::clock_error)) &&
      (layout_.format != LogFormat::native || head_.names.size() > 0);
  if (complete) return;
  const HeadLine& line = head_.titles.empty() ? head_.rows.front() : head_.titles.back();
  const TextPlace place = log_.place(line.number);
  const auto refuse = [&](std::string_view expected, OtherReading other) {
    throw ImpossibleReading(place, shown(line.text), expected, {std::move(other)});
  };
  if (layout_.format == LogFormat::native)
    throw InputError(place, shown(line.text), "a header row with time_s");
  if (layout_.format == LogFormat::ticktock)
    refuse("columns tick, tick_block, tock and tock_block",
           {.words = "they are columns 1 to 4",
            .columns = {"tick-light=1", "tick-dark=2", "tock-light=3", "tock-dark=4"}});
  if (layout_.format == LogFormat::angle)
    refuse("columns for a time and an angle",
           {.words = "they are columns 1 and 2", .columns = {"time=1", "angle=2"}});
  if (layout_.format == LogFormat::clock_error)
    refuse("columns for a label and the clock's error",
           {.words = "they are columns 1 and 2", .columns = {"time=1", "error=2"}});
  const std::string_view expected = "a column with a time or a period";
  auto other = likely_timing();
  if (!other) throw InputError(place, shown(line.text), expected);
  refuse(expected, std::move(*other));
}

// The first column without a known name whose values are as times are, or else as periods are.
std::optional<OtherReading> Detection::likely_timing() const {
  const auto first = [&](auto is_one) {
    std::size_t at = 0;
    while (at < samples_.size() && !(layout_.columns[at].role == ColumnRole::ignored && is_one(at)))
      ++at;
    return at;
  };
  const auto reading = [](std::size_t column, std::string_view what, std::string_view role) {
    return OtherReading{.words = fmt::format("column {} holds {}", column + 1, what),
                        .columns = {fmt::format("{}={}", role, column + 1)}};
  };
  const std::size_t time = first([&](std::size_t i) {
    return is_calendar(i) || are_days(i) || (is_number(i) && is_steady(samples_[i]));
  });
  if (time < samples_.size()) return reading(time, "the times", "time");
  const std::size_t period =
      first([&](std::size_t i) { return is_number(i) && are_alike(samples_[i]); });
  if (period < samples_.size()) return reading(period, "periods", "period");
  return {};
}

// Reports which of several columns is taken for the time: a wrong one would give a wrong rate.
void Detection::say_which_time() {
  const auto at = layout_.find(ColumnRole::time);
  if (!at || layout_.columns.size() < 2 || layout_.format != LogFormat::table) return;
  const std::string& name = layout_.columns[*at].name;
  const auto date = layout_.find(ColumnRole::date);
  assume(fmt::format("times are those of column {}{}{}", *at + 1,
                     name.empty() ? "" : ", " + shown(name),
                     !date ? std::string()
                     : layout_.date_begins_run
                         ? fmt::format(", counted from the dates of column {}", *date + 1)
                         : fmt::format(", with the dates of column {}", *date + 1)),
         Setting::columns, "time=N");
}

Layout detect_layout(const LogHead& head, const ReadingOptions& options, ClockLog& log) {
  return Detection(head, options, log).run();
}

} // namespace goingrate
