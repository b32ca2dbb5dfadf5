#include "inference.hpp"

#include "fit_setup.hpp"

#include "goingrate/base/scaled_time.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <numbers>

namespace goingrate::timing_model {

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
// A value whose three-sigma interval reaches down to nothing tells nothing.
constexpr double largest_relative_sigma = 1.0 / 3.0;

// The clock as it goes after the last event, and what can be said of it.
struct FinalClock {
  double T0, epsilon, mu, phi0, lambda0;
};

FinalClock final_clock(const Parameters& parameters, std::span<const double> x) {
  Going<double> going;
  for (std::size_t event = 0; event <= parameters.event_cycles.size(); ++event)
    apply_changes(parameters, x, event, going);
  return {going.T0, going.epsilon, going.mu, going.phi0, std::sqrt(going.amplitude2_start)};
}

// Value and sigma of a function of the coordinates, by central differences of a thousandth of each
// coordinate's own sigma or unit.
DerivedQuantity derive(std::string name, std::string expression, std::string unit,
                       const std::function<double(std::span<const double>)>& function,
                       std::span<const double> x, const Certainty& certainty) {
  Eigen::VectorXd gradient(static_cast<Eigen::Index>(x.size()));
  std::vector<double> moved(x.begin(), x.end());
  for (std::size_t k = 0; k < x.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    const double step = 1e-3 * std::min(0.1, certainty.sigma(i));
    moved[k] = x[k] + step;
    const double up = function(moved);
    moved[k] = x[k] - step;
    const double down = function(moved);
    moved[k] = x[k];
    gradient[i] = step > 0.0 ? (up - down) / (2.0 * step) : 0.0;
  }
  return {std::move(name), std::move(expression), std::move(unit), function(x),
          (certainty.factor.transpose() * gradient).norm()};
}

constexpr double rivals_apart = 3.5; // sigma: beyond what three sigma of cost allow

bool rivals_agree(const Rivals& rivals,
                  const std::function<double(std::span<const double>)>& function) {
  if (rivals.points.empty()) return true;
  const auto best = derive("", "", "", function, rivals.best, rivals.known);
  return std::all_of(rivals.points.begin(), rivals.points.end(), [&](const auto& point) {
    return std::abs(function(point) - best.value) <= rivals_apart * best.sigma;
  });
}

DerivedQuantity unless_undetermined(DerivedQuantity quantity) {
  if (!(quantity.sigma <= largest_relative_sigma * std::abs(quantity.value)))
    quantity.value = quantity.sigma = unknown;
  return quantity;
}

// Whether the friction that holds at the end is a result.
bool friction_known(const FitProblem& problem, const Certainty& certainty) {
  bool known = true;
  for (const Slot& slot : problem.parameters.slots)
    if (slot.quantity == Quantity::epsilon && slot.free) known = !certainty.distrusted[slot.index];
  return known;
}

// How large an uncertainty makes this parameter undetermined, in units of its coordinate.
double tolerable_sigma(const FitProblem& problem, const Slot& slot, std::span<const double> x) {
  if (slot.coordinate == Coordinate::logarithm) return largest_relative_sigma;
  const FinalClock clock = final_clock(problem.parameters, x);
  if (slot.coordinate == Coordinate::multiple) {
    double largest = 0.0;
    for (const Slot& other : problem.parameters.slots)
      if (other.quantity == Quantity::mu) largest = std::max(largest, other.value(x));
    return largest_relative_sigma * largest / slot.scale;
  }
  // T0 differs from the mean period by the rate excess; it is known when its sigma is a small part
  // of what it has been corrected for.
  const double lambda2 = std::max(clock.lambda0 * clock.lambda0,
                                  2.0 * clock.mu * clock.phi0 / (std::numbers::pi * clock.epsilon));
  const double correction =
      lambda2 / 16.0 + 2.0 * clock.mu / (std::numbers::pi * std::sqrt(lambda2));
  return largest_relative_sigma * correction;
}

std::string unit_of(Quantity quantity) {
  if (quantity == Quantity::T0) return "s";
  return quantity == Quantity::phi0 || quantity == Quantity::lambda0 ? "rad" : "";
}

bool has_prior(const FitOptions& options, const std::string& name) {
  return std::any_of(options.priors.begin(), options.priors.end(),
                     [&](const Prior& prior) { return prior.name == name; });
}

void state_parameters(const FitProblem& problem, std::span<const double> x,
                      const Certainty& certainty, const FitOptions& options, FitSummary& summary) {
  for (const Slot& slot : problem.parameters.slots) {
    FittedParameter parameter;
    parameter.name = name_of(slot);
    parameter.unit = unit_of(slot.quantity);
    parameter.value = slot.value(x);
    parameter.sigma = unknown;
    parameter.model_shift = unknown;
    if (!slot.free) {
      // A free pendulum has no escapement whose parameters could be listed.
      const bool escapement = slot.quantity == Quantity::mu || slot.quantity == Quantity::phi0;
      if (summary.escapement == "none" && escapement) continue;
      parameter.status = ParameterStatus::fixed;
    } else {
      const auto i = static_cast<Eigen::Index>(slot.index);
      const double sigma = certainty.sigma(i);
      parameter.status =
          has_prior(options, parameter.name) ? ParameterStatus::prior : ParameterStatus::free;
      parameter.sigma = sigma * std::abs(slot.slope(x));
      if (!(sigma <= tolerable_sigma(problem, slot, x)) || certainty.distrusted[slot.index]) {
        parameter.status = ParameterStatus::undetermined;
        parameter.value = parameter.sigma = unknown;
      }
    }
    summary.parameters.push_back(parameter);
  }
}

void state_correlation(const FitProblem& problem, const Certainty& certainty, FitSummary& summary) {
  const Eigen::MatrixXd covariance = certainty.covariance();
  const auto n = covariance.rows();
  for (const Slot& slot : problem.parameters.slots)
    if (slot.free) summary.correlated.push_back(name_of(slot));
  for (Eigen::Index i = 0; i < n; ++i) {
    std::vector<double> row;
    for (Eigen::Index k = 0; k < n; ++k)
      row.push_back(covariance(i, k) / std::sqrt(covariance(i, i) * covariance(k, k)));
    summary.correlation.push_back(row);
  }
}

// Standard deviation of the slope of a straight line (s a cycle) under the noise of the times.
double line_sigma(const FitProblem& problem) {
  const auto& cycle = problem.data.cycle;
  std::vector<double> white(cycle.size() - 1);
  Whitening(cycle, problem.weights.timing).apply<double>(cycle, white);
  double sum = 0.0;
  for (const double w : white)
    sum += w * w;
  return problem.weights.time_widening / std::sqrt(sum);
}

double phase_at_end(const FitProblem& problem, std::span<const double> x) {
  Prediction<double> prediction;
  if (!predict(problem.parameters, x, problem.data, prediction)) return unknown;
  return prediction.residual_s.back() - prediction.residual_s.front();
}

void state_combinations(const FitProblem& problem, std::span<const double> x,
                        const Certainty& certainty, const Rivals& rivals, double nominal_period_s,
                        FitSummary& summary) {
  using std::numbers::pi;
  const auto of_clock = [&](std::string name, std::string expression, std::string unit, auto get) {
    const auto function = [&, get](std::span<const double> at) {
      return get(final_clock(problem.parameters, at));
    };
    auto quantity =
        derive(std::move(name), std::move(expression), std::move(unit), function, x, certainty);
    if (!rivals_agree(rivals, function)) quantity.sigma = std::numeric_limits<double>::infinity();
    return unless_undetermined(std::move(quantity));
  };
  summary.q_factor =
      of_clock("Q", "1/(2 epsilon)", "", [](const FinalClock& c) { return 0.5 / c.epsilon; });
  summary.decay_time = of_clock("decay time", "T0/(2 pi epsilon)", "s",
                                [](const FinalClock& c) { return c.T0 / (two_pi * c.epsilon); });
  summary.stationary_amplitude = of_clock(
      "stationary amplitude", "sqrt(2 mu phi0/(pi epsilon))", "rad", [](const FinalClock& c) {
        return std::sqrt(std::max(0.0, 2.0 * c.mu * c.phi0 / (pi * c.epsilon)));
      });
  const auto gain = of_clock("fast gain", "2 mu/(pi lambda) sqrt(1 - (phi0/lambda)^2)", "",
                             [](const FinalClock& c) {
                               const double lambda2 = 2.0 * c.mu * c.phi0 / (pi * c.epsilon);
                               const double y2 = std::max(0.0, lambda2 - c.phi0 * c.phi0);
                               return 2.0 * c.mu / pi * std::sqrt(y2) / lambda2;
                             });
  // What a relaxation that was not seen would lead to is not known either.
  if (!std::isfinite(summary.decay_time.value) || !friction_known(problem, certainty))
    for (DerivedQuantity* quantity :
         {&summary.q_factor, &summary.decay_time, &summary.stationary_amplitude})
      quantity->value = quantity->sigma = unknown;
  const bool driven = summary.escapement != "none";
  if (!driven) summary.stationary_amplitude.value = summary.stationary_amplitude.sigma = unknown;

  // The mean period over the log by the model; its sigma is that of a straight line through the
  // times, which no flat valley of the clock's parameters can touch.
  const double cycles = problem.data.cycle.back();
  const DerivedQuantity period{"mean period", "(t_N - t_0)/N of the model", "s",
                               problem.data.reference_period_s - phase_at_end(problem, x) / cycles,
                               line_sigma(problem)};
  summary.rate_s_per_day = {"rate", "T0_nominal/mean period - 1", "s/day",
                            seconds_gained_per_day(nominal_period_s / period.value - 1.0),
                            seconds_gained_per_day(period.sigma / period.value)};
  summary.combinations.push_back(period);
  const auto add_if_known = [&](const DerivedQuantity& quantity) {
    if (std::isfinite(quantity.value)) summary.combinations.push_back(quantity);
  };
  add_if_known(summary.decay_time);
  if (!driven) return;
  add_if_known(summary.stationary_amplitude);
  add_if_known(gain);
}

} // namespace

