// Numbering the beats: which swing of the pendulum each event of a log belongs to.
#pragma once

#include "goingrate/log/clock_log.hpp"

#include <span>
#include <string_view>

namespace goingrate {

/// Cycles without an event.
struct Gap {
  std::int64_t after_cycle = 0;
  std::int64_t length = 0;  ///< cycles missing, at least 1
  double probability = 1.0; ///< that `length` is right
  bool bridged = true;      ///< false: the log is split here
};

/// A numbered log.
struct Beats {
  std::vector<Beat> beats;       ///< every event, in order of time
  std::vector<Gap> gaps;         ///< single missed beats too
  double typical_period_s = 0.0; ///< robust mean
  double scatter_s = 0.0;        ///< robust standard deviation of the period
  std::int64_t missed = 0;       ///< cycles missing in bridged gaps
  std::int64_t spurious = 0;
  std::uint32_t segments = 1;

  /// The good beats of the segment that has most of them.
  [[nodiscard]] std::vector<Beat> longest_segment() const;
};

/// Settings of the numbering.
struct NumberingOptions {
  double least_probability = 0.99; ///< below it a gap's count is not trusted and the log is split
};

/// Labels every other event of a log without edge labels as a downward crossing: all events if
/// `certain`, else only where the intervals alternate between two lengths (out of beat), which one
/// direction alone never does. Says so in `log.assumptions`; returns whether it did.
bool label_alternate_edges(ClockLog& log, bool certain);

/// Numbers every event of `log`.
///
/// The typical period is the mean of the differences near their median. Each event is compared with
/// the time foreseen from the beats before it: near a whole number of periods it is a beat, else it
/// is spurious; of two events for one cycle the nearer to the foreseen time is the beat. Three
/// events in a row that agree with each other but not with the past are a step: a new segment.
/// The probability that a gap of k cycles is counted right is that of the nearest integer under a
/// normal error whose size is measured in the log itself: the error of foreseeing k cycles from the
/// mean rate of the k before.
/// Works while fewer than about a third of the beats are missed or doubled and the jitter is below
/// 2 % of the period (BeatsTest.NumbersEveryEventUnderFaults). Cost O(N).
/// Throws InputError if no period can be found.
Beats number_beats(const ClockLog& log, const NumberingOptions& options = {});

/// The same for events that are handed over: no second copy of a long log is made. `source` names
/// the log in messages.
Beats number_beats(std::vector<Beat>&& events, const std::string& source,
                   const NumberingOptions& options = {});

/// The cycle, counted from the first of `beats`, of the first beat at or after `time_s` seconds
/// from it; the last one's if there is none.
std::int64_t cycle_at(std::span<const Beat> beats, double time_s);

std::string_view name_of(BeatFlag flag);

} // namespace goingrate
