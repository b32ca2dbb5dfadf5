#include "goingrate/causes/diagnosis.hpp"

#include "candidates.hpp"
#include "change_kinds.hpp"
#include "evidence.hpp"
#include "facts.hpp"
#include "rate_step.hpp"
#include "step_search.hpp"

#include "goingrate/base/pulse.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace goingrate {

namespace {

using namespace timing_model;

ChangeKind kind_of_cause(Cause step) {
  return step == Cause::length_step     ? ChangeKind::regulation
         : step == Cause::friction_step ? ChangeKind::friction
                                        : ChangeKind::drive;
}

constexpr NoiseKinds wandering{.wanders = true};

/// Explains the rate of a log by one cause after another.
class Diagnosis {
public:
  Diagnosis(const DiagnosisInput& input, const TimingData& times)
      : input_(input), times_(times),
        blocks_(rate_blocks(times, std::min<std::size_t>(384, times.size() / 8))),
        healthy_(with_bend_at(input.relaxation_s)), account_(blocks_, healthy_) {}

  std::vector<Suspicion> suspicions() {
    take_causes();
    std::vector<Suspicion> all;
    const std::vector<Candidate> found = faults();
    for (const Candidate& fault : found) {
      const CauseNumbers numbers = numbers_of(fault);
      all.push_back({fault.cause, fault.gain, evidence_of(fault, account_.sees_amplitude()),
                     fault.alternatives, advice_on(fault.cause, account_.sees_amplitude(), numbers),
                     numbers});
    }
    add_if_not_understood(all);
    if (!wanders_) return all;
    // What is not told as a fault is part of the wander.
    std::erase_if(taken_, [](const Candidate& taken) { return taken.is_fault; });
    taken_.insert(taken_.end(), found.begin(), found.end());
    account_ = without(nullptr, healthy_);
    const double gain = account_.gain_of(wandering, 2);
    if (gain > convincing_gain) all.push_back(wander(gain));
    return all;
  }

  // Times of sudden changes that are not dated yet, in order.
  std::vector<double> undated_times() {
    take_causes();
    std::vector<double> times;
    const auto add = [&](double at_s) {
      if (dated_at(at_s) == nullptr) times.push_back(at_s);
    };
    for (const Candidate& fault : faults()) {
      const bool is_visit = fault.cause == Cause::magnet;
      if (is_visit || is_step(fault.cause)) add(fault.at_s);
      if (is_visit) add(fault.time_s);
    }
    std::sort(times.begin(), times.end());
    return times;
  }

  // Uncertainty of the undated times.
  [[nodiscard]] double doubt_s() const { return 1.5 * blocks_.length_s; }

private:
  void take_causes() {
    constexpr std::size_t most_causes = 4; // a log that seems to need more is not understood
    while (taken_.size() < most_causes) {
      pulse();
      Candidate best = best_candidate(input_, blocks_, account_, taken_);
      const double wander = wanders_ ? 0.0 : account_.gain_of(wandering, 2);
      // The noise of a healthy clock is fitted first, unless a fault explains more than any noise.
      if (const Bend bend = best_bend();
          bend.gain > 0.0 && best.gain < std::max(bend.gain, wander)) {
        healthy_ = bend.noise;
        account_.take(healthy_);
        continue;
      }
      if (std::max(best.gain, wander) < least_gain()) break;
      if (wander > best.gain) {
        // A wander absorbs much of any change, so a cause that is significant with it is taken
        // first. A wandering drive, however, imitates changes, whose gain is small compared with
        // that of the wander itself.
        constexpr double least_share = 0.25;
        const Account before = account_;
        account_.take(wandering);
        best = best_candidate(input_, blocks_, account_, taken_);
        if (best.gain < std::max(least_gain(), least_share * wander)) {
          wanders_ = true;
          continue;
        }
        account_ = before;
      }
      account_.take(best.courses);
      taken_.push_back(std::move(best));
    }
  }

