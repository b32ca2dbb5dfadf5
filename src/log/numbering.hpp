// The first numbering of a log: each upward crossing gets a cycle from the beats before it. Places
// where the beats were lost are judged afterwards, from both sides (gap_judge.hpp).
#pragma once

#include "clock_filter.hpp"
#include "phase_search.hpp"

#include <optional>
#include <span>

namespace goingrate {

/// Periods without a beat after which the beats may have been displaced: with a tenth of them
/// missed this happens once in 1e8 by chance. If more are usually missed, correspondingly more.
inline double longest_absence(const TypicalPeriod& typical) { return 8.0 * typical.mean_step; }

/// Numbers the upward crossings of `beats` in place: flag and cycle. Downward crossings get their
/// flag; they, bounces and spurious events get the cycle of the beat before them, so that cycles
/// never decrease.
class Numbering {
public:
  /// `own_step_s`: a step of the times that the clock makes again and again.
  Numbering(std::span<Beat> beats, const TypicalPeriod& typical, const BeatNoise& noise,
            double own_step_s);

  void run();

  /// The first beats after each place where the beats were lost: long absences, and phases that do
  /// not fit. The cycle there is a best guess.
  [[nodiscard]] const std::vector<std::size_t>& resumed() const { return resumed_; }

  [[nodiscard]] bool has_downward() const { return has_downward_; }

private:
  [[nodiscard]] bool is_bounce(std::size_t i) const {
    return i < beats_.size() && beats_[i].flag == BeatFlag::bounce;
  }
  [[nodiscard]] std::size_t next_up(std::size_t i);
  std::size_t run_on(std::size_t i);
  std::size_t place(std::size_t i);
  std::size_t settle(std::size_t i, double cycles, const ClockFilter::Covariance& foreseen);
  [[nodiscard]] std::optional<std::size_t> beat_among_bounces(std::size_t i) const;
  [[nodiscard]] std::optional<std::size_t> missing_among_bounces(std::size_t i) const;
  std::size_t resume(std::size_t i, std::size_t seen, bool few_will_do);
  [[nodiscard]] std::optional<std::size_t> looked_for(std::size_t i, double& period) const;
  void mark_spurious(std::size_t i);
  void accept(std::size_t i, std::int64_t cycle);
  [[nodiscard]] bool fits(double error_s, double variance) const;
  void strike_lone_outliers();
  [[nodiscard]] bool stands_alone(std::size_t i) const;

  std::span<Beat> beats_;
  double period_;
  PhaseSearch search_;
  double floor_; // an event this near fits however little noise there is, s
  ClockFilter filter_;
  std::vector<std::size_t> resumed_;
  std::vector<std::size_t> surprises_;
  std::size_t last_ = 0; // the last beat
  int misfits_ = 0;      // events since then that fit no cycle
  bool has_downward_ = false;
};

} // namespace goingrate
