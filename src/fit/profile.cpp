#include "profile.hpp"

#include "base/workers.hpp"

#include "goingrate/base/pulse.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace goingrate::timing_model {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double q68 = 1.0, q95 = 1.959964;

// The profile likelihood of one coordinate; z is its distance from the minimum in sigmas of the
// curvature.
class Profile {
public:
  /// `widening`: the stated sigma over the curvature's. `search`: where the likelihood is no
  /// parabola, follow the ridge to the ends of the interval; without it they stay open.
  Profile(const ProfiledPlace& place, std::size_t k, double widening, bool search)
      : ridge_(place, k, widening), least_(place.minimum.value), widening_(widening),
        search_(search) {}

  /// The ends of the interval, in z.
  Interval ends() {
    const auto [low68, low95] = ends_on(-1.0);
    const auto [high68, high95] = ends_on(1.0);
    return {low68, high68, low95, high95};
  }

  /// The fall of 2 log L at z, in the units of FittedParameter; nothing where the model does not
  /// hold. To be called at growing distances on one side, then on the other. Where the look shows
  /// how the root of the rise bends, it is taken for that.
  std::optional<double> fall(double z) {
    const bool is_other_side = fallen_z_ * z <= 0.0;
    fallen_z_ = z;
    if (is_other_side) {
      ridge_.restart();
      const double side = std::copysign(1.0, z), shape = look(side * q95);
      bend_ = is_straight(shape) || rises_faster(shape) ? std::optional(bend_of(shape, side))
                                                        : std::nullopt;
    }
    if (bend_) return std::pow(z * (1.0 + *bend_ * z) / widening_, 2);
    if (!ridge_.walk_to(z)) return {};
    return 2.0 * std::max(0.0, ridge_.last().rise) / (widening_ * widening_);
  }

private:
  struct Ends {
    double at68, at95;
  };

  // The rise at q sigma along the tangent, after one step of scoring, over the parabola's; 0 where
  // that step gains so much that it may not be believed.
  [[nodiscard]] double look(double q) const {
    constexpr double largest_gain = 3.0; // parabolas
    const double z = q * widening_, parabola = 0.5 * z * z;
    const auto there = ridge_.look(z);
    if (!there || there->gain > largest_gain * parabola) return 0.0;
    return (there->value - least_) / parabola;
  }

  static bool is_straight(double shape) {
    constexpr double straight = 0.1; // of the rise: a twentieth of the interval
    return std::abs(shape - 1.0) < straight;
  }
  static constexpr double least_straight = 0.65, largest_straight = 1.5; // the root is nearly linear
  static bool rises_faster(double shape) { return shape > 1.0 && shape < largest_straight; }
  // The root of twice the rise is z (1 + b z), with b from the look at 1.96 sigma.
  [[nodiscard]] double bend_of(double shape, double side) const {
    return (std::sqrt(shape) - 1.0) / (side * q95 * widening_);
  }

  // Where the profile has risen by q^2/2. One look tells whether the parabola holds.
  Ends ends_on(double side) {
    const double shape = look(side * q95);
    if (is_straight(shape)) return {side * q68 * widening_, side * q95 * widening_};
    const auto by_root = [&]() -> Ends {
      if (!(shape > least_straight && shape < largest_straight))
        return {side * infinite, side * infinite};
      const double b = bend_of(shape, side);
      const auto root = [&](double z) { return (std::sqrt(1.0 + 4.0 * b * z) - 1.0) / (2.0 * b); };
      return {root(side * q68 * widening_), root(side * q95 * widening_)};
    };
    if (!search_ || rises_faster(shape)) return by_root();
    // An end beyond the look is believed only where the ridge is lost.
    ridge_.restart();
    const double at68 = walk_to_root(q68 * widening_, side);
    if (!std::isfinite(at68)) return by_root();
    const double at95 = walk_to_root(q95 * widening_, side);
    return std::isfinite(at95) ? Ends{at68, at95} : by_root();
  }

  static double root_of(const Foot& foot) { return std::sqrt(2.0 * std::max(0.0, foot.rise)); }

