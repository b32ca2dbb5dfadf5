// Numbers for beats as they come.
#pragma once

#include "common.hpp"

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace goingrate::apps {

/// Numbers new events together with the last few hundred, so that what is handed out is what a run
/// over the whole log would say. A gap that these do not bridge is judged by sixteen to
/// thirty-two thousand more: only a long run tells the period well enough for a long absence
/// (MonitorWatchTest.ALongAbsenceIsCounted). What was handed out is never revised: cycles go
/// on from it.
class RollingNumbers {
public:
  explicit RollingNumbers(const LogOptions& options) : options_(options) {}

  void add(const Beat& event);
  /// From now on times have nothing to do with those before: a segment of its own, whose cycles go
  /// on.
  void begin_anew();
  /// Goes on from the last numbered beats of an earlier run.
  void go_on_from(std::vector<Beat> numbered);
  /// Whether events wait for others to show what they are, at the beginning.
  [[nodiscard]] bool is_settling() const;
  /// Whether there are enough events to be worth numbering.
  [[nodiscard]] bool is_full() const;
  /// The events that were added, numbered; none until there are enough of them.
  std::vector<Beat> numbered(const ClockLog& log);
  /// The rest that was held back, at the end of a log.
  std::vector<Beat> rest(const ClockLog& log);
  /// The gaps between the beats handed out since the last call, by the cycles as handed out.
  std::vector<Gap> take_gaps() { return std::exchange(gaps_, {}); }

  /// Why many events that were added have no numbers, if that is so.
  [[nodiscard]] const std::string& failure() const { return failure_; }
  [[nodiscard]] double period_s() const { return period_s_; } ///< 0 until it is known
  /// The period that rates are compared with, s; 0 until it is known.
  [[nodiscard]] double nominal_period_s() const { return nominal_period_s_; }
  /// What was assumed for it, with the options that say otherwise
  /// (MonitorWatchTest.WhatIsAssumedIsSaid).
  [[nodiscard]] const std::vector<Assumption>& assumptions() const { return assumptions_; }

private:
  // Difference between the cycles and segments of a numbering and those that are handed out.
  struct Shift {
    std::int64_t cycles = 0;
    int segments = 0;
  };
  std::vector<Beat> number_new(const ClockLog& log);
  [[nodiscard]] Beats number(std::vector<Beat> events, const ClockLog& log) const;
  [[nodiscard]] Beats numbered_window(const ClockLog& log) const;
  [[nodiscard]] Shift shift_of(const std::vector<Beat>& numbered) const;
  void take_nominal_period(const ClockLog& log, const Beats& numbered);
  void keep_gaps(const Beats& numbered, const Shift& shift, std::int64_t from_cycle);
  Beat judged(Beat beat);
  void forget_old();

  const LogOptions& options_;
  std::vector<Beat> older_;    // before the window
  std::vector<Beat> window_;   // those that were handed out are as they were handed out
  std::size_t handed_out_ = 0; // of the window
  std::optional<Beat> last_;   // the last good one that was handed out
  std::vector<Gap> gaps_;
  std::string failure_;
  std::vector<Assumption> assumptions_;
  double period_s_ = 0.0, nominal_period_s_ = 0.0;
};

} // namespace goingrate::apps
