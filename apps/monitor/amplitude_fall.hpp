// Whether the amplitude of a clock falls.
#pragma once

#include "daily_wave.hpp"
#include "step_alarm.hpp"

#include <cstdint>
#include <deque>
#include <optional>

namespace goingrate::apps {

/// Finds a fall that comes at once, as a step of the logarithm that StepAlarm looks for, and one
/// that goes on for days, as means of days or of weeks whose changes, 8 to 32 of days or 4 and 8 of
/// weeks, are further below those of a season than a random walk would be (Student's t of the
/// changes; limit: 0.2 false alarms a year). A season takes 2 ‰ of the amplitude a day at most,
/// which is ± 10 % in a year. One fall is found once: it is over when the amplitude has come back
/// by more than half of it, or has not fallen for a month (AmplitudeFallTest).
class AmplitudeFall {
public:
  struct Found {
    double size = 0.0, sigma = 0.0; ///< of the fall: positive
    std::int64_t minutes = 0;       ///< at most, from begin to end
  };

  /// The mean of the minute that begins `minute` minutes after 1970; nothing if it is not known.
  std::optional<Found> add(std::int64_t minute, std::optional<double> mean);
  /// Whether a fall was found that is not over.
  [[nodiscard]] bool is_raised() const { return old_level_.has_value(); }
  void pass(Learnt& learnt);

private:
  std::optional<Found> add_to_day(std::int64_t day, double mean);
  std::optional<Found> end_day();
  [[nodiscard]] std::optional<Found> fall_of_days() const;
  [[nodiscard]] std::optional<Found> fall_over(std::size_t changes, std::size_t days) const;
  std::optional<Found> fell(const Found& found, double old_level, double level);
  void stands_at(double level);

  DailyWave wave_;
  static constexpr double usual_fall = 0.1; // as in minutes of winding without maintaining power
  StepAlarm steps_{usual_fall};             // of the logarithm
  std::int64_t day_ = 0;                    // the one that goes on now
  double day_sum_ = 0.0;
  std::int64_t day_minutes_ = 0;
  bool day_has_fall_ = false;
  std::deque<double> days_;         // the means of the last ones
  std::optional<double> old_level_; // before the fall that is not over
  double lowest_ = 0.0;             // since then
  std::int64_t days_without_fall_ = 0;
};

} // namespace goingrate::apps
