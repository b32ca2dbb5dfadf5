// The index of an archive: what its days came to. It is made again from them where it is missing.
#pragma once

#include "going.hpp"

#include <memory>
#include <string>
#include <vector>

namespace goingrate::apps {

/// A place where the count was carried over beats that were not heard.
struct CountBreak {
  Instant at; ///< of the beat after it
  std::int64_t after_cycle = 0, missing = 0;
  double probability = 1.0; ///< that `missing` is right
};

/// An alarm as it is remembered.
struct AlarmRecord {
  double at_s = 0.0; ///< since 1970
  std::string kind, text;
  bool is_raised = false;
};

/// DIR/.index.sqlite, hidden so that the folder is a log. A change throws OutputError where it
/// cannot be written. A file that is not such an index, or is damaged, is replaced
/// (MonitorArchiveTest.TheIndexIsMadeAgainFromNothing, .AnIndexThatIsDamagedIsMadeAgain); one that
/// cannot be opened for another reason stays, and what is put is kept in memory.
class ArchiveIndex {
public:
  explicit ArchiveIndex(const std::string& folder);
  ~ArchiveIndex();

  /// Days that are complete, with the blocks of their hours, in order.
  [[nodiscard]] std::vector<std::string> days() const;
  [[nodiscard]] std::vector<GoingBlock> hours() const;
  [[nodiscard]] std::vector<CountBreak> breaks() const;
  [[nodiscard]] std::vector<AlarmRecord> alarms() const;
  /// The first beat of the run that went on at the end of a day.
  [[nodiscard]] std::optional<Beat> first_of_run(const std::string& day) const;
  /// What alarms had learnt when a day ended; empty if it is not known. It is known for the last
  /// thirty days.
  [[nodiscard]] std::vector<double> learnt(const std::string& day) const;
  /// Whether the files of its days are as long and as old as they were when these were put.
  [[nodiscard]] bool is_of_the_files() const;
  void put_day(const std::string& day, const std::vector<GoingBlock>& hours,
               const std::optional<Beat>& first_of_run);
  void put_learnt(const std::string& day, const std::vector<double>& numbers);
  void put_break(const CountBreak& gap);
  void put_alarm(const AlarmRecord& alarm);
  /// Everything is forgotten.
  void clear();

private:
  struct Database;
  std::string folder_;
  std::unique_ptr<Database> database_;
};

} // namespace goingrate::apps
