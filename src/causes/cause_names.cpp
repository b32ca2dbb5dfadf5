#include "goingrate/causes/diagnosis.hpp"

namespace goingrate {

std::string_view name_of(Cause cause) {
  switch (cause) {
  case Cause::slow_drive:
    return "slow drive";
  case Cause::drive_step:
    return "step of the drive";
  case Cause::friction_step:
    return "step of the friction";
  case Cause::growing_friction:
    return "growing friction";
  case Cause::temperature:
    return "temperature";
  case Cause::pressure:
    return "pressure";
  case Cause::length_step:
    return "step of the length or regulation";
  case Cause::wheel:
    return "a wheel";
  case Cause::sensor_shift:
    return "shift of the sensor";
  case Cause::missed_beats:
    return "missed beats";
  case Cause::rough_drive:
    return "rough drive";
  case Cause::length_drift:
    return "a drifting length";
  case Cause::log_clock:
    return "the logger's own clock";
  case Cause::unlogged_weather:
    return "weather that was not logged";
  case Cause::knock:
    return "knocks";
  case Cause::magnet:
    return "a magnet or weight brought near";
  case Cause::stop:
    return "a stop";
  case Cause::unknown:
    break;
  }
  return "unknown";
}

} // namespace goingrate
