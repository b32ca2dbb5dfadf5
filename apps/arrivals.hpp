// Events as they arrive: in their place, out of it, or of a source that began again.
#pragma once

#include "goingrate/log/clock_log.hpp"
#include "goingrate/log/reading.hpp"

#include <deque>
#include <optional>
#include <utility>
#include <vector>

namespace goingrate::apps {

/// An event with what else its line tells.
struct HeardEvent : Beat {
  EventValues values{};

  HeardEvent() = default;
  /// Nothing else is told.
  HeardEvent(const Beat& event) : Beat(event) {}
  HeardEvent(const Beat& event, const EventValues& told) : Beat(event), values(told) {}
};

/// Believes a time that leaps far forward, or back, only if the next ones go on from there: three,
/// if it leaps over as much time as went by while nothing was heard, and more if it does not, since
/// lines that a fault of the source makes may agree with each other for a while (ArrivalsTest).
/// Then a leap back is a source that begins again; what is not believed is left out.
class Arrivals {
public:
  /// An event to go on with.
  struct Arrival {
    HeardEvent event;
    bool begins_anew = false; ///< its time has nothing to do with those before
  };

  /// `elsewhere_events`: how many must go on from a leap until it is believed.
  explicit Arrivals(std::size_t elsewhere_events = 16) : elsewhere_events_(elsewhere_events) {}

  /// The last event that was believed before, and when it was heard, s by any steady clock; nothing
  /// where events are not heard as they happen.
  void go_on_from(const Beat& event, std::optional<double> heard_s);
  /// What can be gone on with now.
  std::vector<Arrival> add(const HeardEvent& event, std::optional<double> heard_s = {});
  /// An event that is known to be one, as those of an archive are.
  Arrival believe(const HeardEvent& event);
  /// Events that wait for others to go on from them.
  [[nodiscard]] const std::vector<HeardEvent>& held() const { return held_; }
  /// What was held at the end.
  std::vector<Arrival> rest();
  /// Events that were left out since the last call.
  std::vector<HeardEvent> take_left_out() { return std::exchange(left_out_, {}); }

private:
  [[nodiscard]] bool fits(const Beat& event, std::optional<double> heard_s) const;
  [[nodiscard]] bool follows(const Beat& event, const Beat& before) const;
  [[nodiscard]] std::optional<double> beyond_silence(const Beat& event,
                                                     std::optional<double> heard_s) const;
  [[nodiscard]] double silence_error(std::optional<double> heard_s) const;
  void hold(const HeardEvent& event, std::optional<double> heard_s);
  std::vector<Arrival> release();
  void leave_out_held();
  void learn(double step_s);

  std::size_t elsewhere_events_;
  double usual_step_s_ = 0.0;             // 0: not known
  std::deque<double> steps_s_;            // the last ones
  std::optional<Beat> last_, one_before_; // of those believed
  std::optional<double> last_heard_s_;
  bool is_first_ = true;         // no event fitted yet
  std::vector<HeardEvent> held_; // each follows the one before
  bool held_is_over_silence_ = false;
  std::vector<HeardEvent> left_out_;
};

} // namespace goingrate::apps
