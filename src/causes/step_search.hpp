// Search for sudden changes of rate and amplitude. Private to the causes room.
//
// A change at t0 gives, with h = 0 before it and 1 after, and a = h (1 - exp(-(t - t0)/T)):
//   regulation:  r = b h;
//   drive:       r = b h + c a,   amplitude = e a;
//   friction:    r = c a,         amplitude = e a.
// The squared amplitude approaches its new level exponentially. A torque changes the rate at once,
// friction only through the amplitude.
#pragma once

#include "account.hpp"

#include "goingrate/causes/diary.hpp"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

namespace goingrate::timing_model {

/// A change: its time in blocks, the time constant of the relaxation after it, and the gain.
struct FittedStep {
  double place = 0.0, time_s = 0.0;
  double gain = -std::numeric_limits<double>::infinity();
  Courses courses; ///< the first one's size is the lasting change
};

/// Fits a change near `place`, a time uncertain by `doubt` (both in blocks), in addition to the
/// causes an account has taken.
class StepSearch {
public:
  StepSearch(const Account& account, const RateBlocks& blocks, double place, double doubt);
  /// The best time and time constant for a kind.
  [[nodiscard]] FittedStep best(ChangeKind kind) const;
  /// The sizes of a step's courses. Their sigmas include those of its place and time constant.
  [[nodiscard]] Sizes sizes_of(ChangeKind kind, const FittedStep& step) const;

private:
  // Half the width of Brent's search, in the logarithm of the time constant.
  static constexpr double log_time_reach = 0.35;
  // Blocks between successive times that are tried.
  [[nodiscard]] double stride() const { return std::max(0.5, doubt_ / 4.0); }
  [[nodiscard]] FittedStep best_place(ChangeKind kind, double log_time,
                                      const FixedNoiseAccount& fixed) const;
  [[nodiscard]] FittedStep polished(ChangeKind kind, FittedStep step) const;
  // The step with as many powers of its relaxation as raise the gain. `gains`: an Account or
  // GrowingGains.
  template <class Gains>
  [[nodiscard]] FittedStep by(Gains& gains, ChangeKind kind, double place, double log_time) const;
  [[nodiscard]] FittedStep at(ChangeKind kind, double place, double log_time,
                              const FixedNoiseAccount& fixed) const;
  void add_power(int power, ChangeKind kind, double place, double log_time, Courses& courses) const;
  [[nodiscard]] Courses courses_of(ChangeKind kind, double place, double log_time,
                                   int powers) const;

  const Account& account_;
  CourseMaker make_;
  double block_s_, place_, doubt_, first_log_time_, last_log_time_;
};

/// Scores of a step at every block, and of a temporary change between any two, in addition to the
/// causes an account has taken and in its present noise. All scores are found together.
class StepScan {
public:
  StepScan(const Account& account, const RateBlocks& blocks);
  /// Blocks at which a step explains most, at least `apart` from each other.
  [[nodiscard]] std::vector<std::size_t> best_steps(std::size_t most, std::size_t apart) const;
  /// The blocks between which a temporary change of the rate explains most.
  [[nodiscard]] std::pair<std::size_t, std::size_t> best_visit() const;

private:
  static constexpr std::size_t rim = 2; // blocks: a step closer to an end may be one bad block
  std::vector<double> of_step_;         // from block `rim` on
  Eigen::MatrixXd rate_products_;       // scalar products of the steps, and with the rate
};

/// A temporary difference of the rate.
struct FittedVisit {
  double from = 0.0, to = 0.0; ///< in blocks
  Courses courses;
};
FittedVisit fitted_visit(const Account& account, const RateBlocks& blocks, std::size_t from,
                         std::size_t to);

} // namespace goingrate::timing_model
