// Decides whether a log shows a drive, and with which laws: a free pendulum, a torque or impulses,
// and which parameters change at the dates found.
#include "model_choice.hpp"

#include "date_search.hpp"

#include "base/workers.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <limits>
#include <span>
#include <utility>

namespace goingrate::timing_model {

namespace {

// Whether the amplitude rises anywhere, which it cannot without a drive.
bool swing_grows(const TimingData& data, double noise_rad) {
  constexpr std::size_t beats_a_mean = 16; // few enough not to average a rise away
  // Even the largest of many rises in pure noise stays below this.
  constexpr double least_rise_sigma = 8.0;
  const double sigma = noise_rad / std::sqrt(static_cast<double>(beats_a_mean));
  double least = std::numeric_limits<double>::infinity(), sum = 0.0;
  std::size_t seen = 0;
  for (const double amplitude : data.amplitude_rad) {
    if (std::isnan(amplitude)) continue;
    sum += amplitude;
    if (++seen % beats_a_mean != 0) continue;
    const double mean = sum / static_cast<double>(beats_a_mean);
    if (mean > least + least_rise_sigma * sigma) return true;
    least = std::min(least, mean);
    sum = 0.0;
  }
  return false;
}

constexpr std::size_t thinned_beats = 1000; // enough to show an escapement

// Whether a pendulum under linear friction can go on swinging this freely. A clock whose swing
// falls by a tenth in a day, because its weight nears the floor or its oil thickens, looks like a
// free one of Q 500 000.
bool may_swing_freely(const Fitted& fitted) {
  constexpr double largest_q = 2e5; // the best of pendulums in vacuum come near it
  const Slot* epsilon = fitted.problem.parameters.find(Quantity::epsilon);
  return epsilon->value(std::span<const double>(fitted.minimum.x)) > 0.5 / largest_q;
}

} // namespace

bool ModelSearch::explains(const Fitted& fitted) const {
  return fitted.minimum.usable && white(fitted) && is_as_small_as(guess_.jitter_s, fitted);
}

// A fit of a thinned log by the full equation of motion: effects that first order omits must not be
// mistaken for a drive. One that misses the log by far more than those effects stays as it is. The
// thinned log is made here if it is empty.
Fitted ModelSearch::roughly_fitted(const FitOptions& options, const ModelChoice& model,
                                   TimingData& thin) const {
  if (thin.size() == 0)
    thin = thinned(working_.data, make_parameters(options, working_.data, model), thinned_beats);
  Fitted fitted = fit_from_scratch(thin, options, model, guess_);
  FitOptions dated = options;
  move_dates(fitted, dated);
  if (!fitted.minimum.usable || is_hopeless(fitted)) return fitted;
  fitted.minimum.usable = refine(fitted, FitDynamics::map);
  move_dates(fitted, dated);
  return fitted;
}

// Adds what makes a rough fit explain the log, by the full equation of motion in the end.
void ModelSearch::explain_roughly(Fitted& rough) {
  if (explains(rough)) return;
  add_terms(rough);
  if (rough.dynamics == FitDynamics::map || !refine(rough, FitDynamics::map)) return;
  if (!explains(rough)) add_terms(rough);
}

// Whether the options mention a torque, so that a drive is taken as given.
bool ModelSearch::is_told_of_torque() const {
  const auto speaks = [](const std::string& name) { return name == "mu" || name == "phi0"; };
  return std::any_of(options_.fixed.begin(), options_.fixed.end(),
                     [&](const auto& fixed) { return speaks(fixed.first); }) ||
         std::any_of(options_.priors.begin(), options_.priors.end(),
                     [&](const Prior& prior) { return speaks(prior.name); });
}

// Alternative laws: other parameters that change at the dates found, or the other kind of
// escapement, a torque or impulses.
std::vector<ModelSearch::Laws> ModelSearch::other_laws(const Laws& than) const {
  std::vector<Laws> all;
  const auto& [options, model] = than;
  for (std::size_t event = 0; event < options.events.size(); ++event)
    for (const char* name : {"phi0", "epsilon", "mu", "T0"}) {
      const bool of_drive = std::string_view(name) == "mu" || std::string_view(name) == "phi0";
      if (!options.events[event].movable || (of_drive && model.escapement == Escapement::none))
        continue;
      if (options.events[event].names == std::vector<std::string>{name}) continue;
      all.push_back(than);
      all.back().options.events[event].names = {name};
    }
  if (options_.escapement || model.escapement == Escapement::none || is_told_of_torque())
    return all;
  all.push_back(than);
  all.back().model.escapement = model.escapement == Escapement::single_impulse
                                    ? Escapement::constant_torque
                                    : Escapement::single_impulse;
  return all;
}

namespace {

// Gain in L (odds of 20 to 1) that is needed to prefer impulses to a torque.
double handicap(const ModelChoice& model) {
  return model.escapement == Escapement::single_impulse ? 3.0 : 0.0;
}

} // namespace

namespace {

// The options with the dates at which a fit ended.
FitOptions dated_as(const Fitted& fitted, FitOptions options) {
  for (std::size_t k = 0; k < options.events.size(); ++k)
    options.events[k].cycle = std::llround(fitted.problem.parameters.event_cycles[k]);
  return options;
}

// The first event of which another parameter changes.
std::size_t changed_among(const ModelSearch::Laws& here, const ModelSearch::Laws& other) {
  std::size_t changed = 0;
  while (changed + 1 < here.options.events.size() &&
         other.options.events[changed].names == here.options.events[changed].names)
    ++changed;
  return changed;
}

// The parameters that a fit by other laws determines, and those that it holds fixed.
ModelSearch::EqualLaws knowledge_of(const Fitted& other, const std::string& changed) {
  ModelSearch::EqualLaws knowledge{changed, {}, {}};
  const std::span<const double> x(other.minimum.x);
  for (const Slot& slot : other.problem.parameters.slots) {
    if (slot.free && !is_determined(other, slot)) continue;
    const std::string name = other.problem.parameters.name_of(slot);
    knowledge.values[name] = slot.value(x);
    knowledge.sigmas[name] = slot.free ? other.known.sigma(slot.index) * slot.slope(x) : 0.0;
  }
  return knowledge;
}

} // namespace

// The best rough fit of laws in which event `changed` is of another kind. Not usable if it is
// hopelessly far from the log.
Fitted ModelSearch::roughly_fitted_near(const Laws& laws, std::size_t changed,
                                        TimingData& thin) const {
  constexpr double hopeless_straying = 10.0; // of the jitter: more than an error of one beat
  Fitted best;
  for (const std::int64_t beats : {0, -1, 1}) { // a search that starts a beat off may not arrive
    FitOptions dated = laws.options;
    dated.events[changed].cycle += beats;
    Fitted there = roughly_fitted(dated, laws.model, thin);
    if (!there.minimum.usable || straying(there) > hopeless_straying) break;
    if (there.minimum.value < best.minimum.value) best = std::move(there);
  }
  return best;
}

// A rough fit, searched to its minimum on all beats by the full equation of motion.
Fitted ModelSearch::wholly_fitted(const Fitted& rough, const FitOptions& options) const {
  Fitted all = fit_from(rough, dated_as(rough, options), rough.model, &working_.data);
  all.minimum.usable = all.minimum.usable && refine(all, FitDynamics::map);
  return all;
}

// Fits of the present laws and of each alternative to the same beats. Kinds of changes are always
// compared: one of the wrong kind may explain a log, and be far behind the right one. Another
// escapement is tried only where the present laws do not explain it. An alternative counts if its
// residuals are no larger than the jitter. They need not be white: of many tests, some fail by
// chance.
std::vector<ModelSearch::FittedLaws> ModelSearch::compared_laws(const Laws& here) const {
  std::vector<Laws> others = other_laws(here);
  const auto is_change = [&](const Laws& laws) {
    return laws.model.escapement == here.model.escapement;
  };
  const auto keep_changes = [&] { std::erase_if(others, std::not_fn(is_change)); };
  if (explains(best_)) keep_changes();
  if (others.empty()) return {{here, best_}};
  TimingData thin;
  std::vector<FittedLaws> all{{here, roughly_fitted(here.options, here.model, thin)}};
  if (explains(all.front().fitted)) keep_changes();
  for (Laws& laws : others) {
    Fitted rough = is_change(laws) ? roughly_fitted_near(laws, changed_among(here, laws), thin)
                                   : roughly_fitted(laws.options, laws.model, thin);
    if (rough.minimum.usable && is_as_small_as(guess_.jitter_s, rough))
      all.push_back({std::move(laws), std::move(rough)});
  }
  return all;
}

// Whether the times of a driven clock walk, and no change is known after which laws would differ.
bool ModelSearch::is_steady_walk() const {
  return options_.noise != FitNoise::jitter && options_.events.empty() &&
         best_.model.escapement != Escapement::none &&
         walks(*best_.problem.data, best_.seen.late_s);
}

// Takes the laws that come nearest to the log, and notes those that come as near.
std::vector<ModelSearch::EqualLaws> ModelSearch::choose_laws(const std::vector<FitEvent>& found) {
  if (best_.model.walk || is_rounding(best_) || is_steady_walk()) return {};
  Laws here{options_, best_.model};
  for (std::size_t k = 0; k < found.size(); ++k) // each moves its dates from where they were found
    here.options.events[k].cycle = found[k].cycle;
  std::vector<FittedLaws> all = compared_laws(here);
  const auto loss = [](const FittedLaws& one) {
    const Minimum& minimum = one.fitted.minimum;
    return minimum.usable ? minimum.value + handicap(one.laws.model)
                          : std::numeric_limits<double>::infinity();
  };
  const auto best = std::min_element(
      all.begin(), all.end(), [&](const auto& a, const auto& b) { return loss(a) < loss(b); });
  // In L. A change of the drive or the friction shows a jump and a relaxation besides what a change
  // of T0 shows: laws that explain the log are left only for a gain above Schwarz's price of these
  // two.
  const double least_gain =
      explains(all.front().fitted) ? std::log(static_cast<double>(working_.data.size())) : 0.0;
  if (best == all.begin() || loss(*best) > loss(all.front()) - least_gain) return equal_laws(all);
  if (take_laws(*best)) std::iter_swap(all.begin(), best);
  return equal_laws(all);
}

// False, with the present laws kept, if a search on all beats does not arrive.
bool ModelSearch::take_laws(const FittedLaws& better) {
  FitOptions options = dated_as(better.fitted, better.laws.options);
  Fitted other = fit_from_scratch(working_.data, options, better.laws.model, guess_);
  if (!other.minimum.usable) return false;
  tried(best_, "the next comes nearer to the log");
  best_ = std::move(other);
  options_ = std::move(options);
  move_dates(best_, options_);
  return true;
}

// Other changes at the same dates that explain the log as well as the first of `compared`, to three
// sigma. Asked for only where the chosen ones determine something of the clock, which the others
// may contradict.
std::vector<ModelSearch::EqualLaws>
ModelSearch::equal_laws(const std::vector<FittedLaws>& compared) const {
  const auto& slots = best_.problem.parameters.slots;
  const auto is_known = [&](const Slot& slot) {
    return is_of_clock(slot.quantity) && is_determined(best_, slot);
  };
  const auto& [here, chosen] = compared.front();
  if (std::none_of(slots.begin(), slots.end(), is_known) || !explains(chosen)) return {};
  constexpr double three_sigma = 4.5; // of L
  Fitted whole;
  std::vector<EqualLaws> equal;
  for (const auto& [laws, rough] : std::span(compared).subspan(1)) {
    const bool is_change = laws.model.name() == here.model.name();
    if (!is_change || rough.minimum.value > chosen.minimum.value + three_sigma) continue;
    const Fitted other = wholly_fitted(rough, laws.options);
    if (!whole.minimum.usable) whole = wholly_fitted(chosen, here.options);
    if (!other.minimum.usable || other.minimum.value > whole.minimum.value + three_sigma) continue;
    const auto& changed = laws.options.events[changed_among(here, laws)];
    equal.push_back(knowledge_of(other, changed.names.front()));
  }
  return equal;
}

// Other laws under a drive that varies from beat to beat, compared before a slow drive absorbs the
// misfit of wrong laws. A thinned log is enough to rank them.
std::optional<ModelSearch::FittedLaws>
ModelSearch::laws_that_explain(const FittedLaws& driven) const {
  constexpr std::size_t beats_to_rank_laws = 2500; // beats
  const FewBeats few =
      few_beats(working_.data, driven.fitted.problem.parameters.event_cycles, beats_to_rank_laws);
  const Fitted simpler = on_few_beats(best_, few), here = on_few_beats(driven.fitted, few);
  if (!simpler.minimum.usable || !here.minimum.usable) return {};
  std::vector<Laws> others = other_laws(driven.laws);
  std::vector<double> losses(others.size(), std::numeric_limits<double>::infinity());
  share(others.size(), [&](std::size_t i) {
    Fitted there = fit_from(simpler, others[i].options, others[i].model, &few.data);
    if (!there.minimum.usable || there.minimum.value > here.minimum.value) return;
    if (refine(there, here.dynamics)) move_dates(there, others[i].options);
    if (white(there)) losses[i] = there.minimum.value + handicap(there.model);
  });
  const auto least = std::min_element(losses.begin(), losses.end());
  if (least == losses.end() || *least >= here.minimum.value) return {};
  FittedLaws other{std::move(others[static_cast<std::size_t>(least - losses.begin())]), {}};
  auto& [laws, fitted] = other;
  fitted = fit_from_any(std::array{&std::as_const(best_)}, laws.options, laws.model);
  if (!fitted.minimum.usable || !refine(fitted, driven.fitted.dynamics)) return {};
  move_dates(fitted, laws.options);
  return white(fitted) ? std::optional(std::move(other)) : std::nullopt;
}

// A free pendulum is the simpler model. It is taken if it explains the log as well as a driven
// clock does and the log determines its friction (a stationary log fits any model and determines
// none), unless pushes are seen. Changes that were found in the log may be due to the decaying
// swing: if the free pendulum explains the log without them, they are dropped.
bool ModelSearch::prefers_no_escapement(const ModelChoice& driven, ModelChoice& chosen) {
  const auto is_noticed = [](const FitEvent& event) { return event.movable; };
  if (options_.escapement || all_.impulses || is_told_of_torque() ||
      !std::all_of(options_.events.begin(), options_.events.end(), is_noticed))
    return false;
  if (swing_grows(all_, guess_.amplitude_rad)) return false;
  FitOptions plain = options_;
  plain.events.clear();
  ModelChoice free = driven;
  free.escapement = Escapement::none;
  TimingData thin; // the same beats for both
  if (!options_.events.empty())
    thin = thinned(working_.data, make_parameters(options_, working_.data, driven), thinned_beats);
  Fitted without = roughly_fitted(plain, free, thin);
  if (!without.minimum.usable || !determines_friction(without) || !may_swing_freely(without))
    return false;
  explain_roughly(without); // nonlinear friction may explain what looks like a drive
  const std::string name =
      fmt::format("no escapement, friction {} ({} beats)", without.model.friction(), thin.size());
  chosen = without.model;
  if (explains(without)) {
    alternatives_.push_back({name, without.bic, "explains the log: no drive was looked for"});
    options_ = std::move(plain);
    return true;
  }
  Fitted with = roughly_fitted(options_, driven, thin);
  if (with.minimum.usable) explain_roughly(with); // gives both models the same chance
  constexpr double least_bic_gain = 6.0;          // odds of 20 to 1 needed to believe in a torque
  const bool simpler = !with.minimum.usable || without.bic < with.bic + least_bic_gain;
  if (simpler) options_ = std::move(plain);
  alternatives_.push_back(
      {name, without.bic,
       simpler ? "explains the log with fewer parameters, or better" : "does not explain the log"});
  if (with.minimum.usable)
    alternatives_.push_back({fmt::format("constant-torque ({} beats)", thin.size()), with.bic,
                             simpler ? "the drive is not needed" : "taken"});
  return simpler;
}

} // namespace goingrate::timing_model
