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
  /// What is beyond it: larger by half, as where a clock is wound three days late, and, where weeks
  /// differ much, by twice as much as the habit is larger than the middle week. Of weeks that
  /// follow Gumbel's law, as largest ones do, it is beyond in one of two hundred.
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
