// Where and how rate and amplitude change suddenly. Private to the causes room.
//
// A change at t0 makes, of h = 0 before and 1 after, and a = h (1 - exp(-(t - t0)/T)):
//   regulation:  r = b h;
//   drive:       r = b h + c a,   amplitude = e a;
//   friction:    r = c a,         amplitude = e a:
// the squared amplitude approaches its new level exponentially, a torque turns the clock at once,
// and friction only by way of the amplitude.
#pragma once

#include "account.hpp"

#include "goingrate/causes/diary.hpp"

#include <limits>

namespace goingrate::timing_model {

/// A change at a place in blocks, the time constant of what follows, and what they gain.
struct FittedStep {
  double place = 0.0, time_s = 0.0;
  double gain = -std::numeric_limits<double>::infinity();
  Courses courses; ///< the rate's first course is h, or a for friction
};

/// Changes about a place that may be off by some blocks, beside what an account has taken.
class StepSearch {
public:
  StepSearch(const Account& account, const RateBlocks& blocks, double place, double doubt);
  /// The place and the time constant that suit a kind best.
  [[nodiscard]] FittedStep best(ChangeKind kind) const;

private:
  [[nodiscard]] FittedStep at(ChangeKind kind, double place, double log_time) const;

  const Account& account_;
  CourseMaker make_;
  double block_s_, place_, doubt_, last_log_time_;
};

} // namespace goingrate::timing_model
