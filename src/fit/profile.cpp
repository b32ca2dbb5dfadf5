#include "profile.hpp"

#include "valley.hpp"

#include "base/workers.hpp"

#include "goingrate/base/pulse.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace goingrate::timing_model {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double q68 = 1.0, q95 = 1.959964;

// A point of the ridge on which L is least for each value of one coordinate.
struct Foot {
  double z = 0.0;          // of that coordinate, in sigmas of the curvature
  double rise = 0.0;       // of L
  std::vector<double> x;   // where
  std::vector<double> u;   // the same in the coordinates that straighten the valley
  Eigen::VectorXd tangent; // du/dz
};

// The profile likelihood of one coordinate; z is its distance from the minimum in sigmas of the
// curvature. Away from the minimum the ridge is followed from foot to foot: extrapolated by the
// cubic through the last two feet and their directions, and brought back by steps of scoring in the
// other coordinates.
class Profile {
public:
  /// `widening`: the stated sigma over the curvature's. `search`: where the likelihood is no
  /// parabola, follow the ridge to the ends of the interval; without it they stay open.
  Profile(const ProfiledPlace& place, std::size_t k, double widening, bool search)
      : problem_(place.problem), minimum_(place.minimum), known_(place.known), k_(k),
        valley_(problem_, minimum_.x, k), widening_(widening), search_(search) {
    first_.x = minimum_.x;
    first_.u = valley_.u_of(first_.x);
    const auto row = known_.unwidened.row(static_cast<Eigen::Index>(k_));
    first_.tangent = in_valley(first_.u, known_.unwidened * row.transpose() / row.norm());
    restart();
  }

  /// The ends of the interval, in z.
  Interval ends() {
    const auto [low68, low95] = ends_on(-1.0);
    const auto [high68, high95] = ends_on(1.0);
    return {low68, high68, low95, high95};
  }

  /// The fall of 2 log L at z, in the units of FittedParameter; nothing where the model does not
  /// hold. To be called at growing distances on one side, then on the other.
  std::optional<double> fall(double z) {
    if (last_.z * z < 0.0) restart();
    if (!walk_to(z)) return {};
    return 2.0 * std::max(0.0, last_.rise) / (widening_ * widening_);
  }

private:
  struct Ends {
    double at68, at95;
  };

  // A change of x as one of u, at u.
  [[nodiscard]] Eigen::VectorXd in_valley(const std::vector<double>& u,
                                          const Eigen::VectorXd& change) const {
    return valley_.slopes(u).partialPivLu().solve(change);
  }

  // With a row for each coordinate that makes a change of one, a factor e of most, cost half of L:
  // where the likelihood is flat, steps are kept short, and a determined coordinate does not feel
  // it.
  static Eigen::MatrixXd damped(const Eigen::MatrixXd& rows) {
    Eigen::MatrixXd both(rows.rows() + rows.cols(), rows.cols());
    both << rows, Eigen::MatrixXd::Identity(rows.cols(), rows.cols());
    return both;
  }

  // A step of scoring in the other coordinates: the change it makes and what it gains. Nothing
  // where the model is not defined.
  struct Step {
    Evaluation here; // before the step
    double gain = 0.0;
    Eigen::VectorXd change;
  };
  [[nodiscard]] std::optional<Step> step_of_others(std::span<const double> x) const {
    auto there = evaluate(problem_, x);
    if (!there) return {};
    const auto n = there->triangle.cols(), k = static_cast<Eigen::Index>(k_);
    Step step{std::move(*there), 0.0, Eigen::VectorXd::Zero(n)};
    if (n == 1) return step;
    Eigen::MatrixXd others(n, n - 1);
    others << step.here.triangle.leftCols(k), step.here.triangle.rightCols(n - k - 1);
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(damped(others));
    Eigen::VectorXd projected = Eigen::VectorXd::Zero(2 * n - 1);
    projected.head(n) = step.here.projected;
    const Eigen::VectorXd change = qr.solve(-projected);
    const Eigen::VectorXd moved = others * change;
    step.gain = -moved.dot(step.here.projected) - 0.5 * moved.squaredNorm();
    step.change.head(k) = change.head(k);
    step.change.tail(n - k - 1) = change.tail(n - k - 1);
    return step;
  }

