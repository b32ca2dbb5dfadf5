#include "arrivals.hpp"

#include <algorithm>

namespace goingrate::apps {

std::vector<Arrivals::Arrival> Arrivals::add(const Beat& event) {
  if (fits(event)) {
    leave_out_held();
    if (last_ && event.time < last_->time) return {{event, false}}; // out of order by one
    if (last_) learn(event.time - last_->time);
    one_before_ = std::exchange(last_, event);
    return {{event, false}};
  }
  hold(event);
  constexpr std::size_t events_that_agree = 3; // noise does not agree with itself so often
  return held_.size() < events_that_agree ? std::vector<Arrival>{} : release();
}

std::vector<Arrivals::Arrival> Arrivals::rest() {
  const bool after = !held_.empty() && last_ && held_.front().time > last_->time;
  if (after || held_.size() > 1) return release();
  leave_out_held();
  return {};
}

// In its place, or one place too late in the log.
bool Arrivals::fits(const Beat& event) const {
  return !last_ || follows(event, *last_) ||
         (event.time < last_->time && one_before_ && event.time > one_before_->time);
}

bool Arrivals::follows(const Beat& event, const Beat& before) const {
  constexpr double longest_gap_steps =
      20.0; // steps: where beats are missing for so long, it can wait
  const double step = event.time - before.time;
  return step >= 0.0 && (usual_step_s_ == 0.0 || step <= longest_gap_steps * usual_step_s_);
}

void Arrivals::learn(double step_s) {
  constexpr std::size_t fewest_steps = 4,
                        most_steps = 15; // the middle of which a few odd ones do not move
  steps_s_.push_back(step_s);
  if (steps_s_.size() > most_steps) steps_s_.pop_front();
  if (steps_s_.size() < fewest_steps) return;
  // Steps from one bounce of a contact to the next are none; the largest may be a gap.
  std::vector<double> sorted(steps_s_.begin(), steps_s_.end());
  std::sort(sorted.begin(), sorted.end());
  const double bounce = 0.1 * sorted[sorted.size() - 2];
  const auto first = std::lower_bound(sorted.begin(), sorted.end(), bounce);
  usual_step_s_ = *(first + (sorted.end() - first) / 2);
}

void Arrivals::hold(const Beat& event) {
  if (!held_.empty() && !(held_.back().time < event.time && follows(event, held_.back())))
    leave_out_held();
  held_.push_back(event);
}

std::vector<Arrivals::Arrival> Arrivals::release() {
  const bool anew = last_ && held_.front().time < last_->time;
  std::vector<Arrival> arrivals;
  for (const Beat& event : held_)
    arrivals.push_back({event, anew && arrivals.empty()});
  one_before_ = held_.size() > 1 ? std::optional(held_[held_.size() - 2]) : std::nullopt;
  last_ = held_.back();
  held_.clear();
  return arrivals;
}

void Arrivals::leave_out_held() {
  left_out_.insert(left_out_.end(), held_.begin(), held_.end());
  held_.clear();
}

} // namespace goingrate::apps
