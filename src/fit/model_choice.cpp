#include "model_choice.hpp"

#include "change_moments.hpp"
#include "date_search.hpp"
#include "push_angle.hpp"
#include "reference_run.hpp"
#include "thinning.hpp"

#include "base/readable.hpp"
#include "base/workers.hpp"
#include "fit/timing_noise.hpp"
#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <limits>

namespace goingrate::timing_model {

namespace {

bool by_bic(const Fitted& a, const Fitted& b) { return a.bic < b.bic; }

// The largest shift, in sigma, of a clock parameter that the log determines.
double largest_shift(const Fitted& fitted, const std::map<std::string, double>& shifts) {
  double largest = 0.0;
  for (const Slot& slot : fitted.problem.parameters.slots)
    if (is_of_clock(slot.quantity) && is_determined(fitted, slot))
      largest = std::max(largest, std::abs(shifts.at(fitted.problem.parameters.name_of(slot))));
  return largest;
}

// Names the clock parameter that differs most between two fits, with the difference in sigma.
std::string moved_by(const Fitted& from, const Fitted& to) {
  double largest = 0.0;
  std::string which;
  for (const Slot& slot : from.problem.parameters.slots) {
    const Slot* other = to.problem.parameters.find(slot.quantity, slot.event);
    if (!is_determined(from, slot) || !is_of_clock(slot.quantity) || other == nullptr) continue;
    const double change =
        std::abs(slot.coordinate_of(other->value(std::span<const double>(to.minimum.x))) -
                 from.minimum.x[slot.index]) /
        from.known.sigma(slot.index);
    if (!(change > largest)) continue;
    largest = change;
    which = from.problem.parameters.name_of(slot);
  }
  return which.empty() ? "" : fmt::format("; {} moves by {} sigma", which, readable(largest, 2));
}

} // namespace

bool is_determined(const Fitted& fitted, const Slot& slot) {
  return slot.free &&
         fitted.known.sigma(slot.index) < tolerable_sigma(fitted.problem, slot, fitted.minimum.x);
}

bool determines_friction(const Fitted& fitted) {
  const Slot* slot = fitted.problem.parameters.find(Quantity::epsilon);
  return !slot->free || is_determined(fitted, *slot);
}

bool is_as_small_as(double jitter, const Fitted& fitted) {
  // The robust jitter of few beats is uncertain by a tenth or so.
  constexpr double largest_chance_ratio = 1.3;
  return rms(fitted.seen.late_s) < largest_chance_ratio * jitter;
}

std::map<std::string, double> model_shifts(const Fitted& fitted, FitDynamics judge) {
  const auto exact = difference_to(judge, fitted.problem, fitted.minimum.x);
  if (!exact) return {};
  const Eigen::VectorXd shift = shift_by(fitted.problem, fitted.minimum.x, *exact);
  std::map<std::string, double> in_sigma;
  for (const Slot& slot : fitted.problem.parameters.slots)
    if (slot.free)
      in_sigma[fitted.problem.parameters.name_of(slot)] =
          shift[static_cast<Eigen::Index>(slot.index)] / fitted.known.sigma(slot.index);
  return in_sigma;
}

ModelSearch::ModelSearch(const TimingData& data, const Settled& settled)
    : ModelSearch(data, settled.laws.options) {
  moments_ = true;
  settled_ = settled;
  alternatives_ = settled.alternatives;
  notes_ = settled.notes;
}

ModelSearch::ModelSearch(const TimingData& data, const FitOptions& options)
    : all_(data), options_(options), guess_(guess_noise(data)) {
  // Where a change may be due to several laws, they are told apart before noise, unless it is large.
  if (options.events.empty()) guess_.walks = guess_.walks || walks(data, data.lateness_s);
  check_names(options, data);
  include_named_noise(options_);
  include_angle_of_pushes();
  const std::size_t asked = make_parameters(options_, data, first_model()).free_count;
  if (asked > most_parameters)
    throw ArgumentError("parameters", static_cast<double>(asked),
                        fmt::format("at most {} free ones", most_parameters));
}

// The model of the first fit: the terms that the options name, and a random walk of the times if
// neighbouring beats show one.
ModelChoice ModelSearch::first_model() const {
  ModelChoice model;
  // An escapement that rests between its pushes is modelled by impulses.
  if (all_.impulses && !is_told_of_torque()) model.escapement = Escapement::single_impulse;
  if (options_.escapement) model.escapement = *options_.escapement;
  model.quadratic = names(options_, "quadratic_drag");
  model.dry = names(options_, "dry_friction");
  model.amplitude_scale = names(options_, "amplitude_scale");
  model.walk = names(options_, "walk_rms") || (options_.noise != FitNoise::jitter && guess_.walks);
  return model;
}

// Each push displaces the crossings after it by an amount that depends on its angle. The mean drive
// that is fitted has the same angle but does not show it, because the saw-tooth has been
// subtracted, so the angle enters as a prior.
void ModelSearch::include_angle_of_pushes() {
  if (first_model().escapement != Escapement::single_impulse || names(options_, "impulse_angle"))
    return;
  if (const auto angle = push_shapes::angle_of_pushes(all_))
    options_.priors.push_back({"impulse_angle", angle->value, angle->sigma});
}

namespace {

// The search runs on few beats of a long log; its end is repeated on as many as the information
// asks for.
constexpr std::size_t most_working_beats = 4000;
constexpr std::size_t least_thinned_beats = 12'000;

// Beats at a stride. Under drive noise neighbouring times carry nearly the same information, so
// thinning a long log loses little.
TimingData at_a_stride(const TimingData& data, const std::vector<FitEvent>& changes,
                       std::size_t stride) {
  std::vector<double> events;
  for (const FitEvent& event : changes)
    events.push_back(static_cast<double>(event.cycle));
  // Beats that are all kept after the start and after each event, where the amplitude relaxes.
  constexpr std::size_t dense_beats = 500;
  return thinned_to(data, kept_beats(data, events, stride, dense_beats));
}

std::size_t working_stride(const TimingData& data) {
  std::size_t stride = 1;
  while (data.size() / stride > most_working_beats)
    stride *= 2;
  return stride;
}

} // namespace

void ModelSearch::thin_if_long() {
  const bool is_thinned = first_model().walk && all_.size() >= least_thinned_beats;
  working_.data = is_thinned ? at_a_stride(all_, options_.events, working_stride(all_)) : all_;
}

void ModelSearch::tried(const Fitted& fitted, const std::string& verdict) {
  alternatives_.push_back(
      {fmt::format("{}, {}", name_of(fitted.dynamics), fitted.model.name()), fitted.bic, verdict});
}

bool ModelSearch::take_if_better(Fitted&& other, const std::string& why) {
  if (!other.minimum.usable) return false;
  const double gain = best_.bic - other.bic;
  if (gain > 0.0) {
    tried(best_,
          fmt::format("BIC worse by {}: {}{}", readable(gain, 3), why, moved_by(best_, other)));
    best_ = std::move(other);
    return true;
  }
  tried(other,
        fmt::format("BIC worse by {}: not demanded{}", readable(-gain, 3), moved_by(best_, other)));
  return false;
}

// Chooses the cheapest dynamics whose error shifts no determined parameter by more than 0.2 sigma,
// or 0.1 sigma for second order, since the full equation costs little more. First order is compared
// with second order, at a twentieth of the cost of the full equation, and with the full equation
// before it is accepted.
void ModelSearch::choose_dynamics() {
  const auto& slots = best_.problem.parameters.slots;
  const auto is_free = [](const Slot& slot) { return slot.free && is_of_clock(slot.quantity); };
  if (options_.dynamics == FitDynamics::automatic &&
      std::none_of(slots.begin(), slots.end(), is_free)) {
    chosen_by_ = "no parameter of the clock is free to make up for an error of the averaged course";
    if (!refine_every_end(best_, FitDynamics::map))
      chosen_by_ =
          "the full equation of motion stops at these parameters; first order is all there is";
    return;
  }
  constexpr double tolerable_shift = 0.2, tolerable_shift_of_second = 0.1;
  const auto shift_by = [&](FitDynamics judge) {
    shifts_ = model_shifts(best_, judge);
    return shifts_.empty() ? 0.0 : largest_shift(best_, shifts_);
  };
  // If the noise model was already computed in second order, the error of first order is unknown.
  const bool is_extended = best_.dynamics != FitDynamics::averaged1;
  const double allowed_shift = is_extended ? tolerable_shift_of_second : tolerable_shift;
  double first = is_extended ? 0.0 : shift_by(FitDynamics::averaged2);
  if (first <= allowed_shift) first = shift_by(FitDynamics::map);
  const auto first_order = is_extended ? std::map<std::string, double>{} : shifts_;
  chosen_by_ =
      is_extended
          ? "amplitudes under this noise ask for second order, and the full equation shifts no "
            "determined parameter by more than 0.1 sigma"
          : "first order is good enough: it shifts no determined parameter by more than 0.2 sigma";
  if (shifts_.empty())
    chosen_by_ =
        "the full equation of motion stops at these parameters; first order is all there is";
  if (options_.dynamics != FitDynamics::automatic) {
    chosen_by_ = "asked for";
    if (!refine_every_end(best_, options_.dynamics))
      chosen_by_ = "the dynamics asked for do not run here";
    return;
  }
  if (shifts_.empty() && best_.problem.parameters.escapement == Escapement::none &&
      refine_every_end(best_, FitDynamics::map)) { // from where they do swing to the end
    chosen_by_ = "first order finds a friction that would stop the swing before the log ends";
    return;
  }
  const bool suffices = shifts_.empty() || first <= allowed_shift;
  if (is_extended) shifts_.clear();
  if (suffices) return;
  const auto off_by = [](double sigmas) {
    return fmt::format("off by up to {} sigma", readable(sigmas, 2));
  };
  chosen_by_ = fmt::format("{} is {}", name_of(best_.dynamics), off_by(first));
  tried(best_, off_by(first));
  double second = std::numeric_limits<double>::infinity();
  if (is_extended) {
    second = first;
  } else if (refine_every_end(best_, FitDynamics::averaged2)) {
    second = shift_by(FitDynamics::map);
    if (second > tolerable_shift_of_second) {
      tried(best_, off_by(second));
      chosen_by_ += fmt::format(", averaged2 by {}", readable(second, 2));
    }
  }
  if (second > tolerable_shift_of_second && !refine_every_end(best_, FitDynamics::map))
    notes_.push_back(
        {NoteKind::dynamics, fmt::format("the full equation of motion found no place near this "
                                         "one; the values are {}",
                                         off_by(std::min(first, second)))});
  shifts_ = first_order;
}

// Adds terms one at a time, the best first, while BIC improves and the innovations are not white.
// What walked before its friction was known may walk no more.
void ModelSearch::add_terms(Fitted& fitted) {
  while (add_best_term(fitted)) {
  }
  const bool may_stand_still =
      fitted.model.walk && options_.noise == FitNoise::automatic && !names(options_, "walk_rms");
  if (!may_stand_still) return;
  ModelChoice still = fitted.model;
  still.walk = false;
  Fitted without = fit_from(fitted, options_, still);
  if (without.minimum.usable && refine(without, fitted.dynamics) && without.bic < fitted.bic)
    fitted = std::move(without);
}

// Adds the term of most use, if one is of any.
// For a free pendulum, friction is tried even if they are white, since whiteness is a weaker test
// than BIC and its T0 depends on the friction law. The terms are nonlinear friction, a factor on
// the amplitude column, and drive noise (or a random walk of the times). In a long log, noise is
// taken at once if it suffices: it is the most frequent term, and trying each of the others takes
// long.
bool ModelSearch::add_best_term(Fitted& fitted) {
  constexpr int terms = 4;
  const auto with = [](ModelChoice model, int term) {
    const bool driven = model.escapement != Escapement::none;
    if (term == 0) (driven ? model.drive : model.walk) = true;
    if (term == 0 && driven) model.walk = false;
    if (term == 1) model.quadratic = true;
    if (term == 2) model.dry = true;
    if (term == 3) model.amplitude_scale = true;
    return model;
  };
  constexpr std::size_t long_log_beats = 3000;
  const TimingData& data = *fitted.problem.data;
  const bool is_white = white(fitted);
  if (is_white && fitted.model.escapement != Escapement::none) return false;
  std::vector<ModelChoice> models;
  for (int term = 0; term < terms; ++term) {
    const bool is_friction = term == 1 || term == 2;
    if (is_white && !is_friction) continue;
    const ModelChoice model = with(fitted.model, term);
    if (model.name() == fitted.model.name()) continue;
    if (term == 0 && options_.noise != FitNoise::automatic) continue;
    if (term == 3 && !data.has_amplitude()) continue;
    models.push_back(model);
  }
  std::vector<Fitted> ends(models.size());
  const auto fit = [&](std::size_t i) {
    ends[i] = fit_from(fitted, options_, models[i]);
    if (!ends[i].minimum.usable || !refine(ends[i], fitted.dynamics))
      ends[i].bic = std::numeric_limits<double>::infinity();
  };
  const bool noise_first = data.size() > long_log_beats && !models.empty() &&
                           models.front().noise() != fitted.model.noise();
  const std::size_t begun = noise_first ? 1 : 0;
  if (noise_first) fit(0);
  if (!noise_first || !white(ends.front()) || ends.front().bic >= fitted.bic)
    share(models.size() - begun, [&](std::size_t i) { fit(begun + i); });
  const auto best = std::min_element(ends.begin(), ends.end(), by_bic);
  if (best == ends.end() || best->bic >= fitted.bic) return false;
  tried(fitted, fmt::format("BIC worse by {} than the next{}", readable(fitted.bic - best->bic, 3),
                            moved_by(fitted, *best)));
  fitted = std::move(*best);
  return true;
}

// Further terms are tried only where linear friction is fixed or determined by the log.
void ModelSearch::choose_friction() {
  if (determines_friction(best_)) add_terms(best_);
}

// Runs `choose`, which chooses the noise and more, on some of the beats of a long log: a varying
// drive shows in them as well as in all. If they show no noise beyond the jitter, the fit of all
// beats is kept.
void ModelSearch::choose_on_few_beats(const std::function<void()>& choose) {
  if (working_.data.size() < all_.size() || !noise_is_asked_for()) return choose();
  constexpr std::size_t most_blocks = 16'000; // shorter than a swing's memory in a log of months
  const FewBeats few = few_beats(all_, best_.problem.parameters.event_cycles, most_blocks);
  if (few.together == 1.0) return choose();
  const Fitted whole = best_;
  best_ = on_few_beats(whole, few);
  working_.data = few.data;
  best_.problem.data = &working_.data;
  if (best_.minimum.usable) choose();
  if (best_.minimum.usable && best_.model.noise() != whole.model.noise()) {
    best_.minimum.x =
        with_noise_of_blocks(best_.problem.parameters, best_.minimum.x, 1.0 / few.together);
    TimingData kept = at_a_stride(all_, options_.events, working_stride(all_));
    best_ = fit_from(best_, options_, best_.model, &kept);
    working_.data = std::move(kept);
  }
  if (!best_.minimum.usable || best_.model.noise() == whole.model.noise()) {
    best_ = whole;
    working_.data = all_;
  }
  best_.problem.data = &working_.data;
}

// The beats by which those at a stride are judged: eight times as many, or all.
TimingData ModelSearch::beats_to_judge(std::size_t stride) const {
  return at_a_stride(all_, options_.events, std::max<std::size_t>(1, stride / 8));
}

// The largest stride that keeps the information, according to the fit.
// For times alone it follows from their spectrum; with amplitudes it is the stride at which many
// more beats would add little.
std::size_t ModelSearch::longest_stride() const {
  constexpr double allowed_loss = 0.04;
  if (!all_.has_amplitude()) return timing_model::longest_stride(*noise_shape(best_), allowed_loss);
  Fitted there = best_;
  std::size_t stride = working_stride(all_);
  for (; stride > 1; stride /= 2) {
    const TimingData kept = at_a_stride(all_, options_.events, stride);
    there.problem = best_.problem.on(kept);
    if (information_lost(there, beats_to_judge(stride)) < allowed_loss) break;
  }
  return stride;
}

// Repeats the fit with as many beats as are needed to keep the information.
void ModelSearch::thin_by_information() {
  if (working_.data.size() == all_.size()) return;
  working_.thinning = {working_.data.size(), std::numeric_limits<double>::quiet_NaN()};
  if (!best_.model.drive) return;
  constexpr std::size_t stride_ratio = 8;
  const std::size_t final_stride = longest_stride();
  // The number of beats grows in stages, so that most steps of the search are made on few beats.
  std::size_t stride = final_stride;
  while (all_.size() / (stride * stride_ratio) > working_.data.size())
    stride *= stride_ratio;
  const auto shape = noise_shape(best_);
  for (;; stride /= stride_ratio) {
    TimingData kept = at_a_stride(all_, options_.events, stride);
    best_.minimum.x = with_jitter_of(kept, best_.problem.parameters, best_.minimum.x);
    Fitted finer = fit_from(best_, options_, best_.model, &kept);
    if (!finer.minimum.usable) return;
    finer_ = std::move(kept);
    finer.problem.data = &finer_;
    best_ = std::move(finer);
    if (stride > final_stride) continue;
    working_.thinning = {finer_.size(), all_.has_amplitude()
                                            ? information_lost(best_, beats_to_judge(stride))
                                            : information_lost(*shape, stride)};
    return;
  }
}

// Drops a stated prior that the log alone excludes: a compromise between the two would be a value
// that neither supports. This is checked only if the fit with the priors does not explain the log.
void ModelSearch::leave_out_contradicted_priors() {
  if (options_.priors.empty() || best_.model.walk) return;
  if (best_.minimum.usable && (white(best_) || is_as_small_as(guess_.jitter_s, best_))) return;
  FitOptions without = options_;
  without.priors.clear();
  Fitted alone = fit_from_scratch(working_.data, without, best_.model, guess_);
  if (!alone.minimum.usable) return;
  refine(alone, FitDynamics::map); // so that an error of first order is not blamed on the prior
  std::vector<Prior> kept;
  for (const Prior& prior : options_.priors) {
    const Slot* slot = nullptr;
    for (const Slot& one : alone.problem.parameters.slots)
      if (alone.problem.parameters.name_of(one) == prior.name) slot = &one;
    constexpr double exclusion_sigma = 5.0;
    if (slot == nullptr || !is_determined(alone, *slot)) {
      kept.push_back(prior);
      continue;
    }
    const double value = slot->value(std::span<const double>(alone.minimum.x));
    const double sigma =
        alone.known.sigma(slot->index) * slot->slope(std::span<const double>(alone.minimum.x));
    const double off = std::abs(value - prior.value) / std::hypot(sigma, prior.sigma);
    if (off < exclusion_sigma)
      kept.push_back(prior);
    else
      notes_.push_back({NoteKind::prior,
                        fmt::format("the log contradicts the prior on {0}: alone it says {1:.6g} "
                                    "± {2:.2g}, {3:.3g} σ away; that prior is left out",
                                    prior.name, value, sigma, off)});
  }
  if (kept.size() == options_.priors.size()) return;
  options_.priors = kept;
  best_ = fit_from_scratch(working_.data, options_, best_.model, guess_);
}

// With every change at a crossing, the search may miss the right clock, whose times leap; with free
// leaps it has less to guide it. So the ends of both searches are used as starting points.
void ModelSearch::find_moments() {
  ModelChoice loose = best_.model;
  loose.moments = ModelChoice::Moments::loose;
  scan_moments(best_, fit_from_scratch(working_.data, options_, loose, guess_), options_);
}

// Chooses the escapement, and the parameters that change at the dates found.
void ModelSearch::settle_laws() {
  ModelChoice model = first_model();
  ModelChoice free;
  if (prefers_no_escapement(model, free)) model = free;
  best_ = fit_from_scratch(working_.data, options_, model, guess_);
  leave_out_contradicted_priors();
  if (!best_.minimum.usable) return;
  const std::vector<FitEvent> found = options_.events;
  move_dates(best_, options_);
  std::vector<EqualLaws> equal = choose_laws(found);
  settled_ = {{options_, best_.model}, std::move(equal), alternatives_, notes_};
}

const Fitted& ModelSearch::run(std::string_view what, const FitStage& now) {
  const auto tell = [&](int step, std::string_view doing) {
    constexpr int steps = 5;
    if (now) now(fmt::format("{}, step {} of {}: {}", what, step, steps, doing));
  };
  tell(1, "where to begin");
  thin_if_long();
  if (moments_)
    best_ = fit_from_scratch(working_.data, options_, settled_.laws.model, guess_);
  else
    settle_laws();
  if (!best_.minimum.usable) return best_;
  if (moments_) find_moments();
  const bool noise_first = best_.model.walk || strays_by_noise();
  if (noise_first) {
    tell(2, "noise");
    choose_on_few_beats([&] {
      choose_noise();
      if (best_.dynamics != FitDynamics::averaged1)
        choose_dynamics(); // on few beats, which is cheaper than on those added below
    });
  } else {
    tell(2, "equations and noise");
    choose_dynamics();
    if (best_.dynamics != FitDynamics::averaged1)
      move_dates(best_, options_); // again, now that the parameters are better known
    choose_friction();
    choose_on_few_beats([&] { choose_noise(); });
  }
  tell(3, "the beats that tell most");
  thin_by_information();
  const bool has_new_noise = noise_first || working_.data.size() < all_.size();
  tell(4, "equations");
  if (has_new_noise && best_.dynamics != FitDynamics::map) choose_dynamics();
  tell(5, "slow drive");
  add_other_noise();
  tried(best_, "chosen");
  const bool dated = std::all_of(options_.events.begin(), options_.events.end(),
                                 [](const FitEvent& event) { return event.has_known_moment(); });
  constexpr double beyond_chance = 13.8; // of two leaps: one log in a thousand
  if (dated && leaps_at_changes(best_, options_, beyond_chance))
    notes_.push_back({NoteKind::misfit,
                      "the times leap at a change that is dated by a crossing: it came at some "
                      "moment of the swings beside; dated as such, its moment is fitted too"});
  return best_;
}

} // namespace goingrate::timing_model
