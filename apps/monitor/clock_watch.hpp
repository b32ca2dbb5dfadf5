// A clock that is watched: every event is stored, numbered and looked at as it comes.
#pragma once

#include "alarm_diary.hpp"
#include "alarms.hpp"
#include "archive.hpp"
#include "event_places.hpp"
#include "going.hpp"
#include "index.hpp"
#include "moment.hpp"
#include "unread_lines.hpp"

#include "arrivals.hpp"
#include "rolling_numbers.hpp"

#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace goingrate::apps {

/// The settings of a watch.
struct WatchOptions {
  LogOptions log;
  std::string folder;
  double patience_s = 0.0; ///< silence that is an alarm; 0: five periods
  double lateness_s = 0.0; ///< of a line behind its beat at most, where lines come in batches
  std::size_t most_pending = 1'000'000; ///< events, of 100 bytes, that wait for a disk
  PlaceOptions place;
};

/// Stores, numbers and judges the events of one source, and goes on where an earlier watch of the
/// same archive stopped, however it ended.
class ClockWatch {
public:
  /// Reads the archive. Throws OutputError if it cannot be written.
  explicit ClockWatch(WatchOptions options);

  /// Text from the source that has not become events yet: kept on disk until it has.
  void hold(std::string_view text, const Moment& now);
  /// Lines that were held when the source was last listened to.
  [[nodiscard]] const std::string& unread() const { return unread_.text(); }
  /// No log was found in them.
  void give_up_unread() { unread_.give_up(); }
  /// An event as the source tells it.
  void add(const HeardEvent& event, const ClockLog& log, const Moment& now);
  /// Called while nothing comes.
  void idle(const ClockLog& log, const Moment& now);
  /// The source has ended.
  void end(const ClockLog& log, const Moment& now);

  [[nodiscard]] const Going& going() const { return going_; }
  [[nodiscard]] double nominal_period_s() const { return numbers_.nominal_period_s(); }
  [[nodiscard]] double period_s() const { return numbers_.period_s(); }
  /// What was assumed about the source, with the options that say otherwise.
  [[nodiscard]] const std::vector<Assumption>& assumptions() const {
    return numbers_.assumptions();
  }
  [[nodiscard]] const Alarms& alarms() const { return alarms_; }
  [[nodiscard]] const std::deque<AlarmRecord>& alarm_records() const { return diary_.records(); }
  [[nodiscard]] const std::deque<CountBreak>& breaks() const { return breaks_; }
  /// How long no beat has been heard, s; before the first one of this run by the archive's last.
  [[nodiscard]] double silence_s() const { return silence_s_; }
  /// Events that are safe on disk, and all that were heard, in this run.
  [[nodiscard]] std::int64_t acknowledged() const { return acknowledged_; }
  [[nodiscard]] std::int64_t heard() const { return heard_; }
  /// Events that could not be kept: the archive could not be written for so long that they were too
  /// many.
  [[nodiscard]] std::int64_t lost() const { return lost_; }
  /// Whether all that was heard is on disk as events or comments, and nothing waits.
  [[nodiscard]] bool is_all_stored() const;
  /// A comment for the day's file.
  void note(const std::string& text, const Moment& now);
  /// Alarms that began or ended since the last call.
  std::vector<AlarmChange> take_alarm_changes() { return diary_.take_fresh(); }

private:
  void restore();
  void forget_index();
  void replay(const std::vector<std::string>& days);
  void place(const ClockLog& log, const Moment& now);
  void describe(const HeardEvent& event, const ClockLog& log);
  void meet(const HeardEvent& event, const ClockLog& log, const Moment& now);
  [[nodiscard]] HeardEvent completed(HeardEvent event, const ClockLog& log);
  void offer(const HeardEvent& event, const ClockLog& log, const Moment& now);
  void keep_misdated(const HeardEvent& event, double error_s, const Moment& now);
  void note_left_out(const std::vector<HeardEvent>& events, const Moment& now);
  void may_beat(const Moment& now);
  void tell_lost(const Moment& now);
  void store_pending(const Moment& now);
  void sync(const Moment& now);
  void take(const Arrivals::Arrival& arrived, bool is_replay);
  void number(std::vector<Beat> beats, bool is_replay);
  void take_beat(const Beat& beat, bool is_replay);
  void complete_day(const Beat& beat);
  [[nodiscard]] std::vector<std::string> silent_days(const Beat& beat) const;

  WatchOptions options_;
  Archive archive_;
  ArchiveIndex index_;
  UnreadLines unread_;
  Arrivals arrivals_;
  EventPlaces places_;
  RollingNumbers numbers_;
  Going going_;
  Alarms alarms_;
  AlarmDiary diary_;
  ClockLog log_;           // what is known of the source
  NativeColumns columns_;  // those it has told so far
  bool is_first_ = true;   // no event of this run yet
  bool goes_on_from_unread_ = false; // lines of the last run are told again
  bool is_holding_ = true; // no event since the source was opened
  std::optional<Beat> last_directed_; // where directions are told from times
  std::optional<Moment> last_heard_;
  std::ptrdiff_t held_lines_ = 0;                   // that were waiting at the last call of hold()
  std::optional<double> last_good_s_, last_sync_s_; // by the steady clock
  double silence_s_ = 0.0;
  std::vector<HeardEvent> waited_;        // left by the last run: in the archive only as comments
  std::deque<Arrivals::Arrival> pending_; // with their place, and not stored yet
  std::vector<Gap> gaps_;
  std::deque<CountBreak> breaks_;
  std::int64_t acknowledged_ = 0, heard_ = 0, stored_ = 0, lost_ = 0, told_lost_ = 0;
};

} // namespace goingrate::apps