  // Follows the ridge until the root of twice the rise is `target`, and says where that is. Where
  // the ridge is lost on the second half of the way the root is continued as a line; infinite where
  // it is lost before.
  double walk_to_root(double target, double side) {
    constexpr double farthest = 30.0;  // sigma
    constexpr double tolerance = 0.02; // of the root
    while (root_of(ridge_.last()) < target) {
      pulse();
      const Foot& last = ridge_.last();
      if (std::abs(last.z) > farthest * widening_ || !ridge_.advance(side))
        return root_of(last) > 0.5 * target ? last.z * target / root_of(last) : side * infinite;
    }
    // The root is nearly linear between the two.
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
  double fallen_z_ = 0.0;      // at which the fall was asked for last
  std::optional<double> bend_; // on its side
};

// If every relative sigma is below this, the likelihood counts as a parabola: the two sides of an
// interval then differ by about the same small fraction.
constexpr double small_relative_sigma = 0.015;

// The data for profiles: few beats, if they determine every coordinate as well as all beats do, or
// so well that the profile is a parabola.
const ProfiledPlace& seen_for(const ProfiledPlace& all, const ProfiledPlace* few) {
  constexpr double largest_lopsidedness = 0.2; // of sigma
  constexpr double tight_sigma = 0.05; // of a logarithm: asymmetry of a twentieth of the interval
  if (few == nullptr) return all;
  for (std::size_t k = 0; k < all.minimum.x.size(); ++k) {
    const double sigma = few->known.curvature_sigma(k);
    const double ratio = sigma / all.known.curvature_sigma(k);
    if (!(std::abs(ratio - 1.0) < largest_lopsidedness) && !(sigma < tight_sigma && ratio > 1.0))
      return all;
  }
  return *few;
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
    if (largest < small_relative_sigma && !may_vanish(slot)) {
      result[k] = {x - sigma, x + sigma, x - q95 * sigma, x + q95 * sigma};
      return;
    }
    // A parameter known this poorly, or a model that does not hold, is not worth a search for the
    // ends of a likelihood that is no parabola.
    constexpr double searched_share = 0.4;
    const bool search = model_holds && (lopsided || sigma <= searched_share * tolerable);
    const double unit = known.curvature_sigma(k);
    const Interval z = Profile(seen_for(all, few), k, sigma / unit, search).ends();
    const double least = !problem.bounds.empty() && problem.bounds[k][0] == 0.0 ? 0.0 : -infinite;
    const auto at = [&](double end) { return std::max(least, x + end * unit); };
    result[k] = {at(z.low68), at(z.high68), at(z.low95), at(z.high95)};
  });
  return result;
}

std::vector<ProfilePoint> profile_points(const ProfiledPlace& all, const ProfiledPlace* few,
                                         const Slot& slot, const Interval& interval) {
  constexpr int points_a_side = 5;
  constexpr double reach_factor = 1.15, open_reach = 3.0; // of the interval; sigma
  const std::size_t k = slot.index;
  const double unit = all.known.curvature_sigma(k), widening = all.known.sigma(k) / unit;
  Profile profile(seen_for(all, few), k, widening, true);
  std::vector<double> x = all.minimum.x;
  std::vector<ProfilePoint> found{{slot.value(std::span<const double>(x)), 0.0}};
  for (const double end : {interval.low95, interval.high95}) {
    const bool low = end == interval.low95;
    const double reach = std::isfinite(end) ? reach_factor * (end - all.minimum.x[k]) / unit
                                            : (low ? -open_reach : open_reach) * widening;
    for (int i = 1; i <= points_a_side; ++i) {
      pulse();
      const double z = reach * i / points_a_side;
      x[k] = all.minimum.x[k] + z * unit;
      const auto& bounds = all.problem.bounds;
      if (!bounds.empty() && (x[k] < bounds[k][0] || x[k] > bounds[k][1])) break;
      if (const auto fall = profile.fall(z))
        found.push_back({slot.value(std::span<const double>(x)), *fall});
    }
  }
  std::sort(found.begin(), found.end(),
            [](const ProfilePoint& a, const ProfilePoint& b) { return a.value < b.value; });
  return found;
}

} // namespace goingrate::timing_model
