// Events as they arrive: in their place, out of it, or of a source that began again.
#pragma once

#include "goingrate/log/clock_log.hpp"

#include <deque>
#include <optional>
#include <utility>
#include <vector>

namespace goingrate::apps {

/// Believes a time that leaps far forward, or back, only if the next ones go on from there. Then a
/// leap back is a source that begins again; what is not believed is left out.
class Arrivals {
public:
  /// An event to go on with.
  struct Arrival {
    Beat event;
    bool begins_anew = false; ///< its time has nothing to do with those before
  };

  /// The last event that was believed before.
  void go_on_from(const Beat& event) { last_ = event; }
  /// What can be gone on with now.
  std::vector<Arrival> add(const Beat& event);
  /// Events that wait for others to go on from them.
  [[nodiscard]] const std::vector<Beat>& held() const { return held_; }
  /// What was held at the end.
  std::vector<Arrival> rest();
  /// Events that were left out since this was last asked.
  std::vector<Beat> take_left_out() { return std::exchange(left_out_, {}); }

private:
  [[nodiscard]] bool fits(const Beat& event) const;
  [[nodiscard]] bool follows(const Beat& event, const Beat& before) const;
  void hold(const Beat& event);
  std::vector<Arrival> release();
  void leave_out_held();
  void learn(double step_s);

  double usual_step_s_ = 0.0;             // 0: not known
  std::deque<double> steps_s_;            // the last ones
  std::optional<Beat> last_, one_before_; // of those believed
  std::vector<Beat> held_;                // each follows the one before
  std::vector<Beat> left_out_;
};

} // namespace goingrate::apps
