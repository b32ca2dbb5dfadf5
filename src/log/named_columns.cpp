// What the names of columns and the lines below them say together: dates, periods, a gate's state.
#include "detection.hpp"

#include "column_names.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace goingrate {

// The first column of dates alone that the header calls a time.
std::optional<std::size_t> Detection::named_days() const {
  for (std::size_t i = 0; i < layout_.columns.size(); ++i)
    if (are_days(i) && layout_.columns[i].role == ColumnRole::ignored &&
        column_named(layout_.columns[i].name).column.role == ColumnRole::time)
      return i;
  return {};
}

// Dates alone that stand for the times belong to the times of day behind them. Without any, they
// date readings of the clock's error, which changes little within a day, but no beats.
void Detection::settle_dates() {
  const auto has = [&](ColumnRole role) { return layout_.find(role).has_value(); };
  auto at = layout_.find(ColumnRole::time);
  if (!at && !is_timed()) at = named_days();
  if (!at || !are_days(*at) || has(ColumnRole::date)) return;
  const std::size_t next = *at + 1;
  if (is_calendar(next) && !samples_[next].has_date) {
    set(*at, ColumnRole::date);
    return set(next, ColumnRole::time);
  }
  if (!has(ColumnRole::clock_error)) {
    const HeadLine& row = head_.rows.front();
    throw InputError(log_.place(row.number),
                     fmt::format("dates without a time of day: {}", shown(row.text)),
                     "dates with a time of day, or the clock's error beside each date");
  }
  set(*at, ColumnRole::time);
  layout_.columns[*at].unit = in_days;
  days_alone_ = true;
  assume(
      "the dates have no time of day: the clock is taken to have been read at the same time each "
      "day");
}

// Two columns whose header says that they are dates and the clock's error at them; whether it does.
bool Detection::settle_dated_phases() {
  if (head_.columns != 2 || head_.names.size() != 2) return false;
  if (options_.format && *options_.format != LogFormat::phase) return false;
  const auto named = dated_phases_named(head_.names[0], head_.names[1]);
  if (!named || !(samples_[0].typical_step > 0.0)) return false;
  layout_.columns = {named->date, named->phase};
  stated_unit_.assign(2, true);
  return true;
}

// Whether a light gate's flag is in it where its state is 1: it is there for the shorter time.
bool Detection::is_covered_at_one(std::size_t time, std::size_t state) const {
  std::array<double, 2> lasted{};
  std::optional<double> since;
  std::size_t before = 0;
  std::vector<Field> fields;
  for (const HeadLine& row : head_.rows) {
    split_fields(row.text, layout_.separator, fields);
    if (std::max(time, state) >= fields.size()) continue;
    const auto calendar = parse_calendar(fields[time].text, layout_.point);
    const auto at = calendar ? std::optional(calendar->time.to_double())
                             : parse_number(fields[time].text, layout_.point);
    if (!at) continue;
    if (since && *at > *since) lasted[before] += *at - *since;
    since = at;
    before = fields[state].text == "1" ? 1 : 0;
  }
  return lasted[1] <= lasted[0];
}

// The state of a light gate, where it changes in nearly every line; how many columns got a role.
std::size_t Detection::settle_gate_state() {
  const auto time = layout_.find(ColumnRole::time);
  if (!time || layout_.find(ColumnRole::edge)) return 0;
  for (std::size_t i = 0; i < layout_.columns.size(); ++i) {
    const ColumnSample& sample = samples_[i];
    LogColumn& column = layout_.columns[i];
    constexpr double least_changes = 0.9; // of the lines: some edges may be lost
    const bool is_state = sample.numbers == sample.rows && sample.whole && sample.least == 0.0 &&
                          sample.most == 1.0 &&
                          static_cast<double>(sample.crossings) >=
                              least_changes * static_cast<double>(sample.rows - 1);
    if (column.role != ColumnRole::ignored || !names_gate_state(column.name) || !is_state) continue;
    const bool one = is_covered_at_one(*time, i);
    set(i, ColumnRole::edge, one ? 1.0 : 0.0);
    assume(fmt::format("column {}, {}, is the state of a light gate, {} where the flag is in it",
                       i + 1, shown(column.name), one ? 1 : 0),
           Setting::columns, "edge=N");
    return 1;
  }
  return 0;
}

// Refuses whole numbers in twice as many columns as the header names: commas are both the decimal
// points and the separators, and how the columns were meant cannot be told.
void Detection::refuse_double_commas() const {
  const std::size_t names = names_.size();
  const bool whole = std::all_of(samples_.begin(), samples_.end(), [](const ColumnSample& sample) {
    return sample.numbers == sample.rows && sample.whole;
  });
  if (layout_.separator != ',' || names < 2 || head_.columns != 2 * names || !whole) return;
  const HeadLine& row = head_.rows.front();
  throw InputError(
      log_.place(row.number),
      fmt::format("whole numbers in {} columns below a header of {}: {}", head_.columns, names,
                  shown(row.text)),
      "another sign between the columns (';' or a tab) where commas are decimal points");
}

// Numbers of one size that do not rise are periods, also under a name such as "T (s)".
void Detection::settle_named_periods() {
  const auto at = layout_.find(ColumnRole::time);
  const bool others =
      std::any_of(layout_.columns.begin(), layout_.columns.end(), [](const LogColumn& column) {
        return column.role != ColumnRole::ignored && column.role != ColumnRole::time;
      });
  if (!at || others || options_.wrap_s || options_.weather || !is_number(*at)) return;
  const ColumnSample& sample = samples_[*at];
  constexpr std::size_t fewest_lines = 4; // to see that they do not rise
  if (sample.numbers < fewest_lines || is_steady(sample) || !are_alike(sample)) return;
  layout_.columns[*at].role = ColumnRole::period;
  assume(fmt::format("column {}, {}, holds periods: its values are alike and do not rise", *at + 1,
                     shown(layout_.columns[*at].name)),
         Setting::columns, "time=N");
}

} // namespace goingrate
