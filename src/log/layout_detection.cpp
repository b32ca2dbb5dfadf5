#include "layout_detection.hpp"

#include "calendar.hpp"
#include "column_names.hpp"
#include "issue_list.hpp"
#include "time_columns.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace goingrate {

namespace {

// The unit in which a beat takes between 0.01 s and 100 s, with narrower limits for other units
// than seconds. Samples of an angle may be closer together.
std::optional<TimeUnit> unit_for_step(double step, const ColumnSample& sample) {
  if (step >= 0.01 && step < 100.0) return in_seconds;
  if (step >= 100.0 && step < 2e4) return in_milliseconds;
  if (step >= 2e4 && step < 5e7) return in_microseconds;
  if (step >= 5e7 && step < 1e11) return in_nanoseconds;
  constexpr double mjd_1900 = 15000.0, mjd_2100 = 90000.0;
  if (sample.least > mjd_1900 && sample.most < mjd_2100 && step > 0.02 / 86400.0 && step < 1e-3)
    return in_days;
  return {};
}

// The coarsest unit in which no value exceeds the time at which the counter wraps.
std::optional<TimeUnit> unit_within(double wrap_s, const ColumnSample& sample) {
  for (const TimeUnit& unit : {in_seconds, in_milliseconds, in_microseconds, in_nanoseconds})
    if (sample.most * unit.seconds * std::pow(10.0, unit.power) <= wrap_s) return unit;
  return {};
}

class Detection {
public:
  Detection(const LogHead& head, const ReadingOptions& options, ClockLog& log)
      : head_(head), options_(options), log_(log), first_(head.whole_row()) {
    layout_.separator = head.separator;
    layout_.point = head.point;
    layout_.first_line = head.rows.front().number;
    layout_.columns.resize(head.columns);
    samples_.reserve(head.columns);
    for (std::size_t i = 0; i < head.columns; ++i)
      samples_.push_back(head.sample(i));
  }

