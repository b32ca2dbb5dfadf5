// The numbers that make a clock in the paper's model.
#pragma once

#include <string_view>

namespace goingrate {

/// The escapements that exist.
enum class Escapement {
  constant_torque, ///< torque +mu, then -mu from phi0 on; see escapement.hpp
  none,            ///< a free pendulum
};

/// A pendulum clock: phi'' + 2 epsilon phi' + sin phi = m (Hoyng, eq. ddt1), in scaled time.
struct ClockParameters {
  double nominal_period_s = 2.0; ///< T0, s: small-amplitude period without friction and drive;
                                 ///< 1e-6 to 1e6
  double epsilon = 0.0;          ///< friction coefficient, scaled; 0 <= epsilon < 1
  double mu = 0.0;               ///< driving torque over moment of inertia, scaled; 0 <= mu < 1
  double phi0 = 0.0;             ///< switching angle, rad; 0 < phi0 < pi with an escapement
  Escapement escapement = Escapement::constant_torque;

  /// The torque that really acts: 0 without an escapement.
  [[nodiscard]] double acting_torque() const { return escapement == Escapement::none ? 0.0 : mu; }
};

/// Throws ArgumentError naming the first parameter outside the ranges given above.
void check(const ClockParameters& clock);

/// The names scenarios and results use.
std::string_view name_of(Escapement escapement);

} // namespace goingrate
