#include "goingrate/clock/parameters.hpp"

#include "goingrate/base/errors.hpp"

#include <cmath>
#include <numbers>

namespace goingrate {

namespace {

void check_table(std::string_view name, const TorqueTable& table) {
  if (table.points.size() == 1)
    throw ArgumentError(name, "one point", "a table of two points at least");
  double before = -std::numbers::pi;
  for (const auto& [angle, torque] : table.points) {
    if (!(angle > before && angle < std::numbers::pi))
      throw ArgumentError(name, angle, "an angle between -pi and pi, above the one before it");
    if (!(std::abs(torque) < 1.0)) throw ArgumentError(name, torque, "a torque between -1 and 1");
    before = angle;
  }
}

} // namespace

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
  if (!(clock.quadratic_drag >= 0.0 && clock.quadratic_drag <= 10.0))
    throw ArgumentError("quadratic_drag", clock.quadratic_drag, "between 0 and 10");
  if (!(clock.dry_friction >= 0.0 && clock.dry_friction < 1.0))
    throw ArgumentError("dry_friction", clock.dry_friction, "at least 0 and below 1");
  if (!(clock.impulse >= 0.0 && clock.impulse < 1.0))
    throw ArgumentError("impulse", clock.impulse, "at least 0 and below 1");
  if (!(std::abs(clock.impulse_angle) < std::numbers::pi / 2.0))
    throw ArgumentError("angle", clock.impulse_angle, "between -pi/2 and pi/2 rad");
  if (!(clock.gravity_share >= -10.0 && clock.gravity_share <= 1.5))
    throw ArgumentError("gravity_share", clock.gravity_share,
                        "between -10 and 1.5 (1 is gravity alone)");
  if (!(clock.every >= 1 && clock.every <= 10'000))
    throw ArgumentError("every", static_cast<double>(clock.every), "between 1 and 1e4 periods");
  if (!(clock.below >= 0.0 && clock.below < std::numbers::pi))
    throw ArgumentError("below", clock.below, "at least 0 and below pi rad");
  if (clock.every > 1 && clock.below > 0.0)
    throw ArgumentError("below", clock.below,
                        "0 where `every` is above 1: an escapement waits for the count or for the "
                        "amplitude");
  if (clock.is_intermittent() && clock.escapement == Escapement::none)
    throw ArgumentError(clock.every > 1 ? "every" : "below",
                        clock.every > 1 ? static_cast<double>(clock.every) : clock.below,
                        "an escapement that acts in some periods: this pendulum has none");
  if (clock.escapement == Escapement::profile && clock.rising.points.empty() &&
      clock.falling.points.empty())
    throw ArgumentError("rising", std::string("missing"),
                        "the torque of the profile by angle, here or in `falling`");
  check_table("rising", clock.rising);
  check_table("falling", clock.falling);
}

std::string_view name_of(Escapement escapement) {
  switch (escapement) {
  case Escapement::constant_torque:
    return "constant-torque";
  case Escapement::single_impulse:
    return "single-impulse";
  case Escapement::profile:
    return "profile";
  case Escapement::none:
    break;
  }
  return "none";
}

} // namespace goingrate
