// The numbers that make a clock in the paper's model.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace goingrate {

/// The escapements that exist.
enum class Escapement {
  constant_torque, ///< torque +mu until phi rises through phi0, then -mu until it falls through
                   ///< -phi0 (Hoyng, sec. modesc)
  single_impulse,  ///< an impulse of energy e when phi rises through an angle (eq. blow1)
  profile,         ///< a table of torque against angle for each direction
  none,            ///< a free pendulum
};

/// Torque against angle: linear between the points, zero outside them.
struct TorqueTable {
  /// One point of the table.
  struct Point {
    double angle;  ///< rad, rising from point to point
    double torque; ///< scaled, as mu; positive to the right
    friend bool operator==(const Point&, const Point&) = default;
  };
  std::vector<Point> points; ///< none, or two at least
  friend bool operator==(const TorqueTable&, const TorqueTable&) = default;
};

/// A pendulum clock (Hoyng, eq. ddt1, with two more friction laws and other restoring torques), in
/// scaled time:
///   phi'' + 2 epsilon phi' + quadratic_drag |phi'| phi' + dry_friction sign(phi')
///     + (1 - s) phi + s sin phi = m,   s = gravity_share
struct ClockParameters {
  double nominal_period_s = 2.0; ///< T0, s: small-amplitude period without friction and drive;
                                 ///< 1e-6 to 1e6
  double epsilon = 0.0;          ///< friction coefficient, scaled; 0 <= epsilon < 1
  double mu = 0.0;               ///< driving torque over moment of inertia, scaled; 0 <= mu < 1
  double phi0 = 0.0;             ///< switching angle, rad; 0 < phi0 < pi with an escapement
  Escapement escapement = Escapement::constant_torque;
  double quadratic_drag = 0.0; ///< 0 to 10
  double dry_friction = 0.0;   ///< 0 <= dry_friction < 1
  double impulse = 0.0;        ///< e of a single impulse: phi'^2/2 grows by it; 0 <= impulse < 1
  double impulse_angle = 0.0;  ///< where, rad; between -pi/2 and pi/2
  TorqueTable rising{}, falling{}; ///< a profile's torque while phi rises and while it falls
  double gravity_share = 1.0;      ///< s: 1 gravity alone, 0 torsion; made smaller by springs (of a
                                   ///< suspension or a balance) and by cheeks; -10 to 1.5
  std::int64_t every = 1; ///< the escapement acts in every N-th period (Synchronome: 15), beginning
                          ///< with the first of a run; this N, 1 to 1e4
  double below = 0.0; ///< rad; above 0, it acts only in periods that begin with a smaller turning
                      ///< angle than this (Hipp); 0 to pi, and 0 where `every` is above 1

  /// The torque of the constant-torque escapement, 0 with any other.
  [[nodiscard]] double acting_torque() const {
    return escapement == Escapement::constant_torque ? mu : 0.0;
  }
  /// Whether friction has no other term.
  [[nodiscard]] bool has_linear_friction() const {
    return quadratic_drag == 0.0 && dry_friction == 0.0;
  }
  /// Whether the escapement rests in some periods.
  [[nodiscard]] bool is_intermittent() const { return every > 1 || below > 0.0; }
  /// Whether, while the escapement acts, the laws are those of the paper's main text, which the
  /// fast methods know: linear friction, gravity, an escapement of constant torque or none.
  [[nodiscard]] bool is_plain() const {
    return has_linear_friction() && gravity_share == 1.0 &&
           (escapement == Escapement::constant_torque || escapement == Escapement::none);
  }
  friend bool operator==(const ClockParameters&, const ClockParameters&) = default;
};

/// Throws ArgumentError naming the first parameter outside the ranges given above.
void check(const ClockParameters& clock);

/// The names scenarios and results use.
std::string_view name_of(Escapement escapement);

} // namespace goingrate
