#include "goingrate/drive/drive_split.hpp"

#include "gain_spread.hpp"
#include "linear_rates.hpp"
#include "rate_components.hpp"
#include "time_error.hpp"

#include "base/scaled_time.hpp"
#include "base/special_values.hpp"
#include "goingrate/base/errors.hpp"
#include "log/usual_step.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <functional>

namespace goingrate {

namespace {

using timing_model::Component;
using timing_model::ComponentFit;
using timing_model::RateComponents;

// The estimate with its interval widened by a further, independent, relative error.
RmsEstimate widened(const RmsEstimate& estimate, double relative) {
  const bool is_limit = estimate.low68 == 0.0;
  const double more = relative * (is_limit ? estimate.high68 : estimate.rms);
  return {estimate.rms,
          is_limit ? 0.0
                   : std::max(0.0, estimate.rms - std::hypot(estimate.rms - estimate.low68, more)),
          estimate.rms + std::hypot(estimate.high68 - estimate.rms, more)};
}

using Ends = std::array<RateComponents, 2>;

// The fitted parts of the drive, and the ends of their intervals. An end holds all parts: the one
// whose interval it is at that end, and the others at the values that then fit best.
struct Parts {
  ComponentFit fit;
  Ends fast, slow;

  explicit Parts(ComponentFit of_rates)
      : fit(std::move(of_rates)), fast(fit.interval68(Component::fast)),
        slow(fit.interval68(Component::slow)) {}
  [[nodiscard]] const Ends& ends(Component which) const {
    return which == Component::fast ? fast : slow;
  }
};

// The rms of a part; drive_at() converts the sizes found in the rate to those of the drive.
template <class DriveAt>
RmsEstimate rms_of(const ComponentFit& fit, const Ends& ends, Component which,
                   const DriveAt& drive_at) {
  const auto rms = [&](const RateComponents& found) {
    return std::sqrt(variance_of(drive_at(found), which));
  };
  RmsEstimate estimate{rms(fit.best_for(which)), rms(ends[0]), rms(ends[1])};
  estimate.rms = std::clamp(estimate.rms, estimate.low68, estimate.high68);
  return estimate;
}

// The share of a part's variance that lies below split_hz: of the slow part, or of the fast one.
double share_below(const RateComponents& c, bool slow, double split_hz, double period_s) {
  const double nyquist = 0.5 / period_s;
  if (!slow) return std::min(1.0, split_hz / nyquist);
  const DriveResponse flat{1.0, 1.0, 1.0};
  // Sums on a logarithmic grid from far below the corner; the share is accurate to a thousandth.
  constexpr int steps = 4000;
  double below = 0.0, all = 0.0;
  const double first = std::min(split_hz, 1.0 / c.memory_s) * 1e-4;
  const double ratio = std::pow(nyquist / first, 1.0 / steps);
  double f = first;
  for (int i = 0; i < steps; ++i, f *= ratio) {
    const double part = c.slow_density(f, period_s, flat) * f;
    all += part;
    if (f <= split_hz) below += part;
  }
  return all > 0.0 ? below / all : 0.0;
}

// The rms of the sum of two independent parts, each with a share of its variance.
RmsEstimate sum_of(const RmsEstimate& a, double share_a, const RmsEstimate& b, double share_b) {
  const auto square = [](double x) { return x * x; };
  const double middle = share_a * square(a.rms) + share_b * square(b.rms);
  const double down = std::hypot(share_a * (square(a.rms) - square(a.low68)),
                                 share_b * (square(b.rms) - square(b.low68)));
  const double up = std::hypot(share_a * (square(a.high68) - square(a.rms)),
                               share_b * (square(b.high68) - square(b.rms)));
  return {std::sqrt(middle), std::sqrt(std::max(0.0, middle - down)), std::sqrt(middle + up)};
}

// The rms time error that a part makes after t seconds.
double cost_of(const RateComponents& c, Component which, double t, double period_s,
               const DriveResponse& response) {
  const double variance = variance_of(c, which);
  if (variance == 0.0) return 0.0;
  if (std::isinf(variance)) return variance;
  return time_error(
      [&](double f) {
        return which == Component::fast ? c.fast_density(f, period_s, response)
                                        : c.slow_density(f, period_s, response);
      },
      t, period_s);
}

std::vector<DriveCost> costs_of(const Parts& parts, double period_s,
                                const DriveResponse& response) {
  std::vector<DriveCost> costs;
  for (const double days : {1.0, 7.0, 365.25}) {
    DriveCost cost;
    cost.after_s = 86400.0 * days;
    const auto estimate = [&](Component which) {
      const auto at = [&](const RateComponents& c) {
        return cost_of(c, which, cost.after_s, period_s, response);
      };
      const Ends& ends = parts.ends(which);
      const double middle = at(parts.fit.best_for(which)), a = at(ends[0]), b = at(ends[1]);
      return RmsEstimate{middle, std::min({a, b, middle}), std::max({a, b, middle})};
    };
    cost.fast_s = estimate(Component::fast);
    cost.slow_s = estimate(Component::slow);
    costs.push_back(cost);
  }
  return costs;
}

RateComponents as_found(const RateComponents& found) { return found; }

// Sets the sizes of the drive from rates that were corrected to respond to it linearly.
void take_linear_sizes(DriveSplit& result, const Parts& parts, const DriveResponse& response,
                       double mean_drive_rms) {
  const RateComponents& best = parts.fit.best();
  const auto doubt = timing_model::gain_doubt(response, mean_drive_rms, best.memory_s);
  result.fast = widened(rms_of(parts.fit, parts.fast, Component::fast, as_found), doubt.fast);
  result.slow = widened(rms_of(parts.fit, parts.slow, Component::slow, as_found), doubt.slow);
  result.slow_time_s = best.slow2 > 0.0 ? best.memory_s : not_known;
}

// Sets the sizes of the drive from uncorrected rates, with gains averaged over the amplitudes that
// the slow drive causes.
void take_averaged_sizes(DriveSplit& result, const Parts& parts, const DriveResponse& response,
                         double length_s) {
  const auto drive_at = [&](const RateComponents& found) {
    return timing_model::with_gains_averaged(found, response);
  };
  const RateComponents& best = parts.fit.best();
  const double shift = timing_model::mean_shift(drive_at(best), response, length_s);
  const auto doubt = timing_model::gain_doubt(response, shift, best.memory_s);
  // The spread of amplitudes changes the gain of the fast drive, so the uncertainty of the slow
  // drive's size adds to that of the fast one.
  const auto raised = [&](const RateComponents& at) {
    return at.fast2 > 0.0 ? drive_at(at).fast2 / at.fast2 : 1.0;
  };
  const double at_least = raised(parts.slow[0]);
  const double at_most = std::isfinite(parts.slow[1].slow2) ? raised(parts.slow[1]) : at_least;
  const double by_slow = best.fast2 > 0.0 ? 0.25 * std::abs(at_least - at_most) : 0.0;
  result.fast = widened(rms_of(parts.fit, parts.fast, Component::fast, drive_at),
                        std::hypot(doubt.fast, by_slow));
  result.slow = widened(rms_of(parts.fit, parts.slow, Component::slow, drive_at), doubt.slow);
  result.slow_time_s = best.slow2 > 0.0 ? best.memory_s : not_known;
}

bool is_constant(std::span<const double> rates) {
  return std::adjacent_find(rates.begin(), rates.end(), std::not_equal_to<>()) == rates.end();
}

// Why the slow drive's size is only approximate where the rates could not be linearised; empty if
// it is not.
std::string reason_for_approximation(const RateComponents& found, const DriveResponse& response) {
  const double spread = timing_model::amplitude_spread(found, response);
  const double phi2 = std::pow(response.switching_angle, 2);
  // Above this spread, the variation of the gains exceeds the uncertainty of the slow drive's size.
  constexpr double largest_gain_spread = 0.05;
  // How many standard deviations the squared amplitude is above a stall. With this many, a clock
  // stalls once in several thousand memory times.
  constexpr double stall_distance_sigma = 3.5;
  if (spread > largest_gain_spread && !timing_model::forgets_its_start(response))
    return "the rate hardly responds to slow changes of the drive, and not in proportion: the slow "
           "rms is approximate";
  if (spread > (1.0 - phi2 / response.amplitude2) / stall_distance_sigma)
    return "a slow drive of this size takes the clock near a stall, where the rate does not "
           "respond in proportion: its rms is approximate";
  return {};
}

// What the reader of the sizes must know; `approximation` is from reason_for_approximation().
std::string note_on(const DriveSplit& split, double memory_s, double length_s,
                    const std::string& approximation) {
  constexpr double max_memory_share = 0.3; // of the length of the log
  std::vector<std::string> notes;
  if (split.fast.low68 == 0.0)
    notes.emplace_back("the sensor's jitter hides the fast drive: its rms is an upper limit");
  if (split.slow.low68 > 0.0 && memory_s > max_memory_share * length_s)
    notes.push_back(
        fmt::format("the slow drive's memory is comparable with the length of the log, {:.3g} s: "
                    "its rms describes only a stretch of that length",
                    length_s));
  if (!approximation.empty()) notes.push_back(approximation);
  return fmt::format("{}", fmt::join(notes, "; "));
}

} // namespace

std::vector<double> rate_about_fit(std::span<const Beat> beats, double nominal_period_s,
                                   const FitSummary& fit) {
  const bool is_fitted = fit.residual_s.size() == beats.size();
  const std::int64_t step = usual_step(beats);
  const auto place = [&](const Beat& beat) { return (beat.cycle - beats.front().cycle) / step; };
  std::vector<double> series;
  for (std::size_t i = 1; i < beats.size(); ++i) {
    const Beat &before = beats[i - 1], &beat = beats[i];
    const double rate =
        is_fitted ? (fit.residual_s[i - 1] - fit.residual_s[i]) / (beat.time - before.time)
                  : rate_between(before, beat, nominal_period_s);
    series.insert(series.end(), static_cast<std::size_t>(place(beat) - place(before)), rate);
  }
  return series;
}

DriveSplit split_drive(std::span<const double> rates, double period_s,
                       const DriveResponse& response, double split_hz,
                       std::span<const double> frequency_hz) {
  if (!(period_s > 0.0)) throw ArgumentError("period", period_s, "a positive number of seconds");
  if (rates.size() < 64)
    throw ArgumentError("number of rates", static_cast<double>(rates.size()), "at least 64");
  for (std::size_t i = 0; i < rates.size(); ++i)
    if (!std::isfinite(rates[i]))
      throw ArgumentError(fmt::format("rates[{}]", i), rates[i], "finite");
  if (is_constant(rates)) throw ArgumentError("rates", "all equal", "a series that varies");
  const Parts parts(ComponentFit(rates, period_s, response));
  const RateComponents& best = parts.fit.best();
  const double length_s = static_cast<double>(rates.size()) * period_s;
  DriveSplit result;
  result.at_frequency = split_hz > 0.0;
  result.split_hz = result.at_frequency ? split_hz : response.corner_hz;
  const RateComponents drive = timing_model::with_gains_averaged(best, response);
  const auto linear = timing_model::linear_rates(rates, period_s, response, drive);
  RateComponents found = best; // the components behind the sizes
  if (linear) {
    const Parts linear_parts(ComponentFit(linear->rates, period_s, response));
    take_linear_sizes(result, linear_parts, response, linear->mean_drive_rms);
    found = linear_parts.fit.best();
  } else {
    take_averaged_sizes(result, parts, response, length_s);
  }
  result.jitter_s =
      rms_of(parts.fit, parts.fit.interval68(Component::jitter), Component::jitter, as_found);
  result.slow_gain = parts.fit.gain_of_slow();
  if (result.slow_gain < ComponentFit::least_evidence) result.slow.low68 = 0.0;
  result.costs = costs_of(parts, period_s, response);
  for (DriveCost& cost : result.costs)
    if (result.slow.low68 == 0.0) cost.slow_s.low68 = 0.0;
  for (const double f : frequency_hz) {
    result.jitter_density.push_back(best.jitter_density(f, period_s));
    result.fast_density.push_back(best.fast_density(f, period_s, response));
    result.slow_density.push_back(best.slow_density(f, period_s, response));
  }
  result.note = note_on(result, found.memory_s, length_s,
                        linear ? std::string{} : reason_for_approximation(best, response));
  if (!result.at_frequency) return result;
  const double white = share_below(found, false, split_hz, period_s);
  const double wander = share_below(found, true, split_hz, period_s);
  const RmsEstimate all_fast = result.fast, all_slow = result.slow;
  result.fast = sum_of(all_fast, 1.0 - white, all_slow, 1.0 - wander);
  result.slow = sum_of(all_fast, white, all_slow, wander);
  return result;
}

double drive_of(const SpectralLine& line, const DriveResponse& response) {
  return line.amplitude / std::abs(response.at(line.frequency_hz));
}

namespace {

// The cycle from which the gains hold: five relaxation times after the last change, or halfway from
// it to the end of the log if that is earlier.
std::size_t settled_since(const FitSummary& fit, const ClockParameters& clock, std::size_t cycles) {
  // Relaxation times of the squared amplitude, of T0/(4 pi epsilon) each.
  constexpr double settling_relaxations = 5.0;
  if (fit.events.empty()) return 0;
  const auto change = std::min(
      static_cast<std::size_t>(std::max<std::int64_t>(0, fit.events.back().cycle)), cycles);
  const auto settling =
      static_cast<std::size_t>(settling_relaxations / (2.0 * two_pi * clock.epsilon));
  return change + std::min(settling, (cycles - change) / 2);
}

// The clock with its mean drive from cycle `since` on, as the logged amplitudes show it. In the fit
// a slow drive may absorb part of the mean.
ClockParameters with_logged_drive(ClockParameters clock, std::span<const Beat> beats,
                                  const FitSummary& fit, std::size_t since) {
  if (fit.amplitude_residual_rad.size() != beats.size()) return clock;
  double modelled = 0.0, excess = 0.0;
  for (std::size_t i = 0; i < beats.size(); ++i) {
    const double residual = fit.amplitude_residual_rad[i];
    if (std::isnan(residual) || beats[i].cycle - beats[0].cycle < static_cast<std::int64_t>(since))
      continue;
    modelled += beats[i].amplitude_rad - residual;
    excess += residual;
  }
  if (modelled > 0.0)
    clock.mu *= std::pow(1.0 + excess / modelled, 2); // lambda^2 = 2 mu phi0/(pi eps)
  return clock;
}

// Over missed beats the rate is a mean of several periods, in which jitter looks like fast noise of
// the drive; a fit sees every beat by itself. With less than this missed it hardly shows.
constexpr double most_missed = 0.05;

double share_of_missed(std::span<const Beat> beats, std::int64_t step) {
  const auto cycles = static_cast<double>((beats.back().cycle - beats.front().cycle) / step);
  return 1.0 - static_cast<double>(beats.size() - 1) / cycles;
}

} // namespace

DriveAnalysis analyse_drive(std::span<const Beat> beats, double nominal_period_s,
                            const FitSummary& fit, double split_hz) {
  DriveAnalysis drive;
  drive.swings_freely =
      fit.has_result() && !fit.parameters.empty() && fit.model.escapement == Escapement::none;
  drive.sees_amplitude = !fit.amplitude_residual_rad.empty();
  drive.rates = rate_about_fit(beats, nominal_period_s, fit);
  const std::int64_t step = usual_step(beats);
  const double interval_s = drive.interval_s = static_cast<double>(step) * nominal_period_s;
  const auto& rates = drive.rates;
  if (rates.size() < 8) return drive;
  // A single segment reaches the lowest frequencies. A trend is not removed: it too is a slow
  // variation of the drive.
  drive.rate_spectrum =
      welch_spectrum(rates, interval_s, {.segment = rates.size(), .detrend_linear = false});
  auto clock = fitted_clock(fit);
  const std::size_t cycles = rates.size() * static_cast<std::size_t>(step);
  const std::size_t since = clock ? settled_since(fit, *clock, cycles) : 0;
  const std::size_t since_rate = since / static_cast<std::size_t>(step);
  if (clock) {
    clock = with_logged_drive(*clock, beats, fit, since);
    drive.response = drive_response(*clock);
  }
  constexpr std::size_t fewest_rates = 64;
  if (rates.size() < fewest_rates) return drive;
  drive.lines = find_lines(rates, interval_s);
  if (!drive.response || is_constant(rates)) return drive;
  if (rates.size() - since_rate < fewest_rates) return drive;
  const std::vector<double> lineless = without_lines(rates, interval_s, drive.lines);
  drive.split = split_drive(std::span(lineless).subspan(since_rate), interval_s, *drive.response,
                            split_hz, drive.rate_spectrum->frequency_hz);
  // The gains come from a fit, and their uncertainty adds to that of the sizes.
  DriveSplit& split = *drive.split;
  const double nyquist_hz = 0.5 / interval_s;
  const double fast_hz = std::sqrt(drive.response->corner_hz * nyquist_hz);
  const double slow_hz =
      split.slow_time_s > 0.0 ? 1.0 / (two_pi * split.slow_time_s) : drive.response->corner_hz;
  const double fast_gain_sigma = relative_gain_sigma(fit, *clock, fast_hz);
  const double slow_gain_sigma = relative_gain_sigma(fit, *clock, slow_hz);
  // The drive is the rate divided by the gain: a gain that may be zero does not give its size.
  if (!(std::max(fast_gain_sigma, slow_gain_sigma) < 1.0)) drive.split.reset();
  if (!drive.split) return drive;
  if (!fit.model.drive && share_of_missed(beats, step) > most_missed) split.fast.low68 = 0.0;
  split.fast = widened(split.fast, fast_gain_sigma);
  split.slow = widened(split.slow, slow_gain_sigma);
  return drive;
}

} // namespace goingrate
