// Whether a quantity that is measured once a minute has changed for good.
#pragma once

#include "weekly_largest.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

namespace goingrate::apps {

/// A change that was found.
struct FoundStep {
  double size = 0.0, sigma = 0.0;
  double level = 0.0;       ///< before it
  std::int64_t minutes = 0; ///< of the means that were compared
};

/// Looks for steps on scales of 1, 2, 4 … 4096 minutes: a mean is compared with those of the eight
/// before it, and the difference with what such differences were so far on that scale. So a clock
/// is judged by its own going, in two ways. Wander is in the mean square of the differences, which
/// has a memory of four weeks or 400 differences; the limit is the quantile of Student's t at which
/// all scales together give `false_alarms_a_year`. What comes seldom and is large, as the jump when
/// a clock is wound, is not in a mean square: a step is also to be 1.5 times as large as what the
/// clock did, in that direction and on that scale, in two of the last thirteen weeks. In the first
/// three weeks of a clock, when it was wound twice at least, its habits are not known: they are
/// taken to be `usual_step` (tests/studies/monitor.txt).
class StepAlarm {
public:
  explicit StepAlarm(double usual_step = 0.0, double false_alarms_a_year = 0.2);
  /// The mean of the next minute; nothing if it is not known.
  std::optional<FoundStep> add(std::optional<double> mean);
  /// Whether a step was found and the level since is not yet believed to hold.
  [[nodiscard]] bool is_raised() const { return minutes_raised_ > 0; }
  void pass(Learnt& learnt);

private:
  struct Scale {
    double sum = 0.0;
    std::size_t count = 0;     // minutes in the mean that is being made
    std::deque<double> before; // the means before it
    double square = 0.0;       // mean square of differences
    double differences = 0.0;  // how many are in that mean
    double limit = 0.0;        // in sigmas, for that many differences
    WeeklyLargest rises, falls;
    void pass(Learnt& learnt);
  };
  std::optional<FoundStep> add_to(std::size_t scale, double mean);
  [[nodiscard]] bool is_beyond(const Scale& scale, double difference) const;
  void learn(std::size_t scale, double difference);
  void begin_anew(const FoundStep& found);
  void count_minute();

  double usual_step_, false_alarms_a_year_;
  std::vector<Scale> scales_;
  std::int64_t minutes_raised_ = 0, minutes_heard_ = 0;
};

} // namespace goingrate::apps
