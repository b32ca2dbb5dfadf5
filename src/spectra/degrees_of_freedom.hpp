// The uncertainty of a stability variance: equivalent degrees of freedom (EDF), and the intervals
// that follow from them.
//
// A stability variance is a mean of squares of correlated numbers. It is treated as a multiple of
// chi-squared with as many degrees of freedom as give it the right relative scatter, 2/EDF in
// variance; for the variances built from differences the EDF follows from the power-law noise, for
// the "total" variances and Theo1 it is a formula fitted to simulations. If the noise is not a
// power law over the times that matter, the EDF does not apply to this clock.
#pragma once

#include <cstddef>

namespace goingrate {

/// The start-to-start distance of the differences that are averaged.
enum class DifferenceStride {
  one_sample, ///< overlapped: a difference starts at every sample
  one_tau,    ///< not overlapped: one starts at every m-th sample
};

/// The values whose differences are taken.
enum class PhaseFilter {
  none,        ///< phases m apart, as in the Allan and Hadamard variances
  mean_of_tau, ///< means of m neighbouring phases, as in the modified Allan variance
};

/// The ends of a confidence interval, in the unit of the deviation it belongs to.
struct DeviationInterval {
  double low;
  double high;
};

/// The probability that a normal variable lies between -1 and +1 sigma, erf(1/sqrt 2).
inline constexpr double one_sigma_probability = 0.68268949213708590;

/// The kind of variance of differences; by default the Allan variance.
struct DifferenceVariance {
  DifferenceStride stride = DifferenceStride::one_sample;
  std::size_t order = 2; ///< d: 2 Allan, 3 Hadamard
  PhaseFilter filter = PhaseFilter::none;
};

/// Equivalent degrees of freedom of a variance averaged over `n` differences of phase.
///
/// The combined EDF algorithm of NIST SP 1065 section 5.4 (Greenhall and Riley 2003) for d = 2 or
/// 3, filter F = m (none) or 1 (mean_of_tau), stride factor S = m (one_sample) or 1 (one_tau):
/// 1/edf = [s_z(0)^2 + (1 - J/M) s_z(J/S)^2 + 2 sum_{j=1}^{J-1} (1 - j/M) s_z(j/S)^2]
/// / (M s_z(0)^2), with M = n and J = min(M, (d+1) S). The tabulated short cuts for large m are not
/// taken; instead lags more than 512 samples from a multiple of tau are summed in blocks of a 64th
/// of that distance, each as long as it is times its middle term.
///
/// `alpha`: -2 to 2 for d = 2, -4 to 2 for d = 3. `m`, `n`: 1 or more. With gaps n counts the
/// differences used and the result treats them as one unbroken run. Result: from 1 up to about n.
/// Accuracy: 1e-9 relative up to m = 1024 against the defining formula in long double
/// (DegreesOfFreedom.EqualTheDefiningFormulaInWiderArithmetic) and 3e-5 beyond
/// (DegreesOfFreedom.OfLongAveragingLoseLittleByBlocks). As a description of data: the
/// algorithm takes each phase to be an average over tau0, and averaged phases agree
/// (DegreesOfFreedom.AreThoseOfPhasesAveragedOverASample). Phases read at instants, with white
/// frequency noise, have 0.85 times these degrees of freedom at m = 1, then 1.05, 1.13, 1.10 times
/// at m = 2, 4, 8, and 1 in the limit (DegreesOfFreedom.DifferForPhasesReadAtInstants): intervals
/// are 8 % too narrow at m = 1 and at most 6 % too wide after that.
/// Cost: O(min(n, 1000 + 400 log m)) overlapped, O(1) otherwise. Throws ArgumentError outside the
/// domain.
[[nodiscard]] double difference_degrees_of_freedom(int alpha, std::size_t m, std::size_t n,
                                                   const DifferenceVariance& variance);

/// Equivalent degrees of freedom for the Allan variance: d = 2 and no filter.
[[nodiscard]] double allan_degrees_of_freedom(int alpha, std::size_t m, std::size_t n,
                                              DifferenceStride stride);

/// Equivalent degrees of freedom of the total variance, `tau` = m tau0 of a run of `points` phases.
///
/// alpha <= 0: b T/tau - c with (b, c) = (1.50, 0), (1.17, 0.22), (0.93, 0.36) for alpha 0, -1, -2
/// (SP 1065 section 5.4). alpha = 1, 2, for which there is no formula of its own: those of the
/// overlapping Allan variance (SP 1065 table 5), N the points:
/// 2: (N+1)(N-2m) / (2(N-m)); 1: exp sqrt(ln((N-1)/(2m)) ln((2m+1)(N-1)/4)).
/// These fall to zero as 2m approaches N; at least 1 is returned. Simulations at alpha 2 give as
/// many up to tau = T/60, half as many at T/16 and a tenth at T/4, so that intervals of white phase
/// noise at long tau are too narrow by up to three times. For alpha 0 and below they agree within a
/// tenth. `alpha`: -2 to 2; `m`: 1 or more, below `points`. Throws ArgumentError outside.
[[nodiscard]] double total_degrees_of_freedom(int alpha, std::size_t m, std::size_t points);

/// The same for the modified total variance: b T/tau - c with (b, c) = (1.90, 2.10), (1.20, 1.40),
/// (1.10, 1.20), (0.85, 0.50), (0.75, 0.31) for alpha 2 to -2 (SP 1065 section 5.4), T = N tau0.
/// Simulated at T/tau = 16: 17 % fewer for alpha 2 and 13 % fewer for 0; at 5 up to a third fewer.
[[nodiscard]] double modified_total_degrees_of_freedom(int alpha, std::size_t m,
                                                       std::size_t points);

/// The same for the Hadamard total variance: (T/tau) / (b0 + b1 tau/T) with (b0, b1) =
/// (0.559, 1.004), (0.868, 1.140), (0.938, 1.696), (0.974, 2.554), (1.276, 3.149) for alpha 0 to -4
/// (SP 1065 section 5.4). `alpha`: -4 to 0. Simulations give as many, or a tenth fewer at long tau
/// (DegreesOfFreedom.OfTotalVariancesAreNearTheSimulated).
[[nodiscard]] double hadamard_total_degrees_of_freedom(int alpha, std::size_t m,
                                                       std::size_t points);

/// The same for Theo1 with its factor m (even, tau = 0.75 m tau0): the fits of SP 1065
/// section 5.4, one for each alpha from 2 to -2.
[[nodiscard]] double theo1_degrees_of_freedom(int alpha, std::size_t m, std::size_t points);

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

} // namespace goingrate
