#include "twin.hpp"

#include "final_clock.hpp"

#include <cmath>
#include <numbers>

namespace goingrate::timing_model {

std::optional<std::vector<double>> twin_of(const FitProblem& problem, std::span<const double> x) {
  const Parameters& parameters = problem.parameters;
  if (parameters.escapement != Escapement::constant_torque || !parameters.event_cycles.empty())
    return {};
  for (const Quantity needed : {Quantity::mu, Quantity::phi0, Quantity::lambda0})
    if (!parameters.is_free(needed)) return {};
  const Slot* drive = parameters.find(Quantity::drive_rms);
  if (drive == nullptr || !drive->free) return {};
  const FinalClock clock = final_clock(parameters, x);
  const double epsilon = clock.laws.epsilon, phi0 = clock.laws.phi0;
  const double rate = clock.laws.rate(clock.amplitude2);
  const double ratio = clock.slow_gain() / clock.fast_gain(), b = rate / epsilon;
  const double root = b * b + 1.0 - 2.0 * ratio;
  if (!(root > 0.0) || !(std::sqrt(root) > b)) return {};
  const double u = std::sqrt(root) - b, steep = 1.0 / u; // sqrt(q^2 - 1)
  const double amplitude2 = 16.0 * (epsilon * steep - rate);
  if (!(amplitude2 > 0.0 && amplitude2 < 1.0)) return {};
  const double angle = std::sqrt(amplitude2 / (steep * steep + 1.0));
  const double mu = std::numbers::pi * epsilon * amplitude2 / (2.0 * angle);
  const double old_steep = std::sqrt(clock.amplitude2 / (phi0 * phi0) - 1.0);
  std::vector<double> twin(x.begin(), x.end());
  const auto add_log = [&](Quantity quantity, double factor) {
    twin[parameters.find(quantity)->index] += std::log(factor);
  };
  add_log(Quantity::mu, mu / clock.laws.mu);
  add_log(Quantity::phi0, angle / phi0);
  add_log(Quantity::lambda0, std::sqrt(amplitude2 / clock.amplitude2));
  add_log(Quantity::drive_rms, old_steep / steep); // the scatter of neighbours stays
  return twin;
}

} // namespace goingrate::timing_model
