#include "evidence.hpp"

#include "base/scaled_time.hpp"

#include <cmath>
#include <fmt/format.h>

namespace goingrate::timing_model {

namespace {

std::string when(const Candidate& found) {
  return found.is_dated ? fmt::format("{} after the start", time_words(found.at_s, 4))
                        : fmt::format("about {} after the start", time_words(found.at_s));
}

std::string size(const Sizes& sizes) {
  return fmt::format("{:+.3g} ± {:.2g} s/day", sizes.rate[0] * seconds_per_day,
                     sizes.rate_sigma[0] * seconds_per_day);
}

std::string swing(const Sizes& sizes, const char* per) {
  if (sizes.amplitude.empty()) return {};
  return fmt::format(", the amplitude by {:+.3g} ± {:.2g} mrad{}", 1e3 * sizes.amplitude[0],
                     1e3 * sizes.amplitude_sigma[0], per);
}

// If the response lags, only the lag is stated here. Its size is left to covariate_effects(), which
// allows for the uncertainty of the lag.
std::string response_to_temperature(const Candidate& found) {
  if (!(found.time_s > 0.0)) return fmt::format("the rate changes by {} per K", size(found.sizes));
  // The last course is the memory of the time before the log.
  const bool also_at_once = found.sizes.rate.size() > 2;
  return fmt::format("the rate follows the temperature with a lag of {}{}",
                     time_words(found.time_s, 2),
                     also_at_once ? "; another part of its response is immediate" : "");
}

} // namespace

std::string time_words(double seconds, int digits) {
  constexpr double longest_s = 600.0, hour_s = 3600.0, longest_in_hours_s = 48.0 * hour_s;
  if (seconds < longest_s) return fmt::format("{:.{}g} s", seconds, digits);
  if (seconds < longest_in_hours_s) return fmt::format("{:.{}g} h", seconds / hour_s, digits);
  return fmt::format("{:.{}g} days", seconds / seconds_per_day, digits);
}

bool is_step(Cause cause) {
  return cause == Cause::length_step || cause == Cause::drive_step || cause == Cause::friction_step;
}

std::string daily(double rate) { return fmt::format("{:+.3g} s/day", rate * seconds_per_day); }

CauseNumbers numbers_of(const Candidate& found) {
  CauseNumbers numbers;
  const Sizes& sizes = found.sizes;
  if (found.at_s > 0.0) numbers.at_s = found.at_s;
  if (found.cause == Cause::magnet) numbers.until_s = found.time_s;
  if (!sizes.rate.empty()) {
    const bool wave = found.cause == Cause::unlogged_weather;
    numbers.size = wave ? std::hypot(sizes.rate[0], sizes.rate[1]) : sizes.rate[0];
    numbers.sigma = sizes.rate_sigma[0];
  }
  if (!sizes.amplitude.empty()) {
    numbers.amplitude_rad = sizes.amplitude[0];
    numbers.amplitude_sigma_rad = sizes.amplitude_sigma[0];
  }
  return numbers;
}

std::string evidence_of(const Candidate& found, bool sees_amplitude) {
  const Sizes& sizes = found.sizes;
  switch (found.cause) {
  case Cause::temperature:
    return response_to_temperature(found);
  case Cause::pressure:
    return fmt::format("the rate changes by {} per mbar", size(sizes));
  case Cause::unlogged_weather:
    return fmt::format("the rate swings by {:.3g} s/day with the time of day",
                       seconds_per_day * std::hypot(sizes.rate[0], sizes.rate[1]));
  case Cause::length_step:
    return fmt::format("{} the rate changes by {} and stays{}", when(found), size(sizes),
                       sees_amplitude ? "; the amplitude stays the same" : "");
  case Cause::magnet:
    return fmt::format("from {} to {:.3g} h the rate differs by {}", when(found),
                       found.time_s / 3600.0, size(sizes));
  case Cause::drive_step:
    return fmt::format("{} the rate jumps, and once the amplitude has settled it differs by {}{}",
                       when(found), size(sizes), swing(sizes, ""));
  case Cause::friction_step:
    return fmt::format("{} the rate begins to change, without a jump and by {} in the end{}",
                       when(found), size(sizes), swing(sizes, ""));
  default: {
    const char* steady = sees_amplitude ? "; the amplitude stays the same" : "";
    return fmt::format("{}the rate drifts by {} each day{}",
                       found.at_s > 0.0 ? "from " + when(found) + " on " : "", size(sizes),
                       found.courses.amplitude.empty() ? steady : swing(sizes, " each day"));
  }
  }
}

std::string advice_on_grown_friction() {
  return "If nothing was done to the clock then, clean and oil it, and look for what rubs.";
}

std::string advice_on(Cause cause, bool sees_amplitude, const CauseNumbers& numbers) {
  switch (cause) {
  case Cause::temperature:
    return "Heating also changes the oil and the air: compare two seasons before compensating.";
  case Cause::length_step:
    return sees_amplitude ? "What was done to the clock then?"
                          : "What was done to the clock then? A log of the amplitude would show "
                            "whether the drive changed instead.";
  case Cause::friction_step:
    if (numbers.amplitude_rad < 0.0) return advice_on_grown_friction();
    [[fallthrough]];
  case Cause::drive_step:
    return sees_amplitude ? "Was the clock wound, oiled or touched then?"
                          : "Was the clock wound, oiled or touched then? A log of the amplitude "
                            "would show whether the swing followed.";
  case Cause::growing_friction:
    if (numbers.amplitude_rad > 0.0) return {}; // it swings more freely
    return sees_amplitude ? "Clean and oil the clock, or look for what weakens its drive."
                          : "Log the amplitude: growing friction lowers it, a change of the "
                            "pendulum's length does not.";
  default:
    return {};
  }
}

} // namespace goingrate::timing_model
