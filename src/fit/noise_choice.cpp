// Chooses the noise that a log demands besides the jitter of its sensor: a drive that varies from
// beat to beat or slowly, or times that walk.
#include "model_choice.hpp"

#include "contradictions.hpp"
#include "date_search.hpp"

#include "base/readable.hpp"
#include "fit/timing_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace goingrate::timing_model {

namespace {

// The point of another fit in the parameters `to`: coordinates that it lacks come from `at`, but a
// slow drive that it lacks is made negligible.
std::vector<double> place_among(const Parameters& to, std::span<const double> at,
                                const Fitted& other) {
  std::vector<double> otherwise(at.begin(), at.end());
  const Slot* slow = to.find(Quantity::slow_rms);
  constexpr double nothing = 1e-6; // relative
  if (slow != nullptr && slow->free) otherwise[slow->index] = slow->coordinate_of(nothing);
  return carried_over(other.problem.parameters, other.minimum.x, to, otherwise);
}

} // namespace

// Whether more noise than jitter is to be tried, because the options or the residuals ask for it.
bool ModelSearch::noise_is_asked_for() const {
  const bool walk_is_all = options_.noise == FitNoise::automatic && names(options_, "walk_rms");
  if (options_.noise == FitNoise::jitter || walk_is_all) return false;
  if (options_.noise != FitNoise::automatic || best_.model.drive || best_.model.walk) return true;
  // Single amplitudes are noisy, but they show the drive directly.
  return estimate_noise(working_.data.cycle, best_.seen.late_s).walk_s > 0.0 ||
         !white_in_amplitude(best_);
}

// A push that comes early or late moves the times but hardly changes the swing. With amplitudes,
// which show the drive, such a walk of the times can be recognised, and is added if the log calls
// for it. `other` is one more fit to start from.
void ModelSearch::let_times_walk(FittedLaws& drive, const Fitted& other, FitDynamics judge) const {
  if (!all_.has_amplitude() || drive.laws.model.walk || white(drive.fitted)) return;
  FittedLaws both = drive;
  both.laws.model.walk = true;
  both.fitted = fit_from_any(std::array<const Fitted*, 2>{&drive.fitted, &other}, both.laws.options,
                             both.laws.model);
  if (both.fitted.minimum.usable && refine(both.fitted, judge) &&
      both.fitted.bic < drive.fitted.bic)
    drive = std::move(both);
}

// Whether a slow drive would explain beats that scatter unevenly, judged on few of them.
bool ModelSearch::slow_drive_evens(const FittedLaws& drive) const {
  constexpr std::size_t few_beats = 1000;
  const TimingData few = thinned(working_.data, drive.fitted.problem.parameters, few_beats);
  ModelChoice model = drive.laws.model;
  model.slow = true;
  const Fitted slow = fit_from(drive.fitted, drive.laws.options, model, &few);
  return slow.minimum.usable && !scatters_unevenly(slow);
}

// The fit of these laws with a slowly varying drive as well, if the log calls for it.
Fitted ModelSearch::with_slow_drive(FittedLaws& drive, FitDynamics dynamics) const {
  auto& [options, model] = drive.laws;
  const bool automatic = options.noise == FitNoise::automatic;
  model.slow = true;
  // In a log with amplitudes the peak of the likelihood is so narrow that its height is known only
  // after a search. In a long log a slow drive looks much like another clock, and only a search
  // tells the two apart.
  constexpr std::size_t long_log_beats = 32'000;
  const bool asks_for_more =
      all_.size() >= long_log_beats || (working_.data.has_amplitude() && !white(drive.fitted));
  const bool slowly =
      options.noise == FitNoise::slow ||
      (automatic && (asks_for_more || worth_trying(drive.fitted, drive.fitted, options, model) ||
                     worth_trying(best_, drive.fitted, options, model)));
  if (!slowly) return {};
  // A fit without slow drive may have ended far from the solution: both fits serve as starts.
  Fitted slow = fit_from_any(std::array<const Fitted*, 2>{&drive.fitted, &best_}, options, model);
  if (slow.minimum.usable) refine(slow, dynamics);
  return slow;
}

