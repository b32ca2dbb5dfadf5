// The course of a watched clock in blocks of a minute, an hour and a day.
#pragma once

#include "goingrate/log/clock_log.hpp"

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

namespace goingrate::apps {

/// What was heard within one block of time, and where the clock stood at its end.
struct GoingBlock {
  std::int64_t start_s = 0; ///< since 1970, a multiple of the block's length
  std::int64_t beats = 0, missed = 0, spurious = 0;
  double amplitude_sum = 0.0, beat_error_sum = 0.0;
  std::int64_t amplitudes = 0, beat_errors = 0;
  std::int64_t last_cycle = 0; ///< of the last good beat, if there is one
  Instant mark_time; ///< of the mark near the end, from which rates are taken (ClockMarks)
  std::int64_t mark_cycle = 0;
  /// Number of the run, within which the count is certain.
  std::int64_t run = 0;

  [[nodiscard]] std::optional<double> amplitude_rad() const;
  [[nodiscard]] std::optional<double> beat_error_s() const; ///< tick minus tock
};

/// A clock's count, and when it reached it.
struct ClockMark {
  Instant time;
  std::int64_t cycle = 0;
};

/// The state of a clock a few beats ago, from its last seven beats: at the middle cycle, on the
/// line with the repeated median of their slopes (Siegel, Biometrika 69, 1982) and the mean of the
/// residuals without the two largest and the two smallest. Two beats with wrong times, such as
/// false events in place of missed beats, do not draw it away from the others
/// (ClockMarksTest.TwoWrongBeats). If the scatter of beats is normal, so is that of the mark, 0.44
/// times as large (ClockMarksTest.ScatterIsGaussian): the limits of StepAlarm assume that tails are
/// no heavier.
class ClockMarks {
public:
  void begin_anew() { beats_.clear(); }
  void add(const ClockMark& beat);
  [[nodiscard]] ClockMark get() const;

private:
  std::deque<ClockMark> beats_;
};

/// A number with its standard deviation.
struct Measured {
  double value = 0.0, sigma = 0.0;
  std::size_t blocks = 0; ///< in the mean
};

/// Blocks of one length in constant memory: the oldest are forgotten.
class GoingBlocks {
public:
  GoingBlocks(std::int64_t length_s, std::size_t most) : length_s_(length_s), most_(most) {}

  /// Moves on to the block that holds `time`; returns whether it is a new one. A time in the block
  /// before the last is counted in the last; an earlier one means that the source's dates went
  /// back, and later blocks are forgotten.
  bool open(const Instant& time);
  [[nodiscard]] GoingBlock& last() { return blocks_.back(); }
  [[nodiscard]] const std::deque<GoingBlock>& all() const { return blocks_; }
  [[nodiscard]] std::int64_t length_s() const { return length_s_; }
  /// Rate of a block from the end of the block before it; nullopt across a break.
  [[nodiscard]] std::optional<double> rate_of(std::size_t i, double nominal_period_s) const;
  /// Rate over the complete blocks of the current run within the last `count` block lengths before
  /// now, `silence_s` after the last beat. Its sigma is the largest sigma of the mean from the
  /// blocks' rates, from pairs of them, from fours …, so that slow wander is included. nullopt for
  /// fewer than four rates.
  [[nodiscard]] std::optional<Measured> rate_over(std::size_t count, double nominal_period_s,
                                                  double silence_s = 0.0) const;
  /// Adds a block of an earlier time, or of a shorter length, to the one that holds its start.
  void merge(const GoingBlock& part);

private:
  std::int64_t length_s_;
  std::size_t most_;
  std::deque<GoingBlock> blocks_;
};

/// The blocks of all lengths, fed with numbered beats.
class Going {
public:
  void add(const Beat& beat, std::int64_t missed_before);
  /// An event that is not a beat.
  void add_spurious();
  /// From here on, the count no longer continues with certainty.
  void break_count() { ++run_; }
  /// Adopts the hours of an earlier time, in order, and the first beat of their last run.
  void restore(const std::vector<GoingBlock>& hours, const std::optional<Beat>& first_of_run);

  [[nodiscard]] const GoingBlocks& minutes() const { return minutes_; }
  [[nodiscard]] const GoingBlocks& hours() const { return hours_; }
  [[nodiscard]] const GoingBlocks& days() const { return days_; }
  /// Whether the last beat opened a new minute; then the one before is complete.
  [[nodiscard]] bool minute_is_new() const { return minute_is_new_; }
  [[nodiscard]] const std::optional<Beat>& last() const { return last_; }
  [[nodiscard]] const std::optional<Beat>& first_of_run() const { return first_of_run_; }
  [[nodiscard]] std::int64_t beats() const { return beats_; }
  /// The share of beats that were missed one by one in the last day; never 0 or 1, as a few beats
  /// say little about it.
  [[nodiscard]] double missed_share() const;
  /// The clock's error, s, since the first beat of the run that goes on now: positive, fast.
  [[nodiscard]] std::optional<double> deviation_s(double nominal_period_s) const;

private:
  template <class Do> void each_length(Do&& act) {
    act(minutes_);
    act(hours_);
    act(days_);
  }
  void add_beat_error(const Beat& up);

  GoingBlocks minutes_{60, 2881}, hours_{3600, 9600}, days_{86400, 7400};
  std::optional<Beat> last_, last_down_, first_of_run_;
  ClockMarks marks_; // of the minute
  std::int64_t run_ = 0, run_of_first_ = -1, run_of_last_ = -1, beats_ = 0;
  bool minute_is_new_ = false;
};

} // namespace goingrate::apps
