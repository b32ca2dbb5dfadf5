// The index of an archive: a summary of its days. It is made again from their files if it is
// missing.
#pragma once

#include "going.hpp"

#include <memory>
#include <string>
#include <vector>

namespace goingrate::apps {

/// A break over which the count was carried, because its beats were not heard.
struct CountBreak {
  Instant at; ///< of the beat after it
  std::int64_t after_cycle = 0, missing = 0;
  double probability = 1.0; ///< that `missing` is right
};

/// A stored alarm.
struct AlarmRecord {
  double at_s = 0.0; ///< since 1970
  std::string kind, text;
  bool is_raised = false;
};

/// DIR/.index.sqlite, hidden so that the folder is a log. A change throws OutputError if it
/// cannot be written. A file that is not such an index, or is damaged, is replaced
/// (MonitorArchiveTest.TheIndexIsMadeAgainFromNothing, .AnIndexThatIsDamagedIsMadeAgain); one that
/// cannot be opened for another reason is kept, and new entries are kept in memory.
class ArchiveIndex {
public:
  explicit ArchiveIndex(const std::string& folder);
  ~ArchiveIndex();

  /// Days that are complete, with the blocks of their hours, in order.
  [[nodiscard]] std::vector<std::string> days() const;
  [[nodiscard]] std::vector<GoingBlock> hours() const;
  [[nodiscard]] std::vector<CountBreak> breaks() const;
  [[nodiscard]] std::vector<AlarmRecord> alarms() const;
  /// The first beat of the run that was under way at the end of a day.
  [[nodiscard]] std::optional<Beat> first_of_run(const std::string& day) const;
  /// What the alarms had learnt at the end of a day; empty if that is not stored. It is stored for
  /// the last thirty days.
  [[nodiscard]] std::vector<double> learnt(const std::string& day) const;
  /// Whether the files of its days have the same size and date as when the days were put.
  [[nodiscard]] bool is_of_the_files() const;
  void put_day(const std::string& day, const std::vector<GoingBlock>& hours,
               const std::optional<Beat>& first_of_run);
  void put_learnt(const std::string& day, const std::vector<double>& numbers);
  void put_break(const CountBreak& gap);
  void put_alarm(const AlarmRecord& alarm);
  /// Removes everything.
  void clear();

private:
  struct Database;
  std::string folder_;
  std::unique_ptr<Database> database_;
};

} // namespace goingrate::apps
