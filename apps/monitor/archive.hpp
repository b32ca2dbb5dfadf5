// The archive of a clock that is watched: one native log a day, appended to and never rewritten.
#pragma once

#include "arrivals.hpp"

#include "goingrate/log/clock_log.hpp"
#include "goingrate/log/writing.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace goingrate::apps {

/// The day (UTC) of a time since 1970 as YYYY-MM-DD.
std::string day_of(const Instant& time);

/// The event as the archive keeps it: times and widths to the nanosecond, amplitudes to nine digits.
HeardEvent as_stored(HeardEvent event);

/// Files DIR/YYYY-MM-DD.csv of the native format, the times counted from 1970 (UTC). A line is
/// handed to the system as soon as it is appended and is safe once sync() returned. What a failure
/// of power leaves of a line that was not safe yet is cut off before the file is appended to again
/// (MonitorArchiveTest.ATornLineIsCutOff). What a failed sync() may have lost is written again by
/// the next one (MonitorArchiveTest.WhatAFailedSyncLostIsWrittenAgain).
class Archive {
public:
  /// Makes the folder if need be. Throws OutputError if it cannot be written, or if another
  /// process keeps it.
  explicit Archive(std::string folder);
  ~Archive();
  Archive(const Archive&) = delete;
  Archive& operator=(const Archive&) = delete;

  /// What the header of a new day says of the source: the columns that it tells, its nominal period
  /// and the width of its flag. Before that it is what the header of the last day says.
  void describe(const NativeColumns& columns);
  /// Appends an event whose time counts from 1970. What the day that is open has no column for, as
  /// it began with another header, stands in a comment behind it. Throws OutputError; then nothing
  /// of the event is in the file: also where a disk that fails has left so much unsafe that no more
  /// is kept in memory for another attempt (MonitorArchiveTest.WhatIsUnsafeIsBounded).
  void append(const HeardEvent& event);
  /// Appends a comment, which readers of logs pass over, to the day that is open, or to that of
  /// `at`. Throws OutputError.
  void note(const std::string& text, const Instant& at);
  /// The comments of a day.
  [[nodiscard]] std::vector<std::string> notes_of(const std::string& day) const;
  /// The comments behind the last event, which may be on an earlier day than the last.
  [[nodiscard]] std::vector<std::string> last_notes() const;
  /// All that was appended is on disk when it returns. Throws OutputError.
  void sync();
  [[nodiscard]] bool is_synced() const { return is_synced_; }

  /// The second at which a source's own times began, as noted last; nothing for dated times.
  [[nodiscard]] std::optional<Instant> origin() const { return origin_; }
  /// Sets it; it is noted with the next event, whose time it places.
  void set_origin(const Instant& origin);
  [[nodiscard]] std::optional<Instant> last_time() const { return last_time_; }
  /// The period that the source told, by the header of the last day.
  [[nodiscard]] std::optional<double> nominal_period_s() const { return columns_.nominal_period_s; }

  /// The direction of the last event.
  [[nodiscard]] Edge last_edge() const { return last_edge_; }

  /// The days that there are, in order.
  [[nodiscard]] std::vector<std::string> days() const;
  /// The days after one day and before another.
  [[nodiscard]] std::vector<std::string> days_between(const std::string& after,
                                                      const std::string& before) const;
  /// The events of one day; none if it cannot be read.
  [[nodiscard]] std::vector<Beat> events_of(const std::string& day) const;
  /// Whether an event of just that time is in it.
  [[nodiscard]] bool holds(const Instant& time) const;
  [[nodiscard]] const std::string& folder() const { return folder_; }

private:
  void open_day(const std::string& day);
  void close_day();
  void write(const std::string& text);
  void write_or_close(const std::string& header);
  void write_origin();
  void write_unsynced_again() const;
  void read_last_day();
  [[nodiscard]] std::optional<Instant> origin_of_day(const std::string& day) const;
  [[nodiscard]] std::vector<Beat> few_events_of(const std::string& day) const;
  [[nodiscard]] std::string path_of(const std::string& day) const;

  std::string folder_;
  int lock_ = -1, file_ = -1;
  std::string day_;               // the one that is open
  std::string unsynced_;          // its text that is not safe yet
  std::int64_t synced_bytes_ = 0; // its text that is
  bool sync_failed_ = false;      // the system may have thrown the unsafe text away
  NativeColumns columns_;         // for a new day
  NativeColumns day_columns_; // of the one that is open
  bool is_synced_ = true;
  bool has_origin_ = true; // the day that is open has it
  std::optional<Instant> origin_, last_time_;
  Edge last_edge_ = Edge::up;
};

} // namespace goingrate::apps
