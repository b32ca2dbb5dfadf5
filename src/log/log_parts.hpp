// A log read part by part.
#pragma once

#include "lines.hpp"
#include "row_reader.hpp"

#include "goingrate/log/clock_log.hpp"
#include "goingrate/log/reading.hpp"

#include <limits>
#include <optional>
#include <string>

namespace goingrate {

/// Reads a log, all of it or as many events at a time as there is room for.
class LogParts {
public:
  /// Reads the head, from which the layout follows; of a recording of sound, everything. Both
  /// arguments must outlive it. Throws as read_log_file().
  LogParts(LineReader& lines, const ReadingOptions& options);
  LogParts(const LogParts&) = delete;
  LogParts& operator=(const LogParts&) = delete;

  /// Reads on until log().events are about `most`; of a log whose events do not stand by themselves
  /// (samples of an angle, data on a grid, labels with errors, newest first), to its end. Returns
  /// whether the log has ended: it is then complete, repaired and in order.
  bool read(std::size_t most = std::numeric_limits<std::size_t>::max());
  /// Puts the events in order that were read before the end of the log.
  void put_in_order();

  /// What was read. Its events may be taken away, all but the last few.
  [[nodiscard]] ClockLog& log() { return log_; }
  /// The number of lines to expect of the whole log; 0 if that is not known.
  [[nodiscard]] std::size_t lines_expected() const;

private:
  [[nodiscard]] bool can_be_divided() const;

  LineReader& lines_;
  const ReadingOptions& options_;
  ClockLog log_;
  Layout layout_;
  std::optional<RowReader> rows_; // none of a recording
  std::optional<TimeOrigin> origin_; // that of the first part
  std::size_t room_ = 0;             // lines
};

} // namespace goingrate
