#include "typical_period.hpp"

#include "beat_noise.hpp"

#include "base/special_values.hpp"
#include "base/time_grain.hpp"
#include "goingrate/base/errors.hpp"
#include "goingrate/log/reading.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace goingrate {

namespace {

constexpr std::size_t stretches = 20;
constexpr double normal_from_mad = 1.4826; // standard deviation over median absolute deviation
// A jitter of 1 % of the period moves intervals by 1.4 %; seven times that is still one period.
constexpr double widest_share = 0.1;
// Periods in one interval that are still told apart: beyond, the period is not known well enough.
constexpr double most_periods = 8.0;

// Intervals between neighbouring upward crossings; NaN where a stretch ends or time goes back.
std::vector<double> sampled_intervals(std::span<const Beat> events) {
  std::vector<double> intervals;
  for (const Stretch& stretch : sample_stretches(events.size())) {
    const Beat* last = nullptr;
    for (const Beat& event : events.subspan(stretch.first, stretch.size())) {
      if (!may_be_up(event)) continue;
      const double interval = last == nullptr ? not_known : event.time - last->time;
      intervals.push_back(interval >= 0.0 ? interval : not_known);
      last = &event;
    }
    intervals.push_back(not_known);
  }
  return intervals;
}

// How many periods an interval holds, or 0 if it is not close to a whole number of them.
double periods_in(double interval_s, double period_s) {
  const double n = std::round(interval_s / period_s);
  const bool whole = n >= 1.0 && n <= most_periods &&
                     std::abs(interval_s - n * period_s) <= widest_share * period_s;
  return whole ? n : 0.0;
}

// If half of the beats or more are lost, the median interval holds several periods, or a false
// event. The commonest length is then a whole number of periods. The period is its shortest part to
// which one interval in ten is equal and of which eight in ten are multiples.
double shortest_length(std::vector<double> intervals, double median_s) {
  const auto share = [&](auto is_one) {
    return static_cast<double>(std::count_if(intervals.begin(), intervals.end(), is_one)) /
           static_cast<double>(intervals.size());
  };
  const auto near = [&](double length, double part) {
    return share([&](double interval) { return std::abs(interval - length) <= part * length; });
  };
  if (near(median_s, widest_share) > 0.5) return median_s;
  std::sort(intervals.begin(), intervals.end());
  double commonest = median_s;
  constexpr std::size_t lengths_tried = 20; // of which one at least is of the commonest length
  for (std::size_t k = 0; k < lengths_tried; ++k) {
    const double length = intervals[k * intervals.size() / lengths_tried];
    const bool possible = length > 0.02 * median_s; // and not two events at one time
    if (possible && near(length, 0.02) > near(commonest, 0.02)) commonest = length;
  }
  for (double part = most_periods; part > 1.0; --part) {
    const double period = commonest / part;
    const auto holds = [&](double interval) {
      const double n = std::round(interval / period);
      return n >= 1.0 && std::abs(interval - n * period) <= 0.05 * period; // by chance: one in ten
    };
    const auto is_shortest = [&](double interval) {
      return holds(interval) && interval < 1.5 * period;
    };
    if (share(is_shortest) > 0.1 && share(holds) > 0.8) return period;
  }
  return commonest;
}

// `lengths` are those of `intervals` that are known, and hold `periods` in all.
TypicalPeriod bulk_of(const std::vector<double>& intervals, std::vector<double> lengths,
                      double periods) {
  TypicalPeriod typical;
  typical.mean_step = periods / static_cast<double>(lengths.size());
  const double centre = median(lengths);
  double sum = 0.0;
  std::vector<double> deviations, second;
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    const double deviation = intervals[i] - centre;
    if (!(std::abs(deviation) <= widest_share * centre)) continue;
    sum += deviation;
    deviations.push_back(std::abs(deviation));
    if (i > 0 && std::abs(intervals[i - 1] - centre) <= widest_share * centre)
      second.push_back(intervals[i] - intervals[i - 1]);
  }
  typical.mean_s = centre + sum / static_cast<double>(deviations.size());
  typical.scatter_s = normal_from_mad * median(deviations);
  typical.second_s2 =
      second.empty() ? 2.0 * typical.scatter_s * typical.scatter_s : trimmed_mean_square(second);
  return typical;
}

