#include "ring_down.hpp"

#include "final_clock.hpp"
#include "friction_cone.hpp"
#include "model_fit.hpp"
#include "profile.hpp"
#include "reference_run.hpp"
#include "refinement.hpp"

#include "goingrate/dynamics/swing_loss.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <numbers>

namespace goingrate::timing_model {

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
constexpr double infinite = std::numeric_limits<double>::infinity();
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

std::vector<std::size_t> free_terms(const Parameters& parameters) {
  std::vector<std::size_t> terms;
  for (std::size_t term = 0; term < friction_terms.size(); ++term)
    if (parameters.is_free(friction_terms[term])) terms.push_back(term);
  return terms;
}

// Puts in what the dynamics add at x; second order does not know friction that is not linear. False
// where they do not run.
bool correct(FitProblem& problem, FitDynamics dynamics, std::span<const double> x) {
  if (dynamics == FitDynamics::averaged1) return true;
  auto correction = difference_to(FitDynamics::map, problem, x);
  if (!correction) return false;
  problem.correction = std::move(*correction);
  return true;
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
  constexpr int rounds = 3; // of what the dynamics add: each gains two digits or so
  for (int round = 0; round < rounds; ++round) {
    settle(fitted.problem, fitted.minimum, {100});
    if (!fitted.minimum.usable || fitted.dynamics == FitDynamics::averaged1) break;
    if (!correct(fitted.problem, fitted.dynamics, fitted.minimum.x)) break;
  }
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

Eigen::VectorXd vector_of(const std::vector<double>& x) {
  return Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
}

std::vector<bool> bounded_coordinates(const Fitted& all) {
  std::vector<bool> bounded(all.minimum.x.size(), false);
  for (const std::size_t term : free_terms(all.problem.parameters))
    bounded[all.problem.parameters.find(friction_terms[term])->index] = true;
  return bounded;
}

// All coordinates as the likelihood curves about x, with friction on its side of 0; the top of the
// parabola may lie on the other.
FrictionCone cone_about(const Fitted& all, const Eigen::VectorXd& x, const Evaluation& at) {
  const Eigen::VectorXd to_top = -at.triangle.triangularView<Eigen::Upper>().solve(at.projected);
  return {x + to_top, at.triangle.transpose() * at.triangle, bounded_coordinates(all)};
}

// What a step to the best place that the curvature promises would gain, of L.
double promised_gain(const Evaluation& at, const Eigen::VectorXd& step) {
  return 0.5 * (at.triangle * step).squaredNorm();
}

// Goes to the best place with friction on its side of 0 by steps to the best place of the parabola
// about the last, half as far where L does not fall. A search among bounds stops at a term that is
// 0 although L falls away from it.
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

// Brought to rest by the dynamics of the fit.
bool settle_by_dynamics(Fitted& fitted) {
  if (!correct(fitted.problem, fitted.dynamics, fitted.minimum.x)) return false;
  settle(fitted.problem, fitted.minimum, {100});
  if (!fitted.minimum.usable) return false;
  step_on_the_cone(fitted);
  finish(fitted);
  if (!fitted.minimum.usable) return false;
  return fitted.dynamics == FitDynamics::averaged1 || refine(fitted, FitDynamics::map);
}

// All terms at once.
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

// The same about the fit, as wide as its sigmas are.
FrictionCone cone_of(const Fitted& all, const Evaluation& at) {
  const Eigen::VectorXd to_top = -at.triangle.triangularView<Eigen::Upper>().solve(at.projected);
  return {vector_of(all.minimum.x) + to_top, all.known.covariance().inverse(),
          bounded_coordinates(all)};
}

DecayEstimate nothing_known() { return {unknown, unknown, unknown, unknown, unknown, unknown}; }

// A sum of the coordinates and what the log says of it.
class KnownSum {
public:
  KnownSum(const Fitted& all, const FrictionCone& cone, Eigen::VectorXd weights)
      : all_(all), cone_(cone), h_(std::move(weights)) {
    const Eigen::VectorXd wide = all.known.factor.transpose() * h_;
    const Eigen::VectorXd narrow = all.known.unwidened.transpose() * h_;
    widening_ = wide.norm() / narrow.norm();
    sigma_ = wide.norm();
  }

  [[nodiscard]] double best() const { return h_.dot(cone_.likeliest()); }
  /// Ends at z sigma, by the parabola.
  [[nodiscard]] std::array<double, 2> interval(double z) const { return cone_.interval(h_, z); }
  /// The same by searches with the sum held, from the ends of the parabola.
  [[nodiscard]] std::array<double, 2> searched(double z) const {
    std::array<double, 2> ends = interval(z);
    const double reach = cone_.reach(h_, z);
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}})
      ends[side] = searched_end(reach, ends[side], side == 0 ? -1.0 : 1.0);
    return ends;
  }

  /// Whether L rises as the parabola says where what the dynamics add is found at its ends: along a
  /// ridge that bends first order may see a minimum where the full equation has none.
  [[nodiscard]] bool holds_by_dynamics() const {
    constexpr double least = 0.1, most = 2.0; // of L, for 0.5 that the parabola has at a sigma
    for (const double v : interval(1.0)) {
      if (!std::isfinite(v)) continue;
      FitProblem problem = all_.problem;
      const Eigen::VectorXd there = cone_.likeliest_at(h_, v);
      const std::span place(there.data(), all_.minimum.x.size());
      if (!correct(problem, all_.dynamics, place)) return false;
      const auto value = minus_log_likelihood(problem, place);
      if (!value) return false;
      const double rise = (*value - all_.minimum.value) / (widening_ * widening_);
      if (!(rise > least && rise < most)) return false;
    }
    return true;
  }

