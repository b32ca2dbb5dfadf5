// The effect of a change in the middle of a swing on the averaged clock. Private to the fit room.
//
// The averaged amplitude and phase differ from the instantaneous ones by the work of the forces
// since the upward crossing beyond their mean,
//   P(theta) = C(theta) - theta/(2 pi) C(2 pi),   theta the phase since the crossing,
// with C the work of first order: lambda' = F cos psi, psi' - 1 = -F sin psi/lambda (Hoyng, eqs.
// dotl4 and dotpsi4 before they are averaged). Angle and speed do not leap where the laws change,
// so the averages do, by P of the old laws minus P of the new ones. At a crossing P is 0.
#pragma once

#include "course.hpp"

#include "base/scaled_time.hpp"

#include <cmath>
#include <numbers>

namespace goingrate::timing_model {

/// Leaps of the averaged amplitude and phase, rad.
template <class T> struct Leap { T amplitude{}, phase{}; };

/// P of constant torque, which helps from -phi0 to phi0 on the way up and hinders from there on.
/// `cosine` and `sine` are those of theta, 0 to 2 pi.
template <class T>
Leap<T> ahead_of_mean_torque(const AveragedLaws<T>& laws, const T& amplitude, const T& theta,
                             const T& cosine, const T& sine) {
  using std::sqrt;
  const T reach = laws.phi0 / amplitude, clear = sqrt(T(1.0) - reach * reach);
  const double switches = std::asin(plain(reach)), at = plain(theta);
  const int passed = at < switches                      ? 0
                     : at < std::numbers::pi + switches ? 1
                                                        : 2; // switches so far
  const double side = passed == 1 ? -1.0 : 1.0, share = 1.0 / two_pi;
  const T mean = theta * (4.0 * share);
  return {laws.mu * (reach * (2.0 * passed) + sine * side - mean * reach),
          laws.mu / amplitude * (clear * (2.0 * passed) - 1.0 + cosine * side - mean * clear)};
}

/// P of a single impulse, of which each passage through its angle gives half.
template <class T>
Leap<T> ahead_of_mean_impulse(const AveragedLaws<T>& laws, const T& amplitude, const T& theta) {
  const double first = std::asin(plain(laws.phi0) / plain(amplitude));
  double given = 0.0;
  for (const double pass : {first, first + std::numbers::pi, first + two_pi})
    if (pass > 0.0 && pass < plain(theta)) given += std::numbers::pi;
  const T ahead = theta * -1.0 + given;
  return {laws.drive() / amplitude * 0.5 * ahead, laws.push(T(amplitude * amplitude)) * ahead};
}

/// P of these laws at a phase of `cycles` after an upward crossing.
template <class T>
Leap<T> ahead_of_mean(const AveragedLaws<T>& laws, const T& amplitude, const T& cycles) {
  using std::cos, std::sin;
  const T theta = (cycles - std::floor(plain(cycles))) * two_pi;
  const T cosine = cos(theta), sine = sin(theta);
  Leap<T> ahead = laws.escapement == Escapement::single_impulse
                      ? ahead_of_mean_impulse(laws, amplitude, theta)
                      : ahead_of_mean_torque(laws, amplitude, theta, cosine, sine);
  ahead.amplitude -= laws.epsilon * amplitude * sine * cosine;
  ahead.phase += laws.epsilon * sine * sine;
  return ahead;
}

/// By how much amplitude and phase leap where the laws change at a phase of `cycles` after an
/// upward crossing and T0 grows by the factor `stretched`: the angle and its speed in rad/s go on.
template <class T>
Leap<T> leap_between(const AveragedLaws<T>& before, const AveragedLaws<T>& after,
                     const T& amplitude, const T& cycles, const T& stretched) {
  using std::cos, std::sin, std::sqrt;
  const T cosine = cos(cycles * two_pi), sine = sin(cycles * two_pi);
  const T grown = sqrt(sine * sine + stretched * stretched * cosine * cosine);
  const Leap<T> then = ahead_of_mean(before, amplitude, cycles);
  const Leap<T> now = ahead_of_mean(after, amplitude, cycles);
  return {amplitude * (grown - 1.0) + then.amplitude - now.amplitude,
          then.phase - now.phase - (stretched - 1.0) * sine * cosine};
}

} // namespace goingrate::timing_model
