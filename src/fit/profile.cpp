#include "profile.hpp"

#include "base/special_values.hpp"
#include "base/workers.hpp"

#include "goingrate/base/pulse.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace goingrate::timing_model {

namespace {

constexpr double z68 = 1.0;

// The profile likelihood of one coordinate; z is its distance from the minimum in sigmas of the
// curvature.
class Profile {
public:
  /// `widening`: the stated sigma over the curvature's. `search`: follow the ridge to the ends of
  /// the interval where the likelihood is not nearly a parabola.
  Profile(const ProfiledPlace& place, std::size_t k, double widening, bool search)
      : ridge_(place, k, widening), least_(place.minimum.value), widening_(widening),
        search_(search) {}

  /// The ends of the interval, in z.
  Interval ends() {
    const auto [low68, low95, low] = ends_on(-1.0);
    const auto [high68, high95, high] = ends_on(1.0);
    return {low68, high68, low95, high95, low, high};
  }

  /// The fall of 2 log L at z, over the square of the widening; nullopt if the ridge is lost. To be
  /// called at growing distances on one side, then on the other.
  std::optional<double> fall(double z) {
    if (ridge_.last().z * z < 0.0) ridge_.restart();
    if (!ridge_.walk_to(z)) return {};
    return 2.0 * std::max(0.0, ridge_.last().rise) / (widening_ * widening_);
  }

private:
  struct Ends {
    double at68, at95;
    Interval::Root root;
  };
  static Ends open_ends(double side) { return {side * infinite, side * infinite, {{}, {}}}; }

  // The rise of L at q stated sigma along the tangent of the ridge, after one step of scoring,
  // divided by the parabola's; 0 where the step gains so much that it cannot be trusted.
  [[nodiscard]] double relative_rise(double q) const {
    constexpr double largest_gain = 3.0; // parabolas
    const double z = q * widening_, parabola = 0.5 * z * z;
    const auto there = ridge_.look(z);
    if (!there || there->gain > largest_gain * parabola) return 0.0;
    return (there->value - least_) / parabola;
  }

  // The ends on one side, by the rules of intervals().
  Ends ends_on(double side) {
    constexpr double parabola_tolerance = 0.1; // of the rise: a twentieth of the interval
    constexpr double least_shape = 0.65, largest_shape = 1.5; // for which the polynomial serves
    // The root of twice the rise is |z| (a + b z), with a and b from the rise at 1 and 1.96 sigma.
    const double shape = relative_rise(side * z95), near = relative_rise(side * z68);
    const double from = near > 0.0 ? z68 : 0.0, of_near = near > 0.0 ? std::sqrt(near) : 1.0;
    const double b = (std::sqrt(shape) - of_near) / (side * (z95 - from) * widening_);
    const double a = of_near - b * side * from * widening_;
    const Interval::Root line{{0.0, 1.0}, {a, a + b}};
    if (std::abs(shape - 1.0) < parabola_tolerance)
      return {side * z68 * widening_, side * z95 * widening_, line};
    const auto by_root = [&]() -> Ends {
      if (!(shape > least_shape && shape < largest_shape)) return open_ends(side);
      const auto root = [&](double z) { return 2.0 * z / (a + std::sqrt(a * a + 4.0 * b * z)); };
      return {root(side * z68 * widening_), root(side * z95 * widening_), line};
    };
    if (!search_ || (shape > 1.0 && shape < largest_shape)) return by_root();
    // If L rises slowly, the ends lie beyond 1.96 sigma, where L was not evaluated; there the ridge
    // is better than the polynomial, as far as it can be followed.
    ridge_.restart();
    feet_ = {{0.0}, {1.0}};
    const double at68 = walk_to_root(z68 * widening_, side);
    if (!std::isfinite(at68)) return by_root();
    const double at95 = walk_to_root(z95 * widening_, side);
    return std::isfinite(at95) ? Ends{at68, at95, feet_} : by_root();
  }

  static double root_of(const Foot& foot) { return std::sqrt(2.0 * std::max(0.0, foot.rise)); }

