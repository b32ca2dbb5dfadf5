#include "goingrate/fit/impulse_cycle.hpp"

#include "push_candidate.hpp"
#include "push_friction.hpp"
#include "push_shapes.hpp"

#include "base/robust.hpp"
#include "goingrate/fit/timing_data.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace goingrate {

namespace {

using namespace push_shapes;

constexpr std::size_t longest_cycle = 60; // periods between pushes

// Looks for pushes once in n periods, beginning at any place.
class RegularSearch {
public:
  RegularSearch(const Sight& sight, std::size_t n, double price)
      : sight_(sight), n_(n), price_(price), times_(less_moving_mean(sight.late, n)),
        amplitudes_(less_moving_mean(straightened(sight.amplitude), n)),
        late_(folded_means(times_, n)), swing_(folded_means(amplitudes_, n)) {}

  // The best place. A tooth that begins one swing early or late makes the same pattern as a
  // crossing that is off. So the third shape, for the crossing before or after the push, is used
  // only if the pattern is more than a tooth and a hump, or if these two show nothing.
  [[nodiscard]] std::optional<Candidate> best() const {
    const Sought all = most_shapes(n_), few = few_shapes(n_);
    const std::size_t place = best_place(few), next = (place + 1) % n_;
    auto plain = candidate(place, few);
    if (all.size() == few.size()) return plain;
    const bool shows = plain && plain->pushes.gain > least_gain;
    const std::size_t whole_at = !shows                                 ? best_place(all)
                                 : score(next, all) > score(place, all) ? next
                                                                        : place;
    const double more = (score(whole_at, all) - score(place, few)) *
                        static_cast<double>(sight_.late.size()); // of chi^2
    if (!(more > least_gain)) return plain;
    auto whole = candidate(whole_at, all);
    if (!whole) return plain;
    whole->pushes.gain += shows ? plain->pushes.gain : -price_;
    return whole;
  }

  // The sum of squares that a sine of n periods explains.
  [[nodiscard]] double sine() const {
    constexpr std::size_t most_shapeless_periods = 3; // periods: any pattern of so few is a sine
    if (n_ <= most_shapeless_periods) return 0.0;
    return in_noise(explained_by_sine(late_), has_swing() ? explained_by_sine(swing_) : 0.0);
  }

private:
  [[nodiscard]] bool has_swing() const { return sight_.has_swing(); }
  [[nodiscard]] double in_noise(double late, double swing) const {
    return sight_.in_noise(late, swing) / static_cast<double>(n_);
  }
  [[nodiscard]] double score(std::size_t first, Sought sought) const {
    return in_noise(explained(late_, first, sought),
                    has_swing() ? explained(swing_, first, in_amplitudes(sought)) : 0.0);
  }
  [[nodiscard]] std::size_t best_place(Sought sought) const {
    std::size_t best = 0;
    for (std::size_t first = 1; first < n_; ++first)
      if (score(first, sought) > score(best, sought)) best = first;
    return best;
  }

  // A candidate with three shapes needs the third to show.
  [[nodiscard]] std::optional<Candidate> candidate(std::size_t first, Sought sought) const {
    const bool is_whole = sought.size() == every_shape.size();
    const auto pushes = regular_pushes(first, n_, static_cast<double>(sight_.late.size()));
    const auto late = regular_coefficients(times_, pushes, n_, sought);
    const auto swing = has_swing()
                           ? regular_coefficients(amplitudes_, pushes, n_, in_amplitudes(sought))
                           : std::nullopt;
    if (!late || !late->steady) return {};
    if (has_swing() && (!swing || !swing->steady)) return {};
    const double middle = late->gain(middle_shape) + (swing ? swing->gain(middle_shape) : 0.0);
    if (is_whole && !(middle > least_gain)) return {};
    // A push increases the swing, or runs through the vertical and makes that crossing early; a
    // weak tooth of a wheel does neither.
    const bool early = is_whole && (*late)[middle_shape].value < 0.0;
    const double raised = has_swing()         ? (*swing)[tooth_shape].value
                          : sought.size() > 1 ? (*late)[hump_shape].value
                                              : std::abs((*late)[tooth_shape].value);
    if (!(raised > 0.0) && (has_swing() || !early)) return {};
    Candidate found{described(pushes, static_cast<double>(n_), *late, swing, price_),
                    score(first, sought)};
    if (has_swing() && swing->gain(tooth_shape) > least_gain)
      found.pushes.epsilon =
          friction_of_teeth(sight_.amplitude, pushes, static_cast<double>(n_), *swing);
    if (is_whole) found.pushes.gain = middle; // the others share in it
    return found;
  }

