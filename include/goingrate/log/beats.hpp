// Numbering the beats: which swing of the pendulum each event of a log belongs to.
#pragma once

#include "goingrate/log/clock_log.hpp"

#include <optional>
#include <span>
#include <string_view>

namespace goingrate {

/// What a gap is.
enum class GapKind : std::uint8_t {
  missed,  ///< up to twenty cycles without an event
  gap,     ///< more
  step,    ///< the events go on displaced: the reference clock was set, or the sensor moved
  stop,    ///< more than twenty cycles, and no whole number fits: the clock stood still
  restart, ///< the time goes back: the logger began again, or another log follows
};

/// Cycles without an event, or a displacement.
struct Gap {
  std::int64_t after_cycle = 0;
  std::int64_t length = 0;  ///< cycles missing; 0 only where kind is step or restart
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
  std::int64_t step = 1;         ///< cycles from one event to the next where none is missing
  std::int64_t missed = 0;       ///< cycles missing in bridged gaps
  std::int64_t spurious = 0;     ///< events in either direction
  std::int64_t rivals = 0;
  std::int64_t bounces = 0; ///< events that follow an edge within the dead time
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
  std::optional<double> nominal_period_s{}; ///< believed: how many periods an interval holds
};

/// Marks as bounces the events that follow an edge within `dead_time_s` (0: none), in either
/// direction. Where it is not given it is found: of the events that come within 0.1 s, and a tenth
/// of the usual interval, after another, contacts that bounce make most come at once, while false
/// events come at any time. Says so in `log.assumptions`; returns the dead time, 0 where nothing
/// bounces (BouncesTest.AreFoundWithoutBeingTold). Throws ArgumentError for a negative dead time.
double mark_bounces(ClockLog& log, std::optional<double> dead_time_s = {});

/// Labels every other event of a log without edge labels, bounces apart, as a downward crossing:
/// all events if `certain`, else only where the intervals alternate between two lengths (out of
/// beat) and are not about whole nominal periods, or where most are half of `nominal_period_s`. Says
/// so in `log.assumptions`; returns whether it did.
bool label_alternate_edges(ClockLog& log, bool certain,
                           std::optional<double> nominal_period_s = {});

/// Numbers every event of `log`.
///
/// A filter that follows time and period of the clock, under three kinds of noise measured in the
/// log itself (white in time, white in rate, wander of the rate), foresees each beat. An event
/// within six sigmas of it, or 1 % of the period, is the beat; if there are several, the nearest,
/// unless another is more than 1/100 as likely: that one is a `rival`, the rest are `spurious`.
/// Where six events in a row fit nowhere, or eight periods are empty and the next beat is not
/// foreseen to 5 % of a period, the beats are looked for afresh. Where the time goes back by half a
/// period or more a new segment begins. Events marked as bounces stay so and are passed over.
///
/// Each gap's count has its probability from the clock's time and period on both sides, carried
/// over the gap with the noise as it grows; a count of n periods, of its neighbours, and "the clock
/// stood still or the reference jumped" compete. Below `least_probability` the log is split, and
/// also where the gap is longer than `longest_countable_gap`, or whole hours longer than one
/// period: then the reference was set from one zone to another.
///
/// Within a segment all differences of cycles are right in at least 99 % of logs with up to 10 %
/// missed and 10 % false events, jitter up to 1 % of the period, ramps, steps and restarts, and
/// fewer than 1 of 1e4 good events is marked spurious (NumberingStudy.ShortForm; the long form is
/// tests/studies/numbering.txt). Works in place: 40 bytes an event and a list of gaps. Cost O(N),
/// tens of ns an event. Throws InputError if no period can be found, or the log falls into more
/// than 65536 segments.
Beats number_beats(const ClockLog& log, const NumberingOptions& options = {});

/// The same for events that are handed over and numbered in place: no second copy of a long log is
/// made. `source` names the log in messages.
Beats number_beats(std::vector<Beat>&& events, const std::string& source,
                   const NumberingOptions& options = {});

/// Events on a grid, whose cycles are given: nothing is looked for, and every value that is missing
/// is a gap of known length. Throws InputError if there are fewer than three, or the time goes back
/// (a clock's error then moves by more than the interval).
Beats beats_on_grid(std::vector<Beat>&& events, const std::string& source);

/// Counts swings where the events are `step` swings apart, as those of a wheel's contact are.
void count_swings(std::int64_t step, Beats& numbered);

/// The cycle, counted from the first of `beats`, of the first beat at or after `time_s` seconds
/// from it; the last one's if there is none.
std::int64_t cycle_at(std::span<const Beat> beats, double time_s);

std::string_view name_of(BeatFlag flag);
std::string_view name_of(GapKind kind);

} // namespace goingrate
