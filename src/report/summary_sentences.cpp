// What a log says, in a few sentences: first for the owner of the clock, then for the physicist.
#include "goingrate/report/report.hpp"

#include "cause_words.hpp"
#include "fault_counts.hpp"
#include "impulse_words.hpp"
#include "logbook_words.hpp"
#include "model_words.hpp"
#include "moving_rate.hpp"
#include "part_words.hpp"
#include "wording.hpp"

#include "base/scaled_time.hpp"
#include "causes/rate_step.hpp"
#include "log/usual_step.hpp"

#include "goingrate/report/tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <optional>
#include <string_view>
#include <utility>

namespace goingrate {

namespace {

bool sees_amplitude(const Analysis& data) {
  return std::any_of(data.beats.begin(), data.beats.end(),
                     [](const Beat& beat) { return std::isfinite(beat.amplitude_rad); });
}

bool is_in(const Interruption& event, double at_s) {
  return at_s >= event.begin.at_s && at_s <= event.end.at_s;
}

bool is_in_one(const Diary& diary, double at_s) {
  return std::any_of(diary.interruptions.begin(), diary.interruptions.end(),
                     [&](const Interruption& event) { return is_in(event, at_s); });
}

bool is_step(Cause cause) {
  return cause == Cause::drive_step || cause == Cause::friction_step || cause == Cause::length_step;
}

constexpr double dating_share = 0.01; // of the log: dates of one change

bool is_drift(Cause cause) {
  return cause == Cause::growing_friction || cause == Cause::length_drift;
}

// The first turning angle of the fitted swing, known as well as the amplitude that was fitted.
TurningAngle first_swing_of_fit(const FitSummary& fit) {
  const FittedParameter *lambda0 = fit.find("lambda0"), *scale = fit.find("amplitude_scale");
  if (lambda0 == nullptr || !std::isfinite(lambda0->sigma) || fit.model_amplitude_rad.empty())
    return {};
  const bool is_scaled = scale != nullptr && std::isfinite(scale->value);
  const double rad = fit.model_amplitude_rad.front() / (is_scaled ? scale->value : 1.0);
  return {rad, rad * lambda0->sigma / lambda0->value};
}

/// Writes the sentences of one log.
class Sentences {
public:
  explicit Sentences(const Analysis& data)
      : data_(data), words_(data), sees_amplitude_(sees_amplitude(data)) {
    for (const Change& change : data.diary.changes)
      if (!is_in_one(data.diary, change.at_s) && !change.is_only_noted())
        changes_.push_back(&change);
    for (const Suspicion& suspicion : data.suspicions) // an interruption explains its own steps
      if (!(is_step(suspicion.cause) && is_near_an_interruption(suspicion)) &&
          !(suspicion.cause == Cause::stop && stop_is_told(data)))
        suspicions_.push_back(suspicion);
  }

  std::vector<std::string> all() {
    if (swings_freely(data_))
      say_how_it_comes_to_rest();
    else
      say_how_the_clock_goes();
    say(model_sentence(data_, sees_amplitude_, !changes_.empty()), Weight::model);
    leave_out_what_has_no_room();
    std::vector<std::string> told;
    for (Sentence& sentence : sentences_)
      told.push_back(std::move(sentence.text));
    return told;
  }

private:
  // In the order in which they are left out if there is more than a reader can take in.
  enum class Weight { second_cause, model, logbook, trend, dated_cause, main };
  struct Sentence {
    std::string text;
    Weight weight;
  };

  void say(std::string sentence, Weight weight = Weight::main) {
    if (!sentence.empty()) sentences_.push_back({std::move(sentence), weight});
  }

  // One text may be two sentences: what is seen, and what to do about it.
  [[nodiscard]] std::size_t count() const {
    std::size_t count = 0;
    for (const Sentence& sentence : sentences_)
      count += sentences_in(sentence.text);
    return count;
  }

  void leave_out_what_has_no_room() {
    constexpr std::size_t most_sentences = 6;
    while (count() > most_sentences) {
      const auto least = std::min_element(
          sentences_.begin(), sentences_.end(),
          [](const Sentence& a, const Sentence& b) { return a.weight < b.weight; });
      if (least->weight == Weight::main) return;
      sentences_.erase(least);
    }
  }