  // The gain that a further fault needs: faults are rare, and each additional one is less likely by
  // the same factor.
  [[nodiscard]] double least_gain() const {
    const auto faults = std::count_if(taken_.begin(), taken_.end(),
                                      [](const Candidate& taken) { return taken.is_fault; });
    return convincing_gain * (1.0 + static_cast<double>(faults));
  }

  // Noise of a healthy clock: white, with a corner from its response to white noise of the drive.
  [[nodiscard]] NoiseKinds with_bend_at(const std::optional<double>& relaxation_s) const {
    return {.wanders = false, .corner = relaxation_s ? blocks_.length_s / *relaxation_s : 0.0};
  }

  struct Bend {
    NoiseKinds noise;
    double gain = 0.0;
  };

  // The corner that explains most, if the clock is unknown and no corner has been fitted yet.
  [[nodiscard]] Bend best_bend() const {
    Bend best;
    if (wanders_ || healthy_.corner > 0.0) return best;
    // Range of T0/(4 pi epsilon) in real clocks, in periods. A bend that the log does not show
    // several times over would pass a single drift off as the noise of a healthy clock.
    constexpr double shortest_periods = 10.0, longest_periods = 2e4, fewest_in_log = 6.0;
    const double longest = std::min(longest_periods, times_.elapsed_s.back() /
                                                         input_.nominal_period_s / fewest_in_log);
    for (double periods = shortest_periods; periods < longest; periods *= 2.5) {
      const NoiseKinds bent = with_bend_at(periods * input_.nominal_period_s);
      const double gain = account_.gain_of(bent, 2);
      if (gain > best.gain) best = {bent, gain};
    }
    return best;
  }

  // A dated change has the kind that the diary gives. For another step the kind is found from finer
  // blocks around it.
  [[nodiscard]] Judgement kind_of(const Candidate& step) const {
    if (const Change* dated = dated_at(step.at_s))
      return {.kind = dated->kind,
              .next = dated->next_kind,
              .gain = dated->gain,
              .ahead = dated->kind_gain,
              .at_s = dated->at_s};
    return judge_kind(times_, {0.0, times_.elapsed_s.back()}, step.at_s, doubt_s());
  }

  [[nodiscard]] const Change* dated_at(double at_s) const {
    for (const Change& change : input_.changes)
      if (std::abs(change.at_s - at_s) < 3.0 * blocks_.length_s) return &change;
    return nullptr;
  }

  // The step with the kind that the diary or finer blocks give it. Kinds that the log cannot
  // distinguish from it become alternatives.
  [[nodiscard]] Candidate looked_at_closely(const Candidate& step) const {
    const Judgement found = kind_of(step);
    if (found.kind == ChangeKind::unclear) return step;
    Candidate best = step_candidate(found.kind, found.at_s / blocks_.length_s, account_, blocks_);
    if (best.courses.rate.empty()) return step;
    best.at_s = found.at_s;
    best.is_dated = dated_at(found.at_s) != nullptr;
    // Without amplitudes a lasting step may also be a step of the drive or friction whose
    // relaxation the noise hides.
    const double least = account_.sees_amplitude() || found.kind != ChangeKind::regulation
                             ? convincing_gain
                             : std::numeric_limits<double>::infinity();
    for (const ChangeKind other : {ChangeKind::regulation, ChangeKind::drive, ChangeKind::friction})
      if (other != found.kind && found.ahead < least &&
          (other == found.next || found.kind == ChangeKind::regulation))
        best.alternatives.push_back(cause_of(other));
    return best;
  }

