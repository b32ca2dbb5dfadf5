#include "ring_down.hpp"

#include "base/special_values.hpp"
#include "held.hpp"
#include "quality_curve.hpp"

#include "goingrate/dynamics/swing_loss.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <numbers>
#include <utility>

namespace goingrate::timing_model {

namespace {

constexpr std::array<const char*, 3> friction_words{"linear", "quadratic", "dry"};

// The minimum of the fit with these terms alone, starting with equal parts of the loss, along the
// course to which the correction belongs.
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
  constexpr int rounds = 3; // of computing the correction: each gains two digits or so
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

struct Known {
  double value, sigma;
};

Known known_by(const Fitted& law, Quantity quantity) {
  const Slot* slot = law.problem.parameters.find(quantity);
  if (!slot->free) return {not_known, not_known};
  const std::span<const double> x(law.minimum.x);
  return {slot->value(x), law.known.sigma(slot->index) * std::abs(slot->slope(x))};
}

// The parameters of the pendulum under a law that is open.
void state_parameters(const Fitted& fit, unsigned chosen, FrictionLaw& law) {
  const Known T0 = known_by(fit, Quantity::T0), lambda0 = known_by(fit, Quantity::lambda0);
  law.T0_s = T0.value;
  law.T0_sigma_s = T0.sigma;
  law.lambda0 = lambda0.value;
  law.lambda0_sigma = lambda0.sigma;
  const std::array sizes{&law.epsilon, &law.quadratic_drag, &law.dry_friction};
  const std::array sigmas{&law.epsilon_sigma, &law.quadratic_drag_sigma, &law.dry_friction_sigma};
  for (std::size_t term = 0; term < friction_terms.size(); ++term) {
    const bool is_in = (chosen >> term & 1U) != 0;
    const Known size = is_in ? known_by(fit, friction_terms[term]) : Known{0.0, 0.0};
    *sizes[term] = size.value;
    *sigmas[term] = size.sigma;
  }
}

std::vector<FrictionLaw> laws_of(const Fitted& all) {
  std::vector<FrictionLaw> laws;
  const auto terms = free_terms(all.problem.parameters);
  if (terms.size() < friction_terms.size()) return laws; // some are held
  std::vector<std::pair<unsigned, Fitted>> fits;
  constexpr unsigned every = 7;
  double best = infinite;
  for (unsigned chosen = 1; chosen <= every; ++chosen)
    if (Fitted law = with_terms(all, chosen); law.minimum.usable) {
      best = std::min(best, law.bic);
      laws.push_back({name_of_law(chosen), law.bic});
      fits.emplace_back(chosen, std::move(law));
    }
  for (std::size_t k = 0; k < laws.size(); ++k) {
    FrictionLaw& law = laws[k];
    law.behind = law.bic - best;
    law.T0_s = law.T0_sigma_s = law.lambda0 = law.lambda0_sigma = not_known;
    law.epsilon = law.quadratic_drag = law.dry_friction = not_known;
    law.epsilon_sigma = law.quadratic_drag_sigma = law.dry_friction_sigma = not_known;
    if (!law.is_open()) continue;
    auto& [chosen, fit] = fits[k];
    finish(fit);
    if (fit.minimum.usable) state_parameters(fit, chosen, law);
  }
  std::sort(laws.begin(), laws.end(),
            [](const FrictionLaw& a, const FrictionLaw& b) { return a.bic < b.bic; });
  return laws;
}

bool amplitude_is_known(const Fitted& all) {
  constexpr double largest_relative_sigma = 1.0 / 3.0; // of itself
  const Slot& lambda0 = *all.problem.parameters.find(Quantity::lambda0);
  return !lambda0.free || all.known.sigma(lambda0.index) < largest_relative_sigma;
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
  decay.first = curve.swing(&Span::first);
  decay.last = curve.swing(&Span::last);
  constexpr int steps = 8; // enough for a smooth curve through them
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
