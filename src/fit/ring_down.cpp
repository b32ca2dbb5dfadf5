#include "ring_down.hpp"

#include "final_clock.hpp"
#include "friction_cone.hpp"
#include "model_fit.hpp"
#include "profile.hpp"
#include "reference_run.hpp"

#include "goingrate/dynamics/swing_loss.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <numbers>

namespace goingrate::timing_model {

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
constexpr std::array friction_terms{Quantity::epsilon, Quantity::quadratic_drag,
                                    Quantity::dry_friction}; // in the order of swing_loss.hpp
constexpr std::array<const char*, 3> friction_words{"linear", "quadratic", "dry"};

// The amplitudes between which the fit has the pendulum swing: turning angles, the last and the
// first.
struct Span {
  double last = 0.0, first = 0.0;
  [[nodiscard]] double at(double part) const { return last * std::pow(first / last, part); }
};

Span amplitudes_of(const Fitted& fitted) {
  const auto& course = fitted.seen.amplitude_model;
  const Slot* scale = fitted.problem.parameters.find(Quantity::amplitude_scale);
  const double shown = scale != nullptr ? scale->value(std::span(fitted.minimum.x)) : 1.0;
  return {course.back() / shown, course.front() / shown};
}

// The problem with every term of friction as a size from 0 on, in units of what would by itself
// lose what the fit loses at `amplitude`.
FitProblem with_all_friction(const Fitted& fitted, const FitOptions& options, double amplitude) {
  ModelChoice model = fitted.model;
  model.quadratic = model.dry = true;
  FitProblem problem = fitted.problem.on(*fitted.problem.data);
  problem.parameters = make_parameters(options, *problem.data, model);
  problem.parameters.start_ratio = fitted.problem.parameters.start_ratio;
  const FinalClock clock = final_clock(fitted.problem.parameters, fitted.minimum.x);
  const auto share = inverse_q_per_friction(amplitude);
  const double loss = share[0] * clock.laws.epsilon + share[1] * clock.laws.quadratic +
                      share[2] * clock.laws.dry;
  for (Slot& slot : problem.parameters.slots)
    for (std::size_t term = 0; term < friction_terms.size(); ++term)
      if (slot.quantity == friction_terms[term] && slot.free) {
        slot.coordinate = Coordinate::multiple;
        slot.scale = loss / share[term];
      }
  problem.bounds = make_bounds(problem.parameters, *problem.data);
  return problem;
}

std::vector<std::size_t> free_terms(const Parameters& parameters) {
  std::vector<std::size_t> terms;
  for (std::size_t term = 0; term < friction_terms.size(); ++term)
    if (parameters.is_free(friction_terms[term])) terms.push_back(term);
  return terms;
}

// The fit brought to rest with those terms alone, each from an equal part of the loss, along the
// course that the correction is for.
Fitted with_terms(const Fitted& all, unsigned chosen) {
  Fitted fitted = all;
  for (const std::size_t term : free_terms(all.problem.parameters)) {
    const std::size_t index = fitted.problem.parameters.find(friction_terms[term])->index;
    const bool is_in = (chosen >> term & 1U) != 0;
    if (is_in) {
      fitted.minimum.x[index] = 1.0 / std::popcount(chosen);
    } else {
      fitted.problem = with_held(fitted.problem, index, 0.0);
      fitted.minimum.x.erase(fitted.minimum.x.begin() + static_cast<std::ptrdiff_t>(index));
    }
  }
  settle(fitted.problem, fitted.minimum, {100});
  if (fitted.minimum.usable) fitted.bic = bayes_criterion(fitted.problem, fitted.minimum);
  return fitted;
}

std::string name_of_law(unsigned chosen) {
  std::string name;
  for (std::size_t term = 0; term < friction_terms.size(); ++term)
    if ((chosen >> term & 1U) != 0)
      name += (name.empty() ? "" : " + ") + std::string(friction_words[term]);
  return name;
}

// Brought to rest by the dynamics of the fit: what they add is found where the fit stands, until
// that stands still.
bool settle_by_dynamics(Fitted& fitted) {
  constexpr int rounds = 4;
  constexpr double still = 1e-2; // of L: a tenth of a sigma
  double before = std::numeric_limits<double>::infinity();
  for (int round = 0; round < rounds; ++round) {
    if (fitted.dynamics != FitDynamics::averaged1) {
      // Second order does not know friction that is not linear.
      auto correction = difference_to(FitDynamics::map, fitted.problem, fitted.minimum.x);
      if (!correction) return false;
      fitted.problem.correction = std::move(*correction);
    }
    settle(fitted.problem, fitted.minimum, {100});
    if (!fitted.minimum.usable) return false;
    if (fitted.dynamics == FitDynamics::averaged1) break;
    if (std::abs(fitted.minimum.value - before) < still) break;
    before = fitted.minimum.value;
  }
  finish(fitted);
  return fitted.minimum.usable;
}

// All terms at once.
std::optional<Fitted> with_every_law(const Fitted& fitted, const FitOptions& options) {
  const Span span = amplitudes_of(fitted);
  if (!(span.last > 0.0) || !(span.first < std::numbers::pi)) return {};
  Fitted all = fitted;
  all.rivals.clear();
  all.ends.clear();
  all.problem = with_all_friction(fitted, options, span.at(0.5));
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

// The terms of friction that are free, as the likelihood has them when all else is fitted.
FrictionCone cone_of(const Fitted& all, const std::vector<std::size_t>& terms,
                     const Evaluation& at) {
  const Eigen::VectorXd to_top =
      -at.triangle.triangularView<Eigen::Upper>().solve(at.projected); // the top may lie outside
  const Eigen::MatrixXd covariance = all.known.covariance();
  const auto n = static_cast<Eigen::Index>(terms.size());
  Eigen::VectorXd centre(n);
  Eigen::MatrixXd known(n, n);
  const auto index = [&](Eigen::Index i) {
    return static_cast<Eigen::Index>(
        all.problem.parameters.find(friction_terms[terms[static_cast<std::size_t>(i)]])->index);
  };
  for (Eigen::Index i = 0; i < n; ++i) {
    centre[i] = all.minimum.x[static_cast<std::size_t>(index(i))] + to_top[index(i)];
    for (Eigen::Index k = 0; k < n; ++k)
      known(i, k) = covariance(index(i), index(k));
  }
  return {centre, known.inverse()};
}

DecayEstimate nothing_known() {
  return {unknown, unknown, unknown, unknown, unknown, unknown};
}

// From 1/Q, with its intervals, to `factor` Q.
DecayEstimate estimate(double inverse, const std::array<double, 2>& in68,
                       const std::array<double, 2>& in95, double factor) {
  constexpr double largest_relative_sigma = 1.0 / 3.0; // as of every parameter
  DecayEstimate q{factor / inverse, 0.0,
                  factor / in68[1], factor / in68[0],
                  factor / in95[1], factor / in95[0]};
  q.sigma = 0.5 * (q.high68 - q.low68);
  return q.sigma <= largest_relative_sigma * q.value ? q : nothing_known();
}

// Q at the amplitudes of the log, by the friction of any law.
class QualityCurve {
public:
  QualityCurve(const Fitted& all, const Evaluation& at)
      : parameters_(all.problem.parameters), terms_(free_terms(parameters_)),
        cone_(cone_of(all, terms_, at)) {}

  /// `factor` times Q.
  [[nodiscard]] DecayEstimate at(double amplitude, double factor = 1.0) const {
    const auto share = inverse_q_per_friction(amplitude);
    double held = 0.0; // of the terms that are not free
    for (std::size_t term = 0; term < friction_terms.size(); ++term)
      if (const Slot* slot = parameters_.find(friction_terms[term]); slot != nullptr && !slot->free)
        held += share[term] * slot->fixed_value;
    Eigen::VectorXd h(static_cast<Eigen::Index>(terms_.size()));
    for (Eigen::Index i = 0; i < h.size(); ++i) {
      const std::size_t term = terms_[static_cast<std::size_t>(i)];
      h[i] = share[term] * parameters_.find(friction_terms[term])->scale;
    }
    constexpr double z95 = 1.959964;
    auto in68 = cone_.interval(h, 1.0), in95 = cone_.interval(h, z95);
    for (double* end : {&in68[0], &in68[1], &in95[0], &in95[1]})
      *end += held;
    return estimate(h.dot(cone_.likeliest()) + held, in68, in95, factor);
  }

private:
  const Parameters& parameters_;
  std::vector<std::size_t> terms_;
  FrictionCone cone_;
};

std::vector<FrictionLaw> laws_of(const Fitted& all) {
  std::vector<FrictionLaw> laws;
  const auto terms = free_terms(all.problem.parameters);
  if (terms.size() < friction_terms.size()) return laws; // some are given
  constexpr unsigned every = 7;
  for (unsigned chosen = 1; chosen <= every; ++chosen)
    if (const Fitted law = with_terms(all, chosen); law.minimum.usable)
      laws.push_back({name_of_law(chosen), law.bic});
  std::sort(laws.begin(), laws.end(),
            [](const FrictionLaw& a, const FrictionLaw& b) { return a.bic < b.bic; });
  for (FrictionLaw& law : laws)
    law.behind = law.bic - laws.front().bic;
  return laws;
}

bool amplitude_is_known(const Fitted& all) {
  constexpr double well_enough = 1.0 / 3.0; // of itself
  const Slot& lambda0 = *all.problem.parameters.find(Quantity::lambda0);
  return !lambda0.free || all.known.sigma(lambda0.index) < well_enough;
}

} // namespace

std::optional<Decay> decay_of(const Fitted& fitted, const FitOptions& options) {
  const Parameters& parameters = fitted.problem.parameters;
  const bool changes = std::any_of(parameters.slots.begin(), parameters.slots.end(),
                                   [](const Slot& slot) { return slot.event > 0; });
  if (parameters.escapement != Escapement::none || changes) return {};
  const auto all = with_every_law(fitted, options);
  if (!all || free_terms(all->problem.parameters).empty()) return {};
  const auto at = evaluate(all->problem, all->minimum.x);
  if (!at) return {};
  const Span span = amplitudes_of(*all);
  Decay decay;
  decay.amplitude_rad = span.at(0.5);
  decay.q = decay.time_s = nothing_known();
  decay.laws = laws_of(*all);
  if (!amplitude_is_known(*all)) return decay;
  const QualityCurve curve(*all, *at);
  const double T0 = parameters.find(Quantity::T0)->value(std::span(all->minimum.x));
  decay.q = curve.at(decay.amplitude_rad);
  decay.time_s = curve.at(decay.amplitude_rad, T0 * decay_periods_per_q(decay.amplitude_rad));
  constexpr int steps = 8; // so many that a curve through them is smooth
  for (int k = 0; k <= steps; ++k) {
    const double amplitude = span.at(static_cast<double>(k) / steps);
    decay.q_at_amplitude.push_back({amplitude, curve.at(amplitude)});
  }
  return decay;
}

} // namespace goingrate::timing_model

namespace goingrate {

bool Decay::law_is_open() const {
  constexpr double decisive = 6.0; // odds of 20 to 1
  return laws.size() > 1 && laws[1].behind < decisive;
}

} // namespace goingrate