private:
  // The root of the fall of 2 log L, in sigmas, with the sum held at v: each step goes to the
  // lowest place of the parabola about the last, or half as far where L does not fall. Nothing
  // where the model does not hold.
  [[nodiscard]] std::optional<double> root_at(double v) const {
    constexpr int most_steps = 12;
    constexpr double enough = 5e-3; // of L, where half or two are looked for
    Eigen::VectorXd x = cone_.likeliest_at(h_, v);
    const auto place = [&](const Eigen::VectorXd& at) {
      return std::span(at.data(), all_.minimum.x.size());
    };
    auto value = minus_log_likelihood(all_.problem, place(x));
    for (int step = 0; value && step < most_steps; ++step) {
      const auto here = evaluate(all_.problem, place(x));
      if (!here) return {};
      const Eigen::VectorXd towards = cone_about(all_, x, *here).likeliest_at(h_, v);
      double part = 1.0;
      Eigen::VectorXd there = towards;
      auto next = minus_log_likelihood(all_.problem, place(there));
      while (!(next && *next < *value) && part > 0.05) {
        part *= 0.5;
        there = x + part * (towards - x);
        next = minus_log_likelihood(all_.problem, place(there));
      }
      if (!(next && *next < *value)) break;
      const bool done = *value - *next < enough;
      x = there;
      value = next;
      if (done) break;
    }
    if (!value) return {};
    return std::sqrt(2.0 * std::max(0.0, *value - all_.minimum.value)) / widening_;
  }

  // The root goes nearly straight from 0 at the best: by false position from the parabola's end.
  [[nodiscard]] double searched_end(double z, double end, double side) const {
    constexpr double close = 0.05, farthest = 4.0; // of z; of the parabola's distance
    const double from = best();
    double v = std::isfinite(end) ? end : from + side * z * sigma_;
    double inside = from, root_inside = 0.0;
    std::optional<double> outside, root_outside;
    for (int round = 0; round < 8; ++round) {
      const auto root = root_at(v);
      if (root && std::abs(*root - z) < close * z) return v;
      if (root && *root < z) {
        inside = v;
        root_inside = *root;
      } else {
        outside = v;
        root_outside = root;
      }
      double next = 0.5 * (inside + outside.value_or(inside));
      if (outside && root_outside)
        next = inside + (*outside - inside) * (z - root_inside) / (*root_outside - root_inside);
      else if (!outside)
        next = from + (inside - from) * std::min(2.0, z / std::max(0.3 * z, root_inside));
      if (std::abs(next - from) > farthest * z * sigma_) return side * infinite;
      v = next;
    }
    return outside && root_outside ? v : side * infinite;
  }

  const Fitted& all_;
  const FrictionCone& cone_;
  Eigen::VectorXd h_;
  double widening_ = 1.0, sigma_ = 0.0;
};

// From 1/Q, with its intervals, to `factor` Q.
DecayEstimate estimate(double inverse, const std::array<double, 2>& in68,
                       const std::array<double, 2>& in95, double factor) {
  constexpr double largest_relative_sigma = 1.0 / 3.0; // as of every parameter
  const auto of = [&](double end) { return end > 0.0 ? factor / end : infinite; };
  DecayEstimate q{of(inverse), 0.0, of(in68[1]), of(in68[0]), of(in95[1]), of(in95[0])};
  q.sigma = 0.5 * (q.high68 - q.low68);
  return q.sigma <= largest_relative_sigma * q.value ? q : nothing_known();
}

// Q at the amplitudes of the log, by the friction of any law.
class QualityCurve {
public:
  QualityCurve(const Fitted& all, const Evaluation& at) : all_(all), cone_(cone_of(all, at)) {}

  /// Whether the full equation agrees with what is found at this amplitude.
  [[nodiscard]] bool holds_by_dynamics(double amplitude) const {
    if (all_.dynamics == FitDynamics::averaged1) return true;
    return KnownSum(all_, cone_, loss_at(amplitude).weights).holds_by_dynamics();
  }