  // The rise at q sigma along the tangent, after one step of scoring, over the parabola's; 0 where
  // that step gains so much that it may not be believed.
  [[nodiscard]] double look(double q) const {
    constexpr double largest_gain = 3.0; // parabolas
    const double z = q * widening_, parabola = 0.5 * z * z;
    const auto there = step_of_others(valley_.x_of(ahead(first_, z)));
    if (!there || there->gain > largest_gain * parabola) return 0.0;
    return (there->here.value - there->gain - minimum_.value) / parabola;
  }

  // Where the profile has risen by q^2/2. One look tells whether the parabola holds.
  Ends ends_on(double side) {
    constexpr double straight = 0.1; // of the rise: a twentieth of the interval
    constexpr double least_straight = 0.65, largest_straight = 1.5; // the root is nearly linear
    const double shape = look(side * q95);
    if (std::abs(shape - 1.0) < straight) return {side * q68 * widening_, side * q95 * widening_};
    if (shape > least_straight && shape < largest_straight) {
      // The root of twice the rise is z (1 + b z), with b from the look at 1.96 sigma.
      const double b = (std::sqrt(shape) - 1.0) / (side * q95 * widening_);
      const auto root = [&](double z) { return (std::sqrt(1.0 + 4.0 * b * z) - 1.0) / (2.0 * b); };
      return {root(side * q68 * widening_), root(side * q95 * widening_)};
    }
    if (!search_) return {side * infinite, side * infinite};
    restart();
    const double at68 = walk_to_root(q68 * widening_, side);
    return {at68, std::isfinite(at68) ? walk_to_root(q95 * widening_, side) : at68};
  }

  static double root_of(const Foot& foot) { return std::sqrt(2.0 * std::max(0.0, foot.rise)); }

  // Follows the ridge until the root of twice the rise is `target`, and says where that is. Where
  // the ridge is lost on the second half of the way the root is continued as a line; infinite where
  // it is lost before.
  double walk_to_root(double target, double side) {
    constexpr double farthest = 30.0;  // sigma
    constexpr double tolerance = 0.02; // of the root
    while (root_of(last_) < target) {
      pulse();
      if (std::abs(last_.z) > farthest * widening_ || !advance(last_.z + side * stride_))
        return root_of(last_) > 0.5 * target ? last_.z * target / root_of(last_) : side * infinite;
    }
    // The foot before and the last one, between which the root is nearly linear.
    double inside = before_.z, root_inside = root_of(before_);
    double outside = last_.z, root_outside = root_of(last_);
    const Foot beyond = last_;
    for (int round = 0; round < 4; ++round) {
      const double z =
          inside + (target - root_inside) / (root_outside - root_inside) * (outside - inside);
      const auto between = foot_at(z, before_, beyond);
      if (!between) return z;
      const double root = root_of(*between);
      if (std::abs(root - target) < tolerance * target) return z;
      (root < target ? inside : outside) = z;
      (root < target ? root_inside : root_outside) = root;
    }
    return 0.5 * (inside + outside);
  }

  bool walk_to(double z) {
    while (last_.z != z) {
      pulse();
      const double left = z - last_.z;
      const double step = std::abs(left) < 1.5 * stride_ ? left : std::copysign(stride_, left);
      if (!advance(std::abs(left) <= stride_ || step == left ? z : last_.z + step)) return false;
    }
    return true;
  }

  void restart() {
    last_ = before_ = first_;
    stride_ = first_stride * widening_;
    steps_left_ = most_steps_of_a_side;
  }

