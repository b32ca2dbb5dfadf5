// Counts the cycles in a gap, with the probability that the count is right.
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
/// A forward filter over the beats before the gap predicts time and period after n cycles; a
/// backward filter over the beats after it estimates the actual ones. Given the change of the
/// period, the rest of the discrepancy in time is normally distributed with a variance s^2 that
/// follows from the noise. Each n has the likelihood of its discrepancy; "stopped, or displaced"
/// has that of a prior share of breaks spread evenly over all phases.
class GapJudge {
public:
  /// `noise`: rather too large than too small; `longest_run`: the longest run of the log, cycles.
  /// The noise is trusted for gaps of up to ten times that.
  GapJudge(const BeatNoise& noise, double period_s, std::int64_t longest_run)
      : noise_(noise), period_(period_s), longest_run_(longest_run) {}

  /// The gap before event `after`, whose last beat before is `before`; both flags good. Beats from
  /// index `first` up to `last` (exclusive) are known to be numbered rightly on their side. `lost`:
  /// the beats had to be looked for afresh, so they may be displaced.
  [[nodiscard]] GapCount count(std::span<const Beat> beats, std::size_t first, std::size_t before,
                               std::size_t after, std::size_t last, bool lost) const;

  /// Missing cycles of the longest gap, in the middle of an endless log, that would be counted with
  /// `least_probability` if the clock is off by two sigmas, that is, in 95 of 100 cases.
  [[nodiscard]] std::int64_t longest_countable(double least_probability) const;

private:
  struct Bridge {
    double per_change = 0.5; // change of the time per change of the period, cycles
    double sigma_s = 0.0;    // remaining uncertainty of the time
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