void ModelSearch::choose_noise() {
  if (!noise_is_asked_for()) return;
  const FitNoise wanted = options_.noise;
  const bool automatic = wanted == FitNoise::automatic;
  const FitDynamics dynamics = best_.dynamics;
  const bool driven = best_.model.escapement != Escapement::none;
  const auto fit_with = [&](Laws& laws) {
    Fitted other = fit_from_any(std::array{&std::as_const(best_)}, laws.options, laws.model);
    if (other.minimum.usable) refine(other, dynamics);
    return other;
  };
  Laws laws{options_, best_.model};
  if (automatic && laws.model.drive) {
    laws.model.slow = true;
    if (worth_trying(best_, best_, options_, laws.model)) choose_slow_drive(fit_with(laws));
    take_dates_of_best();
    return;
  }
  if (automatic) {
    const bool walks = estimate_noise(working_.data.cycle, best_.seen.late_s).walk_s > 0.0;
    const bool swing_wanders = !white_in_amplitude(best_);
    laws.model.walk = !best_.model.walk;
    if (laws.model.walk == walks)
      take_if_better(fit_with(laws), walks ? "the times walk" : "the times do not walk");
    if (!(best_.model.walk || swing_wanders) || !driven) return;
  }
  if (!driven) return;
  laws.model = best_.model;
  laws.model.walk = names(options_, "walk_rms");
  laws.model.drive = true;
  laws.model.jitter = wanted != FitNoise::drive;
  FittedLaws drive{laws, fit_with(laws)};
  if (!drive.fitted.minimum.usable) return;
  // As long as the model had no such drive, changes were dated so as to explain its effects.
  move_dates(drive.fitted, drive.laws.options);
  // With noise of the drive and amplitudes, the error of first order looks like a walk of the
  // times.
  const FitDynamics judge = std::max(dynamics, FitDynamics::averaged2);
  if (automatic && all_.has_amplitude() && !white(drive.fitted)) refine(drive.fitted, judge);
  const bool is_uneven = automatic && scatters_unevenly(drive.fitted);
  // Other laws come before other noise, in which a misfit of wrong ones would hide.
  auto other = is_uneven || white(drive.fitted) ? std::nullopt : laws_that_explain(drive);
  const bool are_other = other.has_value();
  if (are_other) drive = std::move(*other);
  FittedLaws slow = drive;
  slow.fitted = is_uneven && !slow_drive_evens(drive) ? Fitted{} : with_slow_drive(slow, dynamics);
  const bool is_slow = slow.fitted.minimum.usable;
  if (automatic && !(is_slow && white(slow.fitted))) {
    let_times_walk(drive, best_, judge);
    if (is_slow) let_times_walk(slow, drive.fitted, judge);
  }
  const auto take_laws = [&] {
    if (best_.model.drive) options_.events = drive.laws.options.events;
    if (best_.model.drive && are_other) settled_.equal.clear(); // equal to the earlier laws
    take_dates_of_best();
  };
  if (automatic) {
    take_if_better(std::move(drive.fitted), "a drive that varies explains the walk");
    take_laws(); // for the comparison with slow drive
    choose_slow_drive(std::move(slow.fitted));
  } else {
    best_ = wanted == FitNoise::slow && is_slow ? std::move(slow.fitted) : std::move(drive.fitted);
  }
  take_laws();
}

void ModelSearch::take_dates_of_best() {
  for (std::size_t k = 0; k < options_.events.size(); ++k)
    options_.events[k].cycle = std::llround(best_.problem.parameters.event_cycles[k]);
}

