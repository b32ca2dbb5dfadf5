// What one cycle makes of a disturbance: by the averaged equations, and what the full equation adds
// to that. Private to the fit room.
//
// With w the departure of lambda^2 from its course at an upward crossing, u the relative departure
// of the drive and t the lateness, to first order
//   w' = kept w + raised u,    t' = t + follow w + kick u.
// From dx' = f_x x + D u and late' = -(g_x x + push u) (course.hpp), with a = 2 pi f_x and
// M = (exp a - 1)/a,
//   kept = exp a,  raised = 2 pi D M,  follow = -T0 g_x M,
//   kick = -T0 [push + 2 pi g_x D (M - 1)/a].
// A log obeys the return map at the crossings, whose derivatives differ from these by parts of
// epsilon and of mu/lambda. Where they pass for an error of phi0 or T0, they have to be known.
#pragma once

#include "course.hpp"

#include "base/scaled_time.hpp"

namespace goingrate::timing_model {

template <class T> struct CycleGains {
  T gone{};            ///< kept - 1
  T raised{};          ///< rad^2
  T follow{};          ///< s per rad^2
  T kick{};            ///< s
  T follow_by_drive{}; ///< of follow, s per rad^2 and relative drive
};

/// By the averaged equations; amplitude2 is lambda^2.
template <class T>
CycleGains<T> averaged_cycle(const AveragedLaws<T>& laws, const T& amplitude2, const T& T0) {
  using std::expm1;
  const T a = laws.growth_slope(amplitude2) * two_pi;
  const T gone = expm1(a), mean = gone / a;
  const T drive = laws.drive() * two_pi;
  const T driven = laws.push_slope(amplitude2) * T0 * -1.0;
  const T slope = driven + T0 * (1.0 / 16.0);
  return {gone, drive * mean, slope * mean,
          slope * drive * (mean - 1.0) / a - laws.push(amplitude2) * T0, driven * mean};
}

/// The full equation beside the averaged one, to second order in w and u.
struct CycleResponse {
  CycleGains<double> factor{1.0, 1.0, 1.0, 1.0, 1.0}; ///< of the gains on the course,
  CycleGains<double> slope{};                         ///< and how they go with w, per rad^2
  double angle = 1.0; ///< factor of the derivative of the turning angle by lambda^2
  /// Half the second derivatives by w and by u, and the one by both.
  struct Bend {
    double ww = 0.0, wu = 0.0, uu = 0.0;
    /// Of second order, for departures of these mean squares and products.
    template <class T> [[nodiscard]] T of(const T& w2, const T& product, const T& u2) const {
      return w2 * ww + product * wu + u2 * uu;
    }
  };
  Bend amplitude2; ///< rad^2
  Bend late;       ///< s

  /// The gains where the squared amplitude is w above the course's.
  template <class T>
  [[nodiscard]] CycleGains<T> at(const AveragedLaws<T>& laws, const T& amplitude2_there,
                                 const T& T0, const T& w) const {
    CycleGains<T> gains = averaged_cycle(laws, amplitude2_there, T0);
    gains.gone *= w * slope.gone + factor.gone;
    gains.raised *= w * slope.raised + factor.raised;
    gains.follow *= w * slope.follow + factor.follow;
    gains.kick *= w * slope.kick + factor.kick;
    gains.follow_by_drive *= factor.follow_by_drive;
    return gains;
  }
};

/// By differences of the return map about the course of a clock that crosses with phi'^2 = `speed2`
/// when its averaged amplitude squared is `amplitude2`; without a difference where the map is not
/// regular there. Gains to 3e-5 (CycleResponseTest.GainsAreTheDerivativesOfTheReturnMap). Cost:
/// nine periods.
CycleResponse cycle_response(const ClockParameters& clock, double speed2,
                             const AveragedLaws<double>& laws, double amplitude2);

} // namespace goingrate::timing_model
