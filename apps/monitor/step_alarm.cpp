#include "step_alarm.hpp"

#include <boost/math/distributions/students_t.hpp>
#include <cmath>

namespace goingrate::apps {

namespace {

constexpr std::size_t scale_count = 13;
constexpr std::size_t compared_means = 8;
constexpr double fewest_differences = 16.0, most_differences = 400.0;
constexpr double minutes_a_year = 525960.0;

std::int64_t minutes_of(std::size_t scale) { return std::int64_t{1} << scale; }

// Differences from the same means before are alike: fewer of them count.
double limit(std::size_t scale, double differences, double false_alarms_a_year) {
  constexpr double overlap = 2.0;
  const double tests_a_year = minutes_a_year / static_cast<double>(minutes_of(scale));
  const double probability = false_alarms_a_year / static_cast<double>(scale_count) / tests_a_year;
  const boost::math::students_t t(differences / overlap);
  return boost::math::quantile(boost::math::complement(t, 0.5 * probability));
}

} // namespace

StepAlarm::StepAlarm(double false_alarms_a_year)
    : false_alarms_a_year_(false_alarms_a_year), scales_(scale_count) {}

std::optional<FoundStep> StepAlarm::add(std::optional<double> mean) {
  if (minutes_raised_ > 0) --minutes_raised_;
  if (!mean) return {};
  std::optional<FoundStep> found;
  for (std::size_t scale = 0; scale < scale_count; ++scale) {
    Scale& s = scales_[scale];
    s.sum += *mean;
    if (++s.count < static_cast<std::size_t>(minutes_of(scale))) continue;
    const double whole = s.sum / static_cast<double>(s.count);
    s.sum = 0.0;
    s.count = 0;
    if (const auto step = add_to(scale, whole); step && !found) found = step;
  }
  if (found) {
    for (Scale& s : scales_) { // the new level is one to compare with from now on
      s.before.clear();
      s.sum = 0.0;
      s.count = 0;
    }
    minutes_raised_ = static_cast<std::int64_t>(compared_means) * found->minutes;
  }
  return found;
}

std::optional<FoundStep> StepAlarm::add_to(std::size_t scale, double mean) {
  Scale& s = scales_[scale];
  std::optional<FoundStep> found;
  if (s.before.size() == compared_means) {
    double level = 0.0;
    for (const double v : s.before)
      level += v / static_cast<double>(compared_means);
    const double difference = mean - level, sigma = std::sqrt(s.square);
    if (s.differences >= fewest_differences && sigma > 0.0 &&
        std::abs(difference) > sigma * s.limit)
      return FoundStep{difference, sigma, level, minutes_of(scale)};
    if (s.differences < most_differences) {
      s.differences += 1.0;
      s.limit = limit(scale, s.differences, false_alarms_a_year_);
    }
    s.square += (difference * difference - s.square) / s.differences;
    s.before.pop_front();
  }
  s.before.push_back(mean);
  return found;
}

} // namespace goingrate::apps
