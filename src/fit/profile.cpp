#include "profile.hpp"

#include "valley.hpp"

#include "base/workers.hpp"

#include "goingrate/base/pulse.hpp"

#include <algorithm>
#include <limits>

namespace goingrate::timing_model {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double q68 = 1.0, q95 = 1.959964;

// The profile likelihood of one coordinate; z is its distance from the minimum in sigmas of the
// curvature.
class Profile {
public:
  /// `widening`: the stated sigma over the curvature's. `search`: where the likelihood is no
  /// parabola, find the ends of the interval by searches; without it they stay open.
  Profile(const ProfiledPlace& place, std::size_t k, double widening, bool search)
      : problem_(place.problem), minimum_(place.minimum), known_(place.known), k_(k),
        valley_(problem_, minimum_.x, k), widening_(widening), search_(search) {}

  /// The ends of the interval, in z.
  Interval ends() {
    const double low = risen(-q95), high = risen(q95);
    Interval found{end(-q68, low), end(q68, high), end(-q95, low), end(q95, high)};
    found.low95 =
        std::min(found.low95,
                 found.low68); // searches end at a finite tolerance, which could reverse the order
    found.high95 = std::max(found.high95, found.high68);
    return found;
  }

  /// The fall of 2 log L at z, in the units of FittedParameter; nothing where the model does not
  /// hold. To be called at growing distances on one side, then on the other.
  std::optional<double> fall(double z) {
    if (last_ && last_->z * z < 0.0) last_.reset();
    constexpr double least_gain = 0.02; // of L: for smaller gains the predicted gain is accurate
    const auto there = step_of_others(along(z));
    const auto risen = there && there->gain < least_gain
                           ? std::optional(there->value - there->gain - minimum_.value)
                           : rise(z);
    if (!risen) return {};
    return 2.0 * std::max(0.0, *risen) / (widening_ * widening_);
  }

private:
  // The shape at q: from one step of scoring, or, if that shows no parabola, from a search;
  // infinite if both fail.
  double risen(double q) {
    const double looked = shape(q);
    if (!broken(looked) || !search_) return looked;
    const double z = q * widening_;
    last_.reset();
    return rise(z).value_or(infinite) / (0.5 * z * z);
  }

  // The point z sigma away along the ridge predicted by the curvature. T0 follows the ridge.
  [[nodiscard]] std::vector<double> straight(double z) const {
    const auto row = known_.unwidened.row(static_cast<Eigen::Index>(k_));
    const Eigen::VectorXd direction = known_.unwidened * row.transpose() / row.norm();
    std::vector<double> u = valley_.u_of(minimum_.x);
    const Eigen::VectorXd in_u = valley_.slopes(u).partialPivLu().solve(direction);
    for (std::size_t i = 0; i < u.size(); ++i)
      u[i] += z * in_u[static_cast<Eigen::Index>(i)];
    std::vector<double> x = valley_.x_of(u);
    return x;
  }

  // A step of scoring in the other coordinates: the change it makes and what it gains. Nothing
  // where the model is not defined.
  struct Step {
    double value = 0.0; // L before the step
    double gain = 0.0;
    Eigen::VectorXd change;
  };
  [[nodiscard]] std::optional<Step> step_of_others(std::span<const double> x) const {
    const auto there = evaluate(problem_, x);
    if (!there) return {};
    const auto n = there->triangle.cols(), k = static_cast<Eigen::Index>(k_);
    Step step{there->value, 0.0, Eigen::VectorXd::Zero(n)};
    if (n == 1) return step;
    Eigen::MatrixXd others(n, n - 1);
    others << there->triangle.leftCols(k), there->triangle.rightCols(n - k - 1);
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(others);
    const Eigen::VectorXd change = qr.solve(-there->projected);
    step.gain = 0.5 * (others * change).squaredNorm();
    step.change.head(k) = change.head(k);
    step.change.tail(n - k - 1) = change.tail(n - k - 1);
    return step;
  }

  // A step of scoring halfway to q measures how much the ridge bends.
  [[nodiscard]] std::vector<double> along(double z) {
    std::vector<double> x = straight(z);
    const std::size_t side = z < 0.0 ? 0 : 1;
    if (!bend_[side]) {
      const double half = std::copysign(0.5 * q95 * widening_, z);
      const auto step = step_of_others(straight(half));
      bend_[side] = step ? Eigen::VectorXd(step->change / (half * half))
                         : Eigen::VectorXd::Zero(static_cast<Eigen::Index>(x.size()));
    }
    for (std::size_t i = 0; i < x.size(); ++i)
      x[i] += z * z * (*bend_[side])[static_cast<Eigen::Index>(i)];
    return x;
  }

