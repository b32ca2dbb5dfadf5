// Recognises the format of a log without a header that names its columns, from the first lines.
#include "detection.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace goingrate {

bool Detection::looks_like_clock_error() const {
  // Whole-number labels that advance with the lines, and an error that is much smaller. A
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
    if (is_calendar(i) || is_edge(i)) return LogFormat::table;
  if (timed || !options_.columns.empty()) return LogFormat::table;
  const HeadLine& first = head_.rows.front();
  if (are_days(0) && is_number(1))
    throw ImpossibleReading(log_.place(first.number), shown(first.text), "a known layout",
                            {{.words = "column 2 is the clock's error on each date",
                              .columns = {"time=1", "error=2"}}});
  throw ImpossibleReading(log_.place(first.number), shown(first.text), "a known layout",
                          {{.words = "column 1 holds the times", .columns = {"time=1"}},
                           {.words = "column 1 holds periods", .columns = {"period=1"}}});
}

bool is_steady(const ColumnSample& sample) {
  constexpr double least_rising = 0.6, least_falling = 0.7; // of the steps
  return sample.rising > least_rising || sample.falling > least_falling;
}

bool Detection::are_alike(const ColumnSample& sample) const {
  constexpr double largest_spread = 0.2; // of the median
  return sample.least >= 0.0 && sample.spread < largest_spread * sample.median &&
         (options_.unit || unit_for_step(sample.median, sample));
}

LogFormat Detection::format_of_one_column() const {
  const ColumnSample& only = samples_.front();
  if (!parse_number(first_[0].text, layout_.point)) {
    const HeadLine& first = head_.rows.front();
    throw InputError(log_.place(first.number), shown(first.text), "one time per line");
  }
  const bool steady = !is_number(0) || is_steady(only);
  const bool beats = !is_number(0) || options_.unit || unit_for_step(only.typical_step, only);
  if ((steady && beats) || options_.wrap_s) return LogFormat::timestamps;
  // Periods of one clock are nearly equal, whereas a clock's error has no typical value.
  if (are_alike(only)) return LogFormat::periods;
  if (only.whole && only.least >= 0.0 && only.most > 100.0) {
    const HeadLine& first = head_.rows.front();
    throw ImpossibleReading(
        log_.place(first.number),
        fmt::format("whole numbers that do not rise, from {}", shown(first.text)), "times",
        {{.words = "they are microseconds of a counter of 16 bits that overflows within a beat of "
                   "1 s",
          .nominal_period_s = 1.0,
          .wrap_s = 0.065536}});
  }
  return LogFormat::phase;
}

} // namespace goingrate
