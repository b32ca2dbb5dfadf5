// The amplitude under a torque that changes with time, in first order and closed form.
//
// Equation (Hoyng, eq. dotl4): d(lambda^2)/dt = -2 eps lambda^2 + 4 mu(t) phi0 / pi, scaled time.
// lambda is the cycle average.
#pragma once

#include <functional>
#include <vector>

namespace goingrate {

/// lambda^2(t) = (4 phi0/pi) int_0^inf exp(-2 eps tau) mu(t - tau) dtau (eq. lamanal), for any
/// bounded torque history mu(t'), after all transients.
///
/// `jumps`: times at which mu jumps, where the quadrature is divided. epsilon > 0. Agrees with
/// eq. l2jump to 1e-12 (AmplitudeHistoryTest.AnyHistoryContainsTheJump).
double amplitude2_at(double t, const std::function<double(double)>& mu, double epsilon, double phi0,
                     const std::vector<double>& jumps = {});

/// lambda^2 at time t after (or, t < 0, before) a jump of the torque from mu0 to mu1 at t = 0
/// (eq. l2jump): (2 phi0/pi eps) (mu1 - (mu1 - mu0) exp(-2 eps t)).
double amplitude2_after_jump(double t, double mu0, double mu1, double epsilon, double phi0);

} // namespace goingrate
