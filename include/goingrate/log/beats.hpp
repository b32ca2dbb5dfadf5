// Numbering the beats: finds the swing of the pendulum to which each event of a log belongs.
#pragma once

#include "goingrate/log/clock_log.hpp"

#include <optional>
#include <span>
#include <string_view>

namespace goingrate {

/// The kinds of gaps.
enum class GapKind : std::uint8_t {
  missed,  ///< up to twenty cycles without an event
  gap,     ///< more than twenty
  step,    ///< later times are displaced: the reference clock was set, or the sensor moved
  stop,    ///< more than twenty cycles, and no whole number fits: the clock stood still
  restart, ///< the time goes back: the logger was restarted, or another log follows
};

/// Cycles without an event, or a displacement.
struct Gap {
  std::int64_t after_cycle = 0;
  std::int64_t length = 0;  ///< cycles missing; 0 only where kind is step or restart
  double probability = 1.0; ///< that `length` is correct
  bool bridged = true;      ///< false: the log is split here
  GapKind kind = GapKind::missed;
};

/// A numbered log.
struct Beats {
  std::vector<Beat> beats;       ///< every event, in the order it came in
  std::vector<Gap> gaps;         ///< single missed beats too
  double typical_period_s = 0.0; ///< robust mean
  double scatter_s = 0.0;        ///< robust standard deviation of the period
  std::int64_t step = 1;         ///< cycles from one event to the next where none is missing
  std::int64_t missed = 0;       ///< cycles missing in bridged gaps
  std::int64_t spurious = 0;     ///< events in either direction
  std::int64_t rivals = 0;
  std::int64_t bounces = 0; ///< events that follow an edge within the dead time
  bool has_downward = false; ///< some of the events are downward crossings
  std::uint32_t segments = 1;
  /// The longest gap, in cycles, that in the middle of a log as steady as this one would be counted
  /// with the required probability in 95 of 100 cases.
  std::int64_t longest_countable_gap = 0;

  /// The good beats of the segment that has most of them.
  [[nodiscard]] std::vector<Beat> longest_segment() const;
};

/// Settings of the numbering.
struct NumberingOptions {
  double least_probability = 0.99; ///< of a gap's count; below it the log is split
  std::optional<double> nominal_period_s{}; ///< gives the number of periods in an interval
};

/// Marks as bounces the events that follow an edge within `dead_time_s` (0: none), in either
/// direction. If the dead time is not given, it is estimated from the events that follow another
/// within 0.1 s and a tenth of the usual interval: those of a bouncing contact come mostly at once,
/// while false events come at any time. Reports this in `log.assumptions`. Returns the dead time, 0
/// if nothing bounces (BouncesTest.AreFoundWithoutBeingTold). Throws ArgumentError for a negative
/// dead time.
double mark_bounces(ClockLog& log, std::optional<double> dead_time_s = {});

/// Labels every other event of a log without edge labels as a downward crossing; bounces do not
/// count. Does so always if `certain`; otherwise only if the intervals alternate between two
/// lengths (out of beat) and are not about whole nominal periods, or if most are half of
/// `nominal_period_s`. Reports this in `log.assumptions`; returns whether it labelled.
bool label_alternate_edges(ClockLog& log, bool certain,
                           std::optional<double> nominal_period_s = {});

/// Numbers every event of `log`.
///
/// A filter tracks the time and period of the clock, with three kinds of noise measured in the log
/// itself (white in time, white in rate, wander of the rate), and predicts each beat. An event
/// within six sigmas of the prediction, or 1 % of the period, is the beat. Of several such events
/// it is the nearest; another that is at least 1/100 as likely is a `rival`, and the rest are
/// `spurious`. If six events in a row fit no beat, or if eight periods are empty and the next beat
/// is not predicted to 5 % of a period, the search for beats starts again. If the time goes back by
/// half a period or more, a new segment begins. Events marked as bounces are ignored.
///
/// The probability of each gap's count follows from the clock's time and period on both sides,
/// extrapolated over the gap with growing noise. Competing explanations are n periods, a
/// neighbouring number, and a stop of the clock or a jump of the reference. The log is split below
/// `least_probability`, at a gap longer than `longest_countable_gap`, and at one that is whole
/// hours longer than one period: the reference was then set to another time zone.
///
/// Within a segment all differences of cycles are correct in at least 99 % of logs with up to 10 %
/// missed and 10 % false events, jitter up to 1 % of the period, ramps, steps and restarts, and
/// fewer than 1 of 1e4 good events is marked spurious (NumberingStudy.ShortForm; the long form is
/// tests/studies/numbering.txt). Works in place: 40 bytes an event and a list of gaps. Cost O(N),
/// tens of ns an event. Throws InputError if no period can be found, or the log falls into more
/// than 65536 segments.
Beats number_beats(const ClockLog& log, const NumberingOptions& options = {});

/// The same for events that are moved in and numbered in place, without a second copy of a long
/// log. `source` names the log in messages.
Beats number_beats(std::vector<Beat>&& events, const std::string& source,
                   const NumberingOptions& options = {});

/// Events on a grid, whose cycles are known: there is no search, and every missing value is a gap
/// of known length. Throws InputError if there are fewer than three, or the time goes back (a
/// clock's error then moves by more than the interval).
Beats beats_on_grid(std::vector<Beat>&& events, const std::string& source);

/// Multiplies the cycle numbers by `step`, where events are that many swings apart, as with the
/// contact of a wheel.
void count_swings(std::int64_t step, Beats& numbered);

/// The cycle, counted from the first of `beats`, of the first beat at or after `time_s` seconds
/// from it; the last one's if there is none.
std::int64_t cycle_at(std::span<const Beat> beats, double time_s);

std::string_view name_of(BeatFlag flag);
std::string_view name_of(GapKind kind);

} // namespace goingrate
