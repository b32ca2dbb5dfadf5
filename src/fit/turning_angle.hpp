// The turning angle of a swing that passes the vertical with a given speed, with derivatives.
// Private to the fit room.
//
// The free pendulum with gravity's share s of the restoring torque (clock/restoring.hpp) turns at
// A,
//   phi'^2 = (1 - s) A^2 + 4 s sin^2(A/2);   under gravity A = 2 asin(phi'/2).
#pragma once

#include "course.hpp"

#include "goingrate/clock/restoring.hpp"

#include <cmath>

namespace goingrate::timing_model {

inline double gravity_share_of(double circular) { return 16.0 * circular; }

template <class T> T turning_angle_at(const AveragedLaws<T>& laws, const T& speed2) {
  using std::asin, std::sqrt;
  const double share = gravity_share_of(plain(laws.circular));
  if (share == 1.0) return asin(sqrt(speed2) * 0.5) * 2.0;
  const double angle = turning_angle_of_velocity(share, std::sqrt(plain(speed2)));
  const double sine = 2.0 * std::sin(0.5 * angle);
  const double pull = share * std::sin(angle) + (1.0 - share) * angle;
  // One Newton step at the root leaves its value unchanged and gives it its derivatives.
  const T missing = speed2 - angle * angle - laws.circular * (16.0 * (sine * sine - angle * angle));
  return missing * (0.5 / pull) + angle;
}

/// dA/d(phi'^2), which is half the inverse of the pull at A.
template <class T> T slope_of_turning_angle(const AveragedLaws<T>& laws, const T& speed2) {
  using std::sin, std::sqrt;
  if (gravity_share_of(plain(laws.circular)) == 1.0)
    return T(0.5) / sqrt(speed2 * (speed2 * -0.25 + 1.0));
  const T angle = turning_angle_at(laws, speed2);
  return T(0.5) / (angle + laws.circular * 16.0 * (sin(angle) - angle));
}

} // namespace goingrate::timing_model