// The clock is also inferred from the noise: if a little slow drive is left out, friction and fast
// drive are wrong by several σ; if it is added without need, intervals are wider. So it has to gain
// as much as chance gains in one log of 100, not as much as BIC asks. Near that limit the fit that
// is not chosen remains as a rival.
void ModelSearch::choose_slow_drive(Fitted&& slow) {
  if (!slow.minimum.usable) return;
  if (!best_.model.drive || best_.model.slow) {
    take_if_better(std::move(slow), "the drive varies slowly too");
    return;
  }
  // Fits can be compared only under the same dynamics. If the one without slow drive has simpler
  // dynamics, it is repeated from the point at which the other ended.
  if (best_.dynamics < slow.dynamics) {
    Fitted same = fit_from(slow, options_, best_.model);
    if (same.minimum.usable && refine(same, slow.dynamics) && same.dynamics == slow.dynamics)
      best_ = std::move(same);
  }
  constexpr double one_in_twenty = 6.0, one_in_a_hundred = 9.2; // of 2 log L, two parameters
  constexpr double three_sigma = 9.0;                           // of 2 log L
  const auto count = [](const Fitted& fitted) {
    return static_cast<double>(fitted.problem.parameters.free_count);
  };
  const double price =
      (count(slow) - count(best_)) * std::log(static_cast<double>(best_.problem.data->size()));
  const double gain = best_.bic - slow.bic + price;
  if (gain > one_in_a_hundred) {
    tried(best_, fmt::format("2 log L less by {}: the drive varies slowly too", readable(gain, 3)));
    std::swap(best_, slow);
  } else {
    tried(slow, fmt::format("2 log L gains {:.3g}, as by chance: not demanded", gain));
  }
  const double ahead = gain - one_in_a_hundred;
  if (gain > one_in_twenty && ahead < three_sigma)
    other_noise_ = {
        {place_among(best_.problem.parameters, best_.minimum.x, slow), 0.5 * std::abs(ahead)},
        best_.minimum.x};
}

void ModelSearch::add_other_noise() {
  if (!other_noise_ || other_noise_->beside.size() != best_.minimum.x.size()) return;
  const auto& [rival, beside] = *other_noise_;
  best_.rivals.push_back({moved_along(rival.x, beside, best_.minimum.x), rival.behind});
}

// The rms residual of times or of amplitudes, whichever is larger in units of the scatter of
// neighbouring beats.
double ModelSearch::straying(const Fitted& fitted) const {
  const double late = rms(fitted.seen.late_s) / guess_.jitter_s;
  const Slot* amplitude = fitted.problem.parameters.find(Quantity::amplitude_rms);
  if (amplitude == nullptr) return late;
  return std::max(late, amplitude->value(std::span<const double>(fitted.minimum.x)) /
                            guess_.amplitude_rad);
}

// Whether a long log departs from the fit by far more than neighbouring beats scatter, and neither
// the full equation of motion nor another friction law halves that. Such a departure is slow noise,
// which differences of neighbouring beats do not show. A model without noise would have to follow
// it by means of the clock parameters, so noise must be fitted first.
bool ModelSearch::strays_by_noise() const {
  constexpr std::size_t long_log_beats = 3000, thinned_beats = 1000;
  constexpr double least_straying = 3.0, largest_share = 0.5;
  if (working_.data.size() < long_log_beats || options_.noise == FitNoise::jitter) return false;
  if (is_steady_walk()) return true;
  const double strays = straying(best_);
  if (strays < least_straying) return false;
  const TimingData thin = thinned(working_.data, best_.problem.parameters, thinned_beats);
  const auto explains_most = [&](bool quadratic, bool dry) {
    ModelChoice model = best_.model;
    model.quadratic |= quadratic;
    model.dry |= dry;
    Fitted other = fit_from(best_, options_, model, &thin);
    if (other.minimum.usable) refine(other, FitDynamics::map);
    return other.minimum.usable && straying(other) < largest_share * strays;
  };
  return !explains_most(false, false) && !explains_most(true, false) && !explains_most(false, true);
}

} // namespace goingrate::timing_model