  const Sight& sight_;
  std::size_t n_;
  double price_;
  Grid times_, amplitudes_;          // without their slow parts
  std::vector<double> late_, swing_; // the same, folded
};

// Looks for pushes each of which stands out from the amplitudes.
std::optional<Candidate> visible_pushes(const Sight& sight, double price) {
  constexpr double least_height = 12.0; // sigma of a difference
  const Grid& a = sight.amplitude;
  std::vector<double> steps, known;
  for (std::size_t i = 1; i < a.size(); ++i) {
    steps.push_back(a[i] - a[i - 1]);
    if (std::isfinite(steps.back())) known.push_back(steps.back());
  }
  if (known.size() < longest_cycle) return {};
  const double middle = median(known), sigma = robust_sigma(known); // which changes `known`
  std::vector<double> heights;
  for (const double step : steps)
    if (step - middle > least_height * sigma) heights.push_back(step - middle);
  if (heights.size() < least_cycles) return {};
  const double threshold = 0.5 * median(heights);
  std::vector<double> pushes;
  std::size_t falls = 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    falls += middle - steps[i] > threshold ? 1 : 0;
    if (!(steps[i] - middle > threshold)) continue;
    // A push through the vertical raises the swing of that crossing by a part, of the next by all.
    const bool goes_on = !pushes.empty() && pushes.back() + 1.0 == static_cast<double>(i);
    if (goes_on) pushes.pop_back();
    pushes.push_back(static_cast<double>(i));
  }
  if (20 * falls > pushes.size()) return {}; // pushes do not go both up and down
  std::vector<double> intervals;
  for (std::size_t j = 1; j < pushes.size(); ++j)
    intervals.push_back(pushes[j] - pushes[j - 1]);
  const double usual = std::round(median(intervals));
  const bool is_regular = std::all_of(intervals.begin(), intervals.end(), [&](double interval) {
    return std::fmod(interval, usual) == 0.0; // some may not have been seen
  });
  if (is_regular && usual <= static_cast<double>(longest_cycle)) return {}; // found as regular
  const double mean = (pushes.back() - pushes.front()) / static_cast<double>(intervals.size());
  const double periods = is_regular ? usual : mean;
  constexpr double least_steady = 0.5; // intervals that vary more are knocks or a hand
  if (periods < 2.0 || robust_sigma(intervals) > least_steady * periods) return {};
  const auto friction = friction_between(sight.amplitude, pushes);
  auto found = irregular_candidate(sight, std::move(pushes), periods, price);
  if (!found) return {};
  found->pushes.epsilon = friction;
  found->pushes.is_regular = is_regular;
  return found;
}

// Whether apparent pushes are an overtone of pushes that are rarer than those looked for.
bool is_part_of_longer_cycle(const Sight& sight, const Candidate& found, double price) {
  if (!found.pushes.is_regular) return false;
  constexpr std::size_t most_cycle_lengths = 5; // times the longest cycle sought
  const auto n = static_cast<std::size_t>(found.pushes.periods);
  for (std::size_t longer = 2 * n;
       longer <= most_cycle_lengths * longest_cycle && longer * least_cycles <= sight.late.size();
       longer += n) {
    if (longer <= longest_cycle) continue; // already looked for
    const auto candidate = RegularSearch(sight, longer, price).best();
    if (candidate && candidate->pushes.gain > least_gain && candidate->squares > found.squares)
      return true;
  }
  return false;
}

std::vector<double> pushes_of(const ImpulseCycle& found, double last) {
  if (!found.is_regular) return found.cycles;
  return regular_pushes(static_cast<std::size_t>(found.first),
                        static_cast<std::size_t>(found.periods), last);
}

} // namespace

std::optional<ImpulseCycle> find_impulse_cycle(const TimingData& data) {
  const Sight sight = seen(data, searched_cycles);
  if (sight.late.size() < least_cycles * 4) return {};
  const double places = 0.5 * static_cast<double>(longest_cycle * (longest_cycle + 1)) - 1.0;
  const double price = 2.0 * std::log(places);
  std::optional<Candidate> best;
  double sine = 0.0;
  const auto take = [&](std::optional<Candidate> candidate) {
    if (candidate && candidate->pushes.gain > least_gain &&
        (!best || candidate->squares > best->squares))
      best = std::move(candidate);
  };
  for (std::size_t n = 2; n <= longest_cycle && n * least_cycles <= sight.late.size(); ++n) {
    const RegularSearch search(sight, n, price);
    sine = std::max(sine, search.sine()); // if it explains more than pushes do, a wheel turns
    take(search.best());
  }
  if (sight.has_swing()) take(visible_pushes(sight, price));
  if (!best || best->squares < sine) return {};
  if (is_part_of_longer_cycle(sight, *best, price)) return {};
  if (!best->pushes.cycles.empty() && sight.late.size() == searched_cycles) // each one, to the end
    best = visible_pushes(seen(data, std::numeric_limits<std::size_t>::max()), price);
  if (!best) return {};
  return std::move(best->pushes);
}

void level_impulses(const ImpulseCycle& found, TimingData& data) {
  const auto pushes = pushes_of(found, data.cycle.back());
  const double hump = found.lateness.value / height_of_hump(found.periods);
  const double mean_rad = data.has_amplitude() ? mean_of_known(data.amplitude_rad) : not_known;
  const auto cycles = static_cast<std::size_t>(std::llround(data.cycle.back())) + 1;
  const auto irregular =
      found.is_regular ? std::vector<Shapes>{} : irregular_shapes(pushes, found.periods, cycles);
  for (std::size_t i = 0; i < data.size(); ++i) {
    const Shapes at = found.is_regular
                          ? shapes_at(pushes, found.periods, data.cycle[i])
                          : irregular[static_cast<std::size_t>(std::llround(data.cycle[i]))];
    data.lateness_s[i] -= Shapes(found.kick.value, hump, found.middle.value).dot(at);
    if (found.amplitude_step)
      data.amplitude_rad[i] *= std::exp(
          -Shapes(found.amplitude_step->value, 0.0, found.amplitude_middle).dot(at) / mean_rad);
  }
}

} // namespace goingrate
