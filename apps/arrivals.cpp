#include "arrivals.hpp"

#include <algorithm>
#include <cmath>

namespace goingrate::apps {

namespace {
constexpr double longest_gap_steps = 20.0; // where beats are missing for so long, it can wait
}

void Arrivals::go_on_from(const Beat& event, std::optional<double> heard_s) {
  last_ = event;
  last_heard_s_ = heard_s;
}

std::vector<Arrivals::Arrival> Arrivals::add(const HeardEvent& event,
                                             std::optional<double> heard_s) {
  if (fits(event, heard_s)) {
    leave_out_held();
    if (last_ && event.time < last_->time) return {{event, false}}; // one place too late
    if (last_) learn(event.time - last_->time);
    one_before_ = std::exchange(last_, event);
    last_heard_s_ = heard_s;
    is_first_ = false;
    return {{event, false}};
  }
  hold(event, heard_s);
  // Noise does not agree with itself that often; a fault of the source may, for a while.
  constexpr std::size_t over_silence_events = 3;
  if (held_.size() < (held_is_over_silence_ ? over_silence_events : elsewhere_events_)) return {};
  last_heard_s_ = heard_s;
  return release();
}

Arrivals::Arrival Arrivals::believe(const HeardEvent& event) {
  const bool is_behind = last_ && event.time < last_->time;
  if (is_behind && one_before_ && event.time > one_before_->time) return {event, false};
  one_before_ = std::exchange(last_, event);
  return {event, is_behind};
}

// If the source is live, events that do not go on from any other stay held.
std::vector<Arrivals::Arrival> Arrivals::rest() {
  if (last_heard_s_ && !held_is_over_silence_) return {};
  const bool after = !held_.empty() && last_ && held_.front().time > last_->time;
  if (after || held_.size() > 1) return release();
  leave_out_held();
  return {};
}

// Whether it comes in its place, or one place too late in the log.
bool Arrivals::fits(const Beat& event, std::optional<double> heard_s) const {
  if (!last_) return true;
  if (event.time < last_->time) return one_before_ && event.time > one_before_->time;
  const auto beyond_s = beyond_silence(event, heard_s);
  if (is_first_ && beyond_s) return *beyond_s < silence_error(heard_s);
  return follows(event, *last_);
}

// How much more time the event leaps over than went by since the last one was heard.
std::optional<double> Arrivals::beyond_silence(const Beat& event,
                                               std::optional<double> heard_s) const {
  if (!last_ || !last_heard_s_ || !heard_s) return {};
  return (event.time - last_->time) - (*heard_s - *last_heard_s_);
}

// A line may wait in a buffer, and two clocks differ.
double Arrivals::silence_error(std::optional<double> heard_s) const {
  constexpr double waited_s = 1.0, clocks_differ = 1e-3;
  return waited_s + longest_gap_steps * usual_step_s_ + clocks_differ * (*heard_s - *last_heard_s_);
}

bool Arrivals::follows(const Beat& event, const Beat& before) const {
  const double step = event.time - before.time;
  return step >= 0.0 && (usual_step_s_ == 0.0 || step <= longest_gap_steps * usual_step_s_);
}

void Arrivals::learn(double step_s) {
  constexpr std::size_t fewest_steps = 4,
                        most_steps = 15; // the middle of which a few odd ones do not move
  steps_s_.push_back(step_s);
  if (steps_s_.size() > most_steps) steps_s_.pop_front();
  if (steps_s_.size() < fewest_steps) return;
  // Steps between bounces of a contact do not count; the largest may be a gap.
  std::vector<double> sorted(steps_s_.begin(), steps_s_.end());
  std::sort(sorted.begin(), sorted.end());
  const double bounce = 0.1 * sorted[sorted.size() - 2];
  const auto first = std::lower_bound(sorted.begin(), sorted.end(), bounce);
  usual_step_s_ = *(first + (sorted.end() - first) / 2);
}

void Arrivals::hold(const HeardEvent& event, std::optional<double> heard_s) {
  if (!held_.empty() && !(held_.back().time < event.time && follows(event, held_.back())))
    leave_out_held();
  if (held_.empty()) {
    const auto beyond_s = beyond_silence(event, heard_s);
    held_is_over_silence_ = beyond_s && std::abs(*beyond_s) < silence_error(heard_s);
  }
  held_.push_back(event);
}

std::vector<Arrivals::Arrival> Arrivals::release() {
  is_first_ = false;
  const bool anew = last_ && held_.front().time < last_->time;
  std::vector<Arrival> arrivals;
  for (const HeardEvent& event : held_)
    arrivals.push_back({event, anew && arrivals.empty()});
  one_before_ = held_.size() > 1 ? std::optional<Beat>(held_[held_.size() - 2]) : std::nullopt;
  last_ = held_.back();
  held_.clear();
  return arrivals;
}

void Arrivals::leave_out_held() {
  left_out_.insert(left_out_.end(), held_.begin(), held_.end());
  held_.clear();
}

} // namespace goingrate::apps
