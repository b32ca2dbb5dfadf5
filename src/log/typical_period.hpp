// The period of a log before anything is numbered, from a bounded sample of its intervals.
#pragma once

#include "base/robust.hpp"

#include "goingrate/log/clock_log.hpp"

#include <optional>
#include <span>
#include <utility>

namespace goingrate {

/// Half-open range of indices.
struct Stretch {
  std::size_t first = 0;
  std::size_t last = 0;
  [[nodiscard]] std::size_t size() const { return last - first; }
};

inline constexpr std::size_t usual_sample = 25'000; ///< events; their medians take a millisecond

/// All of `size` events if there are at most `most`, else as many in twenty stretches spread evenly:
/// a sample that sees all of the log and costs the same however long it is.
std::vector<Stretch> sample_stretches(std::size_t size, std::size_t most = usual_sample);

/// The bulk of the intervals between upward crossings, each over the whole number of periods that
/// it holds.
struct TypicalPeriod {
  double mean_s = 0.0;    ///< of the intervals within a tenth of their median
  double scatter_s = 0.0; ///< their robust standard deviation (from the median absolute deviation)
  double second_s2 = 0.0; ///< trimmed mean square of t[i+2] - 2 t[i+1] + t[i], s^2
  double mean_step = 1.0; ///< periods from one event to the next; above 1 where many are lost
  bool has_a_course = false; ///< have_a_course() of the intervals
  double grain_s = 0.0;   ///< steps of the logger's times, at most a sixteenth of the period
};

/// An event that may be an upward crossing: neither a downward one nor a bounce.
inline bool may_be_up(const Beat& event) {
  return event.edge == Edge::up && event.flag != BeatFlag::bounce;
}

/// Whether periods change along a smooth course rather than by scatter, as those of a wide free
/// swing that dies away: they spread by 0.3 % or more, more than any clock's, and neighbours differ
/// by less than a tenth of that. NaN is ignored.
bool have_a_course(std::span<const double> periods);

/// Whether a pendulum whose small swings take `nominal_s` may take `period_s` for wide ones: up to
/// 140 degrees under gravity (free_period_ratio, 1.59).
bool may_be_wide_swings(double period_s, double nominal_s);

/// The period of `events`. `nominal_s`, if known, settles how many periods an interval holds,
/// except for wide swings that die away. Otherwise the period is the shortest length of which the
/// intervals are multiples, which is their median unless more than half of the beats are lost.
/// Throws InputError if there are fewer than three upward crossings or most are at one time,
/// ImpossibleReading if fewer than one interval in twenty is a multiple of the nominal period.
TypicalPeriod typical_period(std::span<const Beat> events, const std::string& source,
                             std::optional<double> nominal_s = {});

} // namespace goingrate
