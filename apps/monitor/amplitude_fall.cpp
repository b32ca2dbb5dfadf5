#include "amplitude_fall.hpp"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

namespace goingrate::apps {

namespace {

constexpr std::int64_t minutes_a_day = 1440;
constexpr double winding_days = 8.0;      // a clock that is wound once a week has been wound
constexpr std::size_t fewest_changes = 3; // that have a scatter worth the name
constexpr std::size_t most_changes = 32;  // a month: what came before is another season
constexpr std::int64_t held_days = 32;    // then the level is the usual one

double falling_limit(double changes) {
  constexpr double false_alarms_a_year = 0.2, days_a_year = 365.25;
  const boost::math::students_t t(changes - 1.0);
  return boost::math::quantile(boost::math::complement(t, false_alarms_a_year / days_a_year));
}

} // namespace

std::optional<AmplitudeFall::Found> AmplitudeFall::add(std::int64_t minute,
                                                       std::optional<double> mean) {
  std::optional<Found> found;
  if (mean) found = add_to_day(minute / minutes_a_day, *mean);
  if (const auto step = steps_.add(wave_.without(minute, mean))) {
    wave_.stepped(step->size);
    const double level = step->level + step->size;
    if (step->size > 0.0)
      stands_at(level);
    else if (const auto fast =
                 fell({-step->size, step->sigma, 2 * step->minutes}, step->level, level))
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
  if (days_.size() > most_changes + 1) days_.pop_front();
  if (!day_has_fall_) stands_at(mean); // else part of it is of the time before
  ++days_without_fall_;
  const auto found = fall_of_days();
  if (found) return fell(*found, days_.front(), mean);
  if (days_without_fall_ >= held_days) old_level_.reset();
  return {};
}

std::optional<AmplitudeFall::Found> AmplitudeFall::fall_of_days() const {
  if (days_.size() < fewest_changes + 1) return {};
  const auto changes = static_cast<double>(days_.size() - 1);
  const double mean = (days_.back() - days_.front()) / changes;
  double squares = 0.0;
  for (std::size_t i = 1; i < days_.size(); ++i)
    squares += std::pow(days_[i] - days_[i - 1] - mean, 2);
  // No winding takes half of the amplitude: where so much would be gone it is not waited for.
  if (changes < winding_days && -mean * winding_days < 0.5 * days_.front()) return {};
  const double sigma = std::sqrt(squares / (changes - 1.0) / changes); // of the mean change
  if (!(-mean > falling_limit(changes) * sigma)) return {};
  return Found{-mean * changes, sigma * changes,
               minutes_a_day * static_cast<std::int64_t>(changes)};
}

// A fall that goes on is the same one.
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
