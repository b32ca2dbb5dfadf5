// Identifies the kind of noise that a clock shows at one averaging time.
//
// Clock noise is modelled by S_y(f) = h f^alpha (f in Hz, y the fractional frequency). alpha = 2 is
// white phase noise, 1 flicker phase, 0 white frequency, -1 flicker frequency, -2 a random walk of
// frequency. The scatter of an Allan variance depends on alpha (degrees_of_freedom.hpp), so alpha
// is found first.
//
// The result means little on fewer than 30 decimated points, where only the ratio of two variances
// can be used, and for alpha <= -3, where the expected Allan variance is infinite.
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

/// The fewest points for a lag-1 identification (SP 1065 section 5.5.6 asks for about 30).
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
/// series of 1000 points, of alpha 2, 0 and -2 (NoiseType.IsRightForLongSimulatedSeries); for white
/// frequency series of 40 points about five in six, the others mostly found one too high, because
/// the parabola takes slow noise with it (NoiseType.ErrsUpwardsOnFewPoints).
/// Cost: O(N/m). Throws ArgumentError if m is 0.
///
/// `most_differences`: 2, or 3 for Hadamard variances, which converge down to alpha = -4; the
/// domain of the result then reaches -5.
[[nodiscard]] NoiseType identify_noise(std::span<const double> phase, std::size_t m,
                                       std::size_t most_differences = 2);

/// The fewest averaged frequencies that identify_noise_by_ratio accepts: with fewer, its results
/// differ from the tables of Stable32.
inline constexpr std::size_t least_frequencies_for_ratio = 6;

/// Names the noise at m tau0 if too few points are left for identify_noise.
///
/// The variance of the n = (N-1)/m averaged frequencies over their Allan variance is compared with
/// its expectation B1(n, mu) for sigma_y^2 ~ tau^mu: n(n+1)/6, n/2, n ln n / (2 (n-1) ln 2), 1 and
/// (n^2-1) / (1.5 n (n-1)) for mu = 2, 1, 0, -1, -2; parted at geometric means. mu = 1, 0, -1 is
/// alpha = -2, -1, 0; for mu = -2 MVAR/AVAR at m, expected 1/m for alpha = 2 and
/// 3.37/(1.04 + 3 ln(pi m)) for alpha = 1, decides (NIST SP 1065 sections 5.5.3 and 5.5.4), both
/// from differences that start a sixteenth of m apart.
///
/// Arguments as for identify_noise. Result: alpha -2 to 2, `exponent` the same; identified if there
/// are 6 frequencies. Accuracy: of Stable32's 80 alphas for its PHASE.DAT from 29 frequencies
/// down to 6 all but 3 (PublishedTables.NoiseOnFewPointsIsThatOfStable32); of simulated white
/// frequency series of 13 points more than half, of a random walk of frequency somewhat less
/// (NoiseType.ByRatioIsRightAboutHalfTheTime).
/// Cost: O(N/m), O(N) where MVAR is asked. Throws ArgumentError if m is 0.
[[nodiscard]] NoiseType identify_noise_by_ratio(std::span<const double> phase, std::size_t m);

/// The usual name of noise with exponent `alpha` (of the rate's spectrum, f^alpha).
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
