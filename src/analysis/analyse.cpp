#include "goingrate/analysis/analyse.hpp"

#include "fitted_weather.hpp"
#include "rounding.hpp"

#include "base/scaled_time.hpp"
#include "causes/facts.hpp"
#include "fit/fit_setup.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <utility>

namespace goingrate {

namespace {

// Through an interruption, and as long again after it, the lateness stands still: what shook the
// clock then is stated in the diary.
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
    std::erase_if(data.displaced, [&](const Displacement& at) {
      return data.elapsed_s[at.beat] >= from && data.elapsed_s[at.beat] <= to;
    });
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

// Whether the fit follows what is in no list of causes: changes however large, a drive that was
// interrupted, a free pendulum that comes to rest.
bool follows_more(const Analysis& data) {
  if (!data.fit.has_result()) return false;
  if (follows_changes(data)) return true;
  if (!data.diary.interruptions.empty()) return true;
  constexpr double decayed_share = 0.8; // of the amplitude: no clock's falls that far
  const auto& amplitude = data.fit.model_amplitude_rad;
  return data.fit.model.escapement == Escapement::none && !amplitude.empty() &&
         amplitude.back() < decayed_share * amplitude.front();
}

// What the fit gives to the weather or the tides is a cause to be named.
void put_back_weather(const FitSummary& fit, TimingData& times) {
  for (const RateTerm& term : times.terms) {
    const FittedParameter* found = fit.find(term.name);
    if (found == nullptr || !std::isfinite(found->value) || term.name == "drift") continue;
    for (std::size_t i = 0; i < times.size(); ++i)
      times.lateness_s[i] -= found->value * term.advance_s[i];
  }
}

// The times that must be accounted for: what the fit leaves of them, where it follows more than
// causes do; without interruptions, which are in the diary.
TimingData unexplained_times(TimingData times, const Analysis& data) {
  if (follows_more(data) && data.fit.residual_s.size() == times.size()) {
    times.lateness_s = data.fit.residual_s;
    times.amplitude_rad = data.fit.amplitude_residual_rad;
    put_back_weather(data.fit, times);
  }
  level_interruptions(data.diary, times);
  return times;
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

std::vector<Change>::iterator nearest_change(Diary& diary, std::int64_t cycle) {
  return std::min_element(diary.changes.begin(), diary.changes.end(),
                          [&](const Change& a, const Change& b) {
                            return std::abs(a.cycle - cycle) < std::abs(b.cycle - cycle);
                          });
}

// Puts in what a fit that explains the changes says of those it was given, in order of time: its
// whole model tells kinds apart that the course of the rate does not.
void put_fitted_changes(const FitSummary& fit, std::span<const Beat> beats, Diary& diary) {
  for (const FitEvent& event : fit.events) {
    const std::int64_t cycle = beats.front().cycle + event.cycle;
    const auto nearest = nearest_change(diary, cycle);
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
  const auto rates = [&](double margin_s) {
    std::vector<Instant> cuts;
    for (const Change& change : diary.changes)
      for (const double side : {-1.0, 1.0})
        if (!change.is_only_noted() && (margin_s > 0.0 || side > 0.0))
          cuts.push_back(beats.front().time + (change.at_s + side * margin_s));
    return rates_between(beats, cuts, nominal_period_s);
  };
  // Readings date a change to half an interval: the two at it belong to neither stretch, if there
  // are enough others.
  const auto known = std::count_if(diary.changes.begin(), diary.changes.end(),
                                   [](const Change& change) { return !change.is_only_noted(); });
  if (nominal_period_s > longest_swing_s && known > 0) {
    auto apart = rates(0.5 * nominal_period_s);
    if (std::ssize(apart) == known + 1) return apart;
  }
  return rates(0.0);
}

// What the clock does at the end: the mean of the last stretch, unless its last quarter contradicts
// it, as after a change that the clock still follows, or where the rate drifts.
PartRate rate_now(std::span<const Beat> beats, const PartRate& last, double nominal_period_s) {
  constexpr double least_difference_sigma = 3.0; // sigma of the quarter
  const Instant begin = last.start + 0.75 * last.rate.duration_s;
  const auto at = std::find_if(beats.begin(), beats.end(),
                               [&](const Beat& beat) { return beat.time >= begin; });
  constexpr std::ptrdiff_t fewest_beats = 20; // in which σ is told from neighbouring beats
  if (beats.end() - at < fewest_beats) return last;
  const auto quarter = rates_between({at, beats.end()}, {}, nominal_period_s);
  if (quarter.empty()) return last;
  const RateSummary& rate = quarter.back().rate;
  const double apart = std::abs(rate.rate_excess - last.rate.rate_excess);
  return apart > least_difference_sigma * rate.rate_excess_sigma ? quarter.back() : last;
}

// While the drive comes back after an interruption the rate moves: what stands out of its course
// there, and not of its beats, is not a change of its own if a fit explains the log without it.
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
    return !change.stands_out && !change.noted && !is_fitted(change) && is_in_a_wake(change);
  });
}

// Drops changes that the fit was given and does without: the course of the rate dates a change
// within some beats and may take one for two. Possible changes count as given where the swing still
// answers to a change that the fit has.
void drop_what_the_fit_dropped(const FitOptions& asked, const FitSummary& fit,
                               const NumberedLog& loaded, Diary& diary) {
  if (fit.status != FitStatus::converged || !misses_nothing(fit) || fit.events.empty()) return;
  const std::int64_t first = loaded.good.front().cycle;
  const double reach =
      fit.decay_time.value / loaded.nominal_period_s; // cycles; NaN reaches nothing
  std::vector<FitEvent> told;
  for (const FitEvent& event : asked.events)
    if (event.movable) told.push_back(event);
  for (const FitEvent& event : asked.possible_events)
    if (event.movable &&
        std::any_of(fit.events.begin(), fit.events.end(), [&](const FitEvent& own) {
          return std::abs(static_cast<double>(own.cycle - event.cycle)) < reach;
        }))
      told.push_back(event);
  std::vector<bool> kept(told.size(), false);
  for (const FitEvent& event : fit.events) {
    const auto nearest =
        std::min_element(told.begin(), told.end(), [&](const FitEvent& a, const FitEvent& b) {
          return std::abs(a.cycle - event.cycle) < std::abs(b.cycle - event.cycle);
        });
    if (nearest != told.end()) kept[static_cast<std::size_t>(nearest - told.begin())] = true;
  }
  for (std::size_t i = 0; i < told.size(); ++i)
    std::erase_if(diary.changes, [&](const Change& change) {
      return !kept[i] && !change.noted && change.cycle == first + told[i].cycle;
    });
}

// Whether the clock and its sensor's jitter are all there is in the times: no noise that wanders
// stands in for a change.
bool explains_all(const FitSummary& fit) {
  constexpr double least_p = 1e-3;
  const ModelChoice& model = fit.model;
  return fit.status == FitStatus::converged && misses_nothing(fit) &&
         fit.quality.p_value > least_p && !model.walk && !model.drive && !model.slow;
}

// The swing that settles after the start, or after a change, looks like more changes. Where the fit
// explains all, those there that it does not have were none.
void drop_what_the_swing_explains(const FitSummary& fit, std::int64_t first, Diary& diary) {
  if (!explains_all(fit)) return;
  std::vector<const Change*> kept;
  for (const FitEvent& event : fit.events) {
    const auto nearest = nearest_change(diary, first + event.cycle);
    if (nearest != diary.changes.end()) kept.push_back(&*nearest);
  }
  Diary told{{}, diary.interruptions};
  for (const Change& change : diary.changes)
    if (change.noted || std::find(kept.begin(), kept.end(), &change) != kept.end())
      told.changes.push_back(change);
  diary = std::move(told);
}

// The course of a swing that dies away, or of a drive that varies slowly, looks like changes. Where
// such a model, asked for them, explains the log without any, there were none.
void drop_what_no_fit_demands(const FitSummary& fit, Diary& diary) {
  if (fit.status != FitStatus::converged || !misses_nothing(fit) || !fit.events.empty()) return;
  const bool dies_away = fit.model.escapement == Escapement::none && fit.decay && !fit.model.walk;
  const bool wanders =
      fit.model.slow && fit.find("slow_rms") != nullptr && std::isfinite(fit["slow_rms"].value);
  std::erase_if(diary.changes, [&](const Change& change) {
    return !change.noted && (dies_away || (wanders && !change.stands_out));
  });
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
  const bool is_swing = rate.nominal_period_s <= longest_swing_s || request.rod_length_m;
  if (!request.nut_pitch_m || !rate.nominal_is_known || !is_swing) return {};
  const double length_m = request.rod_length_m.value_or(mathematical_length(rate.nominal_period_s));
  return turns_to_zero_rate({*request.nut_pitch_m, length_m}, rate.rate_excess,
                            rate.rate_excess_sigma);
}

bool knows_a_plan(const FitOptions& options) {
  return std::any_of(options.events.begin(), options.events.end(),
                     [](const FitEvent& event) { return event.planned.has_value(); });
}

FitOptions without_plans(FitOptions options) {
  options.profiles = false;
  for (FitEvent& event : options.events)
    event.planned.reset();
  return options;
}

// What comes round with the pushes of an escapement that rests is not a wheel. The log is sampled
// once a swing, so that a line may be an alias: k times the pushes' frequency less j times the
// swing's, within a resolution of the log for each.
std::vector<SpectralLine> without_pushes(std::vector<SpectralLine> lines, const TimingData& times) {
  if (!times.impulses) return lines;
  const double periods = times.impulses->periods;
  const double turn_s = periods * times.reference_period_s;
  const double resolution = turn_s / times.elapsed_s.back();
  std::erase_if(lines, [&](const SpectralLine& line) {
    // Pushes that wait for the amplitude come, say, 39 or 40 swings apart, and the pattern of the two
    // intervals repeats as well.
    constexpr double longest_pattern = 20.0; // intervals
    if (!times.impulses->is_regular && line.frequency_hz * turn_s * longest_pattern > 1.0)
      return true;
    for (const double j : {0.0, 1.0, 2.0, 3.0})
      for (const double sign : {1.0, -1.0}) {
        const double turns = std::abs(line.frequency_hz * turn_s + sign * j * periods);
        const double off = std::abs(turns - std::max(1.0, std::round(turns)));
        if (off < (1.0 + j) * resolution) return true;
      }
    return false;
  });
  return lines;
}

// The beats as they would be if each swing got its share of a push: otherwise the saw-tooth of the
// pushes would pass for changes.
std::vector<Beat> levelled_beats(std::span<const Beat> good, const ImpulseCycle& pushes) {
  const TimingData raw = timing_data(good);
  TimingData levelled = raw;
  level_impulses(pushes, levelled);
  std::vector<Beat> beats(good.begin(), good.end());
  for (std::size_t i = 0; i < beats.size(); ++i) {
    beats[i].time = beats[i].time + (levelled.lateness_s[i] - raw.lateness_s[i]);
    if (levelled.has_amplitude()) beats[i].amplitude_rad = levelled.amplitude_rad[i];
  }
  return beats;
}

} // namespace

