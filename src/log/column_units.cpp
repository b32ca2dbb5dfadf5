// Finds the units of a log's times and angles, and the kind of its times: their order, whether they
// come from a counter that wraps, or whether they are no measurements at all.
#include "detection.hpp"

#include "column_names.hpp"
#include "gate_intervals.hpp"

#include "base/readable.hpp"
#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <set>
#include <string>

namespace goingrate {

namespace {

bool is_mjd(const ColumnSample& sample) {
  constexpr double mjd_1900 = 15000.0, mjd_2100 = 90000.0;
  return sample.least > mjd_1900 && sample.most < mjd_2100;
}

// The coarsest unit in which no value exceeds the time at which the counter wraps.
std::optional<TimeUnit> unit_within(double wrap_s, const ColumnSample& sample) {
  for (const TimeUnit& unit : {in_seconds, in_milliseconds, in_microseconds, in_nanoseconds})
    if (sample.most * unit.seconds * std::pow(10.0, unit.power) <= wrap_s) return unit;
  return {};
}

// For weather readings: the step does not tell the unit, but the size may.
TimeUnit unit_of_readings(const ColumnSample& sample) {
  if (is_mjd(sample) && sample.typical_step < 2.0) return in_days;
  constexpr double unix_milliseconds = 1e11; // 1973; as seconds, the year 5000
  return sample.least > unix_milliseconds ? in_milliseconds : in_seconds;
}

// The unusual units that numbers without a unit may have, by their median.
struct UnitBySize {
  ColumnRole role;
  double least, most;
  std::string_view unit, in_words;
};
constexpr std::array<UnitBySize, 6> units_by_size{{{ColumnRole::temperature, 45.0, 120.0, "f", "°F"},
                                                   {ColumnRole::temperature, 230.0, 330.0, "k", "K"},
                                                   {ColumnRole::pressure, 20.0, 33.0, "inhg", "inHg"},
                                                   {ColumnRole::pressure, 50.0, 110.0, "kpa", "kPa"},
                                                   {ColumnRole::pressure, 5e4, 1.1e5, "pa", "Pa"},
                                                   {ColumnRole::humidity, 0.0, 1.0, "1", "parts of one"}}};

} // namespace

std::optional<TimeUnit> unit_for_step(double step, const ColumnSample& sample) {
  if (step >= 0.01 && step < 100.0) return in_seconds;
  if (step >= 100.0 && step < 2e4) return in_milliseconds;
  if (step >= 2e4 && step < 5e7) return in_microseconds;
  if (step >= 5e7 && step < 1e11) return in_nanoseconds;
  if (is_mjd(sample) && step > 0.02 / 86400.0 && step < 1e-3) return in_days;
  return {};
}

// Looks again at times that are dates, now that the order of day and month is known.
void Detection::sample_dates(std::size_t time) {
  LogColumn& column = layout_.columns[time];
  column.unit = days_alone_ ? in_days : in_seconds;
  const DateColumns from{time, layout_.find(ColumnRole::date), days_alone_};
  samples_[time] = head_.sample_of_dates(from, layout_.month_first ? DateOrder::month_first
                                                                   : DateOrder::day_first);
}

void Detection::settle_times() {
  const auto at = layout_.find(ColumnRole::time);
  if (at) {
    const ColumnSample& sample = samples_[*at];
    layout_.date_begins_run = layout_.find(ColumnRole::date) && is_number(*at);
    layout_.calendar =
        is_calendar(*at) || days_alone_ || (layout_.find(ColumnRole::date) && !is_number(*at));
    const bool date = sample.has_date || days_alone_ || layout_.find(ColumnRole::date);
    if (date) settle_date_order(layout_.find(ColumnRole::date).value_or(*at));
    if (date && layout_.calendar) sample_dates(*at);
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
    if (!options_.tau0_s) settle_tau0();
  if (layout_.format == LogFormat::ticktock) settle_counter();
  settle_angle_unit();
  settle_weather_units();
  if (at && layout_.find(ColumnRole::clock_error)) {
    const TimeUnit unit = layout_.calendar ? in_seconds : layout_.columns[*at].unit;
    const double step = samples_[*at].typical_step * unit.seconds * std::pow(10.0, unit.power);
    const bool label = layout_.format == LogFormat::clock_error || std::fmod(step, 0.25) == 0.0;
    if (label && step > 0.0 && step < 1e9) layout_.label_step_s = step;
  }
  if (at) refuse_what_was_not_measured(*at);
  if (at && layout_.format != LogFormat::angle) refuse_unread_samples(*at);
  if (layout_.format != LogFormat::angle) return;
  for (std::size_t i = 0; i < samples_.size(); ++i)
    if (layout_.columns[i].role == ColumnRole::ignored && samples_[i].smooth &&
        samples_[i].crossings >= 3)
      layout_.swinging = i;
}

// The frequency of the counter, and the column that shows where rows were lost.
void Detection::settle_counter() {
  layout_.counter_hz = options_.counter_hz.value_or(usual_counter_hz);
  if (options_.counter_hz)
    for (LogColumn& column : layout_.columns)
      if (column.role == ColumnRole::counter_rate) column.role = ColumnRole::ignored;
  const auto measured = layout_.find(ColumnRole::counter_rate);
  if (measured)
    assume(fmt::format("the counter's rate is that of column {}, {}", *measured + 1,
                       shown(layout_.columns[*measured].name)),
           Setting::counter_rate);
  else if (!options_.counter_hz)
    assume(fmt::format("the counter runs at {:.0f} Hz", usual_counter_hz), Setting::counter_rate);
  for (std::size_t i = 0; i < layout_.columns.size(); ++i)
    if (layout_.columns[i].name == "pps_seq_row") layout_.coarse_time = i;
}

// Refuses times much closer together than beats if a column that swings has no known name: they are
// times of samples.
void Detection::refuse_unread_samples(std::size_t time) const {
  const TimeUnit& unit = layout_.columns[time].unit;
  const double step_s = samples_[time].typical_step * unit.seconds * std::pow(10.0, unit.power);
  constexpr double shortest_beat_s = 0.08; // of a fast watch
  if (!(step_s > 0.0 && step_s < shortest_beat_s) || options_.format || !options_.columns.empty())
    return;
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    if (layout_.columns[i].role != ColumnRole::ignored || !samples_[i].smooth ||
        samples_[i].crossings < 3)
      continue;
    const std::string& name = layout_.columns[i].name;
    const bool turns = names_turning_speed(name);
    OtherReading other{.words = fmt::format("column {} holds the angle", i + 1),
                       .columns = {fmt::format("angle={}", i + 1)}};
    if (turns) {
      other.words = "the times at which that is 0 are wanted, without amplitudes (over 2π/T, T the "
                    "period, such a speed is nearly an angle)";
      other.columns = {fmt::format("position={}", i + 1)};
    }
    throw ImpossibleReading(log_.place(head_.rows.front().number),
                            fmt::format("times {:.3g} s apart beside column {}, {}which swings{}",
                                        step_s, i + 1, name.empty() ? "" : shown(name) + ", ",
                                        turns ? " and is a speed of turning, no angle" : ""),
                            "beats, or samples of an angle", {std::move(other)});
  }
}

// The order of day and month in dates with strokes. A date that exists in one order only settles it;
// otherwise the number that changes from day to day is the day.
void Detection::settle_date_order(std::size_t column) {
  std::size_t strokes = 0, day_first = 0, month_first = 0;
  std::set<std::string> firsts, seconds;
  std::vector<Field> fields;
  for (const HeadLine& row : head_.rows) {
    split_fields(row.text, head_.separator, fields);
    if (column >= fields.size()) continue;
    const std::string_view text = fields[column].text;
    const std::string date(text.substr(0, text.find_first_of(" Tt")));
    const std::size_t one = date.find('/');
    if (one == std::string::npos || one > 2) continue;
    const auto is_date = [&](DateOrder order) {
      return parse_calendar(date + " 0:0", '.', order).has_value() ? 1U : 0U;
    };
    ++strokes;
    day_first += is_date(DateOrder::day_first);
    month_first += is_date(DateOrder::month_first);
    firsts.insert(date.substr(0, one));
    seconds.insert(date.substr(one + 1, date.find('/', one + 1) - one - 1));
  }
  if (strokes == 0) return;
  layout_.month_first = options_.month_first.value_or(
      month_first != day_first ? month_first > day_first : seconds.size() > firsts.size());
  if (options_.month_first || month_first != day_first || firsts.size() != seconds.size()) return;
  assume("in dates such as 03/04/2013 the day comes first", Setting::date_order, "month");
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
        log_.place(first.number),
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
        log_.place(first.number),
        fmt::format("whole numbers exactly {} apart for times", sample.typical_step),
        "times that were measured",
        {{.words = fmt::format("column {} is the clock's error at each label", i + 1),
          .columns = {column("time", time), column("error", i)}},
         {.words = fmt::format("column {} holds the times", i + 1),
          .columns = {column("time", i)}}});
  }
}

