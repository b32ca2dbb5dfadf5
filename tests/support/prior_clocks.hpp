// Scenarios of random clocks whose parameters are drawn from a prior, for tests of the fit against
// a known truth. A clock either changes once, at a known cycle, or has a noisy drive. The scenarios
// ask for direct integration, so that the simulated log contains none of the fit's approximations.
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

/// A clock to simulate, with the options for a fit to its log and the values the fit should find.
struct DrawnClock {
  Scenario scenario;
  std::string changed; ///< the parameter that jumps: mu, phi0 or epsilon; empty: none
  FitOptions options;  ///< tell the fit of the change and, in some clocks, of T0
  std::map<std::string, double> truth; ///< by the parameter names of the fit
};

/// Draws clocks from the prior; the seed determines the clock.
class ClockPrior {
public:
  explicit ClockPrior(std::uint64_t seed)
      : seed_(seed), chance_(seed, StreamPurpose::amplitude_noise) {}

  /// A clock that changes once. T0 is 1 to 3 s, epsilon 1e-4 to 1.6e-3, phi0 0.01 to 0.05 rad and
  /// the stationary lambda/phi0 1.3 to 3. After 15 to 40 % of its 600 to 3000 periods mu is
  /// multiplied, or phi0 or epsilon divided, by 1.3 to 2.2; the amplitude stays above phi0 either
  /// way. The timing jitter is 1e-6 to 1e-4 s. For even seeds the fit is given T0.
  DrawnClock draw() {
    DrawnClock drawn;
    constexpr std::array T0_choices_s{1.0, 1.5, 2.0, 3.0};
    constexpr std::array parameter_names{"mu", "phi0", "epsilon"};
    const double T0 = T0_choices_s[seed_ / 2 % T0_choices_s.size()];
    drawn.changed = parameter_names[seed_ / 8 % parameter_names.size()];
    const double epsilon = geometric(1e-4, 1.6e-3), phi0 = between(0.01, 0.05);
    const double amplitude = phi0 * between(1.3, 3.0);
    const double mu = 0.5 * std::numbers::pi * epsilon * amplitude * amplitude / phi0; // stationary
    const auto periods = static_cast<std::int64_t>(between(600.0, 3000.0));
    const auto change_period =
        static_cast<std::int64_t>(between(0.15, 0.4) * static_cast<double>(periods));
    Scenario& scenario = drawn.scenario;
    scenario.clock = {T0, epsilon, mu, phi0};
    scenario.periods = periods;
    scenario.method.method = Method::direct;
    scenario.sensor.jitter_rms_s = geometric(1e-6, 1e-4);
    ClockEvent event;
    event.at_period = change_period;
    const double factor = between(1.3, 2.2);
    double after = 0.0;
    if (drawn.changed == "mu") event.mu = after = factor * mu;
    if (drawn.changed == "phi0") event.phi0 = after = phi0 / factor;
    if (drawn.changed == "epsilon") event.epsilon = after = epsilon / factor;
    scenario.events = {event};
    drawn.options.events = {{change_period, {drawn.changed}}};
    if (seed_ % 2 == 0) drawn.options.fixed["T0"] = T0;
    drawn.truth = {{"T0", T0},     {"epsilon", epsilon},   {"mu", mu},
                   {"phi0", phi0}, {"lambda0", amplitude}, {drawn.changed + "@1", after}};
    return drawn;
  }

  /// A clock that does not change but whose drive is noisy: white noise of 0.5 to 10 % rms from
  /// period to period, plus 2 to 15 % rms with a correlation time of 30 to 500 periods. The log
  /// includes amplitudes, with noise of 3e-5 to 6e-4 rad rms. T0 is 0.9 to 3 s, lambda 0.03 to
  /// 0.2 rad and lambda/phi0 1.3 to 5.
  DrawnClock draw_rough() {
    DrawnClock drawn;
    constexpr std::array T0_choices_s{0.9, 1.0, 1.2345, 2.0, 3.0};
    const double T0 = T0_choices_s[seed_ % T0_choices_s.size()];
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

/// The clock's fit options, with the search started at the true values: the fit to compare with
/// one that has to find its own start.
inline FitOptions told_the_truth(const DrawnClock& drawn) {
  FitOptions options = drawn.options;
  for (const auto& [name, value] : drawn.truth)
    if (!options.fixed.contains(name)) options.start[name] = value;
  return options;
}

/// 2 log L, from AIC = 2 k - 2 log L with k free parameters, those that `correlated` lists.
inline double two_log_likelihood(const FitSummary& fit) {
  return 2.0 * static_cast<double>(fit.correlated.size()) - fit.quality.aic;
}

} // namespace goingrate::test
