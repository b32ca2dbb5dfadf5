// Estimates the clock from amplitudes and times together, independently of its drive. Private to
// the fit room.
//
// The drive in a cycle shows twice: in the change of the amplitude and in the change of the phase.
// It can be eliminated between the two. With x = (2 sin(amplitude/2))^2, to first order lambda^2,
// and f = sqrt(x/phi0^2 - 1), the averaged equations of a constant torque give for a cycle
//   period/T0 = 1 + x/16 - f (epsilon + dx/dn / (4 pi x)),
// and the times, with G = (f - atan f)/(2 pi),
//   t_n - t_0 = T0 [n + sum x/16 - epsilon sum f - (G(x_n) - G(x_0))]:
// which is linear in T0 and in epsilon at a given phi0. The circular error is taken one order
// further, x/16 + 9 x^2/1024, because it alone is large for a large swing.
#pragma once

#include "parameters.hpp"

#include "goingrate/fit/timing_data.hpp"

#include <optional>

namespace goingrate::timing_model {

struct AmplitudeClock {
  double T0 = 0.0; ///< s
  double epsilon = 0.0;
  double phi0 = 0.0;       ///< rad
  double amplitude2 = 0.0; ///< mean of lambda^2, rad^2
};

/// The clock by least squares of the times over phi0; parameters that `parameters` hold are held.
/// nullopt without amplitudes at nearly all beats, or if no friction above 0 explains the times
/// best. Good enough as a start: noise of the amplitudes counts as noise of the times
/// (AmplitudeClockTest.FindsTheClockUnderARoughDrive).
std::optional<AmplitudeClock> amplitude_clock(const TimingData& data, const Parameters& parameters);

} // namespace goingrate::timing_model
