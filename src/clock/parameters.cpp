#include "goingrate/clock/parameters.hpp"

#include "goingrate/base/errors.hpp"

#include <cmath>
#include <numbers>

namespace goingrate {

void check(const ClockParameters& clock) {
  // Written as "not (good)" so that a NaN is refused too.
  if (!(clock.nominal_period_s >= 1e-6 && clock.nominal_period_s <= 1e6))
    throw ArgumentError("nominal_period", clock.nominal_period_s, "between 1e-6 and 1e6 s");
  if (!(clock.epsilon >= 0.0 && clock.epsilon < 1.0))
    throw ArgumentError("epsilon", clock.epsilon, "at least 0 and below 1");
  if (!(clock.mu >= 0.0 && clock.mu < 1.0)) // at 1 the torque holds the pendulum up for good
    throw ArgumentError("mu", clock.mu, "at least 0 and below 1");
  if (clock.escapement == Escapement::constant_torque && clock.mu > 0.0 &&
      !(clock.phi0 > 0.0 && clock.phi0 < std::numbers::pi))
    throw ArgumentError("phi0", clock.phi0, "an angle between 0 and pi rad");
}

std::string_view name_of(Escapement escapement) {
  return escapement == Escapement::none ? "none" : "constant-torque";
}

} // namespace goingrate
