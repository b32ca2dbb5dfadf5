// The alarms of a watched clock, stored in its archive.
#pragma once

#include "alarms.hpp"
#include "archive.hpp"
#include "index.hpp"

#include <deque>
#include <string>
#include <utility>
#include <vector>

namespace goingrate::apps {

/// Notes every alarm that begins or ends in the day's file and in the index. Notes that cannot be
/// written because the disk is full are written later; entries that the index cannot take now are
/// restored from the comments at the next start.
class AlarmDiary {
public:
  AlarmDiary(Archive& archive, ArchiveIndex& index) : archive_(archive), index_(index) {}

  /// Takes the alarms from the index.
  void restore();
  /// Puts the alarms into an index that was lost, from the comments of these days.
  void rebuild_index(const std::vector<std::string>& days);
  void add(const std::vector<AlarmChange>& changes);

  /// The last 500, the newest at the end.
  [[nodiscard]] const std::deque<AlarmRecord>& records() const { return records_; }
  /// The alarms that were added since the last call.
  std::vector<AlarmChange> take_fresh() { return std::exchange(fresh_, {}); }

private:
  void put_in_index(const AlarmRecord& record);

  Archive& archive_;
  ArchiveIndex& index_;
  std::deque<AlarmRecord> records_;
  std::deque<AlarmChange> unnoted_; // not in the archive yet
  std::vector<AlarmChange> fresh_;
};

} // namespace goingrate::apps