  // The rise of the profile at q divided by the parabola's; 0 where it is unknown.
  [[nodiscard]] double shape(double q) {
    const double z = q * widening_;
    const auto there = step_of_others(along(z));
    return there ? (there->value - there->gain - minimum_.value) / (0.5 * z * z) : 0.0;
  }

  // Beyond this the root of the rise is not nearly linear. A profile that rises too little may have
  // no end.
  static bool broken(double shape) { return !(shape > 0.65 && shape < 1.5); }
  // A search that ends higher than this has failed: no profile rises so steeply.
  static constexpr double largest_rise = 30.0; // parabolas

  double end(double q, double shape) {
    constexpr double straight = 0.1; // of the rise: a twentieth of the interval
    const double z = q * widening_;
    double reach = z;
    if (!(shape > 0.0) || (broken(shape) && !search_)) {
      reach = std::copysign(infinite, q);
    } else if (broken(shape)) {
      reach = searched(q);
    } else if (std::abs(shape - 1.0) > straight) {
      // The root of twice the rise is z (1 + b z), with b from the look at 1.96 sigma.
      const double b = (std::sqrt(shape) - 1.0) / (std::copysign(q95, q) * widening_);
      reach = (std::sqrt(1.0 + 4.0 * b * z) - 1.0) / (2.0 * b);
    }
    return reach;
  }

  // The start of a search with this coordinate held at z: on the ridge predicted by the curvature,
  // or at the end of the last search, extrapolated, whichever is lower.
  [[nodiscard]] std::vector<double> start_at(double z) {
    std::vector<double> ridge = along(z);
    const double wanted = z * known_.curvature_sigma(k_);
    double length = z; // along the ridge to where it has that coordinate: off it L rises steeply
    for (int round = 0; round < 3; ++round) {
      length *= wanted / (ridge[k_] - minimum_.x[k_]);
      ridge = along(length);
    }
    ridge[k_] = minimum_.x[k_] + wanted;
    if (!last_) return ridge;
    std::vector<double> stretched = minimum_.x;
    for (std::size_t i = 0; i < stretched.size(); ++i)
      stretched[i] += (last_->x[i] - stretched[i]) * z / last_->z;
    const auto here = minus_log_likelihood(problem_, ridge);
    const auto there = minus_log_likelihood(problem_, stretched);
    return there && (!here || *there < *here) ? stretched : ridge;
  }

  [[nodiscard]] bool is_allowed(std::span<const double> x) const {
    for (std::size_t k = 0; k < problem_.bounds.size(); ++k)
      if (x[k] < problem_.bounds[k][0] || x[k] > problem_.bounds[k][1]) return false;
    return true;
  }

  // The profile at z, by steps of scoring in the other coordinates as long as these gain what they
  // predict.
  std::optional<double> rise_by_steps(double z, std::vector<double> x) {
    constexpr double least_gain = 0.05; // of L: a step that gains less gains what it promises
    double before = infinite;
    for (int steps = 0; steps < 3; ++steps) {
      const auto step = step_of_others(x);
      if (!step || !(step->value < before)) return {};
      for (std::size_t i = 0; i < x.size(); ++i)
        x[i] += step->change[static_cast<Eigen::Index>(i)];
      if (!is_allowed(x)) return {};
      if (step->gain < least_gain) {
        last_ = Solution{z, std::move(x)};
        return step->value - step->gain - minimum_.value;
      }
      before = step->value;
    }
    return {};
  }

  // The same, with a search where the steps fail; nothing if the search fails too.
  std::optional<double> rise(double z) {
    const double coordinate = minimum_.x[k_] + z * known_.curvature_sigma(k_);
    std::vector<double> start = start_at(z);
    if (const auto risen = rise_by_steps(z, start)) return risen;
    const FitProblem held = with_held(problem_, k_, coordinate);
    start.erase(start.begin() + static_cast<std::ptrdiff_t>(k_));
    constexpr SearchLimits limits{30, 0.01}; // of 0.5 or 1.9
    Minimum found = minimise(held, start, limits);
    const double parabola = 0.5 * z * z;
    const double risen = found.value + prior_on(coordinate) - minimum_.value;
    if (!found.usable || risen > largest_rise * parabola)
      return rises_by_itself(held, coordinate, z) ? std::optional(parabola) : std::nullopt;
    found.x.insert(found.x.begin() + static_cast<std::ptrdiff_t>(k_), coordinate);
    last_ = Solution{z, std::move(found.x)};
    return risen;
  }

