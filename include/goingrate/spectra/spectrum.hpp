// Spectral density of an evenly sampled series, and the plain Fourier transform pair under it.
//
// A density says how much of the variance of a series lies in each band of frequency; its integral
// over frequency is the variance. It is an estimate with scatter: each ordinate is a multiple of
// chi-squared with `degrees_of_freedom`, so a single segment, unaveraged, has an error of 100 %. It
// means little at the two lowest frequencies, which the removed trend and the window change, and it
// does not resolve structure narrower than 1.5 `resolution_hz`.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace goingrate {

/// How a spectrum is estimated.
struct SpectrumOptions {
  /// Values per segment, 8 or more; 0 chooses: the whole series if it has fewer than 256 values,
  /// otherwise N / (1 + 15 (1 - overlap)) rounded down, which makes 16 or a few more segments.
  std::size_t segment = 0;
  double overlap = 0.5;       ///< share of a segment that the next one repeats, 0 to 0.9
  bool detrend_linear = true; ///< subtract a straight line from each segment; false: the mean
};

/// A one-sided spectral density with what is needed to judge it.
struct Spectrum {
  std::vector<double> frequency_hz; ///< k / (L interval), k = 0 .. L/2, L the segment length
  std::vector<double> density;      ///< (unit of series)^2 / Hz, same shape
  double resolution_hz;             ///< 1 / (L interval), the spacing of the frequencies
  double degrees_of_freedom;        ///< of an ordinate between the first and the last (those: half)
  std::size_t segments;             ///< averaged
  std::size_t segments_skipped;     ///< left out because they contain a NaN
  std::size_t segment_length;       ///< L
};

/// Estimates the one-sided spectral density of a series by Welch's method with a Hann window.
///
/// S(f_k) = c_k interval <|sum_n w[n] x[n] exp(-2 pi i k n/L)|^2> / sum w^2, c_k = 2 (1 at k = 0
/// and at L/2), w[n] = (1 - cos(2 pi n/L))/2, averaged over segments that overlap (P. D. Welch,
/// IEEE Trans. Audio Electroacoust. 15 (1967) 70). The mean or line is fitted by
/// least squares before the window is applied, so the trend is gone but S is low at the first
/// frequencies: a flat density comes out as 0.33, 0.72 and 0.99 of itself at k = 0, 1, 2 (0.33,
/// 0.83, 1 with only the mean removed). S(0) says nothing about the series: it is leakage from
/// k = 1.
/// sum(density) resolution_hz = <sum (w x)^2 / sum w^2>, the variance as the window sees it.
/// degrees_of_freedom = 2 K / (1 + 2 sum_j (pairs_j/K) rho_j), K segments, pairs_j those j apart,
/// rho_j = (sum w[n] w[n + j step])^2 / (sum w^2)^2, right for a density flat over 1.5 resolutions.
///
/// `series`: N values, 8 or more, any unit, NaN = gap. `interval_s`: s, above 0. Any N and L, prime
/// or not, is transformed in O(L log L).
/// Accuracy: the sum rule holds to 1e-12 (Spectrum.IntegratesToTheWindowedVariance). Tests check
/// the level of white noise and the power of a sinusoid (Spectrum.HasTheLevelOfWhiteNoise,
/// Spectrum.ContainsThePowerOfASinusoid), the first frequencies
/// (Spectrum.RemovingTheTrendChangesOnlyTheLowestFrequencies), and the degrees of freedom against
/// the scatter of 2000 realisations (Spectrum.DegreesOfFreedomMatchTheScatterOfManyRealisations).
/// Cost: O(N log L). Throws ArgumentError for arguments outside these ranges, a segment longer than
/// the series, an infinite value, or if every segment contains a NaN.
[[nodiscard]] Spectrum welch_spectrum(std::span<const double> series, double interval_s,
                                      const SpectrumOptions& options = {});

/// The forward Fourier transform of a real series, not normalised.
///
/// X[k] = sum_n x[n] exp(-2 pi i k n/N), k = 0 .. N/2 (the rest are complex conjugates).
/// `series`: N finite values, 1 or more, any unit. Result: N/2 + 1 values of the same unit.
/// Accuracy: 1e-13 of sqrt(N) rms against the defining sum in long double for even, odd and prime N
/// (Transform.EqualsTheDefiningSum). Cost: O(N log N). Throws ArgumentError if the series is empty
/// or contains NaN or infinity.
[[nodiscard]] std::vector<std::complex<double>> real_transform(std::span<const double> series);

/// |X[k]|^2, k = 0 .. length/2, where X is the real_transform() of the series padded with zeros to
/// `length`. Takes half the memory of that transform
/// (Transform.SquaredTransformEqualsThatOfThePaddedSeries).
[[nodiscard]] std::vector<double> squared_transform(std::span<const double> series,
                                                    std::size_t length);

/// The cosine transform (DCT-II) of a real series.
///
/// X[k] = sqrt(2/N) sum_n x[n] cos(pi k (n + 1/2)/N), k = 0 .. N-1; for white noise each has the
/// variance of the series, the first twice that.
/// `series`: N finite values, 1 or more, any unit. Accuracy: 1e-13 of sqrt(N) rms against the
/// defining sum (Transform.CosineTransformEqualsTheDefiningSum). Cost: O(N log N). Throws
/// ArgumentError if the series is empty or contains NaN or infinity.
[[nodiscard]] std::vector<double> cosine_transform(std::span<const double> series);

/// The inverse of real_transform, normalised so that the round trip is the identity.
///
/// x[n] = (1/N) sum_{k=0}^{N-1} X[k] exp(2 pi i k n/N) with X[N-k] = conj X[k]. The imaginary parts
/// of X[0] and, for even N, X[N/2] have no real counterpart and are ignored.
/// `transform`: n/2 + 1 finite values. `n`: length of the real series, 1 or more (a transform of
/// five values may belong to n = 8 or to n = 9, so n must be given).
/// Accuracy: round trip to 1e-14 of the largest value (Transform.InverseRestoresTheSeries).
/// Cost: O(n log n). Throws ArgumentError if the sizes do not fit or a value is not finite.
[[nodiscard]] std::vector<double>
inverse_real_transform(std::span<const std::complex<double>> transform, std::size_t n);

} // namespace goingrate
