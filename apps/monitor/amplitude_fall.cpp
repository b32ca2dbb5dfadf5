#include "amplitude_fall.hpp"

#include <algorithm>
#include <array>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <numeric>
#include <vector>

namespace goingrate::apps {

namespace {

constexpr std::int64_t minutes_a_day = 1440;
constexpr std::size_t winding_days = 8;   // a clock that is wound once a week has been wound
constexpr std::size_t fewest_changes = 3; // for a scatter worth the name
constexpr std::int64_t held_days = 32;    // then the level is the usual one
constexpr double season_a_day = 0.002;    // of the amplitude: 0.1 · 2π in 365 days, rounded up

// Changes from one mean to the next, of days or of weeks: a week contains the whole sag of a clock
// that is wound once a week.
struct Span {
  std::size_t changes, days;
};
constexpr std::array spans{Span{winding_days, 1}, Span{16, 1}, Span{32, 1}, Span{4, 7}, Span{8, 7}};
constexpr std::size_t days_of(const Span& span) { return (span.changes + 1) * span.days; }

double falling_limit(double changes) {
  constexpr double false_alarms_a_year = 0.2, days_a_year = 365.25;
  constexpr double probability =
      false_alarms_a_year / days_a_year / static_cast<double>(spans.size());
  const boost::math::students_t t(changes - 1.0);
  return boost::math::quantile(boost::math::complement(t, probability));
}

// Turns a step of the logarithm into a step of the amplitude.
FoundStep without_logarithm(const FoundStep& step) {
  const double level = std::exp(step.level);
  return {level * std::expm1(step.size), level * step.sigma, level, step.minutes};
}

} // namespace

void AmplitudeFall::pass(Learnt& learnt) {
  wave_.pass(learnt);
  steps_.pass(learnt);
  learnt(day_);
  learnt(day_sum_);
  learnt(day_minutes_);
  learnt(day_has_fall_);
  learnt(days_);
  learnt(old_level_);
  learnt(lowest_);
  learnt(days_without_fall_);
}

std::optional<AmplitudeFall::Found> AmplitudeFall::add(std::int64_t minute,
                                                       std::optional<double> mean) {
  if (mean && !(*mean > 0.0)) mean.reset();
  std::optional<Found> found;
  if (mean) found = add_to_day(minute / minutes_a_day, *mean);
  const auto logarithm = mean ? std::optional(std::log(*mean)) : std::nullopt;
  if (const auto jump = steps_.add(wave_.without(minute, logarithm))) {
    wave_.stepped(jump->size);
    const FoundStep step = without_logarithm(*jump);
    const double level = step.level + step.size;
    if (step.size > 0.0)
      stands_at(level);
    else if (const auto fast = fell({-step.size, step.sigma, 2 * step.minutes}, step.level, level))
      found = fast;
  }
  return found;
}

std::optional<AmplitudeFall::Found> AmplitudeFall::add_to_day(std::int64_t day, double mean) {
  std::optional<Found> found;
  if (day != day_) {
    found = end_day();
    day_ = day;
    day_sum_ = 0.0;
    day_minutes_ = 0;
    day_has_fall_ = found.has_value();
  }
  day_sum_ += mean;
  ++day_minutes_;
  return found;
}

std::optional<AmplitudeFall::Found> AmplitudeFall::end_day() {
  if (2 * day_minutes_ < minutes_a_day) return {}; // the mean of a part has the day's wave in it
  const double mean = day_sum_ / static_cast<double>(day_minutes_);
  days_.push_back(mean);
  if (days_.size() > days_of(spans.back())) days_.pop_front();
  if (!day_has_fall_) stands_at(mean); // else part of it is of the time before
  ++days_without_fall_;
  const auto found = fall_of_days();
  if (found) return fell(*found, mean + found->size, mean);
  if (days_without_fall_ >= held_days) old_level_.reset();
  return {};
}

std::optional<AmplitudeFall::Found> AmplitudeFall::fall_of_days() const {
  if (days_.size() < fewest_changes + 1) return {};
  // No sag between windings halves the amplitude, so a fall that would do so is reported earlier.
  const std::size_t known = days_.size() - 1;
  const double would_be_gone = (days_.front() - days_.back()) / static_cast<double>(known) *
                               static_cast<double>(winding_days);
  if (known < winding_days)
    return would_be_gone < 0.5 * days_.front() ? std::nullopt : fall_over(known, 1);
  for (const Span& span : spans)
    if (days_.size() >= days_of(span))
      if (const auto found = fall_over(span.changes, span.days)) return found;
  return {};
}

// A fall over `changes` changes between means of `days` days.
std::optional<AmplitudeFall::Found> AmplitudeFall::fall_over(std::size_t changes,
                                                             std::size_t days) const {
  std::vector<double> means;
  for (auto day = days_.end() - static_cast<std::ptrdiff_t>((changes + 1) * days);
       day != days_.end(); day += static_cast<std::ptrdiff_t>(days))
    means.push_back(std::accumulate(day, day + static_cast<std::ptrdiff_t>(days), 0.0) /
                    static_cast<double>(days));
  const auto count = static_cast<double>(changes);
  const double mean = (means.back() - means.front()) / count;
  double squares = 0.0;
  for (std::size_t i = 1; i < means.size(); ++i)
    squares += std::pow(means[i] - means[i - 1] - mean, 2);
  const double sigma = std::sqrt(squares / (count - 1.0) / count); // of the mean change
  const double season = season_a_day * static_cast<double>(days) * means.front();
  if (!(-mean - season > falling_limit(count) * sigma)) return {};
  return Found{-mean * count, sigma * count,
               minutes_a_day * static_cast<std::int64_t>((changes + 1) * days - 1)};
}

// A fall that continues counts as the same fall.
std::optional<AmplitudeFall::Found> AmplitudeFall::fell(const Found& found, double old_level,
                                                        double level) {
  days_without_fall_ = 0;
  day_has_fall_ = true;
  if (is_raised()) {
    lowest_ = std::min(lowest_, level);
    return {};
  }
  old_level_ = old_level;
  lowest_ = level;
  return found;
}

void AmplitudeFall::stands_at(double level) {
  if (!is_raised()) return;
  lowest_ = std::min(lowest_, level);
  if (*old_level_ - level < 0.5 * (*old_level_ - lowest_)) old_level_.reset();
}

} // namespace goingrate::apps