  Layout run() {
    if (head_.comma_was_guessed) assume("a comma is the decimal point", Setting::decimal_comma);
    const bool named = !head_.names.empty() && read_names();
    if (options_.format)
      layout_.format = *options_.format;
    else
      layout_.format = named ? format_of_names() : format_of_contents();
    if (!named || !options_.columns.empty()) fill_columns(named);
    if (!options_.columns.empty()) {
      apply_columns(options_.columns, head_, layout_);
      if (!options_.format) layout_.format = format_of_names();
    }
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

private:
  void assume(std::string text, Setting setting = Setting::none, std::string value = {}) {
    log_.assumptions.push_back({std::move(text), setting, std::move(value)});
  }
  [[nodiscard]] bool is_number(std::size_t column) const {
    return column < samples_.size() && samples_[column].numbers * 2 > samples_[column].rows;
  }
  [[nodiscard]] bool is_calendar(std::size_t column) const {
    if (column >= samples_.size()) return false;
    return samples_[column].calendars * 2 > samples_[column].rows ||
           // Invalid dates further on are left to the reader, which reports their place.
           (column == 0 && !is_number(0) && parse_calendar(first_[0].text, layout_.point));
  }
  void set(std::size_t column, ColumnRole role, double scale = 1.0) {
    layout_.columns[column].role = role;
    layout_.columns[column].scale = scale;
  }

  bool read_names();
  void leave_out(std::size_t column);
  [[nodiscard]] LogFormat format_of_names() const;
  [[nodiscard]] LogFormat format_of_contents() const;
  [[nodiscard]] LogFormat format_of_one_column() const;
  [[nodiscard]] bool looks_like_clock_error() const;
  [[nodiscard]] bool has_date_in_front() const;
  void fill_columns(bool named);
  void fill_time();
  void check_needed_columns();
  void settle_times();
  void settle_unit(LogColumn& column, const ColumnSample& sample);
  void settle_angle_unit();
  void settle_tau0();
  void refuse_fast_counter(const ColumnSample& sample) const;
  void refuse_what_was_not_measured(std::size_t time) const;
  void say_which_time();

  const LogHead& head_;
  const ReadingOptions& options_;
  ClockLog& log_;
  std::vector<Field> first_; // a row that has all columns
  std::vector<ColumnSample> samples_;
  std::vector<bool> stated_unit_;
  Layout layout_;
};

// Takes roles and units from the header; false if it contains no known name.
bool Detection::read_names() {
  std::size_t known = 0;
  stated_unit_.assign(head_.columns, false);
  for (std::size_t i = 0; i < std::min(head_.columns, head_.names.size()); ++i) {
    const NamedColumn named = column_named(head_.names[i]);
    const ColumnRole role = named.column.role;
    const bool taken = layout_.find(role).has_value();
    layout_.columns[i] = named.column;
    if (taken && role != ColumnRole::ignored && role != ColumnRole::time) leave_out(i);
    stated_unit_[i] = named.has_unit;
    known += layout_.columns[i].role != ColumnRole::ignored ? 1 : 0;
  }
  for (const std::size_t i : settle_named_times(samples_, layout_))
    leave_out(i);
  if (head_.names.size() != head_.columns && known > 0) {
    const std::size_t line =
        head_.titles.empty() ? head_.rows.front().number - 1 : head_.titles.back().number;
    IssueList(log_, options_.strict)
        .add(line, 1, IssueKind::header,
             fmt::format("a header of {} names over {} columns", head_.names.size(), head_.columns),
             "names taken from the left");
  }
  return known > 0;
}

// Of several columns with the same role the first is read.
void Detection::leave_out(std::size_t column) {
  assume(fmt::format("column {} {} is not read, an earlier one says the same", column + 1,
                     shown(layout_.columns[column].name)),
         Setting::columns);
  layout_.columns[column].role = ColumnRole::ignored;
}

LogFormat Detection::format_of_names() const {
  if (layout_.find(ColumnRole::angle) || layout_.find(ColumnRole::position))
    return LogFormat::angle; // native logs have no such columns
  if (!head_.names.empty() && layout_.separator == ',' &&
      std::find(head_.names.begin(), head_.names.end(), "time_s") != head_.names.end())
    return LogFormat::native;
  if (layout_.find(ColumnRole::phase)) return LogFormat::phase;
  if (layout_.find(ColumnRole::frequency)) return LogFormat::frequency;
  return LogFormat::table;
}

bool Detection::looks_like_clock_error() const {
  // Whole-number labels that advance with the lines, and an error that is small beside them. A
  // value that grows by more than 2 % of the time is not a clock's error but a time beside a count
  // of the lines.
  constexpr double largest_rate = 0.02;
  return head_.columns == 3 && samples_[1].typical_step < largest_rate * samples_[0].typical_step &&
         is_number(0) && is_number(1) && is_number(2) && samples_[0].whole && !samples_[1].whole &&
         std::max(samples_[0].rising, samples_[0].falling) > 0.5 &&
         std::max(std::abs(samples_[1].least), std::abs(samples_[1].most)) <= 43200.0;
}

// "2013-02-22 23:38:00": where blanks separate the fields, the date is a field of its own.
bool Detection::has_date_in_front() const {
  return head_.separator == ' ' && first_.size() >= 2 && !is_number(0) &&
         parse_calendar(fmt::format("{} {}", first_[0].text, first_[1].text), layout_.point);
}

LogFormat Detection::format_of_contents() const {
  if (first_.size() >= 2 && is_number(0)) {
    if (first_[1].text.starts_with("ch")) return LogFormat::ticc;
    if (first_[1].text.starts_with("TI(")) return LogFormat::ticc_interval;
  }
  if (is_calendar(0) || has_date_in_front()) return LogFormat::timestamps;
  if (head_.columns == 1) return format_of_one_column();
  if (looks_like_clock_error()) return LogFormat::clock_error;
  const bool timed = is_number(0) && samples_[0].rising > 0.9;
  const bool turned = is_number(0) && samples_[0].falling > 0.9;
  if ((timed || turned) && is_number(1) && samples_[1].smooth && samples_[1].crossings >= 3)
    return LogFormat::angle;
  const std::string& name = log_.source;
  if (timed && is_number(1) && (name.ends_with(".ykt") || name.ends_with(".ykt.gz")))
    return LogFormat::frequency;
  if (timed && is_number(1) && (name.ends_with(".xtt") || name.ends_with(".xtt.gz")))
    return LogFormat::phase;
  for (std::size_t i = 0; i < head_.columns; ++i)
    if (is_calendar(i)) return LogFormat::table;
  if (timed || !options_.columns.empty()) return LogFormat::table;
  const HeadLine& first = head_.rows.front();
  throw ImpossibleReading({log_.source, first.number, 1}, shown(first.text), "a known layout",
                          {{.words = "column 1 holds the times", .columns = {"time=1"}},
                           {.words = "column 1 holds periods", .columns = {"period=1"}}});
}

LogFormat Detection::format_of_one_column() const {
  const ColumnSample& only = samples_.front();
  if (!parse_number(first_[0].text, layout_.point)) {
    const HeadLine& first = head_.rows.front();
    throw InputError({log_.source, first.number, 1}, shown(first.text), "a time a line");
  }
  const bool steady = !is_number(0) || only.rising > 0.6 || only.falling > 0.7;
  const bool beats = !is_number(0) || options_.unit || unit_for_step(only.typical_step, only);
  if ((steady && beats) || options_.wrap_s) return LogFormat::timestamps;
  // Periods of one clock are nearly equal, whereas a clock's error has no typical value.
  const bool alike = only.least >= 0.0 && only.spread < 0.2 * only.median &&
                     (options_.unit || unit_for_step(only.median, only));
  if (alike) return LogFormat::periods;
  if (only.whole && only.least >= 0.0 && only.most > 100.0) {
    const HeadLine& first = head_.rows.front();
    throw ImpossibleReading(
        {log_.source, first.number, 1},
        fmt::format("whole numbers that do not rise, from {}", shown(first.text)), "times",
        {{.words = "they are microseconds of a counter of 16 bits that overflows within a beat of "
                   "1 s",
          .nominal_period_s = 1.0,
          .wrap_s = 0.065536}});
  }
  return LogFormat::phase;
}

void Detection::fill_time() {
  if (has_date_in_front()) {
    set(0, ColumnRole::date);
    set(1, ColumnRole::time);
    return;
  }
  guess_time(samples_, layout_);
}

// Sets the roles of columns that no header names.
void Detection::fill_columns(bool named) {
  if (named && layout_.format != LogFormat::phase && layout_.format != LogFormat::frequency) return;
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
  // Of a time and a period, the finer is used: a logger's own time stamps are often whole seconds.
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
  const bool timed = has(ColumnRole::time) || has(ColumnRole::period) ||
                     has(ColumnRole::half_period) || has(ColumnRole::phase) ||
                     has(ColumnRole::frequency);
  const bool complete =
      timed &&
      (layout_.format != LogFormat::angle || has(ColumnRole::angle) || has(ColumnRole::position)) &&
      (layout_.format != LogFormat::clock_error || has(ColumnRole::clock_error)) &&
      (layout_.format != LogFormat::native || head_.names.size() > 0);
  if (complete) return;
  const HeadLine& line = head_.titles.empty() ? head_.rows.front() : head_.titles.back();
  const TextPlace place{log_.source, line.number, 1};
  const auto refuse = [&](std::string_view expected, OtherReading other) {
    throw ImpossibleReading(place, shown(line.text), expected, {std::move(other)});
  };
  if (layout_.format == LogFormat::native)
    throw InputError(place, shown(line.text), "a header row with time_s");
  if (layout_.format == LogFormat::angle)
    refuse("columns for a time and an angle",
           {.words = "they are columns 1 and 2", .columns = {"time=1", "angle=2"}});
  if (layout_.format == LogFormat::clock_error)
    refuse("columns for a label and the clock's error",
           {.words = "they are columns 1 and 2", .columns = {"time=1", "error=2"}});
  refuse("a column with a time or a period",
         {.words = "column 1 holds the times", .columns = {"time=1"}});
}

void Detection::settle_times() {
  const auto at = layout_.find(ColumnRole::time);
  if (at) {
    const ColumnSample& sample = samples_[*at];
    layout_.date_begins_run = layout_.find(ColumnRole::date) && is_number(*at);
    layout_.calendar = is_calendar(*at) || (layout_.find(ColumnRole::date) && !is_number(*at));
    const bool date = sample.has_date || layout_.find(ColumnRole::date);
    if (layout_.calendar && !date) layout_.wrap_s = 86400.0;
    if (options_.wrap_s) layout_.wrap_s = options_.wrap_s;
    refuse_fast_counter(sample);
    layout_.newest_first = sample.falling > 0.7 && sample.falling > sample.rising;
    if (layout_.newest_first) {
      assume("the newest line is first; the log is turned round");
    }
    if (!layout_.calendar) settle_unit(layout_.columns[*at], sample);
  }
  for (const ColumnRole role : {ColumnRole::period, ColumnRole::half_period})
    if (const auto column = layout_.find(role)) {
      ColumnSample sample = samples_[*column];
      sample.typical_step = sample.median;
      settle_unit(layout_.columns[*column], sample);
    }
  if (layout_.find(ColumnRole::phase) || layout_.find(ColumnRole::frequency))
    if (!options_.tau0_s && !options_.nominal_period_s) settle_tau0();
  settle_angle_unit();
  if (at && layout_.find(ColumnRole::clock_error)) {
    const TimeUnit& unit = layout_.columns[*at].unit;
    const double step = samples_[*at].typical_step * unit.seconds * std::pow(10.0, unit.power);
    const bool label = layout_.format == LogFormat::clock_error || std::fmod(step, 0.25) == 0.0;
    if (label && step > 0.0 && step < 1e9) layout_.label_step_s = step;
  }
  if (at) refuse_what_was_not_measured(*at);
  if (layout_.format != LogFormat::angle) return;
  for (std::size_t i = 0; i < samples_.size(); ++i)
    if (layout_.columns[i].role == ColumnRole::ignored && samples_[i].smooth &&
        samples_[i].crossings >= 3)
      layout_.swinging = i;
}

// Refuses whole numbers that wrap every few lines, just below the capacity of a counter: they do
// not show how often the counter wrapped between two lines.
void Detection::refuse_fast_counter(const ColumnSample& sample) const {
  if (options_.wrap_s || options_.unit || !sample.whole || !(sample.least >= 0.0)) return;
  constexpr double least_wrap_share = 0.05, // of the lines
      filled_share = 0.9;                   // of what the counter holds
  if (std::min(sample.rising, sample.falling) < least_wrap_share) return;
  for (const double holds : {65536.0, 1e6, 1048576.0, 16777216.0}) {
    if (!(sample.most < holds && sample.most > filled_share * holds)) continue;
    const HeadLine& first = head_.rows.front();
    throw ImpossibleReading(
        {log_.source, first.number, 1},
        fmt::format("whole numbers up to {:.0f} that begin again every few lines", sample.most),
        "times that rise for some beats at least",
        {{.words = "they are microseconds, and begin again more than once a beat of 2 s",
          .nominal_period_s = 2.0,
          .wrap_s = holds * 1e-6,
          .unit = "us"},
         {.words = "they are milliseconds", .wrap_s = holds * 1e-3, .unit = "ms"}});
  }
}

// Refuses whole numbers at exactly equal steps where another column is monotonic or holds counts.
// Measured beats are never so even: such numbers are labels or a count of the lines.
void Detection::refuse_what_was_not_measured(std::size_t time) const {
  const ColumnSample& sample = samples_[time];
  constexpr std::size_t fewest_lines = 20;
  if (!sample.whole || !sample.even || sample.numbers < fewest_lines || !options_.columns.empty() ||
      options_.format || !head_.names.empty() || layout_.find(ColumnRole::clock_error))
    return;
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const ColumnSample& other = samples_[i];
    const bool one_way = std::max(other.rising, other.falling) > 0.9;
    const bool counts = other.whole && other.most > 1000.0 && other.typical_step > 100.0;
    if (i == time || !is_number(i) || !(one_way || counts)) continue;
    const HeadLine& first = head_.rows.front();
    const auto column = [](std::string_view role, std::size_t place) {
      return fmt::format("{}={}", role, place + 1);
    };
    throw ImpossibleReading(
        {log_.source, first.number, 1},
        fmt::format("whole numbers exactly {} apart for times", sample.typical_step),
        "times that were measured",
        {{.words = fmt::format("column {} is the clock's error at each label", i + 1),
          .columns = {column("time", time), column("error", i)}},
         {.words = fmt::format("column {} holds the times", i + 1),
          .columns = {column("time", i)}}});
  }
}

void Detection::settle_unit(LogColumn& column, const ColumnSample& sample) {
  const auto index = static_cast<std::size_t>(&column - layout_.columns.data());
  const bool by_user =
      std::any_of(options_.columns.begin(), options_.columns.end(), [&](const std::string& word) {
        return word.starts_with(fmt::format("{}=", name_of(column.role))) &&
               word.find(':') != std::string::npos;
      });
  if (options_.unit) {
    column.unit = *options_.unit;
    return;
  }
  if (by_user || layout_.format == LogFormat::clock_error || layout_.format == LogFormat::angle)
    return;
  const auto likely = options_.wrap_s && *options_.wrap_s > 0.0 && column.role == ColumnRole::time
                          ? unit_within(*options_.wrap_s, sample)
                          : unit_for_step(sample.typical_step, sample);
  const bool stated = index < stated_unit_.size() && stated_unit_[index];
  if (!likely || *likely == column.unit) return;
  const double own = column.unit.seconds * std::pow(10.0, column.unit.power);
  const double step_s = sample.typical_step * own;
  if (stated && step_s > 0.01 && step_s < 4000.0) return; // unusual but possible
  assume(stated
             ? fmt::format("the header's unit ({}) would make a beat of {:.3g} s: {} taken",
                           name_of(column.unit), step_s, name_of(*likely))
             : fmt::format("times are in {}", *likely == in_days ? std::string_view("days, as MJD")
                                                                 : name_of(*likely)),
         Setting::unit);
  column.unit = *likely;
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

// The spacing of phase or frequency values: the step of a time column, or else 1 s.
void Detection::settle_tau0() {
  const bool timed = head_.columns >= 2 && is_number(0) && samples_[0].rising > 0.9;
  const auto unit = timed ? unit_for_step(samples_[0].typical_step, samples_[0]) : std::nullopt;
  const bool second =
      layout_.find(ColumnRole::phase) != 0 && layout_.find(ColumnRole::frequency) != 0;
  if (unit && second) {
    layout_.tau0_s = samples_[0].typical_step * unit->seconds * std::pow(10.0, unit->power);
    assume(fmt::format("one value every {:.6g} s, the step of the first column", layout_.tau0_s),
           Setting::tau0);
  } else {
    assume("one value a second", Setting::tau0);
    if (!options_.format && layout_.find(ColumnRole::phase))
      assume("the values are the clock's error, neither periods nor frequencies", Setting::format);
  }
}

void Detection::settle_angle_unit() {
  const auto at = layout_.find(ColumnRole::angle);
  if (!at) return;
  const bool stated = *at < stated_unit_.size() && stated_unit_[*at];
  const double half = 0.5 * (samples_[*at].most - samples_[*at].least);
  if (stated || layout_.columns[*at].scale != 1.0) return;
  if (half > 3.2) { // radians: more than half a turn
    (void)set_unit(layout_.columns[*at], "deg");
    assume("angles are in degrees", Setting::columns, "angle=N:rad");
  } else {
    assume("angles are in rad", Setting::columns, "angle=N:deg");
  }
}

} // namespace

Layout detect_layout(const LogHead& head, const ReadingOptions& options, ClockLog& log) {
  return Detection(head, options, log).run();
}

} // namespace goingrate