  // The value of the held coordinate at z.
  [[nodiscard]] double prior_on(double coordinate) const {
    double own = 0.0;
    for (const CoordinatePrior& prior : problem_.priors)
      if (prior.index == k_ && !prior.planned)
        own += 0.5 * std::pow((coordinate - prior.centre) / prior.sigma, 2);
    return own;
  }

  // Whether a search from the coordinates already found stays near them. If it does, the interval
  // of the curvature is kept: such a search sees only part of the profile.
  [[nodiscard]] bool rises_by_itself(const FitProblem& held, double coordinate, double z) const {
    std::vector<double> others = minimum_.x;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(k_));
    const Minimum found = minimise(held, others, {30, 0.01, 1e4});
    return found.usable &&
           found.value + prior_on(coordinate) - minimum_.value < largest_rise * 0.5 * z * z;
  }

  // The square root of twice the rise is nearly linear in z, so regula falsi finds where it is q.
  // Where a search does not converge, a point nearer to the last success is tried; an end that is
  // not reached stays open.
  double searched(double q) {
    const double target = std::abs(q) * widening_, side = std::copysign(1.0, q);
    constexpr double farthest_root = 8.0, root_tolerance = 0.02, longest_step = 1.6;
    double inside = 0.0, root_inside = 0.0, outside = infinite, root_outside = infinite;
    double unreached = infinite, z = target;
    last_.reset();
    for (int round = 0; round < 9; ++round) {
      pulse();
      if (const auto risen = rise(side * z)) {
        const double root = std::sqrt(2.0 * std::max(0.0, *risen));
        if (std::abs(root - target) < root_tolerance * target) return side * z;
        (root < target ? inside : outside) = z;
        (root < target ? root_inside : root_outside) = root;
      } else {
        unreached = z;
      }
      if (inside >= farthest_root * widening_) return side * infinite;
      const double part = (target - root_inside) / (root_outside - root_inside);
      const double slope = root_inside > 0.0 ? root_inside / inside : 1.0;
      z = std::isfinite(outside)
              ? inside + std::clamp(part, 0.1, 0.9) * (outside - inside)
              : std::min({longest_step * std::max(inside, 0.25 * target),
                          std::max(1.05 * inside, target / slope), farthest_root * widening_});
      if (z >= unreached) z = 0.5 * (inside + unreached);
    }
    return side * (std::isfinite(outside) ? 0.5 * (inside + outside) : infinite);
  }

  struct Solution {
    double z;
    std::vector<double> x;
  };

  const FitProblem& problem_;
  const Minimum& minimum_;
  const Certainty& known_;
  std::size_t k_;
  Valley valley_;
  double widening_;
  bool search_;
  std::optional<Solution> last_;                       // of the last search
  std::array<std::optional<Eigen::VectorXd>, 2> bend_; // below and above the minimum
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

namespace {

// Of the slots that stay free those behind the held one move up.
void hold(Slot& slot, std::size_t index, std::span<const double> x) {
  if (!slot.free) return;
  if (slot.index == index) {
    slot.fixed_value = slot.value(x);
    slot.free = false;
  } else if (slot.index > index) {
    --slot.index;
  }
}

} // namespace

FitProblem with_held(const FitProblem& problem, std::size_t index, double coordinate) {
  FitProblem held = problem;
  std::vector<double> x(problem.parameters.free_count, 0.0);
  x[index] = coordinate;
  for (Slot& slot : held.parameters.slots)
    hold(slot, index, x);
  --held.parameters.free_count;
  std::erase_if(held.priors,
                [&](const CoordinatePrior& p) { return p.index == index && !p.planned; });
  for (CoordinatePrior& prior : held.priors) {
    if (prior.planned) {
      hold(prior.planned->after, index, x);
      hold(prior.planned->before, index, x);
    } else if (prior.index > index) {
      --prior.index;
    }
  }
  if (!held.bounds.empty())
    held.bounds.erase(held.bounds.begin() + static_cast<std::ptrdiff_t>(index));
  return held;
}

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