namespace {

// T0 is the mean period less the circular and escapement errors. Where the escapement error (the
// fast gain times the drive) is not determined neither is T0, whatever the curvature says at the
// place on the flat valley where the fit came to rest.
void doubt_T0_without_gain(FitSummary& summary) {
  const auto is_gain = [](const DerivedQuantity& q) { return q.name == "fast gain"; };
  const bool known = summary.escapement == "none" ||
                     std::any_of(summary.combinations.begin(), summary.combinations.end(), is_gain);
  for (FittedParameter& p : summary.parameters)
    if (!known && p.name == "T0" && p.status == ParameterStatus::free) {
      p.status = ParameterStatus::undetermined;
      p.value = p.sigma = unknown;
    }
}

} // namespace

Certainty certainty(const FitProblem& problem, std::span<const double> x) {
  const auto linear = linearise(problem, x);
  const auto n = static_cast<Eigen::Index>(x.size());
  if (!linear || n == 0) return {Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, n), {}};
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(linear->jacobian);
  const Eigen::MatrixXd r = qr.matrixQR().topRows(n).triangularView<Eigen::Upper>();
  // H^-1 J' sqrt(W) = R^-1 (sqrt(W) Q)': as a factor, reduced to n columns by a second QR.
  Eigen::MatrixXd widened =
      qr.householderQ() * Eigen::MatrixXd::Identity(linear->jacobian.rows(), n);
  const auto times = static_cast<Eigen::Index>(linear->times);
  const auto amplitudes = static_cast<Eigen::Index>(linear->amplitudes);
  widened.topRows(times) *= problem.weights.time_widening;
  widened.middleRows(times, amplitudes) *= problem.weights.amplitude_widening;
  const Eigen::HouseholderQR<Eigen::MatrixXd> second(widened);
  const Eigen::MatrixXd s = second.matrixQR().topRows(n).triangularView<Eigen::Upper>();
  const auto upper = r.triangularView<Eigen::Upper>();
  return {upper.solve(s.transpose()), upper.solve(Eigen::MatrixXd::Identity(n, n)),
          std::vector<bool>(x.size(), false)};
}

