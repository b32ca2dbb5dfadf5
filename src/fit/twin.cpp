#include "twin.hpp"

#include "final_clock.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace goingrate::timing_model {

namespace {

using std::numbers::pi;

bool may_have_twins(const Parameters& parameters) {
  const bool stays_stationary =
      std::all_of(parameters.slots.begin(), parameters.slots.end(), [](const Slot& slot) {
        return slot.event == 0 || slot.quantity == Quantity::T0 || is_of_moment(slot.quantity);
      });
  return parameters.escapement == Escapement::constant_torque && stays_stationary &&
         parameters.is_free(Quantity::mu) && parameters.is_free(Quantity::phi0) &&
         parameters.is_free(Quantity::lambda0) && parameters.is_free(Quantity::drive_rms);
}

// The quantities that the density shows; without slow drive its pole and zero are 0.
struct Density {
  double clock_pole, drive_pole; // per cycle
  double clock_zero, drive_zero; // of either sign; above the drive's pole
  double level;                  // root of the density above all of these
};

double value_of(const Parameters& parameters, Quantity quantity, std::span<const double> x) {
  return parameters.find(quantity)->value(x);
}

Density density_of(const FinalClock& clock, const Parameters& parameters,
                   std::span<const double> x) {
  const double drive = value_of(parameters, Quantity::drive_rms, x);
  Density seen{};
  seen.clock_pole = -2.0 * pi * clock.laws.growth_slope(clock.amplitude2);
  seen.clock_zero = seen.clock_pole * clock.slow_gain() / clock.fast_gain();
  seen.level = clock.fast_gain() * drive;
  if (!parameters.has(Quantity::slow_rms)) return seen;
  const double slow = value_of(parameters, Quantity::slow_rms, x) / drive;
  seen.drive_pole = clock.T0 / value_of(parameters, Quantity::slow_time, x);
  seen.drive_zero = std::sqrt(seen.drive_pole * (seen.drive_pole + 2.0 * slow * slow));
  return seen;
}

// The other choices of pole, zero and sign.
std::vector<Density> choices(const Density& seen, bool may_swap_poles, bool may_swap_zeros) {
  std::vector<Density> all;
  for (const bool poles : {false, true})
    for (const bool zeros : {false, true})
      for (const double sign : {1.0, -1.0}) {
        if ((poles && !may_swap_poles) || (zeros && !may_swap_zeros)) continue;
        Density other = seen;
        if (poles) std::swap(other.clock_pole, other.drive_pole);
        if (zeros) {
          other.clock_zero = std::copysign(seen.drive_zero, seen.clock_zero);
          other.drive_zero = std::abs(seen.clock_zero);
        }
        other.clock_zero *= sign;
        if (poles || zeros || sign < 0.0) all.push_back(other);
      }
  return all;
}

// u and the mean rate of a clock whose gains have this ratio. The rate is the log's if T0 is known
// or can be chosen to fit; otherwise u is changed as little as possible.
struct Root {
  double u = 0.0, rate = 0.0;
};
std::optional<Root> root_of(double ratio, double epsilon, const Root& now, bool T0_is_free) {
  const double b = now.rate / epsilon, square = b * b + 1.0 + 2.0 * ratio;
  if (square > 0.0 && std::sqrt(square) > b) {
    const Root root{std::sqrt(square) - b, now.rate};
    if (1.0 / root.u > b) return root; // an amplitude above 0
  }
  if (!T0_is_free) return {};
  constexpr double amplitude_margin = 1.0; // of u^2 + 1 - 2 R, which must be above 0
  const double u = std::sqrt(std::max(now.u * now.u, 2.0 * ratio - 1.0 + amplitude_margin));
  return Root{u, epsilon * (ratio + 0.5 - 0.5 * u * u) / u};
}

} // namespace

std::vector<std::optional<std::vector<double>>> twins_of(const FitProblem& problem,
                                                         std::span<const double> x) {
  const Parameters& parameters = problem.parameters;
  if (!may_have_twins(parameters)) return {};
  const FinalClock clock = final_clock(parameters, x);
  const double epsilon = clock.laws.epsilon, phi0 = clock.laws.phi0;
  if (!(clock.amplitude2 > phi0 * phi0)) return {};
  const Root now{1.0 / std::sqrt(clock.amplitude2 / (phi0 * phi0) - 1.0),
                 clock.laws.rate(clock.amplitude2)};
  const Density seen = density_of(clock, parameters, x);
  const bool has_slow = seen.drive_pole > 0.0 && parameters.is_free(Quantity::slow_rms);
  const bool T0_is_free = parameters.is_free(Quantity::T0);
  const auto twin_at = [&](const Density& other) -> std::optional<std::vector<double>> {
    const double own_epsilon = epsilon * other.clock_pole / seen.clock_pole;
    const auto root = root_of(other.clock_zero / other.clock_pole, own_epsilon, now, T0_is_free);
    if (!root || (has_slow && !(other.drive_zero > other.drive_pole))) return {};
    const double steep = 1.0 / root->u; // sqrt(q^2 - 1)
    const double amplitude2 = 16.0 * (own_epsilon * steep - root->rate);
    if (!(amplitude2 > 0.0 && amplitude2 < 1.0)) return {};
    const double angle = std::sqrt(amplitude2 / (steep * steep + 1.0));
    const double mu = pi * own_epsilon * amplitude2 / (2.0 * angle);
    const double drive = seen.level / (own_epsilon * steep);
    std::vector<double> twin(x.begin(), x.end());
    const auto put = [&](Quantity quantity, double value) {
      twin[parameters.find(quantity)->index] = parameters.find(quantity)->coordinate_of(value);
    };
    if (parameters.is_free(Quantity::epsilon)) put(Quantity::epsilon, own_epsilon);
    put(Quantity::mu, mu);
    put(Quantity::phi0, angle);
    put(Quantity::lambda0,
        value_of(parameters, Quantity::lambda0, x) * std::sqrt(amplitude2 / clock.amplitude2));
    put(Quantity::drive_rms, drive);
    for (const Slot& slot : parameters.slots)
      if (slot.quantity == Quantity::T0 && slot.free)
        twin[slot.index] =
            slot.coordinate_of(slot.value(x) * (1.0 + root->rate) / (1.0 + now.rate));
    if (!has_slow) return twin;
    const double zero2 = other.drive_zero * other.drive_zero, pole = other.drive_pole;
    put(Quantity::slow_rms, drive * std::sqrt(0.5 * (zero2 / pole - pole)));
    put(Quantity::slow_time, clock.T0 / pole);
    return twin;
  };
  std::vector<std::optional<std::vector<double>>> twins;
  for (const Density& other :
       choices(seen, has_slow && parameters.is_free(Quantity::epsilon), has_slow))
    twins.push_back(twin_at(other));
  return twins;
}

} // namespace goingrate::timing_model
