#include "inference.hpp"

#include "base/special_values.hpp"
#include "derived_quantities.hpp"
#include "final_clock.hpp"

#include <algorithm>

namespace goingrate::timing_model {

namespace {

std::string unit_of(const FitProblem& problem, const Slot& slot) {
  switch (slot.quantity) {
  case Quantity::T0:
  case Quantity::jitter_rms:
  case Quantity::walk_rms:
  case Quantity::slow_time:
    return "s";
  case Quantity::phi0:
  case Quantity::lambda0:
  case Quantity::offset:
  case Quantity::amplitude_rms:
    return "rad";
  case Quantity::term:
    return problem.data->terms[slot.term].unit;
  default:
    return "";
  }
}

bool has_prior(const FitOptions& options, const std::string& name) {
  return std::any_of(options.priors.begin(), options.priors.end(),
                     [&](const Prior& prior) { return prior.name == name; });
}

// Whether the log adds nothing to the weak prior about the start.
bool tells_nothing(const FitProblem& problem, const Slot& slot, double sigma) {
  constexpr double largest_prior_share = 0.5; // of the prior's sigma
  return std::any_of(problem.priors.begin(), problem.priors.end(), [&](const auto& prior) {
    return prior.index == slot.index && !prior.stated && sigma > largest_prior_share * prior.sigma;
  });
}

void state_free(const FitProblem& problem, const Slot& slot, std::span<const double> x,
                const Certainty& known, const Interval& interval, FittedParameter& parameter) {
  const double sigma = known.sigma(slot.index);
  parameter.sigma = sigma * std::abs(slot.slope(x));
  const auto value_at = [&](double coordinate) {
    std::vector<double> at(x.begin(), x.end());
    at[slot.index] = coordinate;
    return slot.value(std::span<const double>(at));
  };
  parameter.low68 = value_at(interval.low68);
  parameter.high68 = value_at(interval.high68);
  parameter.low95 = value_at(interval.low95);
  parameter.high95 = value_at(interval.high95);
  if (!problem.bounds.empty()) {
    const auto [low, high] = problem.bounds[slot.index];
    const double near = 1e-6 * std::max(1.0, std::abs(x[slot.index]));
    parameter.at_bound = x[slot.index] - low < near || high - x[slot.index] < near;
  }
  const bool open = !std::isfinite(interval.low68) || !std::isfinite(interval.high68) ||
                    !std::isfinite(interval.low95) || !std::isfinite(interval.high95);
  // If the profile is wider than the curvature at its minimum implies, the curvature would claim
  // too
  // much.
  if (!open && !may_vanish(slot))
    parameter.sigma = std::max({parameter.sigma, 0.5 * (parameter.high68 - parameter.low68),
                                0.5 * (parameter.high95 - parameter.low95) / z95});
  const double widened = parameter.sigma / std::abs(slot.slope(x));
  const bool vague = !(widened <= tolerable_sigma(problem, slot, x)) &&
                     (!may_vanish(slot) || tells_nothing(problem, slot, sigma));
  if (vague || (open && !parameter.at_bound) || known.distrusted[slot.index])
    leave_undetermined(parameter);
}

void state_parameters(const FitProblem& problem, std::span<const double> x, const Certainty& known,
                      const std::vector<Interval>& intervals, const FitOptions& options,
                      FitSummary& summary) {
  for (const Slot& slot : problem.parameters.slots) {
    if (is_of_moment(slot.quantity)) continue;
    FittedParameter parameter;
    parameter.name = problem.parameters.name_of(slot);
    parameter.unit = unit_of(problem, slot);
    parameter.value = slot.value(x);
    parameter.sigma = parameter.model_shift = not_known;
    parameter.low68 = parameter.high68 = parameter.low95 = parameter.high95 = not_known;
    parameter.status = slot.free ? ParameterStatus::free : ParameterStatus::fixed;
    if (slot.free && has_prior(options, parameter.name)) parameter.status = ParameterStatus::prior;
    if (slot.free) state_free(problem, slot, x, known, intervals[slot.index], parameter);
    parameter.sigma_by_law = parameter.sigma;
    summary.parameters.push_back(parameter);
  }
}

void state_correlation(const FitProblem& problem, const Certainty& known, FitSummary& summary) {
  const Eigen::MatrixXd covariance = known.covariance();
  std::vector<Eigen::Index> stated;
  for (const Slot& slot : problem.parameters.slots) {
    if (!slot.free || is_of_moment(slot.quantity)) continue;
    summary.correlated.push_back(problem.parameters.name_of(slot));
    stated.push_back(static_cast<Eigen::Index>(slot.index));
  }
  for (const Eigen::Index i : stated) {
    std::vector<double> row;
    for (const Eigen::Index k : stated)
      row.push_back(covariance(i, k) / std::sqrt(covariance(i, i) * covariance(k, k)));
    summary.correlation.push_back(row);
  }
}

} // namespace

void leave_undetermined(FittedParameter& parameter) {
  parameter.status = ParameterStatus::undetermined;
  parameter.value = parameter.sigma = not_known;
  parameter.low68 = parameter.high68 = parameter.low95 = parameter.high95 = not_known;
}

bool may_vanish(const Slot& slot) {
  return slot.coordinate == Coordinate::multiple && slot.quantity != Quantity::mu;
}

double tolerable_sigma(const FitProblem& problem, const Slot& slot, std::span<const double> x) {
  // Where several noises share the scatter, each size is stated even if known only to a factor; its
  // interval shows the factor.
  constexpr double factor = 1.0;
  if (is_noise(slot.quantity) && problem.parameters.has(Quantity::drive_rms)) return factor;
  if (slot.coordinate == Coordinate::logarithm) return largest_relative_sigma;
  if (slot.coordinate == Coordinate::multiple) {
    double largest = 0.0;
    for (const Slot& other : problem.parameters.slots)
      if (other.quantity == slot.quantity) largest = std::max(largest, std::abs(other.value(x)));
    return largest_relative_sigma * largest / slot.scale;
  }
  if (slot.quantity == Quantity::gravity_share) return largest_relative_sigma; // of all of gravity
  // T0 differs from the mean period by the rate excess. It counts as determined if its sigma is a
  // small part of that correction.
  const FinalClock clock = final_clock(problem.parameters, x);
  Going<double> start;
  apply_changes(problem.parameters, x, 0, start);
  const double lambda2 = std::max(clock.amplitude2, start.amplitude2_start);
  return largest_relative_sigma * (lambda2 / 16.0 + std::abs(clock.fast_gain()));
}

Certainty certainty(const FitProblem& problem, std::span<const double> x, const Evaluation& at,
                    const Widening& widening) {
  const auto n = at.triangle.rows();
  Certainty known;
  known.distrusted.assign(static_cast<std::size_t>(n), false);
  known.unwidened =
      at.triangle.triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(n, n));
  const double times = std::pow(widening.time, 2), amplitudes = std::pow(widening.amplitude, 2);
  if (times == 1.0 && amplitudes == 1.0) {
    known.factor = known.unwidened;
    return known;
  }
  // The curvature with widened priors, times and amplitudes, transformed by R^-1, in which M = 1.
  const Eigen::MatrixXd of_amplitudes = at.amplitude_triangle * known.unwidened;
  Eigen::MatrixXd middle = times * Eigen::MatrixXd::Identity(n, n) +
                           (amplitudes - times) * of_amplitudes.transpose() * of_amplitudes;
  for (const CoordinatePrior& prior : problem.priors) {
    Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(n);
    for (Eigen::Index k = 0; k < n; ++k)
      row += prior.slope(x, static_cast<std::size_t>(k)) * known.unwidened.row(k);
    middle += (1.0 - times) * row.transpose() * row;
  }
  const Eigen::LLT<Eigen::MatrixXd> root(middle);
  known.factor = root.info() == Eigen::Success
                     ? Eigen::MatrixXd(known.unwidened * root.matrixL().toDenseMatrix())
                     : Eigen::MatrixXd(known.unwidened * widening.largest());
  return known;
}

