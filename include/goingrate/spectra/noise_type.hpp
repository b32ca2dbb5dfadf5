// What kind of noise a clock shows at one averaging time, and how sure a deviation then is.
//
// Clock noise is modelled by S_y(f) = h f^alpha (f in Hz, y the fractional frequency). alpha = 2 is
// white phase noise, 1 flicker phase, 0 white frequency, -1 flicker frequency, -2 a random walk of
// frequency. The scatter of an Allan variance depends on alpha, so alpha is found first; then the
// variance is treated as a multiple of chi-squared with "equivalent" degrees of freedom (EDF).
//
// Where this means nothing: on fewer than 30 decimated points (no identification is attempted), and
// for alpha <= -3, where the expected Allan variance is infinite.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace goingrate {

/// A power-law noise found in phase data; `alpha` and `exponent` mean nothing unless `identified`.
struct NoiseType {
  int alpha = 0;           ///< `exponent` rounded, and limited to 2 from above
  double exponent = 0.0;   ///< the estimate of alpha before rounding; scatter about 2/sqrt(points)
  std::size_t points = 0;  ///< finite phase values left after decimation
  bool identified = false; ///< false: too few neighbouring points, or nothing but a parabola
};

/// The start-to-start distance of the second differences that are averaged.
enum class DifferenceStride {
  one_sample, ///< overlapped: a second difference starts at every sample
  one_tau,    ///< not overlapped: one starts at every m-th sample
};

/// The ends of a confidence interval, in the unit of the deviation it belongs to.
struct DeviationInterval {
  double low;
  double high;
};

/// The probability between -1 and +1 sigma of a normal variable, erf(1/sqrt 2).
inline constexpr double one_sigma_probability = 0.68268949213708590;

/// The fewest points a lag-1 identification is honest on (SP 1065 section 5.5.6 asks for about 30).
inline constexpr std::size_t least_points_for_noise_type = 30;

/// Names the power-law noise that dominates phase data at the averaging time m tau0.
///
/// Every m-th phase is taken, a least-squares parabola is removed, and the lag-1 autocorrelation r1
/// is turned into rho = r1/(1 + r1); the series is differenced (d = 0, 1, 2) until rho < 1/4 or
/// d = 2, then alpha = 2 - 2 (rho + d) (NIST SP 1065 section 5.5.6; Riley and Greenhall 2004).
/// NaN entries are gaps: they take no part, and sums are scaled to the pairs there are.
///
/// `phase`: N values in any unit, evenly sampled, NaN = gap. `m`: averaging factor, 1 or more.
/// Domain of the result: alpha from -3 to 2; identified only if there are as many neighbouring
/// pairs as 30 gap-free points have. Accuracy: the right integer for every one of 60 simulated
/// series of 1000 points, of alpha 2, 0 and -2 (NoiseType.IsRightForLongSimulatedSeries); of white
/// frequency series of 40 points about five in six, the others mostly found one too high, because
/// the parabola takes slow noise with it (NoiseType.ErrsUpwardsOnFewPoints).
/// Cost: O(N/m). Throws ArgumentError if m is 0.
[[nodiscard]] NoiseType identify_noise(std::span<const double> phase, std::size_t m);

/// Equivalent degrees of freedom of an Allan variance averaged over `n` second differences.
///
/// The combined EDF algorithm of NIST SP 1065 section 5.4 (Greenhall and Riley 2003) for d = 2 and
/// unmodified filtering (F = m), with stride factor S = m (one_sample) or S = 1 (one_tau):
/// 1/edf = [s_z(0)^2 + (1 - J/M) s_z(J/S)^2 + 2 sum_{j=1}^{J-1} (1 - j/M) s_z(j/S)^2]
/// / (M s_z(0)^2), with M = n and J = min(M, 3 S). The sum is done in full, without the tabulated
/// short cuts for large m, so it is the exact EDF for J = M and a truncation at 3 tau otherwise.
///
/// `alpha`: -2 to 2. `m`, `n`: 1 or more. With gaps n counts the differences used and the result
/// treats them as one unbroken run. Result: from 1 up to about n.
/// Accuracy: 1e-9 relative against the defining formula in long double
/// (DegreesOfFreedom.EqualTheDefiningFormulaInWiderArithmetic). As a description of data: the
/// algorithm takes each phase to be an average over tau0, and averaged phases agree
/// (DegreesOfFreedom.AreThoseOfPhasesAveragedOverASample). Phases read at instants, with white
/// frequency noise, have 0.85 times these degrees of freedom at m = 1, then 1.05, 1.13, 1.10 times
/// at m = 2, 4, 8, and 1 in the limit (DegreesOfFreedom.DifferForPhasesReadAtInstants): intervals
/// are 8 % too narrow at m = 1 and at most 6 % too wide after that.
/// Cost: O(min(n, 3 m)) overlapped, O(1) otherwise. Throws ArgumentError outside the domain.
[[nodiscard]] double allan_degrees_of_freedom(int alpha, std::size_t m, std::size_t n,
                                              DifferenceStride stride);

/// The central confidence interval of a deviation whose square is chi-squared distributed.
///
/// low = s sqrt(edf / q((1+p)/2)), high = s sqrt(edf / q((1-p)/2)), q the chi-squared quantile with
/// `degrees_of_freedom` (NIST SP 1065 section 5.3).
/// `deviation`: s, 0 or more, any unit. `degrees_of_freedom`: above 0. `probability`: p in (0, 1).
/// Accuracy: 1e-12 relative against the closed form that 2 degrees of freedom have
/// (ChiSquaredInterval.AgreesWithTheClosedFormForTwoDegrees).
/// Cost: two quantiles. Throws ArgumentError outside the domain.
[[nodiscard]] DeviationInterval chi_squared_interval(double deviation, double degrees_of_freedom,
                                                     double probability = one_sigma_probability);

/// What clock people call noise of exponent `alpha` (of the rate's spectrum, f^alpha).
[[nodiscard]] constexpr std::string_view noise_name(int alpha) {
  switch (alpha) {
  case 2:
    return "white phase (jitter)";
  case 1:
    return "flicker phase";
  case 0:
    return "white rate";
  case -1:
    return "flicker rate";
  case -2:
    return "random walk of rate";
  default:
    return alpha > 0 ? "steeper than jitter" : "slower than a random walk of rate";
  }
}

} // namespace goingrate
