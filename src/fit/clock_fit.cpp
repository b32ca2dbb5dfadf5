#include "goingrate/fit/clock_fit.hpp"

#include "change_moments.hpp"
#include "contradictions.hpp"
#include "covariate_errors.hpp"
#include "experiments.hpp"
#include "listed_twins.hpp"
#include "model_choice.hpp"
#include "possible_changes.hpp"
#include "profile.hpp"
#include "push_friction.hpp"
#include "reference_run.hpp"
#include "ring_down.hpp"

#include "base/readable.hpp"
#include "base/special_values.hpp"
#include "base/workers.hpp"
#include "fit/timing_noise.hpp"
#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <array>
#include <boost/math/distributions/normal.hpp>
#include <fmt/format.h>
#include <memory>

namespace goingrate {

namespace {

using namespace timing_model;

// The same model on all beats of the log, whatever it was fitted to.
FitProblem on_all_beats(const Fitted& fitted, const TimingData& data) {
  if (fitted.problem.data->size() == data.size()) return fitted.problem;
  FitProblem problem = fitted.problem.on(data);
  if (fitted.dynamics != FitDynamics::averaged1)
    if (auto correction = difference_to(fitted.dynamics, problem, fitted.minimum.x))
      problem.correction = std::move(*correction);
  return problem;
}

void state_amplitudes(const TimingData& data, FitSummary& summary) {
  double sum = 0.0, seen = 0.0;
  for (std::size_t i = 0; i < data.size(); ++i) {
    summary.amplitude_residual_rad.push_back(data.amplitude_rad[i] -
                                             summary.model_amplitude_rad[i]);
    if (std::isnan(data.amplitude_rad[i])) continue;
    sum += std::pow(summary.amplitude_residual_rad.back(), 2);
    ++seen;
  }
  summary.quality.amplitude_rms_rad = seen > 0.0 ? std::sqrt(sum / seen) : not_known;
}

// Chi-squared. With no noise but jitter it compares the residuals, whose sum of squares is `sum`,
// with the robust scatter of neighbouring beats, which a change does not affect. If the times walk,
// the innovations are used instead of the residuals, which then say nothing.
void judge_size(const Fitted& fitted, const TimingData& data, double sum, FitQuality& quality) {
  const auto free = static_cast<double>(fitted.problem.parameters.free_count);
  quality.of_innovations = fitted.model.walk || fitted.model.drive;
  auto n = static_cast<double>(data.size());
  if (quality.of_innovations) {
    n = static_cast<double>(fitted.seen.white_time.size()) + 1.0;
    quality.chi2 = std::pow(rms(fitted.seen.white_time), 2) * (n - 1.0);
  } else {
    const NoiseGuess local = guess_noise(data);
    const double jitter =
        std::max(std::hypot(local.jitter_s, std::sqrt(0.3) * local.walk_s), least_jitter(data));
    quality.chi2 = sum / (jitter * jitter);
  }
  quality.dof = n - 1.0 - free;
  quality.p_value = not_known;
  if (!(quality.dof >= 1.0)) return;
  // The jitter itself comes from the median of third differences: variance of its square 12/N.
  const double of_jitter = quality.of_innovations ? 0.0 : 12.0 / n;
  const boost::math::normal chance(1.0, std::sqrt(2.0 / quality.dof + of_jitter));
  quality.p_value = cdf(complement(chance, quality.chi2 / quality.dof));
}

void state_quality(const Fitted& fitted, const TimingData& data, FitSummary& summary) {
  const FitProblem all = on_all_beats(fitted, data);
  const auto seen = residuals(all, fitted.minimum.x);
  if (!seen) return;
  FitQuality& quality = summary.quality;
  summary.residual_s = seen->late_s;
  summary.model_amplitude_rad = seen->amplitude_model;
  const auto n = static_cast<double>(data.size());
  double sum = 0.0, weighed = 0.0;
  for (std::size_t i = 0; i < data.size(); ++i) {
    const double r = summary.residual_s[i];
    sum += r * r;
    weighed += r * r / (data.time_noise.empty() ? 1.0 : std::pow(data.time_noise[i], 2));
  }
  quality.rms_s = std::sqrt(sum / n);
  judge_size(fitted, data, weighed, quality);
  // Residuals of rounding are not noise, and may look like anything.
  quality.whiteness_p = is_rounding(fitted) ? not_known : whiteness_p(fitted.seen.white_time);
  quality.bic = fitted.bic;
  const auto free = static_cast<double>(fitted.problem.parameters.free_count);
  quality.aic =
      fitted.bic + free * (2.0 - std::log(static_cast<double>(fitted.problem.data->size())));
  quality.amplitude_rms_rad = not_known;
  if (data.has_amplitude()) state_amplitudes(data, summary);
}

double value_of(const FitSummary& summary, std::string_view name) {
  const FittedParameter* found = summary.find(name);
  return found ? found->value : not_known;
}

bool something_is_undetermined(const FitSummary& summary) {
  const auto is_undetermined = [&](std::string_view name) {
    const FittedParameter* found = summary.find(name);
    return found && found->status == ParameterStatus::undetermined;
  };
  return is_undetermined("epsilon") || is_undetermined("mu") || is_undetermined("phi0");
}

void attach_shifts(const Parameters& parameters, const std::map<std::string, double>& shifts,
                   FitSummary& summary) {
  for (const Slot& slot : parameters.slots)
    for (FittedParameter& p : summary.parameters)
      if (slot.free && p.name == parameters.name_of(slot) && shifts.contains(p.name) &&
          std::isfinite(p.sigma) && !is_noise(slot.quantity))
        p.model_shift = shifts.at(p.name);
}

void attach_profiles(const ProfiledPlace& all, const ProfiledPlace* few,
                     const std::vector<Interval>& ends, FitSummary& summary) {
  const Parameters& parameters = all.problem.parameters;
  share(parameters.slots.size(), [&](std::size_t i) {
    const Slot& slot = parameters.slots[i];
    for (FittedParameter& p : summary.parameters)
      if (slot.free && p.name == parameters.name_of(slot) && std::isfinite(p.value))
        p.profile = profile_points(all, few, slot, ends[slot.index]);
  });
}

constexpr std::size_t compared_beats = 3000;

// The beats whose profile is computed. Of times that walk by the drive, as many as hold most of the
// information.
FewBeats beats_to_profile(const Fitted& fitted) {
  constexpr double allowed_loss = 0.25; // of the information: an eighth of a sigma
  const TimingData& data = *fitted.problem.data;
  const auto shape = data.has_amplitude() ? std::nullopt : noise_shape(fitted);
  const std::size_t stride = shape ? longest_stride(*shape, allowed_loss) : 1;
  const auto spacing = static_cast<std::size_t>(std::max(1.0, usual_spacing(data)));
  const std::size_t count = stride > spacing ? data.size() / (stride / spacing) : 0;
  return count > compared_beats
             ? FewBeats{at_one_stride(data, count)}
             : few_beats(data, fitted.problem.parameters.event_cycles, compared_beats);
}

// The fit on few beats of a long log, so that its profile can be computed quickly; not usable if
// the log has no more beats than that.
Fitted on_beats_to_profile(const Fitted& fitted, FewBeats& some) {
  if (fitted.problem.condensed != nullptr || fitted.problem.data->size() < 3 * compared_beats)
    return {};
  some = beats_to_profile(fitted);
  return on_few_beats(fitted, some);
}

// If T0 is held, a T0 after a change is known as well as its ratio to the first.
void take_from_ratio_to_T0(FitSummary& summary) {
  const FittedParameter* first = summary.find("T0");
  if (first == nullptr || first->status != ParameterStatus::fixed) return;
  const double T0 = first->value;
  for (FittedParameter& p : summary.parameters) {
    const DerivedQuantity* ratio = summary.combination(p.name + "/T0 - 1");
    if (p.status != ParameterStatus::undetermined || ratio == nullptr ||
        !std::isfinite(ratio->sigma))
      continue;
    p.status = ParameterStatus::free;
    p.value = T0 * (1.0 + ratio->value);
    p.sigma = p.sigma_by_law = T0 * ratio->sigma;
    p.low68 = p.value - p.sigma;
    p.high68 = p.value + p.sigma;
    p.low95 = p.value - z95 * p.sigma;
    p.high95 = p.value + z95 * p.sigma;
  }
}

// A parameter that differs under other laws that explain the log as well is not known.
void distrust_by_laws(const std::vector<ModelSearch::EqualLaws>& equal, const Fitted& fitted,
                      Certainty& known) {
  constexpr double three_sigma = 3.0;
  const std::span<const double> x(fitted.minimum.x);
  for (const auto& laws : equal)
    for (const Slot& slot : fitted.problem.parameters.slots) {
      if (!slot.free || !is_of_clock(slot.quantity)) continue;
      const auto other = laws.values.find(fitted.problem.parameters.name_of(slot));
      const double reach = three_sigma * known.sigma(slot.index) * slot.slope(x);
      const bool agrees = other != laws.values.end() && laws.sigmas.at(other->first) <= reach &&
                          std::abs(other->second - slot.value(x)) <= reach;
      if (!agrees) known.distrusted[slot.index] = true;
    }
}

// States everything that follows from the chosen fit.
void state(const Fitted& fitted, const ModelSearch& search, double nominal_period_s,
           FitSummary& summary) {
  const Widening& widening = fitted.widening;
  Certainty known = fitted.known;
  widen_by_readings(fitted, known);
  distrust_by_rivals(fitted.rivals, fitted.minimum.x, known);
  distrust_by_laws(search.settled().equal, fitted, known);
  for (const auto& laws : search.settled().equal)
    summary.notes.push_back(
        {NoteKind::change, fmt::format("a change of {} at that date explains the log as well as "
                                       "the one that is stated",
                                       laws.changed)});
  summary.termination = fitted.minimum.termination;
  if (!fitted.minimum.converged) { // it crept along a valley until its steps ran out
    known.distrusted.assign(known.distrusted.size(), true);
    summary.status = FitStatus::stopped_early;
    summary.termination = "stopped on a flat ridge: the log does not determine the parameters";
  }
  FewBeats some;
  const Fitted fewer = on_beats_to_profile(fitted, some);
  const ProfiledPlace all{fitted.problem, fitted.minimum, known};
  const ProfiledPlace of_some{fewer.problem, fewer.minimum, fewer.known};
  const ProfiledPlace* few = fewer.minimum.usable ? &of_some : nullptr;
  const bool holds = widening.largest() < largest_widening;
  const std::vector<Interval> ends = intervals(all, few, holds);
  const std::vector<FitNote> faults = model_contradictions(fitted, summary.quality, ends);
  if (!faults.empty()) {
    known.distrusted.assign(known.distrusted.size(), true);
    summary.status = FitStatus::contradicts_log;
    summary.notes.insert(summary.notes.end(), faults.begin(), faults.end());
  }
  summary.dynamics = fitted.dynamics;
  summary.model = fitted.model;
  summary.chosen_by = search.chosen_by();
  summary.alternatives = search.alternatives();
  summary.thinning = search.thinning();
  summary.events = search.options().events;
  for (const Slot& slot : fitted.problem.parameters.slots)
    if (slot.quantity == Quantity::moment)
      summary.events[slot.event - 1].cycle +=
          std::llround(slot.value(std::span<const double>(fitted.minimum.x)));
  summary.time_widening = widening.time;
  summary.amplitude_widening = widening.amplitude;
  Stated stated{known, ends};
  if (holds && !fitted.problem.parameters.event_cycles.empty())
    reach_along_the_ridge(few != nullptr ? *few : all, fitted.minimum.x, stated);
  state_results(fitted.problem, fitted.minimum.x, stated.known, stated.ends, fitted.rivals,
                search.options(), nominal_period_s, summary);
  take_from_ratio_to_T0(summary);
  if (search.options().profiles) attach_profiles(all, few, ends, summary);
  attach_shifts(fitted.problem.parameters, search.first_order_shifts(), summary);
  summary.jitter_s = value_of(summary, "jitter_rms");
  summary.amplitude_noise_rad = value_of(summary, "amplitude_rms");
  summary.notes.insert(summary.notes.end(), search.notes().begin(), search.notes().end());
  note_contradicted_priors(fitted, summary);
  constexpr double beyond_chance = 1e-6; // probability of residuals as white as a clock's
  if (holds && summary.status != FitStatus::contradicts_log &&
      whiteness_p(fitted.seen.white_time) > beyond_chance)
    list_twins(fitted, summary);
}

// A parameter under one of the laws of friction.
struct ByLaw {
  std::string_view name;
  double FrictionLaw::*value;
  double FrictionLaw::*sigma;
};

constexpr std::array by_law{
    ByLaw{"T0", &FrictionLaw::T0_s, &FrictionLaw::T0_sigma_s},
    ByLaw{"lambda0", &FrictionLaw::lambda0, &FrictionLaw::lambda0_sigma},
    ByLaw{"epsilon", &FrictionLaw::epsilon, &FrictionLaw::epsilon_sigma},
    ByLaw{"quadratic_drag", &FrictionLaw::quadratic_drag, &FrictionLaw::quadratic_drag_sigma},
    ByLaw{"dry_friction", &FrictionLaw::dry_friction, &FrictionLaw::dry_friction_sigma}};

void take_from(const FrictionLaw& law, const ByLaw& which, FittedParameter& p) {
  if (!std::isfinite(law.*which.sigma)) return;
  p.status = ParameterStatus::free;
  p.at_bound = false;
  p.value = law.*which.value;
  p.sigma = p.sigma_by_law = law.*which.sigma;
  p.low68 = p.value - p.sigma;
  p.high68 = p.value + p.sigma;
  p.low95 = p.value - z95 * p.sigma;
  p.high95 = p.value + z95 * p.sigma;
}

// Extends the intervals to contain those under every other law of friction that the log allows.
void widen_by_laws(const Decay& decay, const std::string& own, const ByLaw& which,
                   FittedParameter& p) {
  for (const FrictionLaw& law : decay.laws) {
    const double value = law.*which.value, sigma = law.*which.sigma;
    if (law.friction == own || !law.is_open() || !std::isfinite(sigma)) continue;
    p.low68 = std::min(p.low68, value - sigma);
    p.high68 = std::max(p.high68, value + sigma);
    p.low95 = std::min(p.low95, value - z95 * sigma);
    p.high95 = std::max(p.high95, value + z95 * sigma);
  }
  p.sigma = std::max(p.sigma, 0.5 * (p.high68 - p.low68));
}

// States a parameter for all laws of friction that the log allows. Where the friction terms of the
// fit leave T0 open, or the log excludes them, it is that of the best law.
void state_for_open_laws(const Decay& decay, const std::string& own, const ByLaw& which,
                         FittedParameter& p) {
  const bool is_period = which.name == "T0";
  const auto own_law = std::find_if(decay.laws.begin(), decay.laws.end(),
                                    [&](const auto& law) { return law.friction == own; });
  const bool is_excluded = own_law != decay.laws.end() && !own_law->is_open();
  const bool is_left_open = is_period && p.status == ParameterStatus::undetermined;
  if (!decay.laws.empty() && (is_left_open || (is_excluded && std::isfinite(p.sigma))))
    take_from(decay.laws.front(), which, p);
  if (!std::isfinite(p.sigma)) return;
  widen_by_laws(decay, own, which, p);
  const bool may_be_zero = p.at_bound && which.name != "lambda0"; // then it has an upper limit
  const bool is_known = p.value > 0.0 && p.sigma <= largest_relative_sigma * p.value;
  if (!is_period && !may_be_zero && !is_known) leave_undetermined(p);
}

// The Q and the decay time stated for a free pendulum assume no law of friction. T0, lambda0 and
// the terms of friction are stated for all laws that remain open: a law without a term has it at 0.
void state_decay(const Decay& decay, FitSummary& summary) {
  const std::string own = summary.model.friction();
  for (FittedParameter& p : summary.parameters)
    for (const ByLaw& which : by_law)
      if (p.name == which.name) state_for_open_laws(decay, own, which, p);
  const std::string where =
      fmt::format("at {:.4g} rad, whichever law of friction", decay.amplitude_rad);
  summary.q_factor = {"Q", where, "", decay.q.value, decay.q.sigma};
  summary.decay_time = {"decay time", where, "s", decay.time_s.value, decay.time_s.sigma};
  std::erase_if(summary.combinations, [](const auto& known) { return known.name == "decay time"; });
  if (std::isfinite(decay.time_s.value)) summary.combinations.push_back(summary.decay_time);
  summary.decay = decay;
}

// A period in seconds is only as accurate as the clock that measured the times.
void widen_by_time_base(double time_base_sigma, FitSummary& summary) {
  for (FittedParameter& p : summary.parameters) {
    const bool is_T0 = p.name.substr(0, p.name.find('@')) == "T0";
    if (!is_T0 || p.status == ParameterStatus::fixed || !std::isfinite(p.sigma)) continue;
    const double common = time_base_sigma * p.value;
    const auto widen = [&](double& end, double widths) {
      end = p.value + std::copysign(std::hypot(end - p.value, widths * common), end - p.value);
    };
    widen(p.low68, 1.0), widen(p.high68, 1.0);
    widen(p.low95, z95), widen(p.high95, z95);
    p.sigma = std::hypot(p.sigma, common);
    p.sigma_by_law = std::hypot(p.sigma_by_law, common);
  }
  for (DerivedQuantity& quantity : summary.combinations)
    if (quantity.name == "mean period")
      quantity.sigma = std::hypot(quantity.sigma, time_base_sigma * quantity.value);
  DerivedQuantity& rate = summary.rate_s_per_day;
  rate.sigma = std::hypot(rate.sigma, seconds_gained_per_day(time_base_sigma));
}

// A search, and its result, which is a part of the search.
struct Searched {
  std::unique_ptr<ModelSearch> search;
  const Fitted* fitted = nullptr;
};

template <class Given>
Searched run_search(const TimingData& data, const Given& given, std::string_view what,
                    const FitStage& now) {
  Searched end{std::make_unique<ModelSearch>(data, given), nullptr};
  end.fitted = &end.search->run(what, now);
  return end;
}

// The search with every change at a crossing; if the times leap at a change, with the moment that
// explains them better.
Searched searched(const TimingData& data, const FitOptions& options, std::string_view what,
                  const FitStage& now) {
  Searched plain = run_search(data, options, what, now);
  const std::vector<FitEvent>& events = plain.search->options().events;
  const auto open = std::count_if(events.begin(), events.end(),
                                  [](const FitEvent& event) { return !event.has_known_moment(); });
  constexpr double worth_a_search = 6.0; // of two leaps: one log in twenty by chance
  // A misfit elsewhere that no drive explains is not removed at the changes. Without noise of the
  // drive, a leap at one change affects everything after it.
  const ModelChoice& model = plain.fitted->model;
  const bool is_misfit =
      (model.drive || model.slow) && plain.fitted->widening.largest() >= largest_widening;
  if (open == 0 || !plain.fitted->minimum.usable || is_misfit ||
      !leaps_at_changes(*plain.fitted, plain.search->options(), worth_a_search))
    return plain;
  Searched within = run_search(data, plain.search->settled(), "fitting dates of changes", now);
  if (!within.fitted->minimum.usable) return plain;
  const Fitted beside = on_few_beats(*plain.fitted, {*within.fitted->problem.data, 1.0});
  constexpr double two_sigma = 4.0; // of 2 log L for each moment
  const bool better = beside.minimum.usable &&
                      within.fitted->bic + two_sigma * static_cast<double>(open) < beside.bic;
  return better ? std::move(within) : std::move(plain);
}

// The search without the possible changes, or with them if the log needs them.
Searched searched_with_changes(const TimingData& data, const FitOptions& options,
                               const FitStage& now) {
  Searched plain = searched(data, options, "fitting the model", now);
  if (options.possible_events.empty() || !plain.fitted->minimum.usable) return plain;
  FitOptions wider = options;
  wider.events = joined(plain.search->options().events, options.possible_events);
  const auto added = static_cast<double>(wider.events.size() - options.events.size());
  const double dates = added * std::log(static_cast<double>(data.size())); // BIC counts sizes only
  if (promised_gain(*plain.fitted, wider) < dates) return plain;
  Searched changed = searched(data, wider, "fitting further changes", now);
  if (!changed.fitted->minimum.usable) return plain;
  const Fitted beside = on_few_beats(*plain.fitted, {*changed.fitted->problem.data, 1.0});
  const bool better = beside.minimum.usable && changed.fitted->bic + dates < beside.bic;
  return better ? std::move(changed) : std::move(plain);
}

// The fit without the changes that the log does not demand.
Searched without_needless_changes(const TimingData& data, Searched found, const FitStage& now) {
  const double date = std::log(static_cast<double>(data.size()));
  while (found.fitted->minimum.usable) {
    const auto fewer = without_needless_change(*found.fitted, found.search->options());
    if (!fewer) break;
    Searched without = searched(data, *fewer, "fitting fewer changes", now);
    if (!without.fitted->minimum.usable) break;
    const Fitted beside = on_few_beats(*without.fitted, {*found.fitted->problem.data, 1.0});
    if (!beside.minimum.usable || !(beside.bic < found.fitted->bic + date)) break;
    found = std::move(without);
  }
  return found;
}

// Data from timing_data() are valid; data put together by hand may not be.
void check(const TimingData& data) {
  constexpr std::size_t fewest_beats = 3;
  if (data.size() < fewest_beats)
    throw ArgumentError("data.cycle", static_cast<double>(data.size()), "at least 3 beats");
  const auto as_long = [&](std::string_view name, const std::vector<double>& values) {
    if (values.size() != data.size())
      throw ArgumentError(name, static_cast<double>(values.size()), "one value a beat");
  };
  as_long("data.elapsed_s", data.elapsed_s);
  as_long("data.lateness_s", data.lateness_s);
  if (data.has_amplitude()) as_long("data.amplitude_rad", data.amplitude_rad);
  for (const RateTerm& term : data.terms)
    as_long(term.name, term.advance_s);
  const auto finite = [](const std::vector<double>& values) {
    return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
  };
  if (!(data.reference_period_s > 0.0))
    throw ArgumentError("data.reference_period_s", data.reference_period_s, "above 0");
  if (!finite(data.cycle) || !finite(data.elapsed_s) || !finite(data.lateness_s))
    throw ArgumentError("data", "infinite or no numbers", "finite times");
  for (std::size_t i = 1; i < data.size(); ++i)
    if (!(data.cycle[i] > data.cycle[i - 1]))
      throw ArgumentError("data.cycle", data.cycle[i], "cycles that rise");
}

// Why no pendulum can be fitted; empty if one can.
std::string no_pendulum(const TimingData& data, double nominal_period_s) {
  if (!data.no_swings.empty()) return data.no_swings;
  if (nominal_period_s <= longest_swing_s) return {};
  constexpr double longest_contact_s = 600.0; // what a wheel's contact gives comes more often
  if (nominal_period_s > longest_contact_s)
    return fmt::format("readings of a clock {} s apart tell how it goes, and nothing of how its "
                       "pendulum swings",
                       readable(nominal_period_s, 6));
  return fmt::format("events {} s apart are not the swings of a pendulum, whose period would be "
                     "the nominal one",
                     readable(nominal_period_s, 4));
}

void note_displacements(const TimingData& data, FitSummary& summary) {
  for (const Displacement& at : data.displaced)
    summary.notes.push_back(
        {NoteKind::displacement,
         fmt::format("from {} s after the first beat on all times are displaced by {} ms: this was "
                     "taken off, for it is the sensor's doing, or a knock's",
                     readable(data.elapsed_s[at.beat], 5), readable_signed(1e3 * at.late_s, 3))});
}

// The residuals are stated for the log as it is, before anything was subtracted.
void put_wheels_back(const TimingData& data, FitSummary& summary) {
  const auto add = [](const std::vector<double>& taken, std::vector<double>& residual) {
    for (std::size_t i = 0; i < std::min(taken.size(), residual.size()); ++i)
      residual[i] += taken[i];
  };
  add(data.wheel_late_s, summary.residual_s);
  add(data.wheel_amplitude_rad, summary.amplitude_residual_rad);
}

// One note for each period: the lines beside a strong one come from the same wheel, whose speed
// changes.
void note_wheels(const TimingData& data, FitSummary& summary) {
  constexpr double same_period = 0.01; // relative
  constexpr std::size_t most_told = 4; // the strongest
  std::vector<const Wheel*> told;
  for (const Wheel& wheel : data.wheels) {
    const auto is_told = [&](const Wheel* other) {
      return (other->late_s > 0.0) == (wheel.late_s > 0.0) &&
             std::abs(other->turn_s - wheel.turn_s) < same_period * wheel.turn_s;
    };
    if (told.size() == most_told) return;
    if (std::any_of(told.begin(), told.end(), is_told)) continue;
    told.push_back(&wheel);
    const std::string what =
        wheel.late_s > 0.0
            ? fmt::format("times swing by ±{} ms", readable(1e3 * wheel.late_s, 3))
            : fmt::format("amplitudes swing by ±{} mrad", readable(1e3 * wheel.amplitude_rad, 3));
    summary.notes.push_back(
        {NoteKind::wheel, fmt::format("the {} every {} s, as a turning wheel makes them: this was "
                                      "subtracted before the fit",
                                      what, readable(wheel.turn_s, 5))});
  }
}

std::string why_no_start(const TimingData& data) {
  std::string text = "no start lies in the domain of the model (amplitude above phi0)";
  constexpr double widest_rad = 1.0; // of a clock that gravity brings back
  const double swing_rad =
      data.has_amplitude() ? push_shapes::mean_of_known(data.amplitude_rad) : 0.0;
  if (swing_rad > widest_rad)
    text += fmt::format("; a mean amplitude of {:.3g} rad is that of a balance or a torsion "
                        "pendulum: for one, hold the share of gravity (gravity_share) at 0",
                        swing_rad);
  return text;
}

} // namespace

FitSummary fit_clock(const TimingData& data, double nominal_period_s, const FitOptions& options,
                     const FitStage& now) {
  if (!(nominal_period_s > 0.0))
    throw ArgumentError("nominal_period", nominal_period_s, "a positive number of seconds");
  check(data);
  FitSummary summary;
  summary.impulses = data.impulses;
  summary.termination = no_pendulum(data, nominal_period_s);
  if (!summary.termination.empty()) {
    summary.status = FitStatus::no_valid_model;
    return summary;
  }
  const Searched end =
      without_needless_changes(data, searched_with_changes(data, options, now), now);
  const Fitted& fitted = *end.fitted;
  if (!fitted.minimum.usable) {
    summary.status = FitStatus::no_valid_model;
    summary.termination = why_no_start(data);
    return summary;
  }
  if (now) now("fitting the model: intervals");
  state_quality(fitted, data, summary);
  state(fitted, *end.search, nominal_period_s, summary);
  if (summary.status != FitStatus::contradicts_log)
    if (const auto decay = decay_of(fitted, end.search->options())) state_decay(*decay, summary);
  note_displacements(data, summary);
  put_wheels_back(data, summary);
  note_wheels(data, summary);
  if (data.time_base_sigma > 0.0) widen_by_time_base(data.time_base_sigma, summary);
  if (something_is_undetermined(summary))
    summary.experiments = suggest_experiments(fitted, end.search->options());
  return summary;
}

std::optional<ClockParameters> fitted_clock(const FitSummary& fit) {
  if (!fit.has_result() || fit.model.escapement != Escapement::constant_torque) return {};
  constexpr double largest_relative_sigma =
      0.1; // quantities that depend on the clock are then good to a tenth
  std::map<std::string, double> last; // later events overwrite earlier ones
  for (const FittedParameter& parameter : fit.parameters) {
    const std::string name = parameter.name.substr(0, parameter.name.find('@'));
    const double size = name == "gravity_share" ? 1.0 : std::abs(parameter.value); // 1: all gravity
    last[name] = parameter.sigma > largest_relative_sigma * size ? not_known : parameter.value;
  }
  ClockParameters clock{last["T0"], last["epsilon"], last["mu"], last["phi0"]};
  if (last.contains("gravity_share")) clock.gravity_share = last["gravity_share"];
  if (last.contains("quadratic_drag")) clock.quadratic_drag = last["quadratic_drag"];
  if (last.contains("dry_friction")) clock.dry_friction = last["dry_friction"];
  const bool known = std::isfinite(clock.nominal_period_s + clock.epsilon + clock.mu + clock.phi0 +
                                   clock.gravity_share);
  return known && clock.mu > 0.0 ? std::optional(clock) : std::nullopt;
}

} // namespace goingrate