  // The z at which the root of twice the rise reaches `target` along the ridge. Where the ridge is
  // lost after half of the target, the root is extrapolated linearly; infinite where it is lost
  // earlier.
  double walk_to_root(double target, double side) {
    constexpr double farthest = 30.0;  // sigma
    constexpr double tolerance = 0.02; // of the root
    while (root_of(ridge_.last()) < target) {
      pulse();
      const Foot& last = ridge_.last();
      if (std::abs(last.z) > farthest * widening_ || !ridge_.advance(side))
        return root_of(last) > 0.5 * target ? last.z * target / root_of(last) : side * infinite;
      feet_.z.push_back(ridge_.last().z);
      feet_.over_z.push_back(root_of(ridge_.last()) / std::abs(ridge_.last().z));
    }
    // The root is nearly linear between these two points: a few secant steps find the target.
    const Foot &within = ridge_.before(), &beyond = ridge_.last();
    double inside = within.z, root_inside = root_of(within);
    double outside = beyond.z, root_outside = root_of(beyond);
    for (int round = 0; round < 4; ++round) {
      const double z =
          inside + (target - root_inside) / (root_outside - root_inside) * (outside - inside);
      const auto between = ridge_.between(z, within, beyond);
      if (!between) return z;
      const double root = root_of(*between);
      if (std::abs(root - target) < tolerance * target) return z;
      (root < target ? inside : outside) = z;
      (root < target ? root_inside : root_outside) = root;
    }
    return 0.5 * (inside + outside);
  }

  Ridge ridge_;
  double least_; // L at the minimum
  double widening_;
  bool search_;
  Interval::Root feet_{}; // points of the ridge found so far on the present side
};

// If every relative sigma is below this, the likelihood counts as a parabola: the two sides of an
// interval then differ by about the same small fraction.
constexpr double small_relative_sigma = 0.015;

// Whether the likelihood along this coordinate is a parabola, whatever else the log leaves open:
// the jitter that every beat shows.
bool is_of_every_beat(const Slot& slot, const Certainty& known) {
  return slot.quantity == Quantity::jitter_rms && known.sigma(slot.index) < small_relative_sigma;
}

// The fit whose L the profiles evaluate: that on few beats if it determines every coordinate as
// well as all beats do, or so well that the profile is a parabola.
const ProfiledPlace& place_to_evaluate(const ProfiledPlace& all, const ProfiledPlace* few) {
  constexpr double largest_sigma_change = 0.2; // relative
  constexpr double tight_sigma = 0.05; // of a logarithm: asymmetry of a twentieth of the interval
  if (few == nullptr) return all;
  for (const Slot& slot : all.problem.parameters.slots) {
    if (!slot.free || is_of_every_beat(slot, all.known)) continue;
    const std::size_t k = slot.index;
    const double sigma = few->known.curvature_sigma(k);
    const double ratio = sigma / all.known.curvature_sigma(k);
    if (!(std::abs(ratio - 1.0) < largest_sigma_change) && !(sigma < tight_sigma && ratio > 1.0))
      return all;
  }
  return *few;
}

// The root of twice the rise at z, interpolated: sqrt(2 rise)/|z| is a parabola through the three
// stored points about z, or a line if there are only two.
double root_at(const Interval::Root& root, double z) {
  const std::size_t count = std::min<std::size_t>(3, root.z.size());
  const auto beyond = std::find_if(root.z.begin(), root.z.end(),
                                   [&](double at) { return std::abs(at) >= std::abs(z); });
  const auto place = static_cast<std::size_t>(beyond - root.z.begin());
  const std::size_t first =
      std::min(place - std::min<std::size_t>(place, 2), root.z.size() - count);
  double over_z = 0.0;
  for (std::size_t i = first; i < first + count; ++i) {
    double weight = root.over_z[i];
    for (std::size_t k = first; k < first + count; ++k)
      if (k != i) weight *= (z - root.z[k]) / (root.z[i] - root.z[k]);
    over_z += weight;
  }
  return std::abs(z) * over_z;
}

// The root of twice the rise at `points` equal steps up to z = `reach`; empty where it is unknown
// or does not increase.
std::vector<double> rising(const Interval::Root& root, double reach, int points) {
  std::vector<double> values;
  if (root.z.size() < 2) return values;
  double last = 0.0;
  for (int i = 1; i <= points; ++i) {
    const double here = root_at(root, reach * i / points);
    if (!(here > last)) return {};
    values.push_back(last = here);
  }
  return values;
}

} // namespace

