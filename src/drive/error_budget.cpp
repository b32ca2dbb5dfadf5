#include "goingrate/drive/error_budget.hpp"

#include "rate_components.hpp"
#include "time_error.hpp"

#include "base/scaled_time.hpp"
#include "goingrate/base/errors.hpp"
#include "goingrate/dynamics/intermittent.hpp"
#include "goingrate/dynamics/moments.hpp"
#include "goingrate/dynamics/stationary.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

namespace goingrate {

using std::numbers::pi;

namespace {

// The clock with its drive times a factor.
ClockParameters driven(const ClockParameters& clock, double factor) {
  ClockParameters other = with_drive_divided(clock, 1.0 / factor);
  other.every = clock.every;
  other.below = clock.below;
  return other;
}

// How the rate responds to the drive, and how many periods share one factor of the drive.
struct RateResponse {
  DriveResponse response;
  double periods_per_factor = 1.0;
};

// An escapement that waits for the amplitude to fall begins each wait at its limit, whatever the
// previous impulse was. So the whole effect of an impulse on the clock's time has come when the
// limit is reached, and the rate responds to the drive at once.
RateResponse response_of_waiting(const ClockParameters& clock, double lambda) {
  constexpr double step = 1e-3; // relative; the central difference is then good to some 1e-6
  const auto rate = [&](double factor) {
    return stationary_rate_first_order(driven(clock, factor)).value_or(0.0);
  };
  const double periods = drive_moments(clock, lambda).a / friction_moment(clock, lambda);
  DriveResponse response;
  response.fast_gain = (rate(1.0 + step) - rate(1.0 - step)) / (2.0 * step);
  response.slow_gain = response.fast_gain;
  response.corner_hz = 1.0 / (periods * clock.nominal_period_s);
  return {response, periods};
}

// In first order, for any law: rate = -s lambda^2/16 - f b/lambda, lambda' = f a - friction, f
// being the drive's factor.
RateResponse rate_response(const ClockParameters& clock) {
  const auto lambda = stationary_amplitude(clock);
  if (!lambda)
    throw ArgumentError("clock", name_of(clock.escapement),
                        "a clock with a stationary swing: this one stalls, or has no drive or no "
                        "friction");
  if (waits_for_amplitude(clock)) return response_of_waiting(clock, *lambda);
  // An escapement that acts once in N periods, with N times the mean impulse, takes the factor of
  // the drive of that period alone.
  const auto periods =
      static_cast<double>(clock.below > 0.0 ? fewest_periods_between_actions(clock) : clock.every);
  const ClockParameters mean = with_drive_divided(clock, periods);
  const auto growth = [&](double at) {
    return drive_moments(mean, at).a - friction_moment(mean, at);
  };
  const auto rate = [&](double at) {
    return -mean.gravity_share * at * at / 16.0 - drive_moments(mean, at).b / at;
  };
  const double step = 1e-5 * *lambda; // central differences are then good to some 1e-10
  const auto slope = [&](const auto& of) {
    return (of(*lambda + step) - of(*lambda - step)) / (2.0 * step);
  };
  const double relaxation = -slope(growth);
  DriveResponse response;
  response.fast_gain = -drive_moments(mean, *lambda).b / *lambda;
  response.slow_gain =
      response.fast_gain + slope(rate) * drive_moments(mean, *lambda).a / relaxation;
  response.corner_hz = relaxation / clock.nominal_period_s;
  return {response, periods};
}

// The error, rms over the phase of the sine, at the worst moment up to `after_s`.
double error_of_sine(double rate, double period_s, double after_s) {
  const double turns = std::min(0.5, after_s / period_s);
  return std::abs(rate) * period_s / (std::numbers::sqrt2 * pi) * std::sin(pi * turns);
}

// Adds what all sines of one cause do together; `rate_of` gives the amplitude of the rate for a
// sine.
template <class Sines, class Rate>
void add_sines(const Sines& sines, const char* cause, const char* key, double after_s, Rate rate_of,
               std::vector<ErrorPart>& parts) {
  double size2 = 0.0, error2 = 0.0;
  for (const auto& sine : sines) {
    size2 += sine.amplitude * sine.amplitude;
    error2 += std::pow(error_of_sine(rate_of(sine), sine.period_s, after_s), 2);
  }
  if (error2 > 0.0) parts.push_back({cause, key, std::sqrt(size2), std::sqrt(error2)});
}

void add_drive(const Scenario& scenario, double after_s, std::vector<ErrorPart>& parts) {
  const DriveVariability& drive = scenario.drive;
  if (drive.series)
    throw ArgumentError("drive.series", "a series",
                        "given by rms values and sines: a series does not say how the drive "
                        "continues");
  const auto [response, periods_per_factor] = rate_response(scenario.clock);
  timing_model::RateComponents components;
  components.fast2 = drive.fast_rms * drive.fast_rms * periods_per_factor;
  components.slow2 = drive.slow_rms * drive.slow_rms;
  components.memory_s = drive.slow_time_s;
  const double period_s = scenario.clock.nominal_period_s;
  const auto error = [&](auto density) { return time_error(density, after_s, period_s); };
  if (drive.fast_rms > 0.0)
    parts.push_back({"the drive, from swing to swing", "drive.fast_rms", drive.fast_rms,
                     error([&, &response = response](double f) {
                       return components.fast_density(f, period_s, response);
                     })});
  if (drive.slow_rms > 0.0)
    parts.push_back({"the drive, slow wander", "drive.slow_rms", drive.slow_rms,
                     error([&, &response = response](double f) {
                       return components.slow_density(f, period_s, response);
                     })});
  add_sines(
      drive.sines, "the drive, periodic part", "drive.sine", after_s,
      [&, &response = response](const auto& sine) {
        return sine.amplitude * std::abs(response.at(1.0 / sine.period_s));
      },
      parts);
}

void add_drift(double change_per_day, double rate_per_change, const char* cause, const char* key,
               double size, double after_s, std::vector<ErrorPart>& parts) {
  const double error =
      0.5 * std::abs(change_per_day * rate_per_change) / seconds_per_day * after_s * after_s;
  if (error > 0.0) parts.push_back({cause, key, size, error});
}

double sum_of_squares(const std::vector<ErrorPart>& parts) {
  double sum = 0.0;
  for (const ErrorPart& part : parts)
    sum += part.rms_s * part.rms_s;
  return sum;
}

void add_length(const Scenario& scenario, double after_s, std::vector<ErrorPart>& parts) {
  const LengthChanges& length = scenario.length;
  // The relative rate per K that the compensation leaves, at this period of the temperature.
  const auto per_kelvin = [&](double period_s) {
    const std::complex<double> lag(1.0, two_pi * length.compensation_lag_s / period_s);
    return 0.5 * std::abs(length.temperature_coefficient - length.compensation / lag);
  };
  std::vector<ErrorPart> warmth;
  add_sines(
      scenario.temperature.sines, "", "", after_s,
      [&](const auto& sine) { return per_kelvin(sine.period_s) * sine.amplitude; }, warmth);
  constexpr double no_end = std::numeric_limits<double>::infinity();
  add_drift(scenario.temperature.drift_per_day, per_kelvin(no_end), "", "", 0.0, after_s, warmth);
  const double error2 = sum_of_squares(warmth);
  if (error2 > 0.0)
    parts.push_back({"the temperature, by the length", "length.temperature_coefficient",
                     std::abs(length.temperature_coefficient), std::sqrt(error2)});
  add_sines(
      length.sines, "the length, periodic part", "length.sine", after_s,
      [](const auto& sine) { return 0.5 * sine.amplitude; }, parts);
  add_drift(length.drift_per_day, 0.5, "the length, steady drift", "length.drift_per_day",
            std::abs(length.drift_per_day), after_s, parts);
}

// The value nearest to `present`, by factors of `step`, between `low` and `high` at which `error`
// falls below `most`; if it is below at present, the value at which it no longer is.
std::optional<double> nearest_limit(const std::function<double(double)>& error, double present,
                                    double most, double low, double high, double step = 1.02) {
  const bool holds = error(present) <= most;
  const auto changes = [&](double value) { return (error(value) <= most) != holds; };
  double up = present, down = present;
  low = std::min(low, present);
  high = std::max(high, present);
  while (up < high || down > low) {
    for (double* side : {&up, &down}) {
      const double before = *side;
      const double next =
          side == &up ? std::min(before * step, high) : std::max(before / step, low);
      if (next == before) continue;
      *side = next;
      if (!changes(next)) continue;
      double inside = before, outside = next;
      for (int i = 0; i < 20; ++i) { // a step halved 20 times
        const double middle = std::sqrt(inside * outside);
        (changes(middle) ? outside : inside) = middle;
      }
      return holds ? inside : outside;
    }
  }
  return {};
}

} // namespace

double ErrorBudget::all_s() const { return std::sqrt(sum_of_squares(parts)); }

ErrorBudget error_budget(const Scenario& scenario, double after_s) {
  check(scenario.clock);
  if (!(after_s > 0.0 && std::isfinite(after_s)))
    throw ArgumentError("after", after_s, "a positive number of seconds");
  if (!scenario.events.empty())
    throw ArgumentError("event", static_cast<double>(scenario.events.size()),
                        "none: an error caused by a planned change of the clock is not random");
  ErrorBudget budget{after_s, {}};
  add_drive(scenario, after_s, budget.parts);
  add_length(scenario, after_s, budget.parts);
  constexpr double rounding_s = 1e-12; // parts below it are differences of equal numbers
  std::erase_if(budget.parts, [](const ErrorPart& part) { return part.rms_s < rounding_s; });
  return budget;
}

namespace {

// Looks for the limit of one quantity after the other.
class LimitSearch {
public:
  LimitSearch(const Scenario& scenario, double most_s, double after_s)
      : scenario_(scenario), most_s_(most_s), after_s_(after_s),
        budget_(error_budget(scenario, after_s)), all2_(sum_of_squares(budget_.parts)),
        waits_(waits_for_amplitude(scenario.clock)) {}

