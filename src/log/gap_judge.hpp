// How many cycles a gap holds, and how sure that is.
#pragma once

#include "clock_filter.hpp"
#include "goingrate/log/beats.hpp"

#include <span>

namespace goingrate {

/// How a gap is counted.
struct GapCount {
  std::int64_t cycles = 1;    ///< from the beat before to the beat after
  double probability = 0.0;   ///< that `cycles` is right
  bool displaced = false;     ///< no count fits: the clock stood still, or the reference jumped
  bool reference_set = false; ///< by whole hours, with no beat missing
};

/// Judges gaps by what the clock did before and after each.
///
/// A filter forward over the beats before the gap foresees time and period after n cycles, one
/// backward over the beats after it tells what they were there. With the period's change known, the
/// rest of the discrepancy in time is normal with a variance s^2 that the noise gives; each n is as
/// likely as its discrepancy, and "stopped, or displaced" as likely as a prior share of breaks
/// spread evenly over all phases.
class GapJudge {
public:
  /// `noise` on the cautious side; `longest_run` (cycles) is the longest run of the log, ten times
  /// which is as far as it is believed.
  GapJudge(const BeatNoise& noise, double period_s, std::int64_t longest_run)
      : noise_(noise), period_(period_s), longest_run_(longest_run) {}

  /// The gap before event `after`, whose last beat before is `before`; both flags good. Beats from
  /// index `first` up to `last` (exclusive) are known to be numbered rightly on their side. `lost`:
  /// the beats had to be looked for afresh, so they may be displaced.
  [[nodiscard]] GapCount count(std::span<const Beat> beats, std::size_t first, std::size_t before,
                               std::size_t after, std::size_t last, bool lost) const;

  /// Missing cycles of the longest gap in the middle of an endless log that would be counted with
  /// `least_probability` when the clock is off by two sigmas: in 95 cases of 100.
  [[nodiscard]] std::int64_t longest_countable(double least_probability) const;

private:
  struct Bridge {
    double per_change = 0.5; // cycles' worth of the period's change that the time has taken in
    double sigma_s = 0.0;    // what is left unknown of the time
  };
  [[nodiscard]] Bridge bridge_over(const ClockFilter& before, const ClockFilter& after, double n,
                                   double rate_walk2) const;
  [[nodiscard]] GapCount judge(const ClockFilter& before, const ClockFilter& after,
                               double elapsed_s, bool lost) const;
  [[nodiscard]] double probability(double misfit_periods, double sigma_periods,
                                   double share_displaced) const;
  [[nodiscard]] bool beyond_belief(double cycles) const;
  [[nodiscard]] bool reference_was_set(const ClockFilter& before, const ClockFilter& after,
                                       double elapsed_s) const;

  BeatNoise noise_;
  double period_;
  std::int64_t longest_run_;
};

} // namespace goingrate
