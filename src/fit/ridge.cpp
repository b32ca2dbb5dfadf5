#include "ridge.hpp"

#include "base/special_values.hpp"
#include "held.hpp"

#include "goingrate/base/pulse.hpp"

#include <algorithm>
#include <utility>

namespace goingrate::timing_model {

namespace {

constexpr double first_stride = 0.25; // sigma

// Adds a row for each coordinate, so that a change of one (a factor e for most) costs a half in L:
// this keeps steps short where the likelihood is flat, and hardly affects a determined coordinate.
Eigen::MatrixXd damped(const Eigen::MatrixXd& rows) {
  Eigen::MatrixXd both(rows.rows() + rows.cols(), rows.cols());
  both << rows, Eigen::MatrixXd::Identity(rows.cols(), rows.cols());
  return both;
}

std::vector<double> moved(std::vector<double> from, const Eigen::VectorXd& change, double share) {
  for (std::size_t i = 0; i < from.size(); ++i)
    from[i] += share * change[static_cast<Eigen::Index>(i)];
  return from;
}

std::vector<double> ahead(const Foot& foot, double dz) { return moved(foot.u, foot.tangent, dz); }
// A point on the cubic through two feet with their directions.
std::vector<double> extrapolated(const Foot& a, const Foot& b, double z) {
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

} // namespace

Ridge::Ridge(const ProfiledPlace& place, std::size_t k, double widening, int most_steps)
    : problem_(place.problem), minimum_(place.minimum), known_(place.known), k_(k),
      valley_(problem_, minimum_.x, k), widening_(widening), most_steps_(most_steps) {
  first_.x = minimum_.x;
  first_.u = valley_.u_of(first_.x);
  const auto row = known_.unwidened.row(static_cast<Eigen::Index>(k_));
  first_.tangent = in_valley(first_.u, known_.unwidened * row.transpose() / row.norm());
  restart();
}

void Ridge::restart() {
  last_ = before_ = first_;
  stride_ = first_stride * widening_;
  steps_left_ = most_steps_;
}

bool Ridge::advance(double side) { return go_to(last_.z + side * stride_); }

bool Ridge::walk_to(double z) {
  while (last_.z != z) {
    pulse();
    const double left = z - last_.z;
    const bool near = std::abs(left) < 1.5 * stride_;
    if (!go_to(near ? z : last_.z + std::copysign(stride_, left))) return false;
  }
  return true;
}

std::optional<Ridge::Look> Ridge::look(double z) const {
  constexpr double sure_gain = 0.05; // of L: a step gains less than it promises if that is more
  const std::vector<double> x = valley_.x_of(ahead(first_, z));
  auto there = step_of_others(x);
  if (there && there->gain > sure_gain)
    if (const auto next = lower(x, *there)) there = step_of_others(*next);
  if (!there) return {};
  return Look{there->here.value - there->gain, there->gain};
}

// A change of x as one of u, at u.
Eigen::VectorXd Ridge::in_valley(const std::vector<double>& u,
                                 const Eigen::VectorXd& change) const {
  return valley_.slopes(u).partialPivLu().solve(change);
}

// Nothing where the model is not defined.
std::optional<Ridge::Step> Ridge::step_of_others(std::span<const double> x) const {
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

// Goes one foot further, to z or less far if the ridge bends; by a search if it folds, so that
// steps lead nowhere; false if that fails too.
bool Ridge::go_to(double z) {
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

// A guess of the foot at z: on the cubic, on the tangent or at the last foot, whichever has the
// lowest L.
std::vector<double> Ridge::foreseen(double z) const {
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
// x with its own coordinate at z.
std::vector<double> Ridge::with_own(std::vector<double> x, double z) const {
  x[k_] = minimum_.x[k_] + z * known_.curvature_sigma(k_);
  return x;
}

bool Ridge::search_on(double strides) {
  stride_ = first_stride * widening_;
  const double z = last_.z + strides * widening_;
  auto next = by_search(with_own(last_.x, z), z);
  if (!next) return false;
  before_ = std::exchange(last_, std::move(*next));
  return true;
}

std::optional<Foot> Ridge::between(double z, const Foot& a, const Foot& b) {
  double gain = 0.0;
  return foot_near(with_own(valley_.x_of(extrapolated(a, b, z)), z), z, gain);
}

bool Ridge::is_allowed(std::span<const double> x) const {
  for (std::size_t k = 0; k < problem_.bounds.size(); ++k)
    if (x[k] < problem_.bounds[k][0] || x[k] > problem_.bounds[k][1]) return false;
  return true;
}

// The foot at z from a point near it, by steps of scoring until one gains next to nothing, or
// by a search where a bound is met. `first_gain`: what the first step promises.
std::optional<Foot> Ridge::foot_near(std::vector<double> x, double z, double& first_gain) {
  constexpr double least_gain = 0.02; // of L: a smaller step gains what it promises
  constexpr double kink_gain = 0.25;  // of L: what steps may still promise where L has kinks
  constexpr int most_steps = 6;
  for (int steps = 0;; ++steps) {
    if (!is_allowed(x)) return by_search(std::move(x), z);
    if (steps_left_ == 0) return {};
    --steps_left_;
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
// Goes along the step, in the coordinates that straighten the valley, as far as L falls.
std::optional<std::vector<double>> Ridge::lower(const std::vector<double>& x,
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

// A search counts as the most steps that it may take.
std::optional<Foot> Ridge::by_search(std::vector<double> x, double z) {
  constexpr int most_steps = 30;
  if (steps_left_ < most_steps) return {};
  steps_left_ -= most_steps;
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
std::optional<Foot> Ridge::foot(const std::vector<double>& x, double z, double value,
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

namespace {

std::optional<std::size_t> most_open(const ProfiledPlace& place) {
  std::optional<std::size_t> most;
  for (const Slot& slot : place.problem.parameters.slots)
    if (slot.free && is_of_clock(slot.quantity) &&
        (!most || place.known.curvature_sigma(slot.index) > place.known.curvature_sigma(*most)))
      most = slot.index;
  return most;
}

bool is_far(std::span<const double> a, std::span<const double> b) {
  constexpr double farthest = 3.0; // a factor e^3 in any parameter
  for (std::size_t k = 0; k < a.size(); ++k)
    if (std::abs(a[k] - b[k]) > farthest) return true;
  return false;
}

} // namespace

std::array<RidgeSide, 2> sides_of_most_open(const ProfiledPlace& place, double largest_rise) {
  std::array<RidgeSide, 2> sides;
  const auto open = most_open(place);
  if (!open) return sides;
  for (const bool up : {false, true}) {
    Ridge ridge(place, *open, 1.0);
    RidgeSide& side = sides[up ? 1 : 0];
    side.feet.push_back(ridge.last());
    while (!side.is_lost && ridge.last().rise < largest_rise) {
      side.is_lost = !ridge.advance(up ? 1.0 : -1.0) || is_far(ridge.last().x, place.minimum.x);
      if (!side.is_lost) side.feet.push_back(ridge.last());
    }
  }
  return sides;
}

std::vector<std::vector<double>> hollows_along_most_open(const ProfiledPlace& place,
                                                         double largest_rise) {
  std::vector<std::vector<double>> hollows;
  for (const auto& [feet, is_lost] : sides_of_most_open(place, largest_rise)) {
    for (std::size_t i = 2; i < feet.size(); ++i)
      if (feet[i - 1].rise < feet[i - 2].rise && feet[i - 1].rise < feet[i].rise)
        hollows.push_back(feet[i - 1].x);
    if (is_lost) hollows.push_back(feet.back().x);
  }
  return hollows;
}

} // namespace goingrate::timing_model
