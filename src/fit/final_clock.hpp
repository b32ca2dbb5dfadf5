// The clock after the last event, and the quantities that describe it. Private to the fit room.
#pragma once

#include "clock_model.hpp"

namespace goingrate::timing_model {

struct FinalClock {
  double T0 = 0.0;
  AveragedLaws<double> laws;
  double amplitude2 = 0.0; ///< at which it comes to rest, or its starting value without such

  /// Rate per relative drive, at constant amplitude and after the amplitude has settled.
  [[nodiscard]] double fast_gain() const { return laws.push(amplitude2); }
  [[nodiscard]] double slow_gain() const {
    return fast_gain() - laws.drive() * (laws.push_slope(amplitude2) - laws.circular) /
                             laws.growth_slope(amplitude2);
  }
  /// Q of a small swing with that amplitude (dynamics/swing_loss.hpp): 1/(2 epsilon) under linear
  /// friction.
  [[nodiscard]] double q_factor() const {
    const double lambda = std::sqrt(amplitude2);
    return 1.0 /
           (2.0 * laws.epsilon +
            4.0 / std::numbers::pi * (2.0 / 3.0 * laws.quadratic * lambda + laws.dry / lambda));
  }
  /// The decay time of the amplitude, s: T0/(2 pi epsilon) under linear friction.
  [[nodiscard]] double decay_time() const {
    return -T0 / (std::numbers::pi * laws.growth_slope(amplitude2));
  }
};

FinalClock final_clock(const Parameters& parameters, std::span<const double> x);

} // namespace goingrate::timing_model