std::vector<Interval> intervals(const ProfiledPlace& all, const ProfiledPlace* few,
                                bool model_holds) {
  const FitProblem& problem = all.problem;
  const Certainty& known = all.known;
  std::vector<Interval> result(all.minimum.x.size(), {-infinite, infinite, -infinite, infinite});
  double largest = 0.0;
  for (const Slot& slot : problem.parameters.slots)
    if (slot.free && !is_noise(slot.quantity) && slot.coordinate == Coordinate::logarithm)
      largest = std::max(largest, known.sigma(slot.index));
  share(problem.parameters.slots.size(), [&](std::size_t i) {
    const Slot& slot = problem.parameters.slots[i];
    if (!slot.free || is_of_moment(slot.quantity)) return;
    const std::size_t k = slot.index;
    const double sigma = known.sigma(k), x = all.minimum.x[k];
    const double tolerable = tolerable_sigma(problem, slot, all.minimum.x);
    const bool lopsided = is_noise(slot.quantity) || may_vanish(slot);
    if ((!(sigma <= tolerable) && !may_vanish(slot)) || known.distrusted[k]) return;
    if ((largest < small_relative_sigma && !may_vanish(slot)) || is_of_every_beat(slot, known)) {
      result[k] = {x - sigma, x + sigma, x - z95 * sigma, x + z95 * sigma};
      return;
    }
    // Following the ridge takes long. It is not worthwhile if the model does not hold, or if the
    // sigma of the parameter is larger than this share of the tolerable one.
    constexpr double searched_share = 0.4;
    const bool search = model_holds && (lopsided || sigma <= searched_share * tolerable);
    const double unit = known.curvature_sigma(k);
    const Interval z = Profile(place_to_evaluate(all, few), k, sigma / unit, search).ends();
    const double least = !problem.bounds.empty() && problem.bounds[k][0] == 0.0 ? 0.0 : -infinite;
    const auto at = [&](double end) { return std::max(least, x + end * unit); };
    result[k] = {at(z.low68), at(z.high68), at(z.low95), at(z.high95), z.low, z.high};
  });
  return result;
}

std::vector<ProfilePoint> profile_points(const ProfiledPlace& all, const ProfiledPlace* few,
                                         const Slot& slot, const Interval& interval) {
  constexpr int points_a_side = 5;
  constexpr double reach_factor = 1.15, open_reach = 3.0; // of the interval; sigma
  const std::size_t k = slot.index;
  const double unit = all.known.curvature_sigma(k), widening = all.known.sigma(k) / unit;
  Profile profile(place_to_evaluate(all, few), k, widening, true);
  std::vector<double> x = all.minimum.x;
  std::vector<ProfilePoint> found{{slot.value(std::span<const double>(x)), 0.0}};
  for (const double end : {interval.low95, interval.high95}) {
    const bool low = end == interval.low95;
    const double reach = std::isfinite(end) ? reach_factor * (end - all.minimum.x[k]) / unit
                                            : (low ? -open_reach : open_reach) * widening;
    const auto roots = rising(low ? interval.low : interval.high, reach, points_a_side);
    for (int i = 1; i <= points_a_side; ++i) {
      pulse();
      const double z = reach * i / points_a_side;
      x[k] = all.minimum.x[k] + z * unit;
      const auto& bounds = all.problem.bounds;
      if (!bounds.empty() && (x[k] < bounds[k][0] || x[k] > bounds[k][1])) break;
      const auto fall =
          roots.empty()
              ? profile.fall(z)
              : std::optional(std::pow(roots[static_cast<std::size_t>(i - 1)] / widening, 2));
      if (fall) found.push_back({slot.value(std::span<const double>(x)), *fall});
    }
  }
  std::sort(found.begin(), found.end(),
            [](const ProfilePoint& a, const ProfilePoint& b) { return a.value < b.value; });
  return found;
}

void reach_along_the_ridge(const ProfiledPlace& place, std::span<const double> x, Stated& stated) {
  constexpr double largest_rise = 4.5; // of L: three sigma
  // A point this many times as far out as the interval allows counts as a fold of the ridge.
  constexpr double folded_ratio = 1.5;
  Certainty& known = stated.known;
  known.reach.assign(x.size(), 1.0);
  const std::vector<Interval> before = stated.ends;
  std::vector<double> widening; // the stated sigma over that of the curvature
  double widest = 1.0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    widening.push_back(known.sigma(k) / known.curvature_sigma(k));
    widest = std::max(widest, widening.back());
  }
  const auto take = [&](const Foot& foot, std::size_t k) {
    const double way = foot.x[k] - place.minimum.x[k], distance = std::abs(way);
    const double sigmas = std::max(z68, std::sqrt(2.0 * std::max(0.0, foot.rise)) / widening[k]);
    const double end68 = way < 0.0 ? x[k] - before[k].low68 : before[k].high68 - x[k];
    const double end95 = way < 0.0 ? x[k] - before[k].low95 : before[k].high95 - x[k];
    if (!(distance > folded_ratio * std::max(end68, end95 * sigmas / z95))) return;
    const double sigma = std::max(known.sigma(k), distance / sigmas);
    known.reach[k] *= sigma / known.sigma(k);
    Interval& ends = stated.ends[k];
    ends.low68 = std::min(ends.low68, x[k] - sigma);
    ends.high68 = std::max(ends.high68, x[k] + sigma);
    ends.low95 = std::min(ends.low95, x[k] - z95 * sigma);
    ends.high95 = std::max(ends.high95, x[k] + z95 * sigma);
  };
  for (const RidgeSide& side : sides_of_most_open(place, largest_rise * widest * widest))
    for (const Foot& foot : side.feet)
      for (std::size_t k = 0; k < x.size(); ++k)
        take(foot, k);
}

} // namespace goingrate::timing_model
