// A log as it was read: events in time, and all that was assumed or found wrong on the way.
#pragma once

#include "goingrate/base/instant.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace goingrate {

/// The formats that are read.
enum class LogFormat {
  native,      ///< '#' header, then CSV with named columns, see README
  timestamps,  ///< one time in seconds a line
  clock_error, ///< "label error amplitude_mrad": label s, error s (positive: fast), amplitude mrad
};

/// Which way the pendulum went.
enum class Edge : std::uint8_t { up, down };

/// What an event turned out to be when the beats were numbered.
enum class BeatFlag : std::uint8_t {
  good,     ///< an upward crossing with its cycle number (or not numbered yet)
  spurious, ///< no crossing of its own: a double trigger or a false one
  down,     ///< a downward crossing, numbered with the upward crossing before it
  rival,    ///< another event that fits this cycle as well; which was the crossing cannot be told
};

/// One event of a log: as it was read and, once numbered, with its place in the going of the clock.
/// 40 bytes, so that a year of seconds fits in memory.
struct Beat {
  Instant time;
  std::int64_t cycle = 0; ///< 0 for the first good beat; of a spurious event: the beat before it
  double amplitude_rad = std::numeric_limits<double>::quiet_NaN(); ///< NaN where the log has none
  std::uint32_t line = 0;                                          ///< line of the file, from 1
  std::uint16_t segment = 0; ///< beats of one segment are numbered without doubt
  BeatFlag flag = BeatFlag::good;
  Edge edge = Edge::up;
};
static_assert(sizeof(Beat) == 40);

/// An event that is not numbered yet.
inline Beat event_at(const Instant& time, Edge edge = Edge::up, std::uint32_t line = 0,
                     double amplitude_rad = std::numeric_limits<double>::quiet_NaN()) {
  return {time, 0, amplitude_rad, line, 0, BeatFlag::good, edge};
}

/// Something wrong with one line, and what was done about it.
struct LineIssue {
  std::size_t line = 0;
  std::size_t column = 0;
  std::string found;
  std::string action;
};

/// A log: events in order of time.
struct ClockLog {
  std::string source; ///< file name as given
  LogFormat format = LogFormat::timestamps;
  std::vector<Beat> events;
  bool has_amplitude = false;
  std::optional<double> nominal_period_s; ///< if the log states one
  std::vector<std::string> assumptions;   ///< what was taken for granted, in plain sentences
  std::vector<LineIssue> issues;
};

} // namespace goingrate
