#include "step_search.hpp"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>

namespace goingrate::timing_model {

namespace {

// Within `reach` on either side of 0, near which the search is finest.
template <class Gain> double offset_of_best(const Gain& gain, double reach) {
  constexpr int bits = 8;
  const auto loss = [&](double off) { return -gain(off); };
  return boost::math::tools::brent_find_minima(loss, -reach, reach, bits).first;
}

} // namespace

StepSearch::StepSearch(const Account& account, const RateBlocks& blocks, double place, double doubt)
    : account_(account), make_(blocks), block_s_(blocks.length_s), place_(place),
      doubt_(std::min(std::max(1.0, doubt),
                      0.5 * std::min(place, static_cast<double>(blocks.rate.size()) - place))),
      last_log_time_(std::log(block_s_ * (static_cast<double>(blocks.rate.size()) - place))) {}

FittedStep StepSearch::best(ChangeKind kind) const {
  FittedStep best;
  const auto consider = [&](double place, double log_time) {
    FittedStep step = at(kind, place, log_time);
    if (step.gain > best.gain) best = std::move(step);
  };
  const bool relaxes = kind != ChangeKind::regulation;
  constexpr double octave = 0.7, coarse = 1.4; // of log time
  const double first = relaxes ? std::log(0.3 * block_s_) : last_log_time_ - 0.5 * coarse;
  const double stride = std::max(0.5, doubt_ / 4.0);
  for (double place = place_ - doubt_; place <= place_ + doubt_; place += stride)
    for (double log_time = first; log_time < last_log_time_; log_time += coarse)
      consider(place, log_time);
  if (best.courses.rate.empty()) return best; // the amplitude speaks against it everywhere
  for (int round = 0; round < 3; ++round) {   // place and time hardly depend on each other
    const double place = best.place, log_time = std::log(best.time_s);
    consider(place + offset_of_best(
                         [&](double off) { return at(kind, place + off, log_time).gain; }, stride),
             log_time);
    if (!relaxes) continue;
    const double found = best.place;
    consider(found, log_time + offset_of_best(
                                   [&](double off) { return at(kind, found, log_time + off).gain; },
                                   octave));
  }
  return best;
}

// The amplitude and the rate are curved functions of the squared amplitude: they have the powers of
// its approach in them too, which show if the change is large.
FittedStep StepSearch::at(ChangeKind kind, double place, double log_time) const {
  FittedStep step{place, std::exp(log_time), 0.0, {{make_.step(place)}, {}, 1}};
  if (kind == ChangeKind::regulation) {
    step.gain = account_.gain_of(step.courses);
    return step;
  }
  step.gain = -std::numeric_limits<double>::infinity();
  Courses courses{{}, {}, 2};
  if (kind == ChangeKind::drive) courses.rate.push_back(make_.step(place));
  constexpr int most_powers = 2; // more would make a jump of their own
  for (int power = 1; power <= most_powers; ++power) {
    const auto approach = make_.approach(place, step.time_s / power);
    courses.rate.push_back(approach);
    courses.amplitude.push_back(approach);
    const double gain = account_.gain_of(courses);
    if (gain <= step.gain) break;
    // An amplitude that is seen and does not follow speaks against it, whatever the rate does.
    if (account_.sees_amplitude() && account_.amplitude_gain_of(courses) < 0.0) break;
    step.gain = gain;
    step.courses = courses;
  }
  return step;
}

} // namespace goingrate::timing_model