Diary diary_of(const NumberedLog& loaded, const TimingData& times) {
  if (rounding_explains(times)) return {};
  const std::vector<Beat> even =
      times.impulses ? levelled_beats(loaded.good, *times.impulses) : std::vector<Beat>{};
  const std::span<const Beat> good = times.impulses ? std::span<const Beat>(even) : loaded.good;
  if (are_few_readings(times)) return diary_of_readings(good, loaded.nominal_period_s, times);
  Diary diary = keep_diary(good, loaded.nominal_period_s);
  std::optional<TimingData> levelled; // no copy of a long log in which nothing is to be levelled
  if (!diary.interruptions.empty()) level_interruptions(diary, levelled.emplace(times));
  const TimingData& seen = levelled ? *levelled : times;
  add_small_changes(diagnosis_input(seen, loaded, diary, {}, {}), good, diary);
  join_changes_across_gaps(good, diary);
  return diary;
}

// Two things may have been done at once; the first one's plan is kept.
static void merge_those_of_one_beat(std::vector<FitEvent>& events) {
  std::vector<FitEvent> merged;
  for (FitEvent& event : events) {
    if (merged.empty() || merged.back().cycle != event.cycle) {
      merged.push_back(std::move(event));
      continue;
    }
    std::vector<std::string>& names = merged.back().names;
    for (std::string& name : event.names)
      if (std::find(names.begin(), names.end(), name) == names.end())
        names.push_back(std::move(name));
  }
  events = std::move(merged);
}