  [[nodiscard]] Sizes sizes_of(const Candidate& found) const {
    const double place = found.at_s / blocks_.length_s;
    if (!is_step(found.cause)) {
      Courses courses = found.courses;
      if (found.at_s > 0.0 && found.cause != Cause::magnet) { // a ramp: the date is uncertain, too
        const auto slope = CourseMaker(blocks_).step(place);
        courses.rate.push_back(slope);
        if (!courses.amplitude.empty()) courses.amplitude.push_back(slope);
      }
      return account_.sizes_of(courses);
    }
    return StepSearch(account_, blocks_, place, 1.0)
        .sizes_of(kind_of_cause(found.cause),
                  {.place = place, .time_s = found.time_s, .courses = found.courses});
  }

  // All causes but one, so that each is judged by what it adds to the others.
  [[nodiscard]] Account without(const Candidate* left_out, const NoiseKinds& noise) const {
    Account account(blocks_, noise);
    for (const Candidate& candidate : taken_)
      if (&candidate != left_out) account.take(candidate.courses);
    return account;
  }

  // Whether a change is significant in at least one of its effects. A step may gain much likelihood
  // merely because it makes wander look smaller.
  static bool stands_out(const Sizes& sizes) {
    constexpr double sigmas = 3.0;
    const auto any = [](const std::vector<double>& values, const std::vector<double>& errors) {
      for (std::size_t i = 0; i < values.size(); ++i)
        if (std::abs(values[i]) > sigmas * errors[i]) return true;
      return false;
    };
    return any(sizes.rate, sizes.rate_sigma) || any(sizes.amplitude, sizes.amplitude_sigma);
  }

  // Faults whose gain over all the others is large enough.
  [[nodiscard]] std::vector<Candidate> faults() {
    std::vector<Candidate> all;
    for (const Candidate& taken : taken_) {
      if (!taken.is_fault) continue;
      account_ = without(&taken, wanders_ ? wandering : healthy_);
      const double gain = account_.gain_of(taken.courses);
      if (gain < convincing_gain) continue;
      Candidate found = is_step(taken.cause) ? looked_at_closely(taken) : taken;
      found.gain = gain;
      found.sizes = sizes_of(found);
      if (is_step(found.cause) && !stands_out(found.sizes)) continue;
      all.push_back(std::move(found));
    }
    return all;
  }

  // Whether the amplitude explains more than half of the wander: then the drive wanders. (In a
  // healthy clock amplitude and rate are slightly correlated as well.)
  [[nodiscard]] bool wanders_with_amplitude() const {
    if (!account_.sees_amplitude()) return false;
    // The drive follows from lambda^2 and its derivative; the derivative is left out if it adds
    // nothing.
    const Courses alone{{blocks_.amplitude_rad}, {}};
    const Courses both{{blocks_.amplitude_rad, speed_of(blocks_.amplitude_rad)}, {}};
    const Courses& amplitude = account_.gain_of(both) > account_.gain_of(alone) ? both : alone;
    Account rest = account_;
    rest.take(amplitude);
    return account_.gain_of(amplitude) > rest.gain_of(wandering, 2);
  }

  static std::vector<double> speed_of(const std::vector<double>& series) {
    std::vector<double> speed(series.size(), 0.0);
    for (std::size_t i = 1; i + 1 < series.size(); ++i)
      speed[i] = 0.5 * (series[i + 1] - series[i - 1]);
    return speed;
  }

  // Two faults at once are rare. Three causes mean that none of the known ones explains the course.
  void add_if_not_understood(std::vector<Suspicion>& all) const {
    constexpr std::size_t implausible_causes = 3;
    if (all.size() < implausible_causes) return;
    double gain = 0.0;
    Account account(blocks_, wanders_ ? wandering : healthy_);
    for (const Candidate& taken : taken_) {
      gain += account.gain_of(taken.courses);
      account.take(taken.courses);
    }
    all.push_back(
        {Cause::unknown,
         gain,
         "no one or two known causes explain the course of this rate",
         {Cause::unlogged_weather, Cause::slow_drive, Cause::length_drift, Cause::log_clock},
         "A longer log, and a note of what was done to the clock, would show more."});
  }

