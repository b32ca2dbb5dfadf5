// What a quantity does every week.
#pragma once

#include "learnt.hpp"

#include <array>
#include <cstddef>

namespace goingrate::apps {

/// The largest change of each of the last thirteen weeks. What was done in two of them is a habit,
/// as a jump of the rate when a clock is wound; what was done in one is an event. So the habit is
/// the second largest.
class WeeklyLargest {
public:
  void add(double size);
  void end_week();
  /// 0 until two weeks have had a change.
  [[nodiscard]] double habit() const;
  /// Where a change is beyond the habit: larger by half, as where a clock is wound three days late,
  /// or, where weeks differ much, by twice as much as the habit is above the median week. In weeks
  /// that follow Gumbel's law, as maxima do, one in two hundred is beyond.
  [[nodiscard]] double limit() const;

  void pass(Learnt& learnt) {
    for (double& size : largest_)
      learnt(size);
  }

private:
  static constexpr std::size_t weeks = 13; // a quarter: a clock wound once a month has been twice
  std::array<double, weeks> largest_{};    // the first is of the week that goes on
};

} // namespace goingrate::apps
