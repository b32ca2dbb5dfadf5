// How a clock's going wanders with the time over which it is averaged: Allan deviations.
//
// A deviation at tau = m tau0 is the root mean square of second differences of the time error,
// x[i+2m] - 2 x[i+m] + x[i]; it does not see a constant offset or a constant rate of the clock. It
// means little when only a handful of differences are left (look at n, low, high), and it measures
// drift rather than noise where the clock's rate drifts steadily.
//
// Conventions: x is the time error in seconds, y = dx/dt the fractional frequency; N phase values
// span N - 1 intervals tau0; a NaN is a gap. All equations are those of W. J. Riley, "Handbook of
// frequency stability analysis", NIST SP 1065 (2008).
#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

namespace goingrate {

/// Which deviation is computed.
enum class DeviationKind {
  adev,  ///< Allan deviation, second differences one tau apart (SP 1065 section 5.2.2)
  oadev, ///< overlapping Allan deviation, one at every sample (SP 1065 section 5.2.4)
};

/// "adev" or "oadev".
[[nodiscard]] constexpr std::string_view name_of(DeviationKind kind) {
  return kind == DeviationKind::adev ? "adev" : "oadev";
}

/// One averaging time of a stability table.
struct DeviationRow {
  double tau_s;     ///< m tau0
  std::size_t m;    ///< averaging factor
  std::size_t n;    ///< second differences used, those touching a gap left out
  double value;     ///< the deviation, dimensionless; NaN if n is 0
  double low, high; ///< ends of the central 68.27 % interval; NaN unless `interval`
  int alpha;        ///< exponent of the power-law noise the interval assumes; see `interval`
  bool interval;    ///< false: no noise could be identified (alpha then means nothing and is 0), or
                    ///< alpha is below -2 where no interval exists, or there is no value
};

/// A stability table: one row for each requested factor, in the same order.
struct DeviationTable {
  DeviationKind kind;
  double tau0_s;
  std::vector<DeviationRow> rows;
};

/// Computes Allan deviations of phase data, with the kind of noise and a confidence interval.
///
/// value^2 = sum (x[i+2m] - 2 x[i+m] + x[i])^2 / (2 n m^2 tau0^2), i in steps of 1 (oadev) or m
/// (adev), over the n differences free of NaN. First the first known phase is subtracted and then,
/// in one fused rounding, the line through the first and last known phase; second differences of
/// that exact line are zero, so an offset or slope costs no digits beyond those the phases
/// themselves lack.
///
/// Interval: alpha by identify_noise, EDF by allan_degrees_of_freedom, then chi_squared_interval.
/// Where fewer than 30 decimated points are left, the alpha of the row before is kept; if there is
/// no such row, the largest smaller factor that leaves 30 points is asked.
///
/// `phase_s`: N time errors in s, one every tau0, NaN = gap, 3 or more. `tau0_s`: s, above 0.
/// `factors`: strictly increasing, each with 1 <= m and 2 m < N.
/// Accuracy: 1e-12 relative against long double sums (Stability.EqualsTheSlowOracleOnDataWithGaps);
/// 1e-12 with an offset of 1e9 s and a slope of 2^-10 (Stability.IsImmuneToOffsetAndSlope); printed
/// digits of SP 1065 and Stable32 (Stability.ReproducesTheNist1000PointSet and following). The
/// interval covers the truth in 62 to 75 % of simulated white-frequency series
/// (StabilityInterval.CoversTheTruthAsOftenAsItSays; measured on 3000 runs: 65 % at m = 1, 67 to
/// 71 % at m = 8 and 64), and in about 64 % where the noise type rests on 40 points
/// (StabilityInterval.CoversLessWhereTheNoiseTypeRestsOnFewPoints). With gaps the EDF treats the n
/// differences as one unbroken run, which tends to make the interval too wide rather than too
/// narrow. Cost: O(N) per factor. Throws ArgumentError for arguments outside these ranges or an
/// infinite phase.
[[nodiscard]] DeviationTable allan_deviation(DeviationKind kind, std::span<const double> phase_s,
                                             double tau0_s, std::span<const std::size_t> factors);

/// The factors 1, 2, 4, 8, ... with 2 m < `phase_points`, so that each leaves a second difference.
/// Stable32 stops earlier (4 m <= N); the last rows here have few differences, see their interval.
/// Tested by AveragingFactors.StopWhereOneSecondDifferenceIsLeft. Cost: O(log N).
/// Throws ArgumentError if `phase_points` is below 3.
[[nodiscard]] std::vector<std::size_t> octave_factors(std::size_t phase_points);

/// The factors 1, 2, 4, 10, 20, 40, 100, ... with 2 m < `phase_points`; otherwise as
/// octave_factors.
[[nodiscard]] std::vector<std::size_t> decade_factors(std::size_t phase_points);

/// Every factor 1, 2, 3, ... with 2 m < `phase_points`; otherwise as octave_factors. A table of all
/// of them costs O(N^2): 0.15 s for 10^4 phases and 12 s for 10^5 as measured on one core.
[[nodiscard]] std::vector<std::size_t> all_factors(std::size_t phase_points);

/// The factors for averaging times `taus_s`, sorted and without repetition.
///
/// Each time must be a multiple of `tau0_s` (to 1e-6 of itself, for decimal text) with 2 m <
/// `phase_points`. Throws ArgumentError otherwise.
[[nodiscard]] std::vector<std::size_t> factors_for(std::span<const double> taus_s,
                                                   std::size_t phase_points, double tau0_s);

/// Adds up fractional frequencies to phase: x[0] = 0, x[i+1] = x[i] + y[i] tau0.
///
/// Gaps: x[i+1] is NaN whenever y[i] is NaN, and the sum goes on underneath as if y[i] had been
/// `gap_frequency`. With the default 0 the last phase before a gap is thus *held* over it: the
/// first phase after y[a..b] = NaN is x[b+2] = x[a] + y[b+1] tau0. Second differences with m > b -
/// a + 1 reach across the gap and believe that frequency, so unless y is near zero on average give
/// its mean here (Phase.HoldsTheLastValueOverAGapAndSteadyRateNeedsItsMean).
///
/// `y`: n values, dimensionless, NaN = gap. `tau0_s`: s, above 0. Result: n + 1 phases in s.
/// Accuracy: about one rounding per phase (Phase.AddsUpFrequenciesWithoutAccumulatingRounding).
/// Cost: O(n). Throws ArgumentError if tau0_s is not finite and positive, gap_frequency is not
/// finite, or a frequency is infinite.
[[nodiscard]] std::vector<double> phase_from_frequency(std::span<const double> y, double tau0_s,
                                                       double gap_frequency = 0.0);

} // namespace goingrate