namespace {

// The least cost with coordinate k held at `value`; the rest starts where the curvature points.
double cost_with_held(const FitProblem& problem, std::span<const double> x, const Certainty& known,
                      std::size_t k, double value) {
  FitProblem held = problem;
  const auto row = static_cast<Eigen::Index>(k);
  const Eigen::MatrixXd& factor = known.unwidened;
  const Eigen::VectorXd direction =
      factor * factor.row(row).transpose() / factor.row(row).squaredNorm();
  std::vector<double> start(x.begin(), x.end());
  for (std::size_t i = 0; i < start.size(); ++i)
    start[i] += (value - x[k]) * direction[static_cast<Eigen::Index>(i)];
  const double tight = 1e-3 * factor.row(row).norm(); // of a sigma: held for all purposes
  held.priors.push_back({k, value, tight});
  constexpr int iterations = 20;
  const Minimum minimum = minimise(held, start, iterations);
  return minimum.usable ? minimum.cost : std::numeric_limits<double>::infinity();
}

} // namespace

void distrust_by_rivals(const Rivals& rivals, Certainty& known) {
  for (std::size_t k = 0; k < known.distrusted.size() && !rivals.points.empty(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const double sigma = rivals.known.sigma(row);
    double farthest = 0.0;
    for (const auto& point : rivals.points)
      farthest = std::max(farthest, std::abs(point[k] - rivals.best[k]));
    if (farthest > rivals_apart * sigma) known.distrusted[k] = true;
    known.factor.row(row) *= std::hypot(1.0, farthest / sigma);
  }
  const Eigen::MatrixXd covariance = known.covariance();
  const std::vector<bool> doubted = known.distrusted;
  for (std::size_t k = 0; k < doubted.size(); ++k)
    for (std::size_t j = 0; j < doubted.size(); ++j) {
      const auto row = static_cast<Eigen::Index>(k), column = static_cast<Eigen::Index>(j);
      const double size = std::sqrt(covariance(row, row) * covariance(column, column));
      if (doubted[j] && std::abs(covariance(row, column)) > 0.99 * size) known.distrusted[k] = true;
    }
}

void distrust_ripples(const FitProblem& problem, std::span<const double> x, Certainty& known) {
  const auto linear = linearise(problem, x);
  if (!linear) return;
  const double least = 0.5 * linear->residual.squaredNorm();
  for (const Slot& slot : problem.parameters.slots) {
    if (!slot.free) continue;
    const auto row = static_cast<Eigen::Index>(slot.index);
    const double sigma = known.sigma(row);
    const double tolerable = tolerable_sigma(problem, slot, x);
    if (sigma < 0.03 * tolerable || sigma > tolerable) continue;
    const double promised = 4.5 * std::pow(sigma / known.unwidened.row(row).norm(), 2);
    const auto too_cheap = [&](double side) {
      const double value = x[slot.index] + side * sigma;
      return cost_with_held(problem, x, known, slot.index, value) - least < promised / 3.0;
    };
    known.distrusted[slot.index] = too_cheap(-3.0) || too_cheap(3.0);
  }
}

Eigen::VectorXd shift_by(const FitProblem& problem, std::span<const double> x,
                         const Correction& correction) {
  const auto linear = linearise(problem, x);
  FitProblem corrected = problem;
  corrected.correction = correction;
  const auto other = linearise(corrected, x);
  if (!linear || !other) return Eigen::VectorXd::Zero(static_cast<Eigen::Index>(x.size()));
  return linear->jacobian.householderQr().solve(other->residual - linear->residual);
}

void state_results(const FitProblem& problem, std::span<const double> x, const Certainty& certainty,
                   const Rivals& rivals, const FitOptions& options, double nominal_period_s,
                   FitSummary& summary) {
  state_parameters(problem, x, certainty, options, summary);
  state_correlation(problem, certainty, summary);
  state_combinations(problem, x, certainty, rivals, nominal_period_s, summary);
  doubt_T0_without_gain(summary);
}

} // namespace goingrate::timing_model
