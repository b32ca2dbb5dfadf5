#include "alarm_diary.hpp"

#include "goingrate/base/errors.hpp"

#include <fmt/format.h>
#include <sstream>

namespace goingrate::apps {

namespace {

constexpr std::size_t most_records = 500;
constexpr std::string_view alarm_words = "alarm "; // begin an alarm's comment

std::string note_of(const AlarmChange& change) {
  return fmt::format("{}{} {} {}: {}", alarm_words, change.is_raised ? "begins" : "ends",
                     name_of(change.kind), format_instant(change.at, 3), change.text);
}

// The reverse of note_of().
std::optional<AlarmRecord> record_of(const std::string& note) {
  if (!note.starts_with(alarm_words)) return {};
  std::istringstream words(note.substr(alarm_words.size()));
  AlarmRecord record;
  std::string change, time;
  words >> change >> record.kind >> time >> std::ws;
  std::getline(words, record.text);
  const auto at = parse_instant(std::string_view(time).substr(0, time.find(':')));
  if (!at) return {};
  record.is_raised = change == "begins";
  record.at_s = at->to_double();
  return record;
}

// The alarm as it will be read back from its comment, so that the index has it only once.
AlarmRecord record_of(const AlarmChange& change) { return *record_of(note_of(change)); }

} // namespace

void AlarmDiary::restore() {
  const auto alarms = index_.alarms();
  records_.assign(alarms.rbegin(), alarms.rend());
}

void AlarmDiary::rebuild_index(const std::vector<std::string>& days) {
  for (const std::string& day : days)
    for (const std::string& note : archive_.notes_of(day))
      if (const auto record = record_of(note)) put_in_index(*record);
}

void AlarmDiary::put_in_index(const AlarmRecord& record) {
  try {
    index_.put_alarm(record);
  } catch (const OutputError&) { // the comment holds it
  }
}

void AlarmDiary::add(const std::vector<AlarmChange>& changes) {
  for (const AlarmChange& change : changes) {
    records_.push_back(record_of(change));
    if (records_.size() > most_records) records_.pop_front();
    fresh_.push_back(change);
    if (unnoted_.size() < most_records) unnoted_.push_back(change);
  }
  while (!unnoted_.empty()) {
    try {
      archive_.note(note_of(unnoted_.front()), unnoted_.front().at);
    } catch (const OutputError&) {
      return;
    }
    put_in_index(record_of(unnoted_.front()));
    unnoted_.pop_front();
  }
}

} // namespace goingrate::apps