// Whether the user gave a unit for the column of this role.
bool Detection::unit_is_given(ColumnRole role) const {
  return std::any_of(options_.columns.begin(), options_.columns.end(), [&](const auto& word) {
    return word.starts_with(fmt::format("{}=", name_of(role))) &&
           word.find(':') != std::string::npos;
  });
}

// Refuses a unit that is given for a column whose name states another, if the name's makes the step
// a beat and the given one does not.
void Detection::refuse_other_unit(const LogColumn& column, double step) const {
  constexpr double shortest_s = 0.01, longest_s = 100.0; // of a pendulum's beats, with some margin
  const auto beat_s = [&](const TimeUnit& unit) {
    return step * unit.seconds * std::pow(10.0, unit.power);
  };
  const auto is_beat = [&](double s) { return s > shortest_s && s < longest_s; };
  const double named_s = beat_s(column.unit), given_s = beat_s(*options_.unit);
  if (options_.weather || !is_beat(named_s) || is_beat(given_s)) return;
  const HeadLine& line = head_.titles.empty() ? head_.rows.front() : head_.titles.back();
  throw InputError(log_.place(line.number),
                   fmt::format("column {}, in {} by its name, which makes steps of {} s",
                               shown(column.name), name_of(column.unit), readable(named_s, 3)),
                   fmt::format("times in {}, as was said: steps of {} s", name_of(*options_.unit),
                               readable(given_s, 3)));
}

