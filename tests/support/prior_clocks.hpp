// Clocks drawn from a prior, with one change at a known cycle or a rough drive, by the exact
// simulator.
#pragma once

#include "goingrate/base/random.hpp"
#include "goingrate/fit/clock_fit.hpp"
#include "support/simulated.hpp"

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string>

namespace goingrate::test {

/// T0 1 to 3 s, epsilon 1e-4 to 1.6e-3, phi0 0.01 to 0.05, lambda/phi0 1.3 to 3 at rest; a jump of
/// mu, phi0 or epsilon by 1.3 to 2.2, such that the amplitude stays above the angle, at 15 to 40 %
/// of 600 to 3000 periods; jitter 1e-6 to 1e-4 s. T0 is known for even seeds.
struct DrawnClock {
  Scenario scenario;
  std::string changed; // mu, phi0 or epsilon
  FitOptions options;
  std::map<std::string, double> truth;
};

/// The clock of a seed, and what a fit is told of it.
class ClockPrior {
public:
  explicit ClockPrior(std::uint64_t seed)
      : seed_(seed), chance_(seed, StreamPurpose::amplitude_noise) {}

  DrawnClock draw() {
    DrawnClock drawn;
    constexpr std::array periods_s{1.0, 1.5, 2.0, 3.0};
    constexpr std::array names{"mu", "phi0", "epsilon"};
    const double T0 = periods_s[seed_ / 2 % periods_s.size()];
    drawn.changed = names[seed_ / 8 % names.size()];
    const double epsilon = geometric(1e-4, 1.6e-3), phi0 = between(0.01, 0.05);
    const double amplitude = phi0 * between(1.3, 3.0);
    const double mu = 0.5 * std::numbers::pi * epsilon * amplitude * amplitude / phi0; // at rest
    const auto periods = static_cast<std::int64_t>(between(600.0, 3000.0));
    const auto at = static_cast<std::int64_t>(between(0.15, 0.4) * static_cast<double>(periods));
    Scenario& scenario = drawn.scenario;
    scenario.clock = {T0, epsilon, mu, phi0};
    scenario.periods = periods;
    scenario.method.method = Method::direct;
    scenario.sensor.jitter_rms_s = geometric(1e-6, 1e-4);
    ClockEvent event;
    event.at_period = at;
    const double factor = between(1.3, 2.2);
    double after = 0.0;
    if (drawn.changed == "mu") event.mu = after = factor * mu;
    if (drawn.changed == "phi0") event.phi0 = after = phi0 / factor;
    if (drawn.changed == "epsilon") event.epsilon = after = epsilon / factor;
    scenario.events = {event};
    drawn.options.events = {{at, {drawn.changed}}};
    if (seed_ % 2 == 0) drawn.options.fixed["T0"] = T0;
    drawn.truth = {{"T0", T0},     {"epsilon", epsilon},   {"mu", mu},
                   {"phi0", phi0}, {"lambda0", amplitude}, {drawn.changed + "@1", after}};
    return drawn;
  }

  /// No change, but a drive that varies by 0.5 to 10 % from period to period and by 2 to 15 % over
  /// 30 to 500 periods, and amplitudes to 3e-5 to 6e-4 rad; lambda/phi0 1.3 to 5.
  DrawnClock draw_rough() {
    DrawnClock drawn;
    constexpr std::array periods_s{0.9, 1.0, 1.2345, 2.0, 3.0};
    const double T0 = periods_s[seed_ % periods_s.size()];
    const double epsilon = geometric(1e-4, 2e-3), amplitude = geometric(0.03, 0.2);
    const double phi0 = amplitude / between(1.3, 5.0);
    const double mu = 0.5 * std::numbers::pi * epsilon * amplitude * amplitude / phi0;
    Scenario& scenario = drawn.scenario;
    scenario.clock = {T0, epsilon, mu, phi0};
    scenario.periods = static_cast<std::int64_t>(between(1500.0, 4000.0));
    scenario.method.method = Method::direct;
    scenario.drive.fast_rms = geometric(5e-3, 0.1);
    scenario.drive.slow_rms = geometric(0.02, 0.15);
    scenario.drive.slow_time_s = T0 * geometric(30.0, 500.0);
    scenario.sensor.jitter_rms_s = geometric(1e-6, 1e-4);
    scenario.sensor.amplitude_rms = geometric(3e-5, 6e-4);
    drawn.truth = {
        {"T0", T0}, {"epsilon", epsilon}, {"mu", mu}, {"phi0", phi0}, {"lambda0", amplitude}};
    return drawn;
  }

private:
  double between(double low, double high) { return low + (high - low) * chance_.uniform(); }
  double geometric(double low, double high) {
    return low * std::pow(high / low, chance_.uniform());
  }
  std::uint64_t seed_;
  RandomStream chance_;
};

/// Starts a fit from the truth.
inline FitOptions told_the_truth(const DrawnClock& drawn) {
  FitOptions options = drawn.options;
  for (const auto& [name, value] : drawn.truth)
    if (!options.fixed.contains(name)) options.start[name] = value;
  return options;
}

inline double two_log_likelihood(const FitSummary& fit) {
  return 2.0 * static_cast<double>(fit.correlated.size()) - fit.quality.aic;
}

} // namespace goingrate::test