  [[nodiscard]] bool knows_weather() const {
    const auto knows = [&](std::string_view name) {
      return std::any_of(times_.terms.begin(), times_.terms.end(),
                         [&](const RateTerm& term) { return term.name == name; });
    };
    return knows("temperature") && knows("pressure");
  }

  [[nodiscard]] Suspicion wander(double gain) const {
    const char* what = "the rate wanders more than white noise explains";
    std::vector<Cause> outside{Cause::length_drift, Cause::log_clock};
    if (!knows_weather()) outside.insert(outside.begin(), Cause::unlogged_weather);
    if (!account_.sees_amplitude())
      return {Cause::slow_drive, gain, what, outside,
              "Log the amplitude: it distinguishes a wandering drive from all other causes."};
    if (wanders_with_amplitude())
      return {Cause::slow_drive,
              gain,
              fmt::format("{}, and the amplitude with it", what),
              {},
              "Look at the train and its oil: the force that reaches the escapement varies."};
    return {Cause::unknown, gain, fmt::format("{}, and the amplitude does not", what), outside,
            knows_weather() ? "Check the clock of the logger, and what the rod hangs from."
                            : "Log temperature and air pressure too, and check the clock of the "
                              "logger."};
  }

  const DiagnosisInput& input_;
  const TimingData& times_;
  RateBlocks blocks_;
  NoiseKinds healthy_;
  Account account_;
  bool wanders_ = false;
  std::vector<Candidate> taken_;
};

// A dated change that the fit explains.
Suspicion suspicion_of(const Change& change) {
  CauseNumbers numbers;
  numbers.at_s = change.at_s;
  const RateStep step = step_of(change);
  numbers.size = step.rate;
  numbers.sigma = step.sigma;
  return {cause_of(change.kind),
          change.gain,
          fmt::format("{} after the start the rate changes by {}, as in the fitted model",
                      time_words(change.at_s, 4), daily(step.rate)),
          same_course_as(change.kind),
          change.kind == ChangeKind::friction && change.amplitude_slope_change < 0.0
              ? advice_on_grown_friction()
              : "What was done to the clock then?",
          numbers};
}

// Whether the log is long enough to distinguish the courses of different causes.
bool is_long_enough(const DiagnosisInput& input) {
  return input.data != nullptr && input.data->size() >= least_diagnosed_beats;
}

// Causes that explain the course of the rate, and those found without a model of the rate.
void add_suspicions_of_log(const DiagnosisInput& input, std::vector<Suspicion>& all) {
  if (input.data == nullptr) return;
  if (!is_long_enough(input)) { // what was taken off before the fit is sure all the same
    look_at_displacements(input, input.data->displaced, all);
    return;
  }
  const Undisplaced times(*input.data);
  for (Suspicion& suspicion : Diagnosis(input, times.data()).suspicions())
    all.push_back(std::move(suspicion));
  for (Suspicion& fact : suspicions_of_facts(input, times.displaced()))
    all.push_back(std::move(fact));
}

} // namespace

std::vector<Suspicion> diagnose(const DiagnosisInput& input) {
  std::vector<Suspicion> all;
  for (const Change& change : input.explained)
    if (change.kind != ChangeKind::unclear) all.push_back(suspicion_of(change));
  add_suspicions_of_log(input, all);
  std::stable_sort(all.begin(), all.end(),
                   [](const Suspicion& a, const Suspicion& b) { return a.gain > b.gain; });
  return all;
}

void add_small_changes(const DiagnosisInput& input, std::span<const Beat> beats, Diary& diary) {
  if (!is_long_enough(input)) return;
  const Undisplaced times(*input.data);
  Diagnosis diagnosis(input, times.data());
  for (const double at_s : diagnosis.undated_times())
    add_change(times.data(), at_s, diagnosis.doubt_s(), beats, diary.changes);
  put_rates(beats, input.nominal_period_s, diary.changes);
}

} // namespace goingrate
