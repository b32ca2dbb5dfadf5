// The parameters of a fit and how each is written as a number to search for. Private to the fit
// room.
#pragma once

#include "goingrate/clock/parameters.hpp"

#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace goingrate::timing_model {

/// The kind of a parameter. The clock's come first, then those that act on the times, then the
/// noise's.
enum class Quantity {
  T0,
  epsilon,
  mu,   ///< or the impulse
  phi0, ///< or its angle
  quadratic_drag,
  dry_friction,
  gravity_share,
  lambda0,
  offset,          ///< of the sensor
  amplitude_scale, ///< amplitude in the column over the pendulum's amplitude
  term,            ///< coefficient of a RateTerm
  moment,          ///< cycles from the crossing that dates an event to the event itself
  late_leap,       ///< s, of the times at an event, if its moment is left open
  amplitude_leap,  ///< relative, of the amplitude
  jitter_rms,      ///< s, white in time
  walk_rms,        ///< s per period, white in rate, not from the drive
  drive_rms,       ///< relative, white from period to period
  slow_rms,        ///< relative, Ornstein-Uhlenbeck
  slow_time,       ///< s, its correlation time
  amplitude_rms,   ///< rad, of the amplitude column
};

inline bool is_noise(Quantity quantity) { return quantity >= Quantity::jitter_rms; }
/// Whether it belongs to the moment of an event, and is fitted only so that it does not disturb the
/// other parameters.
inline bool is_of_moment(Quantity quantity) {
  return quantity == Quantity::moment || quantity == Quantity::late_leap ||
         quantity == Quantity::amplitude_leap;
}
inline bool is_of_clock(Quantity quantity) {
  return !is_noise(quantity) && !is_of_moment(quantity);
}

/// How a parameter is expressed by the number that is searched for.
enum class Coordinate {
  logarithm, ///< value = exp(x): cannot become negative
  multiple,  ///< value = scale x: may become zero, such as a drive that is cut off
  stretch,   ///< value = scale (1 + x): T0 about the mean period, gravity_share about 1
};

struct Slot {
  Quantity quantity{};
  std::size_t event = 0; ///< 0: from the start; k: from the k-th event on
  Coordinate coordinate{};
  double scale = 1.0;
  bool free = true;
  double fixed_value = 0.0; ///< if not free
  std::size_t index = 0;    ///< of x among the free ones
  std::size_t term = 0;     ///< which RateTerm

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
  [[nodiscard]] double slope_at(double value) const {
    return coordinate == Coordinate::logarithm ? value : scale;
  }
};

/// All parameters of one model: from the start, those that change, and the noise that is present.
struct Parameters {
  Escapement escapement = Escapement::constant_torque; ///< or single_impulse, or none
  std::vector<Slot> slots;
  std::vector<std::string> term_names; ///< of the RateTerms, for names
  std::vector<double> event_cycles;    ///< in order; event k of the slots is entry k - 1
  std::size_t free_count = 0;
  /// lambda0 over the averaged amplitude at the start. It is 1 for averaged1, where lambda0 is that
  /// average. For other dynamics lambda0 is the velocity at the crossing, and the ratio is taken
  /// from the limit cycle, so that a stationary start is stationary in both.
  double start_ratio = 1.0;

  [[nodiscard]] const Slot* find(Quantity quantity, std::size_t event = 0) const {
    for (const Slot& slot : slots)
      if (slot.quantity == quantity && slot.event == event) return &slot;
    return nullptr;
  }
  [[nodiscard]] bool has(Quantity quantity) const { return find(quantity) != nullptr; }
  [[nodiscard]] bool is_free(Quantity quantity) const {
    const Slot* slot = find(quantity);
    return slot != nullptr && slot->free;
  }
  /// Adds a slot; a free one gets the next index in x.
  void add(Slot slot);
  /// The name of the parameter in results: "epsilon", "mu@1", "impulse", "temperature".
  [[nodiscard]] std::string name_of(const Slot& slot) const;
};

} // namespace goingrate::timing_model
