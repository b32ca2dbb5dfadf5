#include "time_columns.hpp"

namespace goingrate {

namespace {

bool is_mostly(std::size_t count, const ColumnSample& sample) { return count * 2 > sample.rows; }
bool is_date_alone(const ColumnSample& sample) { return is_mostly(sample.dates, sample); }
bool is_time_of_day(const ColumnSample& sample) {
  return is_mostly(sample.calendars, sample) && !sample.has_date;
}

// The first column of dates alone, and of times of day.
struct DateAndTime {
  std::size_t date, time;
};
std::optional<DateAndTime> date_and_time(std::span<const ColumnSample> samples) {
  std::optional<std::size_t> date, time;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!date && is_date_alone(samples[i])) date = i;
    if (!time && is_time_of_day(samples[i])) time = i;
  }
  if (!date || !time) return {};
  return DateAndTime{*date, *time};
}

std::size_t likely_time(std::span<const ColumnSample> samples) {
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (is_mostly(samples[i].calendars, samples[i])) return i;
  std::size_t first = 0; // column of numbers: words of a direction may stand before it
  while (first + 1 < samples.size() && is_mostly(samples[first].edges, samples[first]))
    ++first;
  if (samples.empty() || !counts_lines(samples[first])) return first;
  constexpr double least_rising_share = 0.9; // of the steps: a clock may be set back now and then
  for (std::size_t i = first + 1; i < samples.size(); ++i)
    if (is_mostly(samples[i].numbers, samples[i]) && samples[i].rising > least_rising_share)
      return i;
  return first;
}

// Finds, among the columns named as times, a pair in which one holds a date that stays the same for
// a run of lines and the other numbers that rise within the run.
std::optional<DateAndTime> run_and_time(std::span<const ColumnSample> samples,
                                        const Layout& layout) {
  std::vector<std::size_t> times;
  for (std::size_t i = 0; i < layout.columns.size(); ++i)
    if (layout.columns[i].role == ColumnRole::time) times.push_back(i);
  if (times.size() != 2) return {};
  for (const auto [date, time] :
       {DateAndTime{times[0], times[1]}, DateAndTime{times[1], times[0]}}) {
    const ColumnSample &dates = samples[date], &numbers = samples[time];
    const bool stays = is_mostly(dates.calendars, dates) && dates.has_date && dates.rising < 0.5;
    if (stays && is_mostly(numbers.numbers, numbers) && numbers.rising > 0.5)
      return DateAndTime{date, time};
  }
  return {};
}

} // namespace

bool counts_lines(const ColumnSample& sample) {
  constexpr std::size_t fewest_lines = 3; // lines to see it
  return sample.numbers >= fewest_lines && sample.numbers == sample.rows && sample.whole &&
         sample.typical_step == 1.0 && sample.rising == 1.0 &&
         sample.most - sample.least == static_cast<double>(sample.numbers - 1);
}

void guess_time(std::span<const ColumnSample> samples, Layout& layout) {
  if (const auto both = date_and_time(samples)) {
    layout.columns[both->date].role = ColumnRole::date;
    layout.columns[both->time].role = ColumnRole::time;
    return;
  }
  layout.columns[likely_time(samples)].role = ColumnRole::time;
}

std::vector<std::size_t> settle_named_times(std::span<const ColumnSample> samples, Layout& layout) {
  std::vector<std::size_t> unread;
  std::optional<std::size_t> date, time;
  if (const auto run = run_and_time(samples, layout)) {
    layout.columns[run->date].role = ColumnRole::date;
    return unread;
  }
  for (std::size_t i = 0; i < layout.columns.size(); ++i) {
    ColumnRole& role = layout.columns[i].role;
    if (role != ColumnRole::time) continue;
    role = ColumnRole::ignored;
    if (is_date_alone(samples[i])) {
      if (!date) date = i;
    } else if (time) {
      unread.push_back(i);
    } else {
      time = i;
    }
  }
  if (time) layout.columns[*time].role = ColumnRole::time;
  if (date && time && is_time_of_day(samples[*time])) layout.columns[*date].role = ColumnRole::date;
  return unread;
}

} // namespace goingrate
