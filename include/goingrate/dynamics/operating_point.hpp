// The operation of a clock: stall line, nominal-rate line, and the operating point from any two of
// friction, torque, amplitude and rate (Hoyng, sec. statop, fig. rate); the optimal drive.
//
// Notation: epsilon friction and mu torque (scaled, 0 to 1), phi0 switching angle (rad, 0 to pi),
// lambda amplitude (rad), rate excess psi' - 1 (a fraction). With y = sqrt(lambda^2/phi0^2 - 1)
// the stationary operation of first order (eqs. statam, statrate) is
//   mu = (pi/2) eps phi0 (1 + y^2),   rate excess = -phi0^2 (1 + y^2)/16 + eps y,   y > 0.
// All functions throw ArgumentError naming the argument that is outside its range.
#pragma once

#include <optional>
#include <vector>

namespace goingrate {

/// The equations by which an answer is found.
enum class Equations {
  first_order, ///< the averaged ones, eqs. statam and statrate; amplitude is the cycle average
  exact,       ///< the limit cycle of eq. ddt1; amplitude is phi' at the upward crossing, v*
};

/// The torque (pi/2) eps phi0 at which lambda = phi0: below it the averaged clock stalls.
double stall_torque(double epsilon, double phi0);

/// The torque at which the limit cycle of the full equation just reaches phi0 at its turning point.
///
/// Found from half swings that graze phi0; relative accuracy 1e-17/epsilon. It is lower than
/// stall_torque by the part 5 phi0^2/96 + 0.32 eps^2 and more at large angles; for small epsilon it
/// tends to (8 eps/phi0) (E(k) - (1 - k^2) K(k)), k = sin(phi0/2)
/// (StallTorqueTest.ExactOneTendsToTheAreaOfTheFreeSwing). Below it the clock stalls, above it goes
/// (StallTorqueTest.SeparatesClocksThatGoFromClocksThatStall). nullopt if phi0 can be reached only
/// with phi' >= 2 at the vertical.
std::optional<double> exact_stall_torque(double epsilon, double phi0);

/// The torque at which a clock of this friction keeps nominal time: the dashed line of fig. rate.
///
/// The larger of the two torques with rate excess 0: there more torque makes the clock lose (at the
/// smaller one, nearer the stall line, gain). In first order
///   mu = (pi/2) eps phi0 (1 + y^2),  y = p + sqrt(p^2 - 1),  p = 8 eps/phi0^2.
/// nullopt if epsilon < phi0^2/8 (or its counterpart in the exact equations), where the clock loses
/// whatever the torque, or if amplitude 2 or torque 1 is exceeded. Accuracy as operating_points
/// (NominalRateTest.BothLinesAtPointC).
std::optional<double> nominal_rate_torque(double epsilon, double phi0, Equations equations);

/// Stationary operation. `amplitude` as Equations says.
struct OperatingPoint {
  double epsilon = 0.0;
  double mu = 0.0;
  double amplitude = 0.0;
  double rate_excess = 0.0;
};

/// The two quantities that are known: 0 < epsilon < 1, 0 < mu < 1, 0 < amplitude < 2,
/// rate_excess > -1.
struct KnownPair {
  std::optional<double> epsilon, mu, amplitude, rate_excess;
};

/// All operating points with the two `known` quantities, by rising amplitude: none, one, or two.
///
/// Two arise where the rate is known with epsilon or with mu: the rate first rises with the
/// amplitude (escapement error), then falls (circular error). Rates within 1e-12 of that maximum
/// may give none or two. Points with epsilon or mu >= 1 or amplitude >= 2 are left out.
///
/// Method: along the curve of known epsilon or mu, steps in log y, brackets from changes of sign
/// and from the maximum between steps, then TOMS 748; amplitude and rate by Newton steps in log
/// epsilon and log y, from first order. Accuracy: at A, B, C all six pairs give the others to
/// within 2e-11 of themselves (measured 3e-12; 1e-13 in first order); what limits it is that
/// limit_cycle's rate is good to 1e-15, and at A is close to its maximum
/// (OperatingPointTest.RoundTripOfAllPairs). From 0.003 to 0.3 rad, eps 1e-5 to 1e-2 all six come
/// back within 1e-8 (OperatingPointsTest.RoundTripsInAWideRegion). For random points up to 2 rad,
/// amplitude and rate miss 6 in 1000, all with phi' > 1.85 or mu > 0.8; the other pairs find
/// all. An exact solution takes 0.5 to 4 ms.
///
/// The exact equations follow limit_cycle. As long as that has no cycle below the *first-order*
/// stall line, points between exact_stall_torque and stall_torque are not found.
std::vector<OperatingPoint> operating_points(const KnownPair& known, double phi0,
                                             Equations equations);

/// The escapement error of a torque of limited reach (sec. optdriv): the rate excess it makes in
/// stationary operation.
///
/// The torque is m = M while phi rises through [centre - width/2, centre + width/2] and m = -M
/// while it falls through the mirrored interval. The error -(1/lambda) oint m sin psi, with M from
/// oint m cos psi = eps lambda (eqs. dotl3, dotpsi3; amplitude and friction fixed), is
///   -2 eps (centre/lambda) / (cos psi1 + cos psi2),  sin psi1,2 = (centre -+ width/2)/lambda.
/// Domain: 0 <= epsilon < 1, lambda > 0, width >= 0, |centre| + width/2 <= lambda, and less than
/// lambda if width = 0, which is the single impulse: -eps tan psi1 (eq. blow6). First order in
/// epsilon; free of cancellation (EscapementErrorTest.MatchesTheIntegrals), but for an end at the
/// turning point itself, whose cosine is good to 1e-8. Errors of torques acting together add with
/// the weights of their work: so the model escapement's
/// (EscapementErrorTest.ModelEscapementIsASumOfTwo).
///
/// What it says of the paper's claim that an impulse of the phase width dpsi << 1 beats the
/// estimate eps by the factor dpsi: centred (centre = 0) the error is zero for every width, however
/// large; off centre by its own half width (psi1 = 0) it is -eps tan(dpsi/2), which is the claim up
/// to a factor of two; and off by more it is -eps centre/lambda to leading order, whatever the
/// width (EscapementErrorTest.PlaceMattersNotWidth). So the error depends on the position of the
/// impulse. A small width helps only because a narrow impulse near the vertical cannot be far off
/// centre.
double escapement_error(double epsilon, double lambda, double centre, double width);

} // namespace goingrate
