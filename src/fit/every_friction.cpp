#include "every_friction.hpp"

#include "final_clock.hpp"
#include "model_fit.hpp"
#include "reference_run.hpp"
#include "refinement.hpp"

#include "goingrate/dynamics/swing_loss.hpp"

#include <algorithm>

namespace goingrate::timing_model {

std::vector<std::size_t> free_terms(const Parameters& parameters) {
  std::vector<std::size_t> terms;
  for (std::size_t term = 0; term < friction_terms.size(); ++term)
    if (parameters.is_free(friction_terms[term])) terms.push_back(term);
  return terms;
}

Span amplitudes_of(const Parameters& parameters, std::span<const double> x, const Residuals& seen) {
  const auto& course = seen.amplitude_model;
  const Slot* scale = parameters.find(Quantity::amplitude_scale);
  const double shown = scale != nullptr ? scale->value(x) : 1.0;
  return {course.back() / shown, course.front() / shown};
}

Span amplitudes_of(const Fitted& fitted) {
  return amplitudes_of(fitted.problem.parameters, fitted.minimum.x, fitted.seen);
}

bool correct(FitProblem& problem, FitDynamics dynamics, std::span<const double> x) {
  if (dynamics == FitDynamics::averaged1) return true;
  auto correction = difference_to(FitDynamics::map, problem, x);
  if (!correction) return false;
  problem.correction = std::move(*correction);
  return true;
}

namespace {

// The problem with every term of friction as a size from 0 on. The unit of a term is the size that
// would by itself lose as much as the fit does at `amplitude`.
FitProblem with_all_friction(const Fitted& fitted, const FitOptions& options, double amplitude) {
  ModelChoice model = fitted.model;
  model.quadratic = model.dry = true;
  FitProblem problem = fitted.problem.on(*fitted.problem.data);
  problem.parameters = make_parameters(options, *problem.data, model);
  problem.parameters.start_ratio = fitted.problem.parameters.start_ratio;
  const FinalClock clock = final_clock(fitted.problem.parameters, fitted.minimum.x);
  const auto share = inverse_q_per_friction(amplitude);
  const double loss =
      share[0] * clock.laws.epsilon + share[1] * clock.laws.quadratic + share[2] * clock.laws.dry;
  for (Slot& slot : problem.parameters.slots)
    for (std::size_t term = 0; term < friction_terms.size(); ++term)
      if (slot.quantity == friction_terms[term] && slot.free) {
        slot.coordinate = Coordinate::multiple;
        slot.scale = loss / share[term];
      }
  problem.bounds = make_bounds(problem.parameters, *problem.data);
  return problem;
}

Eigen::VectorXd vector_of(const std::vector<double>& x) {
  return Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
}

std::vector<bool> bounded_coordinates(const Fitted& all) {
  std::vector<bool> bounded(all.minimum.x.size(), false);
  for (const std::size_t term : free_terms(all.problem.parameters))
    bounded[all.problem.parameters.find(friction_terms[term])->index] = true;
  return bounded;
}

} // namespace

FrictionCone cone_about(const Fitted& all, const Eigen::VectorXd& x, const Evaluation& at) {
  const Eigen::VectorXd to_top = -at.triangle.triangularView<Eigen::Upper>().solve(at.projected);
  return {x + to_top, at.triangle.transpose() * at.triangle, bounded_coordinates(all)};
}

FrictionCone cone_of(const Fitted& all, const Evaluation& at) {
  const Eigen::VectorXd to_top = -at.triangle.triangularView<Eigen::Upper>().solve(at.projected);
  return {vector_of(all.minimum.x) + to_top, all.known.covariance().inverse(),
          bounded_coordinates(all)};
}

namespace {

// The gain of L that the curvature promises for a step to the best point.
double promised_gain(const Evaluation& at, const Eigen::VectorXd& step) {
  return 0.5 * (at.triangle * step).squaredNorm();
}

// Goes to the best point with friction not below 0, by steps to the best point of the parabola
// about the last point, halved if L does not fall. An ordinary search with bounds stops at a term
// that is 0 although L falls away from it.
void step_on_the_cone(Fitted& all) {
  constexpr int most_steps = 20;
  constexpr double least_gain = 1e-3, shortest_part = 0.01; // of L; of a step
  Eigen::VectorXd x = vector_of(all.minimum.x);
  const auto place = [&](const Eigen::VectorXd& at) {
    return std::span(at.data(), all.minimum.x.size());
  };
  for (int k = 0; k < most_steps; ++k) {
    const auto here = evaluate(all.problem, place(x));
    if (!here) return;
    const Eigen::VectorXd step = cone_about(all, x, *here).likeliest() - x;
    if (promised_gain(*here, step) < least_gain) return;
    double part = 1.0;
    std::optional<double> value;
    for (; part > shortest_part; part *= 0.5) {
      value = minus_log_likelihood(all.problem, place(x + part * step));
      if (value && *value < all.minimum.value) break;
    }
    if (!(value && *value < all.minimum.value)) return;
    x += part * step;
    all.minimum.x.assign(x.data(), x.data() + x.size());
    all.minimum.value = *value;
  }
}

// Searches a fit to its minimum by its own dynamics; false if that is not possible.
bool settle_by_dynamics(Fitted& fitted) {
  if (!correct(fitted.problem, fitted.dynamics, fitted.minimum.x)) return false;
  settle(fitted.problem, fitted.minimum, {100});
  if (!fitted.minimum.usable) return false;
  step_on_the_cone(fitted);
  finish(fitted);
  if (!fitted.minimum.usable) return false;
  return fitted.dynamics == FitDynamics::averaged1 || refine(fitted, FitDynamics::map);
}

} // namespace

std::optional<Fitted> with_every_law(const Fitted& fitted, const FitOptions& options) {
  Fitted all = fitted;
  all.rivals.clear();
  all.ends.clear();
  all.problem = with_all_friction(fitted, options, amplitudes_of(fitted).at(0.5));
  const Parameters& parameters = all.problem.parameters;
  std::vector<double> start(parameters.free_count, 0.0);
  const auto terms = free_terms(parameters);
  for (const std::size_t term : terms)
    start[parameters.find(friction_terms[term])->index] = 1.0 / static_cast<double>(terms.size());
  all.minimum.x = carried_over(fitted.problem.parameters, fitted.minimum.x, parameters, start);
  for (const std::size_t term : terms) { // as the fit has them
    const Slot& slot = *parameters.find(friction_terms[term]);
    const Slot* own = fitted.problem.parameters.find(friction_terms[term]);
    const double value = own == nullptr ? 0.0 : own->value(std::span(fitted.minimum.x));
    all.minimum.x[slot.index] = slot.coordinate_of(value);
  }
  all.problem.priors = make_priors(options, parameters, all.minimum.x);
  condense(all.problem, all.minimum.x);
  if (!settle_by_dynamics(all)) return {};
  return all;
}

bool is_at_rest(const Fitted& all, const Evaluation& at) {
  constexpr double rest_gain = 0.1; // of ln L: half a sigma
  const Eigen::VectorXd here = vector_of(all.minimum.x);
  const Eigen::VectorXd step = cone_about(all, here, at).likeliest() - here;
  return promised_gain(at, step) < rest_gain;
}

} // namespace goingrate::timing_model