void Detection::settle_unit(LogColumn& column, const ColumnSample& sample) {
  const auto index = static_cast<std::size_t>(&column - layout_.columns.data());
  if (options_.unit) {
    if (index < stated_unit_.size() && stated_unit_[index])
      refuse_other_unit(column, sample.typical_step);
    column.unit = *options_.unit;
    return;
  }
  if (unit_is_given(column.role) || layout_.format == LogFormat::clock_error || layout_.format == LogFormat::angle)
    return;
  const bool stated = index < stated_unit_.size() && stated_unit_[index];
  // Readings on a grid, as those of the weather, may be days apart.
  const bool on_grid = layout_.find(ColumnRole::phase) || layout_.find(ColumnRole::frequency);
  if (stated && (options_.weather || on_grid)) return;
  const auto likely = options_.weather ? unit_of_readings(sample)
                      : options_.wrap_s && *options_.wrap_s > 0.0 && column.role == ColumnRole::time
                          ? unit_within(*options_.wrap_s, sample)
                          : unit_for_step(sample.typical_step, sample);
  if (!likely || *likely == column.unit) return;
  const double own = column.unit.seconds * std::pow(10.0, column.unit.power);
  const double step_s = sample.typical_step * own;
  if (stated && step_s > 0.01 && step_s < 4000.0) return; // unusual but possible
  assume(stated
             ? fmt::format("the header's unit ({}) would make a beat of {} s: {} taken",
                           name_of(column.unit), readable(step_s, 3), name_of(*likely))
             : fmt::format("times are in {}", *likely == in_days ? std::string_view("days, as MJD")
                                                                 : name_of(*likely)),
         Setting::unit);
  column.unit = *likely;
}

// The spacing of phase or frequency values: the step of a time column, or else the nominal period,
// or else 1 s.
void Detection::settle_tau0() {
  const auto time = layout_.find(ColumnRole::time);
  if (time && samples_[*time].typical_step > 0.0) { // not for days alone, without a time of day
    const TimeUnit unit = layout_.calendar ? in_seconds : layout_.columns[*time].unit;
    const double step_s = samples_[*time].typical_step * unit.seconds * std::pow(10.0, unit.power);
    const double whole_s = std::round(step_s);
    constexpr double rounding = 2e-4; // relative: half an hour in days with five decimals
    layout_.tau0_s = std::abs(step_s - whole_s) < rounding * step_s ? whole_s : step_s;
    return assume(fmt::format("one value every {:.9g} s, the step of the times", layout_.tau0_s),
                  Setting::tau0);
  }
  if (options_.nominal_period_s) return;
  const bool timed = head_.columns >= 2 && is_number(0) && samples_[0].rising > 0.9;
  const auto unit = timed ? unit_for_step(samples_[0].typical_step, samples_[0]) : std::nullopt;
  const bool second =
      layout_.find(ColumnRole::phase) != 0 && layout_.find(ColumnRole::frequency) != 0;
  if (unit && second) {
    layout_.tau0_s = samples_[0].typical_step * unit->seconds * std::pow(10.0, unit->power);
    assume(fmt::format("one value every {:.6g} s, the step of the first column", layout_.tau0_s),
           Setting::tau0);
  } else {
    assume("one value per second", Setting::tau0);
    if (!options_.format && layout_.find(ColumnRole::phase))
      assume("the values are the clock's error, neither periods nor frequencies", Setting::format);
  }
}

void Detection::settle_weather_units() {
  for (std::size_t i = 0; i < layout_.columns.size(); ++i) {
    if (i < stated_unit_.size() && stated_unit_[i]) continue;
    LogColumn& column = layout_.columns[i];
    if (unit_is_given(column.role)) continue;
    for (const UnitBySize& entry : units_by_size) {
      const double median = samples_[i].median;
      if (entry.role != column.role || !(median > entry.least && median < entry.most)) continue;
      (void)set_unit(column, entry.unit);
      const std::string_view role = name_of(column.role);
      assume(fmt::format("the {} is in {}", role, entry.in_words), Setting::columns,
             fmt::format("{}=N:UNIT", role));
    }
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

} // namespace goingrate
