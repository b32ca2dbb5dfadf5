#include "goingrate/analysis/analyse.hpp"

#include "base/scaled_time.hpp"
#include "fit/fit_setup.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <utility>

namespace goingrate {

namespace {

// The values of a column at the good beats, which keep the order of the events.
std::vector<double> at_good_beats(const std::vector<double>& column, const NumberedLog& loaded) {
  std::vector<double> values;
  values.reserve(loaded.good.size());
  const std::vector<Beat>& events = loaded.beats.beats;
  for (std::size_t i = 0; i < events.size(); ++i)
    if (events[i].flag == BeatFlag::good && events[i].segment == loaded.good.front().segment)
      values.push_back(column[i]);
  return values;
}

// The standard deviation of amplitudes that come from a flag's dark time, which jitters alike at
// every beat, in units of that jitter: of the median amplitude of neighbours, for noise must not
// weigh itself.
std::vector<double> width_noise(const TimingData& data, const std::vector<double>& width_s) {
  constexpr std::size_t reach = 10; // beats either way
  std::vector<double> sigmas;
  for (std::size_t i = 0; i < data.size(); ++i) {
    std::vector<double> near;
    for (std::size_t k = i > reach ? i - reach : 0; k < std::min(data.size(), i + reach + 1); ++k) {
      const double sigma = amplitude_sigma_from_width(width_s[k], 1.0, data.amplitude_rad[k],
                                                      data.reference_period_s);
      if (std::isfinite(sigma)) near.push_back(sigma);
    }
    if (near.empty()) {
      sigmas.push_back(std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    const auto middle = near.begin() + static_cast<std::ptrdiff_t>(near.size() / 2);
    std::nth_element(near.begin(), middle, near.end());
    sigmas.push_back(*middle);
  }
  return sigmas;
}

// Through an interruption, and as long again after it, the lateness stands still: what shook the
// clock then is told by the diary.
void level_interruptions(const Diary& diary, TimingData& data) {
  constexpr double before_s = 30.0;
  for (const Interruption& event : diary.interruptions) {
    const double from = event.begin.at_s - before_s;
    const double to = 2.0 * event.end.at_s - event.begin.at_s;
    double held = 0.0, taken_off = 0.0;
    for (std::size_t i = 0; i < data.size(); ++i) {
      const double late = data.lateness_s[i];
      if (data.elapsed_s[i] < from) {
        held = late;
      } else if (data.elapsed_s[i] <= to) {
        data.lateness_s[i] = held;
        taken_off = late - held;
      } else {
        data.lateness_s[i] -= taken_off;
      }
    }
  }
}

bool misses_nothing(const FitSummary& fit) {
  constexpr double least_p = 1e-3; // of white residuals
  return fit.quality.whiteness_p > least_p;
}

// Whether the fit explains the changes of the diary to the last beat, and knows how large they are:
// else its noise stands in for them.
bool follows_changes(const Analysis& data) {
  const FitSummary& fit = data.fit;
  const auto is_known = [&](const FittedParameter& p) { // a step of T0 may be, though T0 is not
    return p.name.find('@') == std::string::npos || std::isfinite(p.value) ||
           fit.combination(p.name + "/T0 - 1") != nullptr;
  };
  const bool knows_all = std::all_of(fit.parameters.begin(), fit.parameters.end(), is_known);
  return fit.status == FitStatus::converged && !fit.events.empty() && knows_all &&
         misses_nothing(fit);
}

// Whether it follows what no list of causes holds: changes however large, a drive that was
// interrupted, a free pendulum that comes to rest.
bool follows_more(const Analysis& data) {
  if (!data.fit.has_result()) return false;
  if (follows_changes(data)) return true;
  if (!data.diary.interruptions.empty()) return true;
  constexpr double decayed_share = 0.8; // of the amplitude: no clock's falls so far
  const auto& amplitude = data.fit.model_amplitude_rad;
  return data.fit.model.escapement == Escapement::none && !amplitude.empty() &&
         amplitude.back() < decayed_share * amplitude.front();
}

// The times that must be accounted for: what the fit leaves of them, where it follows more than
// causes do, and without interruptions, which the diary tells of.
TimingData unexplained_times(const TimingData& times, const Analysis& data) {
  TimingData unexplained = times;
  if (follows_more(data) && data.fit.residual_s.size() == times.size()) {
    unexplained.lateness_s = data.fit.residual_s;
    unexplained.amplitude_rad = data.fit.amplitude_residual_rad;
  }
  level_interruptions(data.diary, unexplained);
  return unexplained;
}

const char* changed_by(ChangeKind kind) {
  switch (kind) {
  case ChangeKind::regulation:
    return "T0";
  case ChangeKind::friction:
    return "epsilon";
  case ChangeKind::drive:
  case ChangeKind::unclear:
    break;
  }
  return "mu";
}

ChangeKind kind_of_change(const std::string& parameter) {
  if (parameter == "T0") return ChangeKind::regulation;
  return parameter == "epsilon" ? ChangeKind::friction : ChangeKind::drive;
}

// What a fit that explains the changes says of those it was told of, in order of time: its whole
// model tells kinds apart that the course of the rate does not.
void put_fitted_changes(const FitSummary& fit, std::span<const Beat> beats, Diary& diary) {
  for (const FitEvent& event : fit.events) {
    const std::int64_t cycle = beats.front().cycle + event.cycle;
    const auto nearest = std::min_element(
        diary.changes.begin(), diary.changes.end(), [&](const Change& a, const Change& b) {
          return std::abs(a.cycle - cycle) < std::abs(b.cycle - cycle);
        });
    if (nearest == diary.changes.end()) return;
    nearest->kind = kind_of_change(event.names.front());
    nearest->cycle = cycle;
    const auto at = std::find_if(beats.begin(), beats.end(),
                                 [&](const Beat& beat) { return beat.cycle >= cycle; });
    if (at != beats.end()) nearest->at_s = at->time - beats.front().time;
  }
}

// The rate from one dated change to the next.
std::vector<PartRate> stretches_of(std::span<const Beat> beats, const Diary& diary,
                                   double nominal_period_s) {
  std::vector<Instant> cuts;
  for (const Change& change : diary.changes)
    cuts.push_back(beats.front().time + change.at_s);
  return rates_between(beats, cuts, nominal_period_s);
}

// What the clock does in the end: the mean of the last stretch, unless its last quarter contradicts
// it, as after a change that the clock still follows, or where the rate drifts.
PartRate rate_now(std::span<const Beat> beats, const PartRate& last, double nominal_period_s) {
  constexpr double least_difference_sigma = 3.0; // sigma of the quarter
  const Instant begin = last.start + 0.75 * last.rate.duration_s;
  const auto at = std::find_if(beats.begin(), beats.end(),
                               [&](const Beat& beat) { return beat.time >= begin; });
  const auto quarter = rates_between({at, beats.end()}, {}, nominal_period_s);
  if (quarter.empty()) return last;
  const RateSummary& rate = quarter.back().rate;
  const double apart = std::abs(rate.rate_excess - last.rate.rate_excess);
  return apart > least_difference_sigma * rate.rate_excess_sigma ? quarter.back() : last;
}

// While the drive comes back after an interruption the rate moves: what stands out of its course
// there, and not of its beats, is no change of its own if a fit explains the log without it.
void drop_wakes(const FitSummary& fit, std::span<const Beat> beats, Diary& diary) {
  const auto is_fitted = [&](const Change& change) {
    return std::any_of(fit.events.begin(), fit.events.end(), [&](const FitEvent& event) {
      return beats.front().cycle + event.cycle == change.cycle;
    });
  };
  const auto is_in_a_wake = [&](const Change& change) {
    return std::any_of(diary.interruptions.begin(), diary.interruptions.end(),
                       [&](const Interruption& event) {
                         return event.recovery && change.at_s > event.end.at_s &&
                                change.at_s < event.end.at_s + event.recovery->window_s;
                       });
  };
  std::erase_if(diary.changes, [&](const Change& change) {
    return !change.stands_out && !is_fitted(change) && is_in_a_wake(change);
  });
}

// The course of a swing that dies away, or of a drive that varies slowly, looks like changes. Where
// such a model, asked for them, explains the log without any, there were none.
void drop_what_no_fit_demands(const FitSummary& fit, Diary& diary) {
  if (fit.status != FitStatus::converged || !misses_nothing(fit) || !fit.events.empty()) return;
  const bool dies_away = fit.model.escapement == Escapement::none && fit.decay && !fit.model.walk;
  const bool wanders =
      fit.model.slow && fit.find("slow_rms") != nullptr && std::isfinite(fit["slow_rms"].value);
  std::erase_if(diary.changes,
                [&](const Change& change) { return dies_away || (wanders && !change.stands_out); });
}

// The rms of the fast drive, as far as the log tells it: without a high end if only its least is
// known.
std::optional<RmsEstimate> fast_drive(const DriveAnalysis& drive, const FitSummary& fit) {
  if (drive.split) return drive.split->fast;
  if (const DerivedQuantity* least = fit.combination("least fast drive"))
    return RmsEstimate{least->value, least->value - least->sigma,
                       std::numeric_limits<double>::infinity()};
  const FittedParameter* found = fit.find("drive_rms");
  if (found == nullptr || !std::isfinite(found->value) || !(found->sigma > 0.0)) return {};
  return RmsEstimate{found->value, found->low68, found->high68};
}

// Turns of the rating nut for the clock as it goes now, where the pitch is given and a nominal
// period is known.
std::optional<NutTurns> nut_turns(const AnalysisRequest& request, const RateSummary& rate) {
  if (!request.nut_pitch_m || !rate.nominal_is_known) return {};
  const double length_m = request.rod_length_m.value_or(mathematical_length(rate.nominal_period_s));
  return turns_to_zero_rate({*request.nut_pitch_m, length_m}, rate.rate_excess,
                            rate.rate_excess_sigma);
}

} // namespace

TimingData fit_data(const NumberedLog& loaded) {
  TimingData data = timing_data(loaded.good);
  const auto add = [&](const char* name, const char* unit, const std::vector<double>& column) {
    if (!column.empty())
      data.terms.push_back(rate_term(name, unit, data, at_good_beats(column, loaded)));
  };
  const EventColumns& columns = loaded.log.columns;
  if (!columns.sigma_s.empty())
    data.time_noise = relative_noise(at_good_beats(columns.sigma_s, loaded));
  if (!columns.width_s.empty() && data.has_amplitude())
    data.amplitude_noise =
        relative_noise(width_noise(data, at_good_beats(columns.width_s, loaded)));
  add("temperature", "1/K", columns.temperature_c);
  add("pressure", "1/mbar", columns.pressure_mbar);
  if (!columns.temperature_c.empty() && !columns.pressure_mbar.empty())
    add("density", "m^3/kg", air_density(columns.temperature_c, columns.pressure_mbar));
  return data;
}

Diary diary_of(const NumberedLog& loaded, const TimingData& times) {
  Diary diary = keep_diary(loaded.good, loaded.nominal_period_s);
  TimingData levelled = times;
  level_interruptions(diary, levelled);
  add_small_changes(diagnosis_input(levelled, loaded, diary, {}, {}), loaded.good, diary);
  return diary;
}

void ask_for_changes(const Diary& diary, std::int64_t first_cycle, FitOptions& options) {
  constexpr std::size_t most_events = 4; // each costs a parameter
  const auto events = [&](bool stand_out) {
    std::vector<FitEvent> found;
    for (const Change& change : strongest_changes(diary, most_events, stand_out)) {
      const std::string name = changed_by(change.kind);
      if (name == "mu" && options.escapement == Escapement::none) continue;
      found.push_back({change.cycle - first_cycle, {name}, true});
    }
    return found;
  };
  options.events = events(true);
  options.possible_events = events(false);
}

FitOptions with_seen_offset(FitOptions options, const NumberedLog& loaded) {
  constexpr double least_significance = 5.0; // sigma
  const auto& beat_error = loaded.sensor.beat_error_s;
  const bool is_seen =
      beat_error && std::abs(beat_error->value) > least_significance * beat_error->sigma;
  // The rest angle of samples is an estimate. Its error shifts the times of a ring-down
  // increasingly, even if the beat error is too small to show.
  const bool is_estimate = beat_error && loaded.log.format == LogFormat::angle;
  if ((!is_seen && !is_estimate) || loaded.sensor.at_vertical ||
      timing_model::names(options, "offset"))
    return options;
  // With amplitudes the two directions tell the place far better than times of one direction, which
  // would trade it for friction.
  const auto place = loaded.log.has_amplitude
                         ? sensor_offset(loaded.beats.beats, loaded.nominal_period_s)
                         : std::nullopt;
  if (place)
    options.priors.push_back({"offset", place->value, place->sigma});
  else if (is_seen)
    options.freed.emplace_back("offset");
  return options;
}

DiagnosisInput diagnosis_input(const TimingData& times, const NumberedLog& loaded,
                               const Diary& diary, const DriveAnalysis& drive,
                               const FitSummary& fit) {
  DiagnosisInput input;
  input.data = &times;
  input.nominal_period_s = loaded.nominal_period_s;
  input.changes = diary.changes;
  input.lines = drive.lines;
  if (drive.response) // of corner 2 epsilon / T0
    input.relaxation_s = 1.0 / (two_pi * drive.response->corner_hz);
  input.fast_drive = fast_drive(drive, fit);
  for (const Gap& gap : loaded.beats.gaps)
    if (gap.kind == GapKind::stop && !gap.bridged)
      input.stopped_s = static_cast<double>(gap.after_cycle) * loaded.nominal_period_s;
  return input;
}

Analysis analyse(NumberedLog loaded, const AnalysisRequest& request) {
  constexpr int steps = 6;
  auto tell = [&, step = 0](std::string_view what) mutable {
    if (request.now) request.now(fmt::format("{} of {}: {}", ++step, steps, what));
  };
  Analysis data;
  data.rate = summarise_rates(loaded.good, loaded.nominal_period_s);
  data.rate.nominal_is_known = loaded.nominal_is_known;
  const TimingData times = fit_data(loaded);
  data.diary = diary_of(loaded, times);
  FitOptions asked = with_seen_offset(request.fit, loaded);
  asked.profiles = request.traces_profiles;
  if (request.finds_events && asked.events.empty())
    ask_for_changes(data.diary, loaded.good.front().cycle, asked);
  tell("fitting the model");
  data.fit = fit_clock(times, loaded.nominal_period_s, asked);
  if (request.finds_events && follows_changes(data)) {
    put_fitted_changes(data.fit, loaded.good, data.diary);
    drop_wakes(data.fit, loaded.good, data.diary);
  }
  if (request.finds_events) drop_what_no_fit_demands(data.fit, data.diary);
  put_rates(loaded.good, loaded.nominal_period_s, data.diary);
  data.stretches = stretches_of(loaded.good, data.diary, loaded.nominal_period_s);
  for (PartRate& stretch : data.stretches)
    stretch.rate.nominal_is_known = loaded.nominal_is_known;
  data.now = rate_now(loaded.good, data.stretches.back(), loaded.nominal_period_s);
  data.now.rate.nominal_is_known = loaded.nominal_is_known;
  tell("looking at temperature and pressure");
  data.covariates = covariate_effects(times);
  tell("spectrum of the rate, fast and slow drive");
  data.drive = analyse_drive(loaded.good, loaded.nominal_period_s, data.fit);
  tell("the drive as it went");
  if (const auto model = drive_model(data.fit, times)) data.history = drive_history(times, *model);
  tell("likely causes");
  const TimingData unexplained = unexplained_times(times, data);
  DiagnosisInput causes = diagnosis_input(unexplained, loaded, data.diary, data.drive, data.fit);
  if (follows_changes(data) && data.diary.interruptions.empty())
    causes.explained = std::exchange(causes.changes, {});
  data.suspicions = diagnose(causes);
  name_weather(data.covariates, data.suspicions);
  tell("stability");
  const PhaseSeries phase = phase_series(loaded);
  data.deviation = stability_table(DeviationKind::oadev, phase.phase_s, phase.tau0_s,
                                   octave_factors(phase.phase_s.size()));
  data.nut = nut_turns(request, data.now.rate);
  data.sensor = loaded.sensor;
  data.beats.assign(loaded.good.begin(), loaded.good.end());
  data.log = std::move(loaded.log);
  data.numbered = std::move(loaded.beats);
  return data;
}

} // namespace goingrate