  void say_how_the_clock_goes() {
    say(going());
    say(which_part(data_, words_));
    say(every_nth());
    for (const Interruption& event : data_.diary.interruptions)
      if (&event == &data_.diary.interruptions.front()) say(interruption(event));
    // A change without a date of its own adds little to the cause.
    say(whether_worse(),
        changes_.empty() && !suspicions_.empty() ? Weight::trend : Weight::main);
    say(out_of_beat(), Weight::second_cause);
    if (data_.logbook && !data_.logbook->entries.empty())
      say(logbook_sentence(*data_.logbook, words_), Weight::logbook);
    say_what_it_suffers_from();
    say(pushes(), Weight::logbook);
    say(what_to_do());
  }

  void say_what_it_suffers_from();
  [[nodiscard]] std::string fall_of_swing() const;
  void say_how_it_comes_to_rest();
  [[nodiscard]] std::string going() const;
  [[nodiscard]] std::string interruption(const Interruption& event) const;
  [[nodiscard]] std::string trend_of_few_beats() const;
  [[nodiscard]] std::string trend(bool told_a_change) const;
  [[nodiscard]] std::string whether_worse() const;
  [[nodiscard]] std::string changes() const;
  [[nodiscard]] std::string when_it_changed() const;
  [[nodiscard]] std::string out_of_beat() const;
  [[nodiscard]] std::string zero_rate() const;
  [[nodiscard]] std::string pushes() const;
  [[nodiscard]] std::string what_to_do() const;
  [[nodiscard]] std::string rate_words(double rate, double sigma) const;
  [[nodiscard]] std::string every_nth() const;
  [[nodiscard]] bool moves_on() const;
  [[nodiscard]] bool has_settled() const;
  [[nodiscard]] bool escapement_angle_changed(double at_s) const;
  [[nodiscard]] bool is_near_an_interruption(const Suspicion& suspicion) const;
  [[nodiscard]] bool has(bool (*kind)(Cause)) const {
    return std::any_of(suspicions_.begin(), suspicions_.end(),
                       [&](const Suspicion& suspicion) { return kind(suspicion.cause); });
  }