void distrust_by_rivals(const Rivals& rivals, std::span<const double> x, Certainty& known) {
  for (std::size_t k = 0; k < known.distrusted.size(); ++k) {
    const double sigma = known.sigma(k);
    double added = 0.0; // to the variance: share times distance squared, in units of it
    for (const Rival& rival : rivals) {
      const double distance = std::abs(rival.x[k] - x[k]) / sigma;
      // Whichever clock is right, the value is known to within that distance.
      constexpr double slight_distance = 1e-3; // of the coordinate: a thousandth
      const bool is_slight = std::abs(rival.x[k] - x[k]) < slight_distance;
      if (distance > rivals_apart && is_slight) added = std::max(added, distance * distance);
      if (distance > rivals_apart && !is_slight) known.distrusted[k] = true;
      // The distance expected for this sigma at this deficit, or sigma itself.
      if (distance * distance < 1.0 + 2.0 * rival.behind) continue;
      added = std::max(added, rival.share() * distance * distance);
    }
    known.factor.row(static_cast<Eigen::Index>(k)) *= std::sqrt(1.0 + added);
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

Eigen::VectorXd shift_by(const FitProblem& problem, std::span<const double> x,
                         const Correction& correction) {
  FitProblem corrected = problem;
  corrected.correction = correction;
  const auto there = evaluate(corrected, x);
  const auto n = static_cast<Eigen::Index>(x.size());
  if (!there) return Eigen::VectorXd::Zero(n);
  // Minus one step of scoring, which leads from here to the other minimum.
  return there->triangle.triangularView<Eigen::Upper>().solve(there->projected);
}

void state_results(const FitProblem& problem, std::span<const double> x, const Certainty& known,
                   const std::vector<Interval>& intervals, const Rivals& rivals,
                   const FitOptions& options, double nominal_period_s, FitSummary& summary) {
  state_parameters(problem, x, known, intervals, options, summary);
  state_correlation(problem, known, summary);
  state_derived(problem, x, known, rivals, nominal_period_s, summary);
}

} // namespace goingrate::timing_model