  // One foot further, to z or less far where the ridge bends; by a search where it folds, so that
  // steps lead nowhere; false where that fails too.
  bool advance(double z) {
    constexpr double least_stride = 0.02;              // sigma
    constexpr double easy_gain = 0.1, hard_gain = 5.0; // of L, of the first step of scoring
    constexpr double longest_stride = 2.0;             // sigma
    while (true) {
      double gain = 0.0;
      if (auto next = foot_near(foreseen(z), z, gain)) {
        if (gain < easy_gain) stride_ = std::min(2.0 * stride_, longest_stride * widening_);
        if (gain > hard_gain) stride_ *= 0.5;
        before_ = std::exchange(last_, std::move(*next));
        return true;
      }
      stride_ = 0.4 * std::min(stride_, std::abs(z - last_.z));
      if (stride_ < least_stride * widening_)
        return search_on(std::copysign(first_stride, z - last_.z));
      z = last_.z + std::copysign(stride_, z - last_.z);
    }
  }

  // Where the foot at z may be: on the cubic, on the tangent or where the last one was, whichever
  // L likes best.
  [[nodiscard]] std::vector<double> foreseen(double z) const {
    std::vector<double> best = with_own(last_.x, z);
    double least = minus_log_likelihood(problem_, best).value_or(infinite);
    const auto consider = [&](const std::vector<double>& u) {
      std::vector<double> x = with_own(valley_.x_of(u), z);
      const double there = minus_log_likelihood(problem_, x).value_or(infinite);
      if (!(there < least)) return;
      least = there;
      best = std::move(x);
    };
    consider(ahead(last_, z - last_.z));
    if (last_.z != before_.z) consider(extrapolated(before_, last_, z));
    return best;
  }
  // x with the profile's own coordinate at z.
  [[nodiscard]] std::vector<double> with_own(std::vector<double> x, double z) const {
    x[k_] = minimum_.x[k_] + z * known_.curvature_sigma(k_);
    return x;
  }

  bool search_on(double strides) {
    stride_ = first_stride * widening_;
    const double z = last_.z + strides * widening_;
    auto next = by_search(with_own(last_.x, z), z);
    if (!next) return false;
    before_ = std::exchange(last_, std::move(*next));
    return true;
  }

  static std::vector<double> ahead(const Foot& foot, double dz) {
    return moved(foot.u, foot.tangent, dz);
  }
  // On the cubic through two feet that has their directions.
  static std::vector<double> extrapolated(const Foot& a, const Foot& b, double z) {
    const double h = b.z - a.z, s = (z - a.z) / h;
    const double of_b = s * s * (3.0 - 2.0 * s), along_a = s * (1.0 - s) * (1.0 - s) * h,
                 along_b = s * s * (s - 1.0) * h;
    std::vector<double> u = a.u;
    for (std::size_t i = 0; i < u.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      u[i] += of_b * (b.u[i] - a.u[i]) + along_a * a.tangent[k] + along_b * b.tangent[k];
    }
    return u;
  }
  [[nodiscard]] std::optional<Foot> foot_at(double z, const Foot& a, const Foot& b) {
    double gain = 0.0;
    return foot_near(with_own(valley_.x_of(extrapolated(a, b, z)), z), z, gain);
  }

  [[nodiscard]] bool is_allowed(std::span<const double> x) const {
    for (std::size_t k = 0; k < problem_.bounds.size(); ++k)
      if (x[k] < problem_.bounds[k][0] || x[k] > problem_.bounds[k][1]) return false;
    return true;
  }

