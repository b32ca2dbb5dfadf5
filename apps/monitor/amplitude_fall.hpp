// Detects a falling amplitude of a clock.
#pragma once

#include "daily_wave.hpp"
#include "step_alarm.hpp"

#include <cstdint>
#include <deque>
#include <optional>

namespace goingrate::apps {

/// Finds two kinds of fall. A sudden one is a step of the amplitude's logarithm, for which
/// StepAlarm looks. A slow one is found from the changes between daily means (8 to 32 of them) or
/// weekly means (4 or 8): it is a fall if these changes exceed the fall due to a season by more
/// than those of a random walk would (Student's t; limit: 0.2 false alarms per year). A season
/// changes the amplitude by at most 2 ‰ per day, which is ± 10 % in a year. Each fall is reported
/// once: it is over when more than half of it has been regained, or when the amplitude has not
/// fallen for a month (AmplitudeFallTest).
class AmplitudeFall {
public:
  struct Found {
    double size = 0.0, sigma = 0.0; ///< how far it fell: positive
    std::int64_t minutes = 0;       ///< the longest possible duration of the fall
  };

  /// The mean of the minute that begins `minute` minutes after 1970; nothing if it is not known.
  std::optional<Found> add(std::int64_t minute, std::optional<double> mean);
  /// Whether a fall has been found and is not over.
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
  std::int64_t day_ = 0;                    // the present one
  double day_sum_ = 0.0;
  std::int64_t day_minutes_ = 0;
  bool day_has_fall_ = false;
  std::deque<double> days_;         // the means of the last ones
  std::optional<double> old_level_; // before the fall that is not over
  double lowest_ = 0.0;             // since then
  std::int64_t days_without_fall_ = 0;
};

} // namespace goingrate::apps