  std::vector<Requirement> run() {
    if (scenario_.clock.epsilon > 0.0) ask_of_friction();
    ask_of_amplitude();
    // A compensation opposes the rod: the limit of each is found with the other unchanged.
    const bool compensates = scenario_.length.compensation != 0.0;
    if (compensates) {
      ask_of_length("length.temperature_coefficient", &LengthChanges::temperature_coefficient);
      ask_of_length("length.compensation", &LengthChanges::compensation);
    }
    for (const ErrorPart& part : budget_.parts)
      if (!compensates || part.key != "length.temperature_coefficient") ask_of_part(part);
    return found_;
  }

private:
  // Infinite for a clock that would stall, or that no scenario may have: it is no answer.
  [[nodiscard]] double error_of(const ClockParameters& clock) const {
    try {
      Scenario other = scenario_;
      other.clock = clock;
      return error_budget(other, after_s_).all_s();
    } catch (const ArgumentError&) {
      return std::numeric_limits<double>::infinity();
    }
  }

  // The drive is adjusted to the friction to keep the amplitude; a limit of amplitude keeps it
  // without that.
  void ask_of_friction() {
    const ClockParameters& clock = scenario_.clock;
    const double swing = *stationary_amplitude(clock), friction = friction_moment(clock, swing);
    const auto error = [&](double epsilon) {
      const double more = waits_ ? 1.0 : 1.0 + (epsilon - clock.epsilon) * swing / friction;
      ClockParameters other = driven(clock, more);
      other.epsilon = epsilon;
      return error_of(other);
    };
    found_.push_back(
        {"clock.epsilon", clock.epsilon, nearest_limit(error, clock.epsilon, most_s_, 1e-7, 1e-2)});
  }