  // The foot at z from a point beside it, by steps of scoring until one gains next to nothing, or
  // by a search where a bound is met. `first_gain`: what the first step promises.
  [[nodiscard]] std::optional<Foot> foot_near(std::vector<double> x, double z,
                                              double& first_gain) {
    constexpr double least_gain = 0.02; // of L: a step that gains less gains what it promises
    constexpr double kink_gain = 0.25;  // of L: what steps may still promise where L has kinks
    constexpr int most_steps = 6;
    for (int steps = 0;; ++steps) {
      if (!is_allowed(x)) return by_search(std::move(x), z);
      if (--steps_left_ < 0) return {};
      const auto step = step_of_others(x);
      if (!step) return {};
      if (steps == 0) first_gain = step->gain;
      if (step->gain < least_gain)
        return foot(x, z, step->here.value - step->gain, step->here.triangle);
      auto next = steps < most_steps ? lower(x, *step) : std::nullopt;
      if (next)
        x = std::move(*next);
      else
        return step->gain < kink_gain ? foot(x, z, step->here.value, step->here.triangle)
                                      : std::nullopt;
    }
  }
  static std::vector<double> moved(std::vector<double> from, const Eigen::VectorXd& change,
                                   double share) {
    for (std::size_t i = 0; i < from.size(); ++i)
      from[i] += share * change[static_cast<Eigen::Index>(i)];
    return from;
  }
  // As far along the step, in the coordinates that straighten the valley, as L falls.
  [[nodiscard]] std::optional<std::vector<double>> lower(const std::vector<double>& x,
                                                         const Step& step) const {
    const std::vector<double> u = valley_.u_of(x);
    const Eigen::VectorXd way = in_valley(u, step.change);
    for (double share = 1.0; share > 0.01; share *= 0.25) {
      std::vector<double> next = valley_.x_of(moved(u, way, share));
      next[k_] = x[k_];
      const auto there = minus_log_likelihood(problem_, next);
      if (there && *there < step.here.value) return next;
    }
    return {};
  }

  [[nodiscard]] std::optional<Foot> by_search(std::vector<double> x, double z) {
    constexpr int most_steps = 30;
    if ((steps_left_ -= most_steps) < 0) return {};
    for (std::size_t i = 0; i < problem_.bounds.size(); ++i)
      x[i] = std::clamp(x[i], problem_.bounds[i][0], problem_.bounds[i][1]);
    const double coordinate = x[k_];
    x.erase(x.begin() + static_cast<std::ptrdiff_t>(k_));
    constexpr SearchLimits limits{most_steps, 0.01}; // of 0.5 or 1.9
    Minimum found = minimise(with_held(problem_, k_, coordinate), x, limits);
    if (!found.usable || !found.converged) return {};
    found.x.insert(found.x.begin() + static_cast<std::ptrdiff_t>(k_), coordinate);
    const auto at = evaluate(problem_, found.x);
    if (!at) return {};
    return foot(found.x, z, at->value, at->triangle);
  }

  // The direction of the ridge there is C e_k / C_kk with the covariance C.
  [[nodiscard]] std::optional<Foot> foot(const std::vector<double>& x, double z, double value,
                                         const Eigen::MatrixXd& triangle) const {
    const auto n = triangle.cols();
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(damped(triangle));
    const Eigen::MatrixXd root = qr.matrixQR().topRows(n);
    const auto upper = root.triangularView<Eigen::Upper>();
    Eigen::VectorXd way = Eigen::VectorXd::Unit(n, static_cast<Eigen::Index>(k_));
    way = upper.transpose().solve(way);
    way = upper.solve(way);
    way *= known_.curvature_sigma(k_) / way[static_cast<Eigen::Index>(k_)];
    Foot foot{z, value - minimum_.value, x, valley_.u_of(x), {}};
    foot.tangent = in_valley(foot.u, way);
    if (!foot.tangent.allFinite() || !std::isfinite(foot.rise)) return {};
    return foot;
  }

  static constexpr double first_stride = 0.25; // sigma
  // Of scoring, each a pass over the log with derivatives; a search counts as the most it may take.
  // A ridge that needs more can take minutes on a long noisy log: it ends like one that is lost.
  static constexpr int most_steps_of_a_side = 100;

  const FitProblem& problem_;
  const Minimum& minimum_;
  const Certainty& known_;
  std::size_t k_;
  Valley valley_;
  double widening_;
  bool search_;
  Foot first_;          // the minimum
  Foot last_, before_;  // the last two
  double stride_ = 0.0; // in z
  int steps_left_ = most_steps_of_a_side;
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