  /// `factor` times Q.
  [[nodiscard]] DecayEstimate at(double amplitude, double factor = 1.0) const {
    const auto [h, held] = loss_at(amplitude);
    const KnownSum sum(all_, cone_, h);
    auto in68 = sum.interval(1.0), in95 = sum.interval(z95);
    if (!is_straight(in68, sum.best())) {
      in68 = sum.searched(1.0);
      in95 = sum.searched(z95);
    }
    for (double* end : {&in68[0], &in68[1], &in95[0], &in95[1]})
      *end += held;
    return estimate(sum.best() + held, in68, in95, factor);
  }

private:
  // 1/Q = weights . coordinates + held.
  struct Loss {
    Eigen::VectorXd weights;
    double held = 0.0; // by the terms that are not free
  };
  [[nodiscard]] Loss loss_at(double amplitude) const {
    const auto share = inverse_q_per_friction(amplitude);
    Loss loss{Eigen::VectorXd::Zero(cone_.likeliest().size())};
    for (std::size_t term = 0; term < friction_terms.size(); ++term) {
      const Slot* slot = all_.problem.parameters.find(friction_terms[term]);
      if (slot->free)
        loss.weights[static_cast<Eigen::Index>(slot->index)] = share[term] * slot->scale;
      else
        loss.held += share[term] * slot->fixed_value;
    }
    return loss;
  }

  static constexpr double z95 = 1.959964;
  static bool is_straight(const std::array<double, 2>& in68, double best) {
    constexpr double surely = 0.02; // relative sigma: no bend of the ridge shows
    return in68[1] - in68[0] < 2.0 * surely * best;
  }
  const Fitted& all_;
  FrictionCone cone_;
};

struct Known {
  double value, sigma;
};

Known known_by(const Fitted& law, Quantity quantity) {
  const Slot* slot = law.problem.parameters.find(quantity);
  if (!slot->free) return {unknown, unknown};
  const std::span<const double> x(law.minimum.x);
  return {slot->value(x), law.known.sigma(slot->index) * std::abs(slot->slope(x))};
}

std::vector<FrictionLaw> laws_of(const Fitted& all) {
  std::vector<FrictionLaw> laws;
  const auto terms = free_terms(all.problem.parameters);
  if (terms.size() < friction_terms.size()) return laws; // some are given
  std::vector<Fitted> fits;
  constexpr unsigned every = 7;
  double best = infinite;
  for (unsigned chosen = 1; chosen <= every; ++chosen)
    if (Fitted law = with_terms(all, chosen); law.minimum.usable) {
      best = std::min(best, law.bic);
      laws.push_back({name_of_law(chosen), law.bic});
      fits.push_back(std::move(law));
    }
  for (std::size_t k = 0; k < laws.size(); ++k) {
    FrictionLaw& law = laws[k];
    law.behind = law.bic - best;
    law.T0_s = law.T0_sigma_s = law.lambda0 = law.lambda0_sigma = unknown;
    if (!law.is_open()) continue;
    finish(fits[k]);
    if (!fits[k].minimum.usable) continue;
    const Known T0 = known_by(fits[k], Quantity::T0),
                lambda0 = known_by(fits[k], Quantity::lambda0);
    law.T0_s = T0.value;
    law.T0_sigma_s = T0.sigma;
    law.lambda0 = lambda0.value;
    law.lambda0_sigma = lambda0.sigma;
  }
  std::sort(laws.begin(), laws.end(),
            [](const FrictionLaw& a, const FrictionLaw& b) { return a.bic < b.bic; });
  return laws;
}

// Whether a step to the best place that the curvature promises would gain nothing that counts. By
// times alone, at wide swings, amplitude and friction trade places along a ridge that bends, and a
// search may stop on its way.
bool is_at_rest(const Fitted& all, const Evaluation& at) {
  constexpr double little = 0.1; // of L: half a sigma
  const Eigen::VectorXd here = vector_of(all.minimum.x);
  const Eigen::VectorXd step = cone_about(all, here, at).likeliest() - here;
  return promised_gain(at, step) < little;
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
  const Span of_fit = amplitudes_of(fitted);
  if (!(of_fit.last > 0.0) || !(of_fit.first < std::numbers::pi)) return {};
  Decay decay;
  decay.amplitude_rad = of_fit.at(0.5);
  decay.q = decay.time_s = nothing_known();
  const auto all = with_every_law(fitted, options);
  if (!all) return decay;
  if (free_terms(all->problem.parameters).empty()) return {};
  const auto at = evaluate(all->problem, all->minimum.x);
  if (!at) return decay;
  const Span span = amplitudes_of(*all);
  decay.amplitude_rad = span.at(0.5);
  decay.laws = laws_of(*all);
  if (!amplitude_is_known(*all) || !is_at_rest(*all, *at)) return decay;
  const QualityCurve curve(*all, *at);
  if (!curve.holds_by_dynamics(decay.amplitude_rad)) return decay;
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

bool Decay::law_is_open() const { return laws.size() > 1 && laws[1].is_open(); }

} // namespace goingrate
