#include "cause_words.hpp"

#include <cmath>
#include <fmt/format.h>
#include <vector>

namespace goingrate {

namespace {

std::string one_of(const std::vector<Cause>& causes) {
  std::vector<std::string> names;
  for (const Cause cause : causes)
    names.emplace_back(owners_name(cause));
  return listed(names, "or");
}

/// Explains one suspicion in words.
class Explanation {
public:
  Explanation(const Suspicion& suspicion, const Wording& words, bool sees_amplitude,
              std::string_view when, std::string_view drive)
      : suspicion_(suspicion), numbers_(suspicion.numbers), words_(words),
        sees_amplitude_(sees_amplitude), when_(when), drive_(drive) {}

  [[nodiscard]] std::string text() const {
    std::string sentence = seen_and_meant();
    if (!suspicion_.alternatives.empty())
      sentence += fmt::format("; {} {}",
                              suspicion_.cause == Cause::unknown ? "it may be"
                                                                 : "this log cannot tell that from",
                              one_of(suspicion_.alternatives));
    return capitalised(sentence) + ".";
  }

private:
  [[nodiscard]] std::string seen_and_meant() const {
    switch (suspicion_.cause) {
    case Cause::drive_step:
    case Cause::friction_step:
    case Cause::length_step:
      return step();
    case Cause::slow_drive:
    case Cause::unknown:
      return wander();
    case Cause::growing_friction:
      return fmt::format("{}the rate {} by {} each day{}: most likely {}", since(),
                         falls_or_rises(), size(), swing(" each day"),
                         numbers_.amplitude_rad > 0.0 ? "friction lessens, or the drive grows"
                                                      : "friction grows, or the drive fades");
    case Cause::length_drift:
      return fmt::format("{}the rate {} by {} each day{}: most likely the pendulum's length "
                         "drifts, as it does while {}",
                         since(), falls_or_rises(), size(),
                         sees_amplitude_ ? " and the swing does not follow" : "",
                         numbers_.size < 0.0 ? "a suspension stretches" : "a wooden rod dries");
    case Cause::temperature:
      return fmt::format("the rate follows the temperature: it {} by {} per kelvin",
                         falls_or_rises(), size());
    case Cause::pressure:
      return fmt::format("the rate follows the air pressure: it {} by {} per millibar",
                         falls_or_rises(), size());
    case Cause::unlogged_weather:
      return fmt::format(
          "the rate swings by {} either way with the time of day: most likely it "
          "follows the temperature or the air pressure, which this log does not hold",
          size());
    case Cause::magnet:
      return fmt::format("from {} the rate is {} by {} than before and after: perhaps something "
                         "was brought near the pendulum, or laid on it, and taken away again",
                         words_.span(numbers_.at_s, numbers_.until_s),
                         numbers_.size < 0.0 ? "lower" : "higher", size());
    default:
      return fact();
    }
  }

  [[nodiscard]] std::string step() const {
    const std::string moment = when_.empty() ? words_.moment(numbers_.at_s) : std::string(when_);
    const std::string by = when_.empty() ? fmt::format(", by {} in the end", signed_size()) : "";
    switch (suspicion_.cause) {
    case Cause::drive_step:
      return fmt::format("most likely {} changed {}: the rate jumped at once and then moved on{}",
                         drive_, moment, by);
    case Cause::friction_step:
      return fmt::format("most likely the friction changed {}: the rate did not jump, it moved as "
                         "the swing did{}",
                         moment, by);
    default:
      return fmt::format("most likely the regulation changed {} (the rating nut, a weight on the "
                         "bob, the suspension): the rate changed at once{} and stayed{}",
                         moment, when_.empty() ? fmt::format(" by {}", signed_size()) : "",
                         sees_amplitude_ ? ", and the swing did not follow" : "");
    }
  }

  [[nodiscard]] std::string wander() const {
    if (suspicion_.cause == Cause::unknown)
      return "what makes it is not known: " + suspicion_.evidence;
    return sees_amplitude_ ? "rate and swing wander together: most likely the drive is not steady"
                           : "the rate wanders: most likely the drive is not steady";
  }

