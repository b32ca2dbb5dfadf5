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
#include <utility>
#include <vector>

namespace goingrate::timing_model {

/// A change at a place in blocks, the time constant of what follows, and what they gain.
struct FittedStep {
  double place = 0.0, time_s = 0.0;
  double gain = -std::numeric_limits<double>::infinity();
  Courses courses; ///< of sizes that begin with the change in the end
};

/// Changes about a place that may be off by some blocks, beside what an account has taken.
class StepSearch {
public:
  StepSearch(const Account& account, const RateBlocks& blocks, double place, double doubt);
  /// The place and the time constant that suit a kind best.
  [[nodiscard]] FittedStep best(ChangeKind kind) const;
  /// The sizes of a step's courses, their sigmas with those of its place and time constant.
  [[nodiscard]] Sizes sizes_of(ChangeKind kind, const FittedStep& step) const;

private:
  [[nodiscard]] FittedStep at(ChangeKind kind, double place, double log_time) const;
  [[nodiscard]] Courses courses_of(ChangeKind kind, double place, double log_time,
                                   int powers) const;

  const Account& account_;
  CourseMaker make_;
  double block_s_, place_, doubt_, last_log_time_;
};

/// What a step at each block, or from one block to another, would explain beside what an account
/// has taken, in noise as it is now: the score of all places at once.
class StepScan {
public:
  StepScan(const Account& account, const RateBlocks& blocks);
  /// Blocks at which a step explains most, at least `apart` from each other.
  [[nodiscard]] std::vector<std::size_t> best_steps(std::size_t most, std::size_t apart) const;
  /// From where to where the rate explains most if it is different meanwhile.
  [[nodiscard]] std::pair<std::size_t, std::size_t> best_visit() const;

private:
  static constexpr std::size_t rim = 2; // blocks: a step so near an end is a bad block
  std::vector<double> of_step_;         // from the rim on
  Eigen::MatrixXd rate_products_;       // of the steps with each other, last the rate
};

/// A rate that is different for a while.
struct FittedVisit {
  double from = 0.0, to = 0.0; ///< in blocks
  Courses courses;
};
FittedVisit fitted_visit(const Account& account, const RateBlocks& blocks, std::size_t from,
                         std::size_t to);

} // namespace goingrate::timing_model
