#include "goingrate/clock/parameters.hpp"

#include "goingrate/base/errors.hpp"

#include <cmath>
#include <numbers>

namespace goingrate {

void check(const ClockParameters& clock) {
  // Written as "not (good)" so that a NaN is refused too.
  if (!(clock.nominal_period_s > 0.0) || !std::isfinite(clock.nominal_period_s))
    throw ArgumentError("nominal_period", clock.nominal_period_s, "a positive number of seconds");
  if (!(clock.epsilon >= 0.0 && clock.epsilon < 1.0))
    throw ArgumentError("epsilon", clock.epsilon, "at least 0 and below 1");
  if (!(clock.mu >= 0.0) || !std::isfinite(clock.mu))
    throw ArgumentError("mu", clock.mu, "a number not below 0");
  if (clock.escapement == Escapement::constant_torque && clock.mu > 0.0 &&
      !(clock.phi0 > 0.0 && clock.phi0 < std::numbers::pi))
    throw ArgumentError("phi0", clock.phi0, "an angle between 0 and pi rad");
}

std::string_view name_of(Escapement escapement) {
  return escapement == Escapement::none ? "none" : "constant-torque";
}

} // namespace goingrate
