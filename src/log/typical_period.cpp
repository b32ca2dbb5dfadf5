#include "typical_period.hpp"

#include "beat_noise.hpp"
#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace goingrate {

namespace {

constexpr std::size_t most_sampled = 100'000; // three medians of so many take some milliseconds
constexpr std::size_t stretches = 20;
constexpr double normal_from_mad = 1.4826; // standard deviation over median absolute deviation
// A jitter of 1 % of the period moves intervals by 1.4 %; seven times that is still one period.
constexpr double widest_share = 0.1;

// Intervals between neighbouring upward crossings; NaN where a stretch ends.
std::vector<double> sampled_intervals(std::span<const Beat> events) {
  std::vector<double> intervals;
  for (const Stretch& stretch : sample_stretches(events.size())) {
    const Beat* last = nullptr;
    for (const Beat& event : events.subspan(stretch.first, stretch.size())) {
      if (event.edge == Edge::down) continue;
      if (last != nullptr) intervals.push_back(event.time - last->time);
      last = &event;
    }
    intervals.push_back(std::numeric_limits<double>::quiet_NaN());
  }
  return intervals;
}

} // namespace

std::vector<Stretch> sample_stretches(std::size_t size) {
  if (size <= most_sampled) return {{0, size}};
  std::vector<Stretch> sample;
  const std::size_t length = most_sampled / stretches;
  for (std::size_t k = 0; k < stretches; ++k) {
    const std::size_t first = k * (size - length) / (stretches - 1);
    sample.push_back({first, first + length});
  }
  return sample;
}

double median(std::span<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

TypicalPeriod typical_period(std::span<const Beat> events, const std::string& source) {
  const auto intervals = sampled_intervals(events);
  std::vector<double> work;
  std::copy_if(intervals.begin(), intervals.end(), std::back_inserter(work),
               [](double interval) { return !std::isnan(interval); });
  if (work.size() < 2)
    throw InputError({source, 1, 1},
                     fmt::format("{} upward crossings", events.empty() ? 0 : work.size() + 1),
                     "at least 3");
  // Missed and spurious events put intervals far from the bulk; the median sits inside it.
  const double centre = median(work);
  constexpr double shortest_s =
      1e-9; // no pendulum swings so fast, and its square is still a number
  if (!(centre >= shortest_s))
    throw InputError({source, events[1].line, 1}, "two events at one time in most places",
                     "times that increase");
  double sum = 0.0;
  std::vector<double> second;
  work.clear();
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    const double deviation = intervals[i] - centre;
    if (!(std::abs(deviation) <= widest_share * centre)) continue;
    sum += deviation;
    work.push_back(std::abs(deviation));
    if (i > 0 && std::abs(intervals[i - 1] - centre) <= widest_share * centre)
      second.push_back(intervals[i] - intervals[i - 1]);
  }
  TypicalPeriod typical;
  typical.mean_s = centre + sum / static_cast<double>(work.size());
  typical.scatter_s = normal_from_mad * median(work);
  typical.second_s2 =
      second.empty() ? 2.0 * typical.scatter_s * typical.scatter_s : trimmed_mean_square(second);
  return typical;
}

} // namespace goingrate