void ask_for_changes(const Diary& diary, std::int64_t first_cycle, FitOptions& options) {
  constexpr std::size_t most_events = 4; // each costs a parameter
  Diary noticed = diary, noted = diary;
  std::erase_if(noticed.changes, [](const Change& change) { return change.noted; });
  std::erase_if(noted.changes, [](const Change& change) { return !change.noted; });
  const auto add = [&](const Change& change, std::vector<FitEvent>& events) {
    const std::string name = changed_by(change.kind);
    if (name == "mu" && options.escapement == Escapement::none) return;
    events.push_back({change.cycle - first_cycle, {name}, !change.noted, change.planned, false});
  };
  options.events.clear();
  for (const Change& change : strongest_changes(noticed, most_events, true))
    add(change, options.events);
  for (const bool stand_out : {true, false})
    for (const Change& change : strongest_changes(noted, most_events, stand_out))
      if (!change.is_only_noted() || change.planned) add(change, options.events);
  const auto is_before = [](const FitEvent& a, const FitEvent& b) { return a.cycle < b.cycle; };
  std::stable_sort(options.events.begin(), options.events.end(), is_before);
  merge_those_of_one_beat(options.events);
  options.possible_events.clear();
  for (const Change& change : strongest_changes(noticed, most_events, false))
    add(change, options.possible_events);
  for (const Change& change : strongest_changes(noted, most_events, false))
    if (change.is_only_noted() && !change.planned) add(change, options.possible_events);
  std::stable_sort(options.possible_events.begin(), options.possible_events.end(), is_before);
  merge_those_of_one_beat(options.possible_events);
}