  // What the numbering and the spectrum show.
  [[nodiscard]] std::string fact() const {
    switch (suspicion_.cause) {
    case Cause::wheel:
      return fmt::format("the rate swings by {} either way every {:.5g} s: most likely a wheel of "
                         "the train, or something moved by one, turns once in that time",
                         size(), numbers_.period_s);
    case Cause::sensor_shift:
      if (words_.is_read())
        return fmt::format(
            "{} the clock begins to show {} {} than before{}, and goes on as it did: "
            "most likely its hands were set",
            words_.moment(numbers_.at_s), short_time(std::abs(numbers_.size), 0.0),
            numbers_.size < 0.0 ? "more" : "less",
            numbers_.places > 1 ? fmt::format(", the largest of {} such leaps", numbers_.places)
                                : "");
      return fmt::format(
          "{} the beats begin to come {} {} than before, and the clock goes on as it "
          "did: most likely the sensor was moved",
          words_.moment(numbers_.at_s), short_time(std::abs(numbers_.size), 0.0), late_or_early());
    case Cause::knock:
      return fmt::format("the times jump in {} places, farthest {}, where the beats begin to come "
                         "{} {}, and the clock goes on as it did: most likely it was knocked",
                         numbers_.places, words_.moment(numbers_.at_s),
                         short_time(std::abs(numbers_.size), 0.0), late_or_early());
    case Cause::missed_beats:
      return fmt::format("the sensor missed {:.2g} % of the beats, in {} places",
                         100.0 * numbers_.size, numbers_.places);
    case Cause::stop:
      return fmt::format(
          "{} the clock stopped, and was started again; only one side of the stop is "
          "analysed",
          words_.moment(numbers_.at_s));
    default:
      return suspicion_.evidence;
    }
  }

  // Of a drift that begins within the log.
  [[nodiscard]] std::string since() const {
    return std::isfinite(numbers_.at_s) ? "beginning " + words_.moment(numbers_.at_s) + ", " : "";
  }

  [[nodiscard]] std::string_view falls_or_rises() const {
    return numbers_.size < 0.0 ? "falls" : "rises";
  }

  [[nodiscard]] std::string_view late_or_early() const {
    return numbers_.size < 0.0 ? "earlier" : "later";
  }

  [[nodiscard]] std::string signed_size() const {
    return fmt::format("{}{}", numbers_.size < 0.0 ? '-' : '+', size());
  }

  [[nodiscard]] std::string size() const {
    return words_.size_of_rate(numbers_.size, numbers_.sigma);
  }

  [[nodiscard]] std::string swing(const char* per) const {
    if (!std::isfinite(numbers_.amplitude_rad)) return {};
    return fmt::format(", the swing {} by {}{}", numbers_.amplitude_rad < 0.0 ? "falls" : "rises",
                       words_.angle(std::abs(numbers_.amplitude_rad), numbers_.amplitude_sigma_rad),
                       per);
  }

  const Suspicion& suspicion_;
  const CauseNumbers& numbers_;
  const Wording& words_;
  bool sees_amplitude_;
  std::string_view when_, drive_;
};

} // namespace

std::string_view owners_name(Cause cause) {
  switch (cause) {
  case Cause::slow_drive:
    return "a drive that is not steady";
  case Cause::drive_step:
    return "a change of the drive";
  case Cause::friction_step:
    return "a change of the friction";
  case Cause::growing_friction:
    return "growing friction";
  case Cause::temperature:
    return "the temperature";
  case Cause::pressure:
    return "the air pressure";
  case Cause::length_step:
    return "a change of the regulation";
  case Cause::wheel:
    return "a wheel of the train";
  case Cause::sensor_shift:
    return "a sensor that was moved";
  case Cause::missed_beats:
    return "missed beats";
  case Cause::rough_drive:
    return "a rough drive";
  case Cause::length_drift:
    return "a pendulum whose length drifts";
  case Cause::log_clock:
    return "a fault of the logger's own clock";
  case Cause::unlogged_weather:
    return "weather that was not logged";
  case Cause::knock:
    return "a knock";
  case Cause::magnet:
    return "a magnet or a weight brought near";
  case Cause::stop:
    return "a stop";
  case Cause::unknown:
    break;
  }
  return "something else";
}

std::string explanation(const Suspicion& suspicion, const Wording& words, bool sees_amplitude,
                        std::string_view when, std::string_view drive) {
  return Explanation(suspicion, words, sees_amplitude, when, drive).text();
}

} // namespace goingrate
