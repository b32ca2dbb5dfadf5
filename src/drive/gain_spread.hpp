// The effect of a wandering amplitude on the gains of a clock. Private to the drive room.
//
// The response H belongs to one amplitude. A slow drive of several per cent moves the amplitude,
// and with it the gains: with y = sqrt(x - phi0^2), x = lambda^2 about x0,
//   g_fast(x) = c y/x   and, the amplitude in step with the drive,   rate(x) = c y/x0 - x/16,
// c = g_fast(x0) x0/y0 (Hoyng, eqs. dotpsi4, statam). A relative spread of x of rms s_x raises the
// mean square of g_fast by one factor; that of the slow part of the rate is raised by what the
// curvature of rate(x) adds to |H|^2 s_x^2 at the frequency 1/(2 pi tau). For an Ornstein-Uhlenbeck
// drive of rms s and memory tau, s_x^2 = s^2 tau/(tau + tau_r), tau_r the relaxation 1/(2 pi f_c);
// the second factor holds for that share of the variance.
#pragma once

#include "rate_components.hpp"

namespace goingrate::timing_model {

/// The components of the drive itself, from those found with the gains of one amplitude.
RateComponents with_gains_averaged(RateComponents components, const DriveResponse& response);

/// 1/(2 pi f_c).
double relaxation_s(const DriveResponse& response);

/// s_x; 0 where there is no slow drive, or no amplitude is known.
double amplitude_spread(const RateComponents& drive, const DriveResponse& response);

/// The relative standard deviation of the mean drive over a log of this length, and thus of the
/// mean x: s sqrt(2 tau/length), at most s.
double mean_shift(const RateComponents& drive, const DriveResponse& response, double length_s);

/// The relative uncertainty of the gains if the mean amplitude is uncertain by `shift`: of g_fast,
/// and of |H| at the frequency 1/(2 pi tau) of a slow drive.
struct GainDoubt {
  double fast = 0.0, slow = 0.0;
};
GainDoubt gain_doubt(const DriveResponse& response, double shift, double memory_s);

} // namespace goingrate::timing_model
