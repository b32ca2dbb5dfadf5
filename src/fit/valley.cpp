#include "valley.hpp"

#include "final_clock.hpp"

#include <algorithm>

namespace goingrate::timing_model {

namespace {

// Relative step of the finite differences: a compromise between rounding and curvature.
constexpr double step = 1e-6;

} // namespace

Valley::Valley(const FitProblem& problem, std::span<const double> start,
               std::optional<std::size_t> except)
    : parameters_(problem.parameters),
      ends_(ends_of_stretches(*problem.data, problem.parameters.event_cycles)) {
  if (start.size() < 2) return;
  const Slot* lambda0 = parameters_.find(Quantity::lambda0);
  if (lambda0->free && lambda0->index != except && parameters_.has(Quantity::mu)) {
    rest_ = log_rest(start);
    if (std::isfinite(rest_)) start_ = lambda0->index;
  }
  const Slot* drive = parameters_.find(Quantity::drive_rms);
  if (drive != nullptr && drive->free && drive->index != except) {
    scatter_ = log_scatter(start);
    if (std::isfinite(scatter_)) drive_ = drive->index;
  }
  std::vector<double> x(start.begin(), start.end());
  const double own = start_ ? start[*start_] : 0.0;
  const auto here = late(x, own);
  if (!here) return;
  const Eigen::MatrixXd slopes = slopes_of_late(x, own);
  choose_following(start, except, slopes);
  late_ = (*here)(stretches_);
  way_ = Eigen::MatrixXd(slopes(stretches_, rates_)).inverse();
  reference_ = Eigen::Map<const Eigen::VectorXd>(start.data(),
                                                 static_cast<Eigen::Index>(start.size()))(rates_);
  if (way_.allFinite()) return;
  stretches_.clear();
  rates_.clear();
}

// For one stretch after the other the coordinate that moves its end most beside those chosen
// before, by Gaussian elimination. Prefers the switching angle: the rate of a clock at rest always
// falls with it, while torque and friction may hardly affect it.
void Valley::choose_following(std::span<const double> start, std::optional<std::size_t> except,
                              const Eigen::MatrixXd& slopes) {
  constexpr double phi0_weight = 3.0;  // another steeper by this factor replaces phi0
  constexpr double least_share = 1e-6; // of what the coordinate moves: less is rounding
  Eigen::MatrixXd moves = Eigen::MatrixXd::Zero(slopes.rows(), slopes.cols());
  for (const Slot& slot : parameters_.slots) {
    const bool could = slot.quantity == Quantity::T0 || slot.quantity == Quantity::phi0 ||
                       slot.quantity == Quantity::mu || slot.quantity == Quantity::epsilon;
    if (!could || !slot.free || slot.index == except || slot.index == start_) continue;
    const double weight = slot.quantity == Quantity::phi0 ? phi0_weight : 1.0;
    // Slopes are compared for relative changes; a free T0 moves the ends by far the most.
    const double unit = slot.coordinate == Coordinate::multiple ? start[slot.index] : 1.0;
    const auto column = static_cast<Eigen::Index>(slot.index);
    moves.col(column) = weight * unit * slopes.col(column);
  }
  Eigen::MatrixXd left = moves;
  for (Eigen::Index stretch = 0; stretch < moves.rows(); ++stretch) {
    Eigen::Index best = 0;
    const double most = left.row(stretch).cwiseAbs().maxCoeff(&best);
    if (!(most > least_share * moves.col(best).cwiseAbs().maxCoeff())) continue;
    stretches_.push_back(stretch);
    rates_.push_back(best);
    const Eigen::RowVectorXd row = left.row(stretch) / left(stretch, best);
    const Eigen::VectorXd column = left.col(best);
    left -= column * row;
    left.col(best).setZero();
  }
}

double Valley::log_rest(std::span<const double> x) const {
  Going<double> going;
  apply_changes(parameters_, x, 0, going);
  return 0.5 * std::log(going.laws.drive() / (2.0 * going.laws.epsilon));
}

double Valley::log_scatter(std::span<const double> x) const {
  const FinalClock clock = final_clock(parameters_, x);
  return std::log(std::abs(clock.T0 * clock.fast_gain()));
}

void Valley::follow_start(std::vector<double>& x, double own) const {
  if (start_) x[*start_] = own + log_rest(x) - rest_;
}

std::vector<double> Valley::x_of(std::span<const double> u) const {
  std::vector<double> x(u.begin(), u.end());
  const double own = start_ ? u[*start_] : 0.0;
  if (const auto change = solved(x, own))
    for (std::size_t k = 0; k < rates_.size(); ++k)
      x[static_cast<std::size_t>(rates_[k])] += (*change)[static_cast<Eigen::Index>(k)];
  follow_start(x, own);
  if (drive_) x[*drive_] -= log_scatter(x) - scatter_;
  return x;
}

std::vector<double> Valley::u_of(std::span<const double> x) const {
  std::vector<double> u(x.begin(), x.end());
  if (drive_) u[*drive_] += log_scatter(x) - scatter_;
  if (start_) u[*start_] -= log_rest(x) - rest_;
  if (const auto change = solved({x.begin(), x.end()}, start_ ? u[*start_] : 0.0))
    for (std::size_t k = 0; k < rates_.size(); ++k)
      u[static_cast<std::size_t>(rates_[k])] -= (*change)[static_cast<Eigen::Index>(k)];
  return u;
}

std::optional<Eigen::VectorXd> Valley::late(std::vector<double>& x, double own) const {
  follow_start(x, own);
  const auto at = late_after_first(parameters_, ends_, x);
  if (!at) return {};
  Eigen::VectorXd late =
      Eigen::Map<const Eigen::VectorXd>(at->data(), static_cast<Eigen::Index>(at->size()));
  for (Eigen::Index k = late.size(); k-- > 1;)
    late[k] -= late[k - 1];
  return late;
}

Eigen::MatrixXd Valley::slopes_of_late(std::vector<double> x, double own) const {
  const auto stretches = static_cast<Eigen::Index>(ends_.size()) - 1;
  Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(stretches, static_cast<Eigen::Index>(x.size()));
  for (const Slot& slot : parameters_.slots) {
    if (!slot.free || is_noise(slot.quantity)) continue;
    const double here = x[slot.index];
    const auto beside = [&](double by) {
      x[slot.index] = here + by;
      return late(x, slot.index == start_ ? own + by : own);
    };
    const auto up = beside(step), down = beside(-step);
    x[slot.index] = here;
    if (up && down)
      slopes.col(static_cast<Eigen::Index>(slot.index)) = (*up - *down) / (2.0 * step);
  }
  return slopes;
}

template <class Function>
Eigen::RowVectorXd Valley::gradient(std::vector<double>& x, Function&& function) const {
  Eigen::RowVectorXd result = Eigen::RowVectorXd::Zero(static_cast<Eigen::Index>(x.size()));
  for (const Slot& slot : parameters_.slots) {
    if (!slot.free || is_noise(slot.quantity)) continue;
    const double here = x[slot.index];
    x[slot.index] = here + step;
    const double up = function(x);
    x[slot.index] = here - step;
    result[static_cast<Eigen::Index>(slot.index)] = (up - function(x)) / (2.0 * step);
    x[slot.index] = here;
  }
  return result;
}

Eigen::MatrixXd Valley::slopes(std::span<const double> u) const {
  const auto n = static_cast<Eigen::Index>(u.size());
  Eigen::MatrixXd result = Eigen::MatrixXd::Identity(n, n);
  std::vector<double> x = x_of(u);
  const double own = start_ ? u[*start_] : 0.0;
  if (!rates_.empty()) { // dh/du = -(d late/dx_a)^-1 d late/du
    const Eigen::MatrixXd all = slopes_of_late(x, own);
    const Eigen::MatrixXd slopes = all(stretches_, Eigen::all);
    Eigen::MatrixXd moved = -Eigen::MatrixXd(slopes(Eigen::all, rates_)).inverse() * slopes;
    moved(Eigen::all, rates_).setIdentity();
    if (moved.allFinite()) result(rates_, Eigen::all) = moved;
  }
  if (start_) {
    const Eigen::RowVectorXd moved =
        gradient(x, [&](const auto& at) { return log_rest(at); }) * result;
    if (moved.allFinite()) result.row(static_cast<Eigen::Index>(*start_)) += moved;
  }
  if (drive_) {
    const Eigen::RowVectorXd moved =
        gradient(x, [&](const auto& at) { return log_scatter(at); }) * result;
    if (moved.allFinite()) result.row(static_cast<Eigen::Index>(*drive_)) -= moved;
  }
  return result;
}

// Broyden's method in units of lateness, in which the slopes at the start are one.
std::optional<Eigen::VectorXd> Valley::solved(std::vector<double> x, double own) const {
  constexpr int rounds = 20;
  constexpr double longest_step = 0.3, smallest_change = 1e-13;
  constexpr double rounding_change = 1e-9; // a smaller step that gains nothing is rounding
  const auto count = static_cast<Eigen::Index>(rates_.size());
  if (count == 0) return {};
  const auto go_to = [&](const Eigen::VectorXd& change) {
    for (Eigen::Index k = 0; k < count; ++k)
      x[static_cast<std::size_t>(rates_[static_cast<std::size_t>(k)])] = reference_[k] + change[k];
  };
  Eigen::VectorXd change = Eigen::VectorXd::Zero(count), last = change, moved, missed;
  Eigen::MatrixXd slopes = Eigen::MatrixXd::Identity(count, count);
  for (int round = 0; round < rounds; ++round) {
    go_to(change);
    const auto here = late(x, own);
    if (!here) return {};
    const Eigen::VectorXd misses = late_ - Eigen::VectorXd((*here)(stretches_));
    const double size = last.cwiseAbs().maxCoeff();
    if (round > 0 && size < rounding_change && !(misses.norm() < missed.norm())) break;
    if (round > 0 && size > rounding_change)
      slopes += (missed - misses - slopes * moved) * moved.transpose() / moved.squaredNorm();
    missed = misses;
    moved = slopes.partialPivLu().solve(misses);
    last = way_ * moved;
    const double share = std::min(1.0, longest_step / last.cwiseAbs().maxCoeff());
    moved *= share, last *= share;
    change += last;
    if (!(last.cwiseAbs().maxCoeff() > smallest_change)) break;
  }
  return change;
}

} // namespace goingrate::timing_model
