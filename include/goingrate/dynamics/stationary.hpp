// Stationary operation: amplitude and rate of a clock whose parameters are constant.
//
// Notation: lambda amplitude (rad), v = phi' at the upward crossing (scaled), rate excess
// psi' - 1 (a fraction). All angles in rad, all times scaled unless a name ends in _s.
#pragma once

#include "goingrate/clock/parameters.hpp"

#include <complex>
#include <optional>

namespace goingrate {

/// The amplitude at which drive and friction balance, in first order (cycle average): lambda =
/// sqrt(2 mu phi0 / (pi epsilon)) (Hoyng, eq. statam); for other laws the largest lambda with
/// friction_moment = a (moments.hpp), e.g. sqrt(e / (2 pi epsilon)) for a single impulse.
/// If the escapement acts only now and then, it is sqrt(<lambda^2>) (intermittent.hpp).
/// nullopt if there is no drive or no friction, or if the escapement is not reached (lambda <=
/// phi0) and the clock stalls.
std::optional<double> stationary_amplitude(const ClockParameters& clock);

/// Rate excess -s lambda^2/16 - b/lambda there, s being gravity_share: -mu phi0/(8 pi eps) + eps
/// sqrt(2 mu/(pi eps phi0) - 1) for constant torque (eq. statrate), -e/(32 pi eps) - eps tan psi1
/// for an impulse (eq. blow6). Off by 5.4e-9, 7.1e-8, 1.8e-8 at the paper's points A, B, C
/// (StationaryTest.FirstOrderRateDiffersFromTheExactOneAsTabulated). nullopt if it stalls.
std::optional<double> stationary_rate_first_order(const ClockParameters& clock);

/// Rate excess 2 pi / T - 1 = -(T - 2 pi)/T of a scaled period, from T - 2 pi.
double rate_excess_of(double period_excess);

/// The limit cycle of the full equation of motion; with `every` N, that of N periods, and of an
/// escapement that waits for the amplitude to fall the orbit of waiting_orbit (intermittent.hpp).
struct LimitCycle {
  double velocity = 0.0;      ///< v*: phi' at the upward crossing; of many, one before an impulse
  double period_excess = 0.0; ///< T - 2 pi, scaled, to its own rounding; the mean of N
  double period = 0.0;        ///< T, scaled
  double rate_excess = 0.0;   ///< 2 pi / T - 1, without cancellation
};

/// Solves v' = v for the return map of the full equation of motion, any clock law. Velocity and
/// period within 1e-15, rate excess within 2e-15 of 128-bit values at A, B, C
/// (StationaryTest.LimitCycleMatchesExactValues); for an escapement that waits within its
/// WaitingOrbit::rate_within. nullopt if the clock stalls or turns over.
std::optional<LimitCycle> limit_cycle(const ClockParameters& clock);

/// The response of the rate to a small relative change of the drive, mu -> mu (1 + d).
struct DriveResponse {
  double fast_gain = 0.0; ///< d(rate)/d(d) with the amplitude frozen: 2 mu cos(psi0) / (pi lambda)
  double slow_gain = 0.0; ///< with the amplitude settled: -lambda^2/16 + eps q^2/(2 sqrt(q^2 - 1)),
                          ///< q = lambda/phi0
  double corner_hz = 0.0; ///< between the two: 2 epsilon / T0
  double amplitude2 = 0.0;      ///< lambda^2 at which the gains hold; 0 if not known
  double switching_angle = 0.0; ///< phi0, rad

  /// The complex gain at frequency f (Hz).
  [[nodiscard]] std::complex<double> at(double frequency_hz) const {
    return fast_gain + (slow_gain - fast_gain) / std::complex(1.0, frequency_hz / corner_hz);
  }
};

/// phi' at an upward crossing in stationary operation: that of the limit cycle; for an escapement
/// that waits for the amplitude to fall, the limit that it waits for. `averaged`: by the averaged
/// equations of first order, where it is lambda. nullopt if there is no stationary operation.
std::optional<double> stationary_start(const ClockParameters& clock, bool averaged);

/// The response in stationary operation, by eqs. dotl4 and dotpsi4. At A, B, C within 1e-3 of that
/// of the full equation (StationaryTest.DriveResponseMatchesExactGains). nullopt if the clock
/// stalls, and for other laws than constant torque with linear friction.
std::optional<DriveResponse> drive_response(const ClockParameters& clock);

} // namespace goingrate
