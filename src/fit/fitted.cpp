#include "fitted.hpp"

#include "final_clock.hpp"
#include "fit_setup.hpp"
#include "fit_starts.hpp"

#include "fit/timing_noise.hpp"

#include <algorithm>

namespace goingrate::timing_model {

std::vector<double> moved_along(std::vector<double> place, std::span<const double> from,
                                std::span<const double> to) {
  for (std::size_t k = 0; k < place.size(); ++k)
    place[k] += to[k] - from[k];
  return place;
}

bool all_but_known(const FitProblem& problem, const Certainty& known, std::span<const double> x) {
  constexpr double determined_share = 0.1; // of the largest sigma that counts as determined
  return std::all_of(
      problem.parameters.slots.begin(), problem.parameters.slots.end(), [&](const Slot& slot) {
        return !slot.free || !is_of_clock(slot.quantity) ||
               known.sigma(slot.index) < determined_share * tolerable_sigma(problem, slot, x);
      });
}

namespace {

constexpr double least_white_p = 1e-2; // p below which the innovations call for a better model

} // namespace

bool white_in_amplitude(const Fitted& fitted) {
  return fitted.seen.white_amplitude.size() < 8 ||
         whiteness_p(fitted.seen.white_amplitude) > least_white_p;
}

bool white(const Fitted& fitted) {
  return whiteness_p(fitted.seen.white_time) > least_white_p && white_in_amplitude(fitted);
}

bool knows_its_clock(const Fitted& fitted) {
  return all_but_known(fitted.problem, fitted.known, fitted.minimum.x);
}

void rescale_noise(const FitProblem& problem, std::vector<double>& x) {
  const auto seen = residuals(problem, x);
  if (!seen) return;
  for (const Slot& slot : problem.parameters.slots) {
    if (!slot.free || !is_noise(slot.quantity) || slot.quantity == Quantity::slow_time) continue;
    const bool of_amplitude = slot.quantity == Quantity::amplitude_rms;
    const auto& white = of_amplitude ? seen->white_amplitude : seen->white_time;
    if (white.empty()) continue;
    const auto [low, high] = problem.bounds[slot.index];
    x[slot.index] = std::clamp(x[slot.index] + std::log(rms(white)), low, high);
  }
}

void condense(FitProblem& problem, std::span<const double> x) {
  const Parameters& parameters = problem.parameters;
  for (const Quantity quantity : {Quantity::walk_rms, Quantity::drive_rms, Quantity::term})
    if (parameters.has(quantity)) return;
  if (problem.data->has_amplitude() || !problem.data->time_noise.empty()) return;
  double epsilon = 0.0; // the largest of those found
  for (const Slot& slot : parameters.slots)
    if (slot.quantity == Quantity::epsilon) epsilon = std::max(epsilon, slot.value(x));
  problem.condensed =
      CondensedLog::of(*problem.data, parameters.event_cycles, 1.0 / (2.0 * two_pi * epsilon));
}

namespace {

// Whether a few beats give the same likelihood as all of them.
bool condensed_well(const FitProblem& problem, std::span<const double> x) {
  constexpr double largest_difference = 1e-3; // of L: 0.05 sigma
  const auto few = minus_log_likelihood(problem, x);
  const auto all = minus_log_likelihood(on_every_beat(problem), x);
  return few && all && std::abs(*few - *all) < largest_difference;
}

// If the misfit is still due to the clock and not to the noise, the clock is fitted first, with the
// noise held.
void settle_clock(const FitProblem& problem, std::vector<double>& x, const SearchLimits& limits) {
  const auto seen = residuals(problem, x);
  if (!seen) return;
  constexpr double largest_rms = 2.0;
  if (rms(seen->white_time) < largest_rms && rms(seen->white_amplitude) < largest_rms) return;
  FitProblem held = with_noise_held(problem, x);
  const std::size_t clock = held.parameters.free_count;
  std::erase_if(held.priors, [&](const CoordinatePrior& p) { return p.index >= clock; });
  const Minimum moved =
      minimise(held, {x.begin(), x.begin() + static_cast<std::ptrdiff_t>(clock)}, limits);
  if (moved.usable) std::copy(moved.x.begin(), moved.x.end(), x.begin());
  rescale_noise(problem, x);
}

// Searches on some beats of a long log first, so that all beats are needed at few points only.
void begin_on_few_beats(const FitProblem& problem, std::vector<double>& x,
                        const SearchLimits& limits) {
  constexpr std::size_t searched_beats = 8000;
  if (problem.condensed != nullptr || !problem.correction.late_s.empty() ||
      problem.data->size() < 3 * searched_beats)
    return;
  const Parameters& parameters = problem.parameters;
  const bool wanders = parameters.has(Quantity::walk_rms) || parameters.has(Quantity::drive_rms);
  const FewBeats few = wanders ? FewBeats{at_one_stride(*problem.data, searched_beats)}
                               : few_beats(*problem.data, parameters.event_cycles, searched_beats);
  const FitProblem fewer = problem.on(few.data);
  std::vector<double> there = with_noise_of_blocks(parameters, x, few.together);
  settle_clock(fewer, there, limits);
  const Minimum end = minimise(fewer, there, limits);
  if (!end.usable) return;
  there = with_noise_of_blocks(parameters, end.x, 1.0 / few.together);
  if (few.together > 1.0) rescale_noise(problem, there); // a misfit does not average out
  const auto before = minus_log_likelihood(problem, x);
  const auto after = minus_log_likelihood(problem, there);
  if (after && (!before || *after < *before)) x = std::move(there);
}

} // namespace

void settle(FitProblem& problem, Minimum& minimum, const SearchLimits& limits) {
  begin_on_few_beats(problem, minimum.x, limits);
  settle_clock(problem, minimum.x, limits);
  minimum = minimise(problem, minimum.x, limits);
  // The first search judges its convergence relative to its bad start, and may stop too early.
  if (minimum.usable && !minimum.converged) minimum = minimise(problem, minimum.x, limits);
  if (!minimum.usable || problem.condensed == nullptr || condensed_well(problem, minimum.x)) return;
  problem = on_every_beat(problem);
  minimum = minimise(problem, minimum.x, limits);
}

namespace {

Widening widening_of(const Fitted& fitted) {
  Widening widening;
  if (is_rounding(fitted)) return widening;
  constexpr double least_p_value = 1e-3;
  const auto of = [&](const std::vector<double>& innovations) {
    const bool doubtful = innovations.size() >= 8 && whiteness_p(innovations) < least_p_value;
    return doubtful ? std::sqrt(correlation_time(innovations)) : 1.0;
  };
  widening.time = of(fitted.seen.white_time);
  widening.amplitude = of(fitted.seen.white_amplitude);
  const auto n =
      static_cast<double>(fitted.seen.white_time.size() + fitted.seen.white_amplitude.size());
  const auto p = static_cast<double>(fitted.problem.parameters.free_count);
  const double taken = std::sqrt(n / std::max(1.0, n - p));
  widening.time *= taken;
  widening.amplitude *= taken;
  return widening;
}

} // namespace

void finish(Fitted& fitted) {
  fitted.bic = bayes_criterion(fitted.problem, fitted.minimum);
  auto seen = residuals(fitted.problem, fitted.minimum.x);
  const auto at = evaluate(fitted.problem, fitted.minimum.x);
  if (!seen || !at) {
    fitted.minimum.usable = false;
    return;
  }
  fitted.seen = std::move(*seen);
  fitted.widening = widening_of(fitted);
  fitted.known = certainty(fitted.problem, fitted.minimum.x, *at, fitted.widening);
}

bool is_rounding(const Fitted& fitted) {
  return rms(fitted.seen.late_s) < least_jitter(*fitted.problem.data);
}

double value_without_weak_priors(const FitProblem& problem, const Minimum& minimum) {
  double weak = 0.0;
  for (const CoordinatePrior& prior : problem.priors)
    if (!prior.stated) weak += 0.5 * std::pow(prior.pull(minimum.x), 2);
  return minimum.value - weak;
}

double bayes_criterion(const FitProblem& problem, const Minimum& minimum) {
  double seen = static_cast<double>(problem.data->size()) - 1.0;
  for (const double a : problem.data->amplitude_rad)
    seen += std::isnan(a) ? 0.0 : 1.0;
  const auto parameters = std::count_if( // a moment is a part of its event's date
      problem.parameters.slots.begin(), problem.parameters.slots.end(),
      [](const Slot& slot) { return slot.free && !is_of_moment(slot.quantity); });
  return 2.0 * value_without_weak_priors(problem, minimum) +
         static_cast<double>(parameters) * std::log(seen);
}

std::optional<NoiseShape> noise_shape(const Fitted& fitted) {
  const Slot* drive = fitted.problem.parameters.find(Quantity::drive_rms);
  if (drive == nullptr) return {};
  const std::span<const double> x(fitted.minimum.x);
  const FinalClock clock = final_clock(fitted.problem.parameters, x);
  const double jitter = fitted.problem.parameters.find(Quantity::jitter_rms)->value(x);
  return NoiseShape{std::pow(clock.T0 * clock.fast_gain() * drive->value(x), 2), jitter * jitter,
                    -clock.laws.growth_slope(clock.amplitude2),
                    clock.slow_gain() / clock.fast_gain()};
}

namespace {

// The information that these beats hold about the parameters, from the curvature at a point.
std::optional<Certainty> certainty_on(const FitProblem& problem, const TimingData& beats,
                                      std::span<const double> x) {
  const FitProblem there = problem.on(beats);
  const auto at = evaluate(there, x);
  return at ? std::optional(certainty(there, x, *at, {})) : std::nullopt;
}

} // namespace

double information_lost(const Fitted& fitted, const TimingData& beats) {
  const Parameters& parameters = fitted.problem.parameters;
  const auto x = with_jitter_of(beats, parameters, fitted.minimum.x);
  const auto here = certainty_on(fitted.problem, *fitted.problem.data, x);
  const auto there = certainty_on(fitted.problem, beats, x);
  double lost = 0.0;
  if (!here || !there) return lost;
  for (const Slot& slot : parameters.slots)
    if (slot.free && is_of_clock(slot.quantity))
      lost = std::max(lost, 1.0 - std::pow(there->curvature_sigma(slot.index) /
                                               here->curvature_sigma(slot.index),
                                           2));
  return lost;
}

std::vector<double> with_noise_of_blocks(const Parameters& parameters, std::vector<double> x,
                                         double together) {
  for (const Slot& slot : parameters.slots)
    if (slot.free &&
        (slot.quantity == Quantity::jitter_rms || slot.quantity == Quantity::amplitude_rms))
      x[slot.index] -= 0.5 * std::log(together);
  return x;
}

std::vector<double> with_jitter_of(const TimingData& data, const Parameters& parameters,
                                   std::vector<double> x) {
  const Slot* jitter = parameters.find(Quantity::jitter_rms);
  if (jitter != nullptr && jitter->free)
    x[jitter->index] =
        std::max(x[jitter->index], jitter->coordinate_of(guess_noise(data).jitter_s));
  return x;
}

} // namespace goingrate::timing_model
