// The archive of a monitored clock: one log in the native format per day, only appended to.
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

/// The event rounded as the archive stores it: times and widths to the nanosecond, amplitudes to
/// nine digits.
HeardEvent as_stored(HeardEvent event);

/// Files DIR/YYYY-MM-DD.csv in the native format, with times counted from 1970 (UTC). A line is
/// written to the file as soon as it is appended, and is safely on disk once sync() has returned.
/// If a power failure leaves part of a line, it is cut off before the file is appended to again
/// (MonitorArchiveTest.ATornLineIsCutOff). Text that a failed sync() may have lost is written again
/// by the next one (MonitorArchiveTest.WhatAFailedSyncLostIsWrittenAgain).
class Archive {
public:
  /// Creates the folder if it does not exist. Throws OutputError if it cannot be written to, or if
  /// another process is writing to this archive.
  explicit Archive(std::string folder);
  ~Archive();
  Archive(const Archive&) = delete;
  Archive& operator=(const Archive&) = delete;

  /// Sets the header of the days to come: the source's columns, its nominal period and the width of
  /// its flag. Until then the header of the last day in the archive is used.
  void describe(const NativeColumns& columns);
  /// Appends an event whose time counts from 1970. Values for which the header of the open day has
  /// no column are put in a comment on the next line. Throws OutputError, and then nothing of the
  /// event is in the file. It also throws after a failed sync() once 4 MB of unsaved text are held
  /// in memory (MonitorArchiveTest.WhatIsUnsafeIsBounded).
  void append(const HeardEvent& event);
  /// Appends a comment, which readers of logs skip, to the open day or, if none is open, to that of
  /// `at`. Throws OutputError.
  void note(const std::string& text, const Instant& at);
  /// The comments of a day.
  [[nodiscard]] std::vector<std::string> notes_of(const std::string& day) const;
  /// The comments after the last event. That event may be on an earlier day than the last one.
  [[nodiscard]] std::vector<std::string> last_notes() const;
  /// Writes everything that was appended to disk. Throws OutputError.
  void sync();
  [[nodiscard]] bool is_synced() const { return is_synced_; }

  /// The date of second 0 of a source whose times carry no date, as last recorded in the archive;
  /// nothing for dated times.
  [[nodiscard]] std::optional<Instant> origin() const { return origin_; }
  /// Sets it. It is recorded in a comment before the next event, which is the first dated by it.
  void set_origin(const Instant& origin);
  /// The time of the last event.
  [[nodiscard]] std::optional<Instant> last_time() const { return last_time_; }
  /// The nominal period that the source stated, from the header of the last day.
  [[nodiscard]] std::optional<double> nominal_period_s() const { return columns_.nominal_period_s; }

  /// The direction of the last event.
  [[nodiscard]] Edge last_edge() const { return last_edge_; }

  /// The days in the archive, in order.
  [[nodiscard]] std::vector<std::string> days() const;
  /// The days after one day and before another.
  [[nodiscard]] std::vector<std::string> days_between(const std::string& after,
                                                      const std::string& before) const;
  /// The events of one day; none if it cannot be read.
  [[nodiscard]] std::vector<Beat> events_of(const std::string& day) const;
  /// Whether the archive has an event of exactly that time.
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
  std::string day_;               // the open day
  std::string unsynced_;          // text of the open day that may not be on disk yet
  std::int64_t synced_bytes_ = 0; // length of its text that is on disk
  bool sync_failed_ = false;      // the system may have discarded the unsynced text
  NativeColumns columns_;         // for the header of a new day
  NativeColumns day_columns_;     // in the header of the open day
  bool is_synced_ = true;
  bool has_origin_ = true; // origin_ is recorded in the open day
  std::optional<Instant> origin_, last_time_;
  Edge last_edge_ = Edge::up;
};

} // namespace goingrate::apps
