// The clock that amplitudes and times tell together, whatever its drive does. Private to the fit
// room.
//
// What the drive gives in a cycle shows twice: in the amplitude that it leaves and in the push that
// it gives the phase. Between the two the drive drops out. With x = (2 sin(amplitude/2))^2, to
// first order lambda^2, and f = sqrt(x/phi0^2 - 1), the averaged equations of a constant torque
// give for a cycle
//   period/T0 = 1 + x/16 - f (epsilon + dx/dn / (4 pi x)),
// and the times, with G = (f - atan f)/(2 pi),
//   t_n - t_0 = T0 [n + sum x/16 - epsilon sum f - (G(x_n) - G(x_0))]:
// at a given phi0 linear in T0 and in epsilon. The circular error is taken one order further,
// x/16 + 9 x^2/1024: it alone is large where the swing is.
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

/// The clock by least squares of the times over phi0; what `parameters` hold is held. Nothing
/// without amplitudes at nearly all beats, or where no friction above 0 explains the times best.
/// Good as a start: noise of the amplitudes counts as noise of the times
/// (AmplitudeClockTest.FindsTheClockUnderARoughDrive).
std::optional<AmplitudeClock> amplitude_clock(const TimingData& data, const Parameters& parameters);

} // namespace goingrate::timing_model
