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
    : parameters_(problem.parameters), ends_(ends_of(*problem.data)) {
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
  const auto follows = following(start, except);
  const auto late = late_at_end(parameters_, ends_, start);
  if (!follows || !late) return;
  std::vector<double> x(start.begin(), start.end());
  const auto slope = slope_of_late(x, *follows, start_ ? start[*start_] : 0.0);
  if (!slope || *slope == 0.0) return;
  slope_ = *slope;
  reference_ = start[*follows];
  late_ = *late;
  rate_ = follows;
}

// Prefers the switching angle: the rate of a clock at rest always falls with it, while torque and
// friction may hardly affect it. Slopes are those of the last beat, before which an event may have
// changed the clock.
std::optional<std::size_t> Valley::following(std::span<const double> start,
                                             std::optional<std::size_t> except) const {
  constexpr double phi0_weight = 3.0; // another steeper by this factor replaces phi0
  std::vector<double> x(start.begin(), start.end());
  std::optional<std::size_t> best;
  double steepest = 0.0;
  for (const Slot& slot : parameters_.slots) {
    const bool could = slot.quantity == Quantity::T0 || slot.quantity == Quantity::phi0 ||
                       slot.quantity == Quantity::mu || slot.quantity == Quantity::epsilon;
    if (!could || !slot.free || slot.index == except || slot.index == start_) continue;
    const auto slope = slope_of_late(x, slot.index, start_ ? start[*start_] : 0.0);
    if (!slope) continue;
    const double weight = slot.quantity == Quantity::phi0 ? phi0_weight : 1.0;
    // Slopes are compared for relative changes; a free T0 moves the last beat by far the most.
    const double unit = slot.coordinate == Coordinate::multiple ? x[slot.index] : 1.0;
    const double moves = weight * std::abs(*slope * unit);
    if (moves <= steepest) continue;
    steepest = moves;
    best = slot.index;
  }
  return best;
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
  if (rate_) {
    std::vector<double> from = x;
    from[*rate_] = reference_;
    if (const auto value = solved(from, own)) x[*rate_] += *value - reference_;
  }
  follow_start(x, own);
  if (drive_) x[*drive_] -= log_scatter(x) - scatter_;
  return x;
}

std::vector<double> Valley::u_of(std::span<const double> x) const {
  std::vector<double> u(x.begin(), x.end());
  if (drive_) u[*drive_] += log_scatter(x) - scatter_;
  if (start_) u[*start_] -= log_rest(x) - rest_;
  if (rate_) {
    std::vector<double> from(x.begin(), x.end());
    from[*rate_] = reference_;
    if (const auto value = solved(from, start_ ? u[*start_] : 0.0))
      u[*rate_] -= *value - reference_;
  }
  return u;
}

std::optional<double> Valley::slope_of_late(std::vector<double>& x, std::size_t k,
                                            double own) const {
  const double here = x[k];
  x[k] = here + step;
  follow_start(x, start_ && k == *start_ ? own + step : own);
  const auto up = late_at_end(parameters_, ends_, x);
  x[k] = here - step;
  follow_start(x, start_ && k == *start_ ? own - step : own);
  const auto down = late_at_end(parameters_, ends_, x);
  x[k] = here;
  follow_start(x, own);
  if (!up || !down) return {};
  return (*up - *down) / (2.0 * step);
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
  if (rate_) { // dh/du_k = -(d late/dx_k) / (d late/dx_a)
    const auto row = static_cast<Eigen::Index>(*rate_);
    const auto along = slope_of_late(x, *rate_, own);
    for (const Slot& slot : parameters_.slots) {
      if (!slot.free || slot.index == *rate_ || is_noise(slot.quantity)) continue;
      const auto slope = slope_of_late(x, slot.index, own);
      if (along && slope && *along != 0.0)
        result(row, static_cast<Eigen::Index>(slot.index)) = -*slope / *along;
    }
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

std::optional<double> Valley::solved(std::vector<double> x, double own) const {
  constexpr int rounds = 20;
  constexpr double longest_step = 0.3, smallest_change = 1e-13;
  constexpr double rounding_change = 1e-9; // a smaller step that gains nothing is rounding
  double slope = slope_, change = 0.0, missed = 0.0;
  for (int round = 0; round < rounds; ++round) {
    follow_start(x, own);
    const auto late = late_at_end(parameters_, ends_, x);
    if (!late) return {};
    const double misses = late_ - *late;
    if (round > 0) { // secant slope, from the last step
      const bool gained = std::abs(misses) < std::abs(missed);
      if (!gained && std::abs(change) < rounding_change) break;
      if (misses != missed && std::abs(change) > rounding_change)
        slope = (missed - misses) / change;
    }
    missed = misses;
    change = std::clamp(misses / slope, -longest_step, longest_step);
    x[*rate_] += change;
    if (std::abs(change) < smallest_change) break;
  }
  return x[*rate_];
}

} // namespace goingrate::timing_model
