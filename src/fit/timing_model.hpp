// The averaged clock as a function of its parameters: residuals of times, and amplitudes.
// Private to the fit room.
#pragma once

#include "goingrate/base/scaled_time.hpp"
#include "goingrate/dynamics/averaged.hpp"
#include "goingrate/fit/timing_data.hpp"

#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace goingrate::timing_model {

enum class Quantity { T0, epsilon, mu, phi0, lambda0 };

/// How a parameter is written as the number that is searched for.
enum class Coordinate {
  logarithm, ///< value = exp(x): cannot become negative
  multiple,  ///< value = scale x: may become zero, as a drive that is cut off
  stretch,   ///< value = scale (1 + x): T0 about the mean period
};

struct Slot {
  Quantity quantity;
  std::size_t event; ///< 0: from the start; k: from the k-th event on
  Coordinate coordinate;
  double scale;
  bool free;
  double fixed_value; ///< if not free
  std::size_t index;  ///< of x among the free ones

  template <class T> [[nodiscard]] T value(std::span<const T> x) const {
    using std::exp;
    if (!free) return T(fixed_value);
    switch (coordinate) {
    case Coordinate::logarithm:
      return exp(x[index]);
    case Coordinate::multiple:
      return x[index] * scale;
    case Coordinate::stretch:
      break;
    }
    return (x[index] + 1.0) * scale;
  }
  /// The x that gives `value`.
  [[nodiscard]] double coordinate_of(double value) const {
    switch (coordinate) {
    case Coordinate::logarithm:
      return std::log(value);
    case Coordinate::multiple:
      return value / scale;
    case Coordinate::stretch:
      break;
    }
    return value / scale - 1.0;
  }
  /// d value / d x.
  [[nodiscard]] double slope(std::span<const double> x) const {
    return coordinate == Coordinate::logarithm ? value(x) : scale;
  }
};

/// All parameters of one clock: five from the start and those that change.
struct Parameters {
  std::vector<Slot> slots;
  std::vector<double> event_cycles; ///< in order; event k of the slots is entry k - 1
  std::size_t free_count = 0;
  /// lambda0 over the averaged amplitude at the start. 1 for averaged1, where lambda0 is that
  /// average; for the full equation lambda0 is the velocity at the crossing, and the ratio is that
  /// of the limit cycle, so that a stationary start is stationary in both.
  double start_ratio = 1.0;
};

/// What the model says about each beat.
template <class T> struct Prediction {
  std::vector<T> residual_s; ///< t_i less the model's time: (psi(t_i) - 2 pi n_i) T0 / (2 pi psi')
  std::vector<T> amplitude;  ///< turning angle, rad
};

/// The parameters that hold at present, and where the clock stood when they began to.
template <class T> struct Going {
  T T0{}, epsilon{}, mu{}, phi0{};
  T amplitude2_start{};
  T start{};  ///< scaled time at which they began to hold
  T excess{}; ///< psi - t there

  [[nodiscard]] AveragedMotion<T> motion() const { return {epsilon, mu, phi0, amplitude2_start}; }

  /// The time at which psi = 2 pi n. The excess changes by parts in ten thousand, so each round of
  /// t = 2 pi n - excess(t) gains four digits, in the derivatives too.
  [[nodiscard]] T time_of_cycle(const AveragedMotion<T>& motion, double n) const {
    T t = two_pi * n - excess;
    for (int round = 0; round < 5; ++round)
      t = two_pi * n - excess - motion.at(t - start).phase_excess;
    return t;
  }
};

template <class T>
void apply_changes(const Parameters& parameters, std::span<const T> x, std::size_t event,
                   Going<T>& going) {
  for (const Slot& slot : parameters.slots) {
    if (slot.event != event) continue;
    const T value = slot.value(x);
    switch (slot.quantity) {
    case Quantity::T0:
      going.T0 = value;
      break;
    case Quantity::epsilon:
      going.epsilon = value;
      break;
    case Quantity::mu:
      going.mu = value;
      break;
    case Quantity::phi0:
      going.phi0 = value;
      break;
    case Quantity::lambda0:
      going.amplitude2_start = value * value;
      break;
    }
  }
}

/// Lets `going` run to the event and applies its changes; false where the model does not hold.
template <class T>
bool pass_event(const Parameters& parameters, std::span<const T> x, std::size_t event,
                Going<T>& going) {
  const AveragedMotion<T> motion = going.motion();
  const double cycle = parameters.event_cycles[event - 1];
  if (!motion.in_domain(two_pi * cycle - going.excess - going.start)) return false;
  const T t = going.time_of_cycle(motion, cycle);
  if (!motion.in_domain(t - going.start)) return false;
  const auto state = motion.at(t - going.start);
  going.excess += state.phase_excess;
  going.start = t;
  going.amplitude2_start = state.amplitude2;
  apply_changes(parameters, x, event, going);
  return true;
}

/// Fills `out`; false where the model does not hold (amplitude down to phi0, or not finite).
template <class T>
bool predict(const Parameters& parameters, std::span<const T> x, const TimingData& data,
             Prediction<T>& out) {
  using std::isfinite, std::sqrt;
  out.residual_s.resize(data.size());
  out.amplitude.resize(data.size());
  Going<T> going;
  apply_changes(parameters, x, 0, going);
  going.amplitude2_start /= parameters.start_ratio * parameters.start_ratio;
  AveragedMotion<T> motion = going.motion();
  const T scaled_per_second = two_pi / going.T0;
  const T seconds_per_scaled = going.T0 / two_pi;
  const T longer = going.T0 - data.reference_period_s;
  std::size_t event = 0;
  for (std::size_t i = 0; i < data.size(); ++i) {
    while (event < parameters.event_cycles.size() &&
           data.cycle[i] > parameters.event_cycles[event]) {
      if (!pass_event(parameters, x, ++event, going)) return false;
      motion = going.motion();
    }
    const T t = data.elapsed_s[i] * scaled_per_second - going.start;
    if (!motion.in_domain(t)) return false;
    const auto state = motion.at(t);
    // What is late in phase is late in time by the rate: without the division a model that runs
    // slow would shrink the noise, and be preferred for it.
    out.residual_s[i] = (data.lateness_s[i] - data.cycle[i] * longer +
                         seconds_per_scaled * (going.excess + state.phase_excess)) /
                        (state.rate_excess + 1.0);
    out.amplitude[i] = turning_angle(T(sqrt(state.amplitude2)));
    if (!isfinite(out.residual_s[i]) || !isfinite(out.amplitude[i])) return false;
  }
  return true;
}

} // namespace goingrate::timing_model