FitOptions with_seen_offset(FitOptions options, const NumberedLog& loaded) {
  constexpr double least_significance = 5.0; // sigma
  const auto& beat_error = loaded.sensor.beat_error_s;
  const bool is_seen =
      beat_error && std::abs(beat_error->value) > least_significance * beat_error->sigma;
  // The rest angle of samples is an estimate. Its error shifts the times of a ring-down
  // increasingly, even if the beat error is too small to show.
  const bool is_estimate = beat_error && loaded.log.format == LogFormat::angle;
  if (loaded.sensor.at_vertical || timing_model::names(options, "offset")) return options;
  const bool is_leading_edge =
      loaded.log.flag_width_rad && !loaded.log.has_amplitude && loaded.log.columns.width_s.empty();
  if (is_leading_edge) options.fixed["offset"] = -0.5 * *loaded.log.flag_width_rad;
  if ((!is_seen && !is_estimate) || is_leading_edge) return options;
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

// When the clock stopped at the end of the analysed part, or else before it; s from its first beat.
static std::optional<double> stopped_s(const NumberedLog& loaded) {
  const Instant begin = loaded.good.front().time;
  const double end_s = loaded.good.back().time - begin;
  const std::vector<Beat>& beats = loaded.beats.beats;
  std::optional<double> at_s;
  for (const Gap& gap : loaded.beats.gaps) {
    if (gap.kind != GapKind::stop || gap.bridged) continue;
    const auto last = std::find_if(beats.begin(), beats.end(), [&](const Beat& beat) {
      return beat.cycle == gap.after_cycle && beat.flag == BeatFlag::good;
    });
    if (last == beats.end()) continue;
    at_s = last->time - begin;
    if (*at_s >= end_s) break;
  }
  return at_s;
}

DiagnosisInput diagnosis_input(const TimingData& times, const NumberedLog& loaded,
                               const Diary& diary, const DriveAnalysis& drive,
                               const FitSummary& fit) {
  DiagnosisInput input;
  input.data = &times;
  input.nominal_period_s = loaded.nominal_period_s;
  input.changes = diary.changes;
  std::erase_if(input.changes, [](const Change& change) { return change.is_only_noted(); });
  input.lines = without_rounding(without_pushes(drive.lines, times), times);
  if (drive.response) // of corner 2 epsilon / T0
    input.relaxation_s = 1.0 / (two_pi * drive.response->corner_hz);
  // Pushes that come seldom vary more than those in every swing; what is usual is not known.
  if (!times.impulses) input.fast_drive = fast_drive(drive, fit);
  input.stopped_s = stopped_s(loaded);
  return input;
}

// A pendulum without a drive has no cause of a clock that gets worse: that it comes to rest is told.
static void leave_out_drifts_of_free_swings(const FitSummary& fit,
                                            std::vector<Suspicion>& suspicions) {
  if (!fit.has_result() || fit.model.escapement != Escapement::none) return;
  std::erase_if(suspicions, [](const Suspicion& suspicion) {
    return suspicion.cause == Cause::growing_friction || suspicion.cause == Cause::length_drift;
  });
}

// The causes of what is not explained; the times are not needed after that.
static std::vector<Suspicion> suspicions_of(TimingData times, const NumberedLog& loaded,
                                            const Analysis& data) {
  if (rounding_explains(times)) { // but for what was taken off before
    std::vector<Suspicion> taken_off;
    const DiagnosisInput input = diagnosis_input(times, loaded, data.diary, data.drive, data.fit);
    timing_model::look_at_displacements(input, times.displaced, taken_off);
    return taken_off;
  }
  TimingData unexplained = unexplained_times(std::move(times), data);
  DiagnosisInput causes = diagnosis_input(unexplained, loaded, data.diary, data.drive, data.fit);
  if (follows_changes(data) && data.diary.interruptions.empty())
    causes.explained = std::exchange(causes.changes, {});
  const auto diagnosed = [&] {
    std::vector<Suspicion> found = diagnose(causes);
    name_weather(data.covariates, found);
    return found;
  };
  std::vector<Suspicion> suspicions = diagnosed();
  const std::vector<Suspicion> hidden = weather_seen_by_fit(data.fit, suspicions);
  if (hidden.empty()) return suspicions;
  take_off(hidden, unexplained);
  suspicions = diagnosed();
  std::erase_if(suspicions, [&](const Suspicion& again) {
    return std::any_of(hidden.begin(), hidden.end(),
                       [&](const Suspicion& known) { return known.cause == again.cause; });
  });
  suspicions.insert(suspicions.end(), hidden.begin(), hidden.end());
  const auto gains_more = [](const Suspicion& a, const Suspicion& b) { return a.gain > b.gain; };
  std::stable_sort(suspicions.begin(), suspicions.end(), gains_more);
  return suspicions;
}

Analysis analyse(NumberedLog loaded, const AnalysisRequest& request) {
  constexpr int steps = 6;
  int step = 0;
  const auto tell_more = [&](std::string_view what) {
    if (request.now) request.now(fmt::format("{} of {}: {}", step, steps, what));
  };
  const auto tell = [&](std::string_view what) {
    ++step;
    tell_more(what);
  };
  Analysis data;
  data.rate = mean_rate(loaded);
  TimingData times = fit_data(loaded);
  data.diary = diary_of(loaded, times);
  std::optional<Logbook> logbook;
  if (request.logbook) {
    logbook = brought_to(loaded.log, *request.logbook);
    take_entries(*logbook, loaded.good, data.diary);
  }
  FitOptions asked = with_seen_weather(with_seen_offset(request.fit, loaded), loaded);
  asked.profiles = request.traces_profiles;
  if (request.finds_events && asked.events.empty())
    ask_for_changes(data.diary, loaded.good.front().cycle, asked);
  tell("fitting the model");
  const bool has_plans = logbook && knows_a_plan(asked);
  const FitSummary alone =
      has_plans ? fit_clock(times, loaded.nominal_period_s, without_plans(asked), tell_more)
                : FitSummary{};
  if (has_plans) asked = without_what_is_excluded(std::move(asked), alone);
  data.fit = fit_clock(times, loaded.nominal_period_s, asked, tell_more);
  if (request.finds_events) {
    drop_what_the_swing_explains(data.fit, loaded.good.front().cycle, data.diary);
    drop_what_the_fit_dropped(asked, data.fit, loaded, data.diary);
  }
  if (request.finds_events && follows_changes(data)) {
    put_fitted_changes(data.fit, loaded.good, data.diary);
    drop_wakes(data.fit, loaded.good, data.diary);
  }
  if (request.finds_events) drop_what_no_fit_demands(data.fit, data.diary);
  const auto moved_back = without_displacements(loaded.good, times);
  const std::span<const Beat> level = moved_back ? std::span<const Beat>(*moved_back) : loaded.good;
  put_rates(level, loaded.nominal_period_s, data.diary);
  data.stretches = stretches_of(level, data.diary, loaded.nominal_period_s);
  data.now = rate_now(level, data.stretches.back(), loaded.nominal_period_s);
  if (data.stretches.size() == 1 && std::isnan(data.now.rate.rate_excess_sigma))
    data.now.rate = data.rate; // so few beats have no blocks to scatter, but a jitter
  const auto complete = [&](RateSummary& rate) {
    rate.nominal_is_known = loaded.nominal_is_known;
    add_time_base(rate, loaded.log.time_base_sigma);
  };
  for (PartRate& stretch : data.stretches)
    complete(stretch.rate);
  complete(data.now.rate);
  tell("looking at weather and amplitude");
  data.covariates = covariate_effects(times);
  // A rate that follows the weather does not stay as it was at the end.
  if (std::any_of(data.covariates.begin(), data.covariates.end(),
                  [](const CovariateEffect& effect) { return effect.helps(); }))
    data.now = data.stretches.back();
  tell_ways(times, data.fit, data.covariates);
  data.isochronism = isochronism(times, data.fit);
  tell("spectrum of the rate, fast and slow drive");
  data.drive = analyse_drive(level, loaded.nominal_period_s, data.fit);
  tell("the drive as it went");
  if (const auto model = drive_model(data.fit, times)) data.history = drive_history(times, *model);
  tell("likely causes");
  data.suspicions = suspicions_of(std::move(times), loaded, data);
  leave_out_drifts_of_free_swings(data.fit, data.suspicions);
  tell("stability");
  const PhaseSeries phase = phase_series(loaded);
  data.deviation = stability_table(DeviationKind::oadev, phase.phase_s, phase.tau0_s,
                                   octave_factors(phase.phase_s.size()));
  data.nut = nut_turns(request, data.now.rate);
  data.sensor = loaded.sensor;
  if (loaded.chosen.empty())
    data.beats.assign(loaded.good.begin(), loaded.good.end());
  else
    data.beats = std::move(loaded.chosen);
  data.log = std::move(loaded.log);
  data.numbered = std::move(loaded.beats);
  if (logbook) data.logbook = check_logbook(*logbook, data, has_plans ? alone : data.fit);
  return data;
}

} // namespace goingrate
