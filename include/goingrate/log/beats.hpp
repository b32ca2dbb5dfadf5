// Numbering the beats: which swing of the pendulum each event of a log belongs to.
#pragma once

#include "goingrate/log/clock_log.hpp"

#include <span>
#include <string_view>

namespace goingrate {

/// What a gap is.
enum class GapKind : std::uint8_t {
  missed, ///< up to twenty cycles without an event
  gap,    ///< more
  step,   ///< the events go on displaced: the reference clock was set, or the sensor moved
  stop,   ///< more than twenty cycles, and no whole number fits: the clock stood still
};

/// Cycles without an event, or a displacement.
struct Gap {
  std::int64_t after_cycle = 0;
  std::int64_t length = 0;  ///< cycles missing; 0 only where kind is step
  double probability = 1.0; ///< that `length` is right
  bool bridged = true;      ///< false: the log is split here
  GapKind kind = GapKind::missed;
};

/// A numbered log.
struct Beats {
  std::vector<Beat> beats;       ///< every event, in the order it came in
  std::vector<Gap> gaps;         ///< single missed beats too
  double typical_period_s = 0.0; ///< robust mean
  double scatter_s = 0.0;        ///< robust standard deviation of the period
  std::int64_t missed = 0;       ///< cycles missing in bridged gaps
  std::int64_t spurious = 0;     ///< events in either direction
  std::int64_t rivals = 0;
  std::uint32_t segments = 1;
  /// Cycles of the longest gap that would, in 95 cases of 100, be counted with the least
  /// probability asked for, in the middle of a log as steady as this one.
  std::int64_t longest_countable_gap = 0;

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
/// A filter that follows time and period of the clock, under three kinds of noise measured in the
/// log itself (white in time, white in rate, wander of the rate), foresees each beat. An event
/// within six sigmas of it, or 1 % of the period, is the beat; of several the nearest, unless
/// another is more than 1/100 as likely: that one is a `rival`, the rest are `spurious`. Where six
/// events in a row fit nowhere, or eight periods are empty, the beats are looked for afresh.
///
/// Each gap's count has its probability from the clock's time and period on both sides, carried
/// over the gap with the noise as it grows; a count of n periods, of its neighbours, and "the clock
/// stood still or the reference jumped" compete. Below `least_probability` the log is split. A gap
/// beyond ten times the longest run of the log is never counted.
///
/// Within a segment all differences of cycles are right in at least 99 % of logs with up to 10 %
/// missed and 10 % false events, jitter up to 1 % of the period, ramps, steps and restarts, and
/// fewer than 1 of 1e4 good events is marked spurious (NumberingStudy.ShortForm; the long form is
/// tests/studies/numbering.txt). Works in place: 40 bytes an event and a list of gaps. Cost O(N),
/// tens of ns an event.
/// Throws InputError if no period can be found, or the log falls into more than 65536 segments.
Beats number_beats(const ClockLog& log, const NumberingOptions& options = {});

/// The same for events that are handed over and numbered in place: no second copy of a long log is
/// made. `source` names the log in messages.
Beats number_beats(std::vector<Beat>&& events, const std::string& source,
                   const NumberingOptions& options = {});

/// The cycle, counted from the first of `beats`, of the first beat at or after `time_s` seconds
/// from it; the last one's if there is none.
std::int64_t cycle_at(std::span<const Beat> beats, double time_s);

std::string_view name_of(BeatFlag flag);
std::string_view name_of(GapKind kind);

} // namespace goingrate