  const Analysis& data_;
  Wording words_;
  bool sees_amplitude_;
  std::vector<const Change*> changes_; // those that are not part of an interruption
  std::vector<Suspicion> suspicions_;  // those that no interruption covers
  std::vector<Sentence> sentences_;
};

bool Sentences::is_near_an_interruption(const Suspicion& suspicion) const {
  constexpr double blocks = 384.0; // blocks for judging causes: a date is good to one block
  const double doubt_s = 2.0 * data_.rate.duration_s / blocks;
  const auto& all = data_.diary.interruptions;
  return std::any_of(all.begin(), all.end(), [&](const Interruption& event) {
    return suspicion.numbers.at_s > event.begin.at_s - doubt_s &&
           suspicion.numbers.at_s < event.end.at_s + doubt_s;
  });
}

std::string Sentences::rate_words(double rate, double sigma) const {
  constexpr double least_significance = 2.0; // sigma: below this, the sign is open
  return std::abs(rate) > least_significance * sigma ? words_.going(rate, sigma)
                                                     : "has a rate of " + words_.rate(rate, sigma);
}

// Whether the rate at the end differs from the mean rate of the last stretch.
// Whether the swing has had the time to follow the last change.
bool Sentences::has_settled() const {
  constexpr double relaxations = 7.0; // after which a thousandth is left
  return !changes_.empty() && data_.drive.response &&
         two_pi * data_.drive.response->corner_hz *
                 (data_.rate.duration_s - changes_.back()->at_s) >
             relaxations;
}

bool Sentences::moves_on() const {
  return !data_.stretches.empty() && data_.now.from_cycle > data_.stretches.back().from_cycle;
}

std::string Sentences::going() const {
  const RateSummary& rate = data_.rate;
  const bool is_whole = data_.numbered.segments < 2;
  const std::string span = words_.duration(rate.duration_s);
  const std::string log = is_whole ? "this log" : "the longest part of this log";
  if (!rate.nominal_is_known)
    return fmt::format("Whether this clock gains or loses is not known, because no nominal period "
                       "is; over {} its mean period is {} s.",
                       span, with_sigma(rate.mean_period_s, rate.mean_period_sigma_s, 12));
  const RateSummary& now = data_.now.rate;
  const std::string how = rate_words(now.rate_excess, now.rate_excess_sigma);
  const bool is_zero = std::abs(now.rate_excess) <= 2.0 * now.rate_excess_sigma;
  const std::string guess = // the log or its owner may have stated the period, or it needs none
      data_.log.nominal_period_s || has_no_period(data_.log)
          ? ""
          : fmt::format(", if its period should be {:.9g} s", rate.nominal_period_s);
  if (moves_on())
    return fmt::format("In the last {} of {} of {} the clock {}{}.",
                       words_.duration(now.duration_s), log, span, how, guess);
  if (data_.stretches.size() > 1) return fmt::format("The clock now {}{}.", how, guess);
  return is_zero ? fmt::format("Over the {} of {} the clock neither gains nor loses beyond "
                               "what the log can tell: its rate is {}{}.",
                               span, log, words_.rate(now.rate_excess, now.rate_excess_sigma),
                               guess)
                 : fmt::format("Over the {} of {} the clock {}{}.", span, log, how, guess);
}

// The commonest mistake is to give half the period as the period.
std::string Sentences::every_nth() const {
  const std::int64_t step = usual_step(data_.beats);
  if (step < 2) return {};
  const double nominal_s = data_.rate.nominal_period_s;
  const bool is_thinned = data_.rate.crossings > static_cast<std::int64_t>(data_.beats.size());
  if (is_thinned)
    return fmt::format("Of this long log one beat in {} was taken for the analysis.", step);
  if (step > 2)
    return fmt::format("The log holds one in {} of the swings, whose period should be {:.6g} s.",
                       step, nominal_s);
  return fmt::format(
      "Every second beat is missing: a period is there and back, tick and tock, and "
      "if that takes {:.6g} s here, the rate holds all the same, but the period and the "
      "fitted model are those of another clock.",
      2.0 * nominal_s);
}

std::string Sentences::interruption(const Interruption& event) const {
  std::string text = fmt::format("From {} the drive was interrupted",
                                 words_.span(event.begin.at_s, event.end.at_s));
  if (std::isfinite(event.amplitude_before_rad + event.amplitude_after_rad))
    text +=
        fmt::format(": the swing fell from {} to {}", words_.angle(event.amplitude_before_rad, 0.0),
                    words_.angle(event.amplitude_after_rad, 0.0));
  const std::size_t more = data_.diary.interruptions.size() - 1;
  if (more > 0) text += fmt::format("; {} more such interruption{}", more, more > 1 ? "s" : "");
  return text + ".";
}

std::string Sentences::changes() const {
  if (changes_.empty()) return {};
  const Change& first = *changes_.front();
  if (changes_.size() == 1 && data_.stretches.size() == 2) {
    const RateSummary& before = data_.stretches[0].rate;
    const RateSummary& after = data_.stretches[1].rate;
    const RateStep step = known_jump(first).value_or(
        RateStep{after.rate_excess - before.rate_excess,
                 std::hypot(own_rate_sigma(before), own_rate_sigma(after))});
    // Weather may hide a change in the two means that shows between neighbouring beats.
    constexpr double least_told = 2.0; // sigma
    // If the time base leaves the rate open, its changes may still be known.
    if (!data_.rate.nominal_is_known || data_.rate.time_base_sigma > 0.0)
      return "The rate changed " + when_it_changed() +
             (std::abs(step.rate) < least_told * step.sigma
                  ? ""
                  : ", by " + words_.rate(step.rate, step.sigma));
    return fmt::format(
        "The rate changed {}, from {} before to {}{} after{}", words_.moment(first.at_s),
        words_.rate(before.rate_excess, before.rate_excess_sigma), moves_on() ? "a mean of " : "",
        words_.rate(after.rate_excess, after.rate_excess_sigma),
        moves_on() ? ", and it has moved on since" : "");
  }
  if (changes_.size() == 2 && data_.stretches.size() == 3 && data_.rate.nominal_is_known &&
      data_.rate.time_base_sigma == 0.0) {
    const auto rate_of = [&](std::size_t stretch) {
      const RateSummary& rate = data_.stretches[stretch].rate;
      return words_.rate(rate.rate_excess, rate.rate_excess_sigma);
    };
    return fmt::format("The rate changed {}: from {} before to {} between and {}{} after",
                       when_it_changed(), rate_of(0), rate_of(1), moves_on() ? "a mean of " : "",
                       rate_of(2));
  }
  return "The rate changed " + when_it_changed();
}

std::string Sentences::when_it_changed() const {
  const double first_s = changes_.front()->at_s, last_s = changes_.back()->at_s;
  if (changes_.size() == 1) return words_.moment(first_s);
  if (changes_.size() == 2) return "twice, " + words_.moments(first_s, last_s);
  return fmt::format("{} times, first {} and last {}", changes_.size(), words_.moment(first_s),
                     words_.moment(last_s));
}

// The share of the period that 2 ms on a timegrapher are in a watch of 18,000 beats per hour.
std::string Sentences::out_of_beat() const {
  constexpr double least_share = 0.01; // of the period: tick minus tock
  const auto& error = data_.sensor.beat_error_s;
  if (!error || std::abs(error->value) < least_share * data_.rate.mean_period_s) return {};
  return fmt::format("Tick and tock differ by {}: the clock is out of beat{}.",
                     short_time(std::abs(error->value), error->sigma),
                     data_.log.sound ? "" : ", or the sensor is off the vertical");
}

// What a log tells whose beats are too few to judge trends and their causes.
std::string Sentences::trend_of_few_beats() const {
  if (const std::string moving = moving_rate(data_, words_); changes_.empty() && !moving.empty())
    return moving;
  return fmt::format("the log is too short, with {} {}, to tell whether it is getting worse",
                     data_.beats.size(),
                     event_word(has_no_period(data_.log), data_.rate.nominal_period_s));
}

std::string Sentences::trend(bool told_a_change) const {
  if (data_.beats.size() < least_diagnosed_beats) return trend_of_few_beats();
  if (!suspicions_.empty() && is_drift(suspicions_.front().cause))
    return std::isfinite(suspicions_.front().numbers.at_s)
               ? "the rate was steady at first, and has moved in one direction since"
               : "the rate has moved in one direction throughout this log";
  if (has(is_drift)) return "besides, the rate has drifted through this log";
  if (has([](Cause cause) { return cause == Cause::slow_drive || cause == Cause::unknown; }))
    return "the rate is not steady, but shows no trend through the log";
  if (suspicions_.empty() && !stop_is_told(data_) && out_of_beat().empty())
    return changes_.empty() && data_.diary.interruptions.empty()
               ? "nothing in this log shows that anything is wrong with the clock, or that it is "
                 "getting worse"
               : "apart from that, nothing shows that anything is wrong with the clock, or that it "
                 "is getting worse";
  return told_a_change ? "no other trend shows in this log"
                       : "nothing in this log shows that the clock is getting worse";
}

std::string Sentences::whether_worse() const {
  const std::string told = changes();
  const std::string besides = trend(!told.empty());
  return capitalised(told.empty() ? besides : told + "; " + besides) + ".";
}

// Only one cause can be the most likely: later sentences lose the superlative.
std::string less_likely(std::string explanation) {
  constexpr std::string_view superlative = "ost likely"; // at the beginning or within
  const std::size_t at = explanation.find(superlative);
  if (at == std::string::npos || at == 0) return explanation;
  const bool begins = explanation[at - 1] == 'M';
  return explanation.replace(at - 1, superlative.size() + 1, begins ? "Probably" : "probably");
}

// Whether the change that the fit has at this time is of that angle alone.
bool Sentences::escapement_angle_changed(double at_s) const {
  return std::any_of(data_.fit.events.begin(), data_.fit.events.end(), [&](const FitEvent& event) {
    const double event_s = static_cast<double>(event.cycle) * data_.rate.mean_period_s;
    return !event.names.empty() &&
           std::abs(event_s - at_s) < dating_share * data_.rate.duration_s &&
           std::all_of(event.names.begin(), event.names.end(), [](const std::string& name) {
             return name == "phi0" || name == "impulse_angle";
           });
  });
}

// The likeliest cause, and the likeliest of another kind.
void Sentences::say_what_it_suffers_from() {
  if (suspicions_.empty()) return;
  const Suspicion& first = suspicions_.front();
  const auto is_told = [&](const Suspicion& step) {
    return changes_.size() == 1 && is_step(step.cause) &&
           std::abs(step.numbers.at_s - changes_.front()->at_s) <
               dating_share * data_.rate.duration_s;
  };
  const std::string advice = first.advice.empty() ? "" : " " + first.advice;
  const std::string_view drive = escapement_angle_changed(first.numbers.at_s)
                                     ? "the angle at which the escapement acts"
                                     : driving_force;
  say(explanation(first, words_, sees_amplitude_, is_told(first) ? "then" : "", drive) + advice);
  const auto other = std::find_if(suspicions_.begin(), suspicions_.end(),
                                  [&](const Suspicion& s) { return s.cause != first.cause; });
  if (other != suspicions_.end())
    say(less_likely(explanation(*other, words_, sees_amplitude_,
                                is_told(*other) ? "when the rate did" : "")),
        is_step(other->cause) ? Weight::dated_cause : Weight::second_cause);
}

// The adjustment that brings the rate to zero; empty if the log cannot tell the rate from zero.
std::string Sentences::zero_rate() const {
  const RateSummary& now = data_.now.rate;
  if (data_.nut)
    return fmt::format("{} the bob by {} turns of the rating nut ({:.3g} mm), to bring the rate to "
                       "zero.",
                       data_.nut->turns < 0.0 ? "lower" : "raise",
                       with_sigma(std::abs(data_.nut->turns), data_.nut->sigma, 3),
                       1e3 * std::abs(data_.nut->raise_m));
  if (!(std::abs(now.rate_excess) > 2.0 * now.rate_excess_sigma)) return {};
  const bool is_slow = now.rate_excess < 0.0;
  constexpr double slowest_balance_s = 0.5; // a chronometer's: 14,400 beats an hour
  const std::string balance =
      data_.rate.nominal_period_s > slowest_balance_s
          ? ""
          : fmt::format(" (of a balance: move the regulator towards {})", is_slow ? "fast" : "slow");
  return fmt::format("turn the rating nut so that the bob goes {}{}, to bring the rate to zero.",
                     is_slow ? "up" : "down", balance);
}

std::string Sentences::pushes() const {
  if (!data_.fit.impulses) return {};
  const ImpulseCycle& found = *data_.fit.impulses;
  std::string text = fmt::format("The pendulum is pushed {}", how_often(found));
  if (!found.epsilon) return text + ".";
  return text +
         fmt::format(
             "; each push widens the swing by {}, and if nothing else drives it, its Q is {}.",
             words_.angle(found.amplitude_step->value, found.amplitude_step->sigma),
             quality_of(found));
}

std::string Sentences::what_to_do() const {
  if (!data_.rate.nominal_is_known)
    return "State the period that the clock should have, and this report will give its rate.";
  if (const std::string nut = zero_rate(); !nut.empty()) {
    // A wandering rate never settles.
    const bool settles = moves_on() && changes_.size() == 1 && !has_settled();
    return settles ? "Once the rate has come to rest, " + nut : capitalised(nut);
  }
  if (!suspicions_.empty()) return "";
  return data_.beats.size() < least_diagnosed_beats ? "A longer log would tell more."
                                                    : "There is nothing to do.";
}

// How far it swings, as far as the log determines it: times alone may fit swings of many sizes.
std::string Sentences::fall_of_swing() const {
  TurningAngle first, last;
  if (data_.fit.decay) {
    first = data_.fit.decay->first;
    last = data_.fit.decay->last;
  } else {
    first = first_swing_of_fit(data_.fit);
  }
  if (!std::isfinite(first.rad)) return {};
  const std::string begin = words_.angle(first.rad, first.sigma_rad);
  if (!std::isfinite(last.rad)) return fmt::format(": its swing is {} at first", begin);
  return fmt::format(": its swing falls from {} to {}", begin,
                     words_.angle(last.rad, last.sigma_rad));
}

// A dark time gives half of the amplitude if the period is taken for half as long as it is.
std::string size_of_logged_amplitudes(const FittedParameter& scale) {
  constexpr double tolerance = 0.01, sigmas = 3.0; // of a half
  const std::string told = fmt::format("The amplitudes in the log are {} of the true ones: the "
                                       "period, which wide swings lengthen, tells.",
                                       with_sigma(scale.value, scale.sigma));
  if (!(std::abs(scale.value - 0.5) < std::max(tolerance, sigmas * scale.sigma))) return told;
  return told + " They are half where both passages of each swing are in a log that was read as if "
                "it had one: then the period is twice and Q half of what is given here.";
}

void Sentences::say_how_it_comes_to_rest() {
  const FitSummary& fit = data_.fit;
  const FittedParameter* scale = fit.find("amplitude_scale");
  const bool is_scaled = scale != nullptr && std::isfinite(scale->value);
  say(fmt::format("This pendulum swings freely for {}{}.", words_.duration(data_.rate.duration_s),
                  fall_of_swing()));
  if (is_scaled) say(size_of_logged_amplitudes(*scale));
  if (fit.decay) say(decay_sentences(*fit.decay));
  const FittedParameter* period = fit.find("T0");
  if (period != nullptr && std::isfinite(period->value))
    say(fmt::format("Its small swings would take {} s; wide ones take longer, which is why the "
                    "period changes as it comes to rest.",
                    with_sigma(period->value, period->sigma, 10)));
  if (!suspicions_.empty()) say(explanation(suspicions_.front(), words_, sees_amplitude_));
}

} // namespace

std::vector<std::string> report_sentences(const Analysis& data) { return Sentences(data).all(); }

} // namespace goingrate