  // The clock with `factor` times the lambda^2, by the drive or by the limit of amplitude.
  [[nodiscard]] ClockParameters wider(double factor) const {
    if (!waits_) return driven(scenario_.clock, factor);
    ClockParameters other = scenario_.clock;
    other.below *= std::sqrt(factor);
    return other;
  }

  void ask_of_amplitude() {
    const auto size = [&](const ClockParameters& of) {
      return waits_ ? std::optional(of.below) : stationary_amplitude(of);
    };
    const auto error = [&](double factor) { return error_of(wider(factor)); };
    constexpr double widest = 100.0; // times lambda^2: ten times the swing, or a tenth of it
    const auto limit2 = nearest_limit(error, 1.0, most_s_, 1.0 / widest, widest);
    constexpr double margin = 1e-3; // relative, above the promised accuracy of a limit, 1e-4
    const bool stops =
        limit2 && !std::isfinite(error(*limit2 * (*limit2 < 1.0 ? 1.0 - margin : 1.0 + margin)));
    found_.push_back({waits_ ? "clock.below" : "amplitude", *size(scenario_.clock),
                      limit2 ? size(wider(*limit2)) : std::nullopt, stops});
  }

  [[nodiscard]] double error2_of(const LengthChanges& length) const {
    Scenario other = scenario_;
    other.length = length;
    std::vector<ErrorPart> parts;
    add_length(other, after_s_, parts);
    return sum_of_squares(parts);
  }

  void ask_of_length(const char* key, double LengthChanges::*value) {
    const double beside2 = all2_ - error2_of(scenario_.length);
    const double now = std::abs(scenario_.length.*value);
    const auto error = [&](double with) {
      LengthChanges length = scenario_.length;
      length.*value = std::copysign(with, scenario_.length.*value);
      return std::sqrt(beside2 + error2_of(length));
    };
    constexpr double range = 10.0, step = 1.001; // finer than what a good compensation leaves
    found_.push_back({key, now,
                      now > 0.0 ? nearest_limit(error, now, most_s_, now / range, now * range, step)
                                : std::nullopt});
  }

  // What errs in proportion to its size.
  void ask_of_part(const ErrorPart& part) {
    const double others2 = all2_ - part.rms_s * part.rms_s, room2 = most_s_ * most_s_ - others2;
    const double limit = part.size * std::sqrt(std::max(0.0, room2)) / part.rms_s;
    // An rms of more than 100 % of the drive has no meaning.
    const double largest =
        part.key.starts_with("drive.") ? 1.0 : std::numeric_limits<double>::infinity();
    const bool is_limit = room2 > 0.0 && limit <= largest;
    found_.push_back({part.key, part.size, is_limit ? std::optional(limit) : std::nullopt});
  }

  const Scenario& scenario_;
  double most_s_, after_s_;
  ErrorBudget budget_;
  double all2_; // square of the present error, s^2
  bool waits_;
  std::vector<Requirement> found_;
};

} // namespace

std::vector<Requirement> requirements(const Scenario& scenario, double most_s, double after_s) {
  if (!(most_s > 0.0)) throw ArgumentError("error", most_s, "a positive number of seconds");
  return LimitSearch(scenario, most_s, after_s).run();
}

} // namespace goingrate
