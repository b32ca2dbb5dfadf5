// A log as it was read: events in time, and all that was assumed or found wrong on the way.
#pragma once

#include "goingrate/base/instant.hpp"

#include <cstddef>
#include <cstdint>
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

/// One event of the log. The amplitude is NaN where the log has none.
struct LogEvent {
  Instant time;
  double amplitude_rad;
  std::uint32_t line; ///< line of the file, from 1
  Edge edge;
};

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
  std::vector<LogEvent> events;
  bool has_amplitude = false;
  std::optional<double> nominal_period_s; ///< if the log states one
  std::vector<std::string> assumptions;   ///< what was taken for granted, in plain sentences
  std::vector<LineIssue> issues;
};

} // namespace goingrate
