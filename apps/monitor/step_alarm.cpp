#include "step_alarm.hpp"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

namespace goingrate::apps {

namespace {

constexpr std::size_t scale_count = 13;
constexpr std::size_t compared_means = 8;
constexpr double fewest_differences = 16.0, most_differences = 400.0;
constexpr std::int64_t minutes_a_week = 10080;
constexpr double minutes_a_year = 525960.0;

std::int64_t minutes_of(std::size_t scale) { return std::int64_t{1} << scale; }

double memory_of(std::size_t scale) {
  return std::max(most_differences, 4.0 * static_cast<double>(minutes_a_week / minutes_of(scale)));
}

// Differences from the same earlier means are not independent, at worst all from the same eight.
double limit(std::size_t scale, double differences, double false_alarms_a_year) {
  constexpr double overlap = 8.0;
  const double tests_a_year = minutes_a_year / static_cast<double>(minutes_of(scale));
  const double probability = false_alarms_a_year / static_cast<double>(scale_count) / tests_a_year;
  const boost::math::students_t t(differences / overlap);
  return boost::math::quantile(boost::math::complement(t, 0.5 * probability));
}

} // namespace

void StepAlarm::Scale::pass(Learnt& learnt) {
  learnt(sum);
  learnt(count);
  learnt(before);
  learnt(square);
  learnt(differences);
  learnt(limit);
  rises.pass(learnt);
  falls.pass(learnt);
}

void StepAlarm::pass(Learnt& learnt) {
  for (Scale& scale : scales_)
    scale.pass(learnt);
  learnt(minutes_raised_);
  learnt(minutes_heard_);
}

StepAlarm::StepAlarm(double usual_step, double false_alarms_a_year)
    : usual_step_(usual_step), false_alarms_a_year_(false_alarms_a_year), scales_(scale_count) {}

std::optional<FoundStep> StepAlarm::add(std::optional<double> mean) {
  if (minutes_raised_ > 0) --minutes_raised_;
  if (!mean) return {};
  count_minute();
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
  if (found) begin_anew(*found);
  return found;
}

void StepAlarm::count_minute() {
  if (++minutes_heard_ % minutes_a_week != 0) return;
  for (Scale& s : scales_) {
    s.rises.end_week();
    s.falls.end_week();
  }
}

// From now on means are compared with the new level, and the step counts towards the habits.
void StepAlarm::begin_anew(const FoundStep& found) {
  for (Scale& s : scales_) {
    s.before.clear();
    s.sum = 0.0;
    s.count = 0;
    (found.size > 0.0 ? s.rises : s.falls).add(std::abs(found.size));
  }
  minutes_raised_ = static_cast<std::int64_t>(compared_means) * found.minutes;
}

bool StepAlarm::is_beyond(const Scale& s, double difference) const {
  constexpr std::int64_t settling_minutes = 3 * minutes_a_week;
  if (s.differences < fewest_differences || !(s.square > 0.0)) return false;
  const double size = std::abs(difference);
  double habitual = (difference > 0.0 ? s.rises : s.falls).limit();
  if (minutes_heard_ <= settling_minutes) habitual = std::max(habitual, 1.5 * usual_step_);
  return size > s.limit * std::sqrt(s.square) && size > habitual;
}

void StepAlarm::learn(std::size_t scale, double difference) {
  Scale& s = scales_[scale];
  if (s.differences < memory_of(scale)) {
    s.differences += 1.0;
    s.limit = limit(scale, s.differences, false_alarms_a_year_);
  }
  s.square += (difference * difference - s.square) / s.differences;
  (difference > 0.0 ? s.rises : s.falls).add(std::abs(difference));
}

std::optional<FoundStep> StepAlarm::add_to(std::size_t scale, double mean) {
  Scale& s = scales_[scale];
  if (s.before.size() == compared_means) {
    double level = 0.0;
    for (const double v : s.before)
      level += v / static_cast<double>(compared_means);
    const double difference = mean - level;
    if (is_beyond(s, difference))
      return FoundStep{difference, std::sqrt(s.square), level, minutes_of(scale)};
    learn(scale, difference);
    s.before.pop_front();
  }
  s.before.push_back(mean);
  return {};
}

} // namespace goingrate::apps
