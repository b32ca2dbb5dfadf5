// How a clock's going wanders with the time over which it is averaged: Allan deviations and their
// relatives.
//
// A deviation at tau = m tau0 is the root mean square of second (Hadamard: third) differences of
// the time error over tau; a constant offset or a constant rate of the clock does not change it
// (nor, for Hadamard, a steady drift). It means little when only a handful of differences are left
// (see n, low, high), and the second differences measure drift rather than noise where the clock's
// rate drifts steadily. MTIE and the rms time error include the rate: they describe the error of
// the clock, not how steady it is.
//
// Conventions: x is the time error in seconds, y = dx/dt the fractional frequency; N phase values
// span N - 1 intervals tau0, T = (N-1) tau0; a NaN is a gap. All equations but PDEV's are those of
// W. J. Riley, "Handbook of frequency stability analysis", NIST SP 1065 (2008).
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace goingrate {

/// Which deviation is computed.
enum class DeviationKind {
  adev,    ///< Allan deviation, second differences one tau apart (SP 1065 section 5.2.2)
  oadev,   ///< overlapping Allan deviation, one at every sample (5.2.4)
  mdev,    ///< modified Allan deviation, differences of means over tau (5.2.5)
  tdev,    ///< time deviation, tau MDEV / sqrt 3, s (5.2.6)
  hdev,    ///< Hadamard deviation, third differences one tau apart (5.2.8)
  ohdev,   ///< overlapping Hadamard deviation (5.2.9)
  totdev,  ///< total deviation: OADEV with the data reflected at both ends (5.2.11)
  mtotdev, ///< modified total deviation (5.2.12)
  ttotdev, ///< time total deviation, tau MTOTDEV / sqrt 3, s (5.2.13)
  htotdev, ///< Hadamard total deviation (5.2.14)
  theo1,   ///< Theo1, differences over all spacings up to m; tau = 0.75 m tau0, m even (5.2.15)
  theoh,   ///< OADEV up to a tenth of the run, beyond it Theo1 scaled to agree with it (5.2.16)
  mtie,    ///< largest range of the time error within tau, s (5.2.17)
  tierms,  ///< rms change of the time error over tau, s (5.2.18)
  pdev,    ///< parabolic deviation: differences of slopes fitted by least squares (Vernotte 2016)
};

/// All of them, in the order above.
inline constexpr std::array deviation_kinds = {
    DeviationKind::adev,    DeviationKind::oadev,   DeviationKind::mdev,   DeviationKind::tdev,
    DeviationKind::hdev,    DeviationKind::ohdev,   DeviationKind::totdev, DeviationKind::mtotdev,
    DeviationKind::ttotdev, DeviationKind::htotdev, DeviationKind::theo1,  DeviationKind::theoh,
    DeviationKind::mtie,    DeviationKind::tierms,  DeviationKind::pdev};

/// The name in lower case letters, as in the enumeration.
[[nodiscard]] constexpr std::string_view name_of(DeviationKind kind) {
  constexpr std::array<std::string_view, 15> names = {
      "adev",    "oadev",   "mdev",  "tdev",  "hdev", "ohdev",  "totdev", "mtotdev",
      "ttotdev", "htotdev", "theo1", "theoh", "mtie", "tierms", "pdev"};
  return names[static_cast<std::size_t>(kind)];
}

/// The deviation of that name; nullopt for any other word.
[[nodiscard]] constexpr std::optional<DeviationKind> deviation_named(std::string_view name) {
  for (const DeviationKind kind : deviation_kinds)
    if (name_of(kind) == name) return kind;
  return {};
}

/// Whether the deviation is one of time, in s; if not it is one of fractional frequency.
[[nodiscard]] constexpr bool is_in_seconds(DeviationKind kind) {
  return kind == DeviationKind::tdev || kind == DeviationKind::ttotdev ||
         kind == DeviationKind::mtie || kind == DeviationKind::tierms;
}

/// One averaging time of a stability table.
struct DeviationRow {
  double tau_s;     ///< m tau0; for Theo1 0.75 m tau0
  std::size_t m;    ///< averaging factor
  std::size_t n;    ///< terms averaged, those touching a gap left out
  double value;     ///< the deviation, dimensionless or in s; NaN if n is 0
  double low, high; ///< ends of the central 68.27 % interval; NaN unless `interval`
  int alpha;        ///< exponent of the power-law noise the interval assumes; see `interval`
  bool interval;    ///< false: no noise could be identified (alpha then means nothing and is 0), or
                    ///< alpha is below what the variance converges for, or there is no value, or
                    ///< the deviation has no interval (mtie, tierms)
  double bias =
      1.0; ///< the variance was divided by this: its expectation over that of an unbiased one
};

/// A stability table: one row for each requested factor, in the same order.
struct DeviationTable {
  DeviationKind kind;
  double tau0_s;
  std::vector<DeviationRow> rows;
  std::size_t bridged =
      0; ///< unknown phases replaced by the straight line between their neighbours
};

/// What may be chosen about a stability table.
struct DeviationOptions {
  std::optional<int> alpha = {}; ///< noise at every tau, -4 to 2; nothing: it is identified at each
  bool remove_bias = true;       ///< false: the total variances and Theo1 without correction
  std::size_t threads = 0;       ///< among which the factors are shared; 0: chosen by the work
};

/// Computes deviations of phase data, with the kind of noise and a confidence interval.
///
/// OADEV and ADEV: value^2 = sum (x[i+2m] - 2 x[i+m] + x[i])^2 / (2 n tau^2), i in steps of 1 or m.
/// HDEV, OHDEV: third differences, over 6 n tau^2. MDEV: second differences of means of m phases.
/// TOTDEV: OADEV's differences at x[1] .. x[N-2], x continued by 2 x[0] - x[j] and likewise at the
/// end; m up to N-1. MTOTDEV (HTOTDEV: on the frequencies): every run of 3m values less the line
/// through the means of its halves, continued by mirror images, 6m differences each. THEO1: see
/// SP 1065 section 5.2.15. THEOH: OADEV up to T/10, then Theo1 times the root of the mean ratio of
/// the two variances at OADEV's factors 9 + 3i and Theo1's 12 + 4i up to T/10 (of more than 32 such
/// pairs, 32 evenly spread). MTIE: max of max - min over m + 1 phases. TIErms: rms x[i+m] - x[i].
/// PDEV: 72 / (M m^4 tau^2) sum_i [sum_{k<m} ((m-1)/2 - k)(x[i+k] - x[i+k+m])]^2, M = N - 2m as in
/// the published values of SigmaTheta (one more term could be had); OADEV at m = 1 (F. Vernotte, M.
/// Lenczner, P.-Y. Bourgeois, E. Rubiola, IEEE UFFC 63 (2016) 611). First the first known phase is
/// subtracted and then, in one fused rounding, the line through the first and last known phase (not
/// for MTIE and TIErms); differences of that exact line are zero, so an offset or slope costs no
/// digits beyond those the phases themselves lack.
///
/// Gaps: a difference that touches one is left out. MDEV, TDEV: a mean is over the known phases
/// of its window if they are at least half of it. MTIE: the range of the known phases. TOTDEV:
/// unknown phases at the ends are cut off. MTOTDEV, TTOTDEV, HTOTDEV, THEO1, THEOH and PDEV need an
/// unbroken run: gaps are bridged by straight lines and counted in `bridged`; at taus no longer
/// than the gaps they then tell too little noise.
///
/// Bias (`remove_bias`): the variances of MTOTDEV, HTOTDEV and TOTDEV are divided by their
/// expectation over that of MVAR, HVAR, AVAR; Theo1's is multiplied by a + b/m^c (SP 1065 sections
/// 5.2.11 to 5.2.15), by alpha. The measured rest: Stability.TotalVariancesAndTheo1HaveLittleBias.
///
/// Interval: alpha by identify_noise, or below 30 decimated points by identify_noise_by_ratio, at
/// tau; EDF by degrees_of_freedom.hpp (PDEV: that of the modified Allan variance); then
/// chi_squared_interval. Where phase noise is found beyond times at which the rate is noisy, the
/// phases count as far apart as the longest of those (Stability.AReturningPhaseIsNotWhite), but not
/// in total deviations and Theo1. Where neither finds a noise, the alpha of the row before is kept;
/// if there is no such row, the largest smaller factor that leaves 30 points is asked.
///
/// `phase_s`: N time errors in s, one every tau0, NaN = gap, 3 or more. `tau0_s`: s, above 0.
/// `factors`: strictly increasing, from 1 to largest_factor; theo1: even, 10 or more; theoh: tau in
/// units of tau0 (a row of its second part is at the nearest tau that Theo1 has).
/// Accuracy: 1e-12 relative against long double sums (Stability.EqualsTheSlowOracleOnDataWithGaps,
/// Stability.FastSumsEqualPlainOnes; Theo1 by transforms 1e-9,
/// Theo1.ByTransformEqualsTheDirectSum); 1e-12 with an offset of 1e9 s and a slope of 2^-10
/// (Stability.IsImmuneToOffsetAndSlope); printed digits of SP 1065 and Stable32
/// (tests/spectra/published_tables_test.cpp). The interval covers the truth in 62 to 75 % of
/// simulated white-frequency series (StabilityInterval.CoversTheTruthAsOftenAsItSays,
/// StabilityInterval.OfOtherKindsCoversTheTruth). With gaps the EDF treats the n differences as one
/// unbroken run, which tends to make the interval too wide rather than too narrow. Cost: O(N) per
/// factor; Theo1 O(N log N + m log^2 m); MTOTDEV, TTOTDEV and HTOTDEV O(N m). The result is the
/// same for any number of threads (Stability.IsTheSameForAnyNumberOfThreads). Throws ArgumentError
/// for arguments outside these ranges or an infinite phase.
[[nodiscard]] DeviationTable stability_table(DeviationKind kind, std::span<const double> phase_s,
                                             double tau0_s, std::span<const std::size_t> factors,
                                             const DeviationOptions& options = {});

/// The largest factor that leaves one term of `kind` among `phase_points` phases; 0 if none does.
[[nodiscard]] std::size_t largest_factor(DeviationKind kind, std::size_t phase_points);

/// The factors 1, 2, 4, 8, ... up to largest_factor (for Theo1 16, 32, 64, ...).
/// Stable32 stops earlier (4 m <= N); the last rows here have few differences, see their interval.
/// Tested by AveragingFactors.StopWhereOneSecondDifferenceIsLeft. Cost: O(log N).
/// Throws ArgumentError if `phase_points` is below 3.
[[nodiscard]] std::vector<std::size_t> octave_factors(std::size_t phase_points,
                                                      DeviationKind kind = DeviationKind::oadev);

/// The factors 1, 2, 4, 10, 20, 40, 100, ... (for Theo1 10, 20, 40, ...); otherwise as
/// octave_factors.
[[nodiscard]] std::vector<std::size_t> decade_factors(std::size_t phase_points,
                                                      DeviationKind kind = DeviationKind::oadev);

/// Every factor 1, 2, 3, ... (for Theo1 every even one from 10); otherwise as octave_factors. A
/// table of all of them costs O(N^2): tests/studies/stability.txt has times.
[[nodiscard]] std::vector<std::size_t> all_factors(std::size_t phase_points,
                                                   DeviationKind kind = DeviationKind::oadev);

/// The factors of that name: octave, decade or all; nullopt for any other word.
[[nodiscard]] std::optional<std::vector<std::size_t>>
factors_named(std::string_view name, std::size_t phase_points,
              DeviationKind kind = DeviationKind::oadev);

/// The factors for averaging times `taus_s`, sorted and without repetition.
///
/// Each time must be a multiple of `tau0_s` (Theo1: of 1.5 tau0), to 1e-6 of itself, for decimal
/// text, with a factor up to largest_factor. Throws ArgumentError otherwise.
[[nodiscard]] std::vector<std::size_t> factors_for(std::span<const double> taus_s,
                                                   std::size_t phase_points, double tau0_s,
                                                   DeviationKind kind = DeviationKind::oadev);

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