[[noreturn]] void refuse_nominal(const std::string& source, std::size_t line, double median_s,
                                 double nominal_s) {
  throw ImpossibleReading(
      {source, line, 1}, fmt::format("events {:.6g} s apart", median_s),
      fmt::format("beats a whole number of nominal periods, {:.6g} s, apart", nominal_s),
      readings_for_period(median_s, nominal_s));
}

} // namespace

bool have_a_course(std::span<const double> periods) {
  std::vector<double> known, steps;
  for (std::size_t i = 0; i < periods.size(); ++i) {
    if (std::isfinite(periods[i])) known.push_back(periods[i]);
    const double step = i > 0 ? periods[i] - periods[i - 1] : not_known;
    if (std::isfinite(step)) steps.push_back(step);
  }
  constexpr std::size_t fewest = 8; // to tell a course from
  if (known.size() < fewest || steps.size() < fewest) return false;
  const double middle = median(known), spread = robust_sigma(known), step = robust_sigma(steps);
  constexpr double least_spread = 0.003, most_scatter = 0.1;
  return spread > least_spread * middle && step < most_scatter * spread;
}

bool may_be_wide_swings(double period_s, double nominal_s) {
  constexpr double widest = 1.6;
  return period_s > nominal_s && period_s < widest * nominal_s;
}

std::vector<Stretch> sample_stretches(std::size_t size, std::size_t most) {
  if (size <= most) return {{0, size}};
  std::vector<Stretch> sample;
  const std::size_t length = most / stretches;
  for (std::size_t k = 0; k < stretches; ++k) {
    const std::size_t first = k * (size - length) / (stretches - 1);
    sample.push_back({first, first + length});
  }
  return sample;
}

TypicalPeriod typical_period(std::span<const Beat> events, const std::string& source,
                             std::optional<double> nominal_s) {
  auto intervals = sampled_intervals(events);
  std::vector<double> work;
  std::copy_if(intervals.begin(), intervals.end(), std::back_inserter(work),
               [](double interval) { return !std::isnan(interval); });
  if (work.size() < 2)
    throw InputError({source, 1, 1},
                     fmt::format("{} upward crossings", events.empty() ? 0 : work.size() + 1),
                     "at least 3");
  // Missed and spurious events make intervals far outside the bulk; the median is inside it.
  double centre = median(work);
  constexpr double shortest_s =
      1e-9; // no pendulum swings so fast, and its square is still a number
  if (!(centre >= shortest_s))
    throw InputError({source, events[1].line, 1}, "two events at one time in most places",
                     "times that increase");
  const double middle_s = centre;
  const double own = shortest_length(work, middle_s);
  const bool has_a_course = have_a_course(intervals);
  const bool wide = nominal_s && may_be_wide_swings(own, *nominal_s) && has_a_course;
  centre = wide ? own : nominal_s.value_or(own);
  double periods = 0.0;
  std::vector<double> lengths;
  for (double& interval : intervals) {
    const double n = std::isnan(interval) ? 0.0 : periods_in(interval, centre);
    interval = n > 0.0 ? interval / n : not_known;
    if (n > 0.0) lengths.push_back(interval);
    periods += n;
  }
  if (nominal_s && !wide &&
      static_cast<double>(lengths.size()) <= 0.05 * static_cast<double>(work.size()))
    refuse_nominal(source, events[1].line, middle_s, centre);
  TypicalPeriod typical = bulk_of(intervals, std::move(lengths), periods);
  typical.has_a_course = has_a_course;
  typical.grain_s = time_grain(std::min(events.size(), times_for_grain), typical.mean_s,
                               [&](std::size_t i) { return events[i].time - events[0].time; });
  return typical;
}

} // namespace goingrate
