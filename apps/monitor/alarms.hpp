// The alarms of a clock that is watched.
#pragma once

#include "amplitude_fall.hpp"
#include "daily_wave.hpp"
#include "going.hpp"
#include "index.hpp"
#include "moment.hpp"
#include "step_alarm.hpp"

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace goingrate::apps {

enum class AlarmKind {
  stopped,
  out_of_beat,
  rate_step,
  amplitude_falling,
  sensor_failing,
  archive_failing
};
inline constexpr std::size_t alarm_kinds = 6;
std::string_view name_of(AlarmKind kind);

/// An alarm that began or ended.
struct AlarmChange {
  AlarmKind kind = AlarmKind::stopped;
  bool is_raised = false;
  Instant at;
  std::string text; ///< the message for people
};

struct LastMinutes;

/// Raises and clears alarms. Each has a limit at which it is raised and a lower one at which it is
/// cleared.
class Alarms {
public:
  /// `patience_s`: silence after which the clock has stopped; 0: five periods. `lateness_s`: how
  /// long after a beat its line may come, which does not count as silence.
  explicit Alarms(double patience_s, double lateness_s = 0.0)
      : patience_s_(patience_s), lateness_s_(lateness_s) {}

  /// After a beat: looks at the last complete minute, if a new one has begun. With `replay` the
  /// past is only learnt from, and no alarm is raised.
  void heard(const Going& going, double nominal_period_s, bool is_replay);
  /// Continues from the records of an earlier run, in order of time.
  void restore(const std::vector<AlarmRecord>& records);
  /// What was learnt about the clock so far, as numbers; take_learnt() continues from them.
  [[nodiscard]] std::vector<double> learnt() const;
  void take_learnt(std::vector<double> numbers);
  /// No good beat was heard for `silence_s`: checks whether the clock is running, and whether the
  /// events heard instead come from a failing sensor.
  void silent(double silence_s, double period_s, const Going& going, const Moment& now);
  /// The source stated a date that is `error_s` from the computer's.
  void misdated(double error_s, const Moment& now);
  /// Many events were heard that are not the beats of one clock.
  void no_beats(const std::string& why, const Moment& now);
  void archive_fails(const Moment& now, const std::string& why);
  /// Everything is on disk. The alarm ends when that has been so for a minute.
  void archive_works(const Moment& now);

  /// What changed since the last call.
  std::vector<AlarmChange> take_changes() { return std::exchange(changes_, {}); }
  /// The alarms that are raised now, in the words they were raised with.
  [[nodiscard]] std::vector<AlarmChange> raised() const;

private:
  void set(AlarmKind kind, bool raised, const Instant& at, const std::string& text);
  [[nodiscard]] bool is_raised(AlarmKind kind) const;
  void look_at_minutes(const Going& going, double nominal_period_s);
  void goes(const Instant& at, const Going& going, double period_s);
  [[nodiscard]] double patience_of(const Going& going, double period_s) const;
  void tell_faults(const LastMinutes& last, const Instant& at);
  void look_for_steps(const Going& going, double nominal_period_s, bool is_replay);

  double patience_s_, lateness_s_;
  std::optional<Instant> goes_since_; // while `stopped` is raised
  std::optional<double> archive_failed_s_; // by the steady clock
  // Everything that is learnt about a clock.
  struct Habits {
    static constexpr double usual_winding = 10e-6; // largest usual change of the rate by winding
    DailyWave rate_wave;
    StepAlarm rate{usual_winding};
    AmplitudeFall amplitude;
    void pass(Learnt& learnt);
  };
  Habits habits_;
  bool is_faulty_ = false; // too many events of the last minutes were missing or false
  std::array<std::optional<AlarmChange>, alarm_kinds> raised_;
  std::vector<AlarmChange> changes_;
};

} // namespace goingrate::apps
