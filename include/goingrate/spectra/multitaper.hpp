// Spectra of one series by several tapers, of two series against each other, and of series with
// gaps.
#pragma once

#include "goingrate/spectra/spectrum.hpp"

#include <span>
#include <vector>

namespace goingrate {

/// One-sided density by sine tapers.
///
/// The mean over k = 1 .. K of the periodograms of h_k x, h_k[n] = sqrt(2/(N+1)) sin(pi k
/// (n+1)/(N+1)) (K. S. Riedel and A. Sidorenko, IEEE Trans. Signal Process. 43 (1995) 188). Every
/// taper covers the whole series, so low frequencies are reached, with 2 K degrees of freedom and a
/// bias of only S'' (K/N)^2/24. The mean, or a straight line, is subtracted first. The sum of the
/// density times the resolution is the variance weighted by the tapers.
///
/// `series`: N finite values, 8 or more; `tapers` from 1 to N/4. Throws ArgumentError otherwise.
/// Accuracy: the level and scatter of white noise (MultitaperTest.WhiteNoiseHasItsLevelAndScatter),
/// the variance (MultitaperTest.TheIntegralIsTheVariance). Cost: K transforms of N values.
[[nodiscard]] Spectrum multitaper_spectrum(std::span<const double> series, double interval_s,
                                           std::size_t tapers = 8, bool detrend_linear = true);

/// The central interval of one value of a density, as factors of that value: the degrees of freedom
/// over quantiles of chi-squared.
struct DensityInterval {
  double low, high;
};
[[nodiscard]] DensityInterval density_interval(double degrees_of_freedom,
                                               double probability = 0.68268949213708590);

/// The relation of two series at each frequency.
struct CrossSpectrum {
  std::vector<double> frequency_hz;
  std::vector<double> coherence; ///< squared, 0 to 1
  std::vector<double> gain;      ///< amplitude of the answer per unit of the cause
  std::vector<double> phase_rad; ///< of the answer after the cause; negative: it lags
  double significant =
      0.0; ///< a coherence that unrelated series exceed once in a hundred ordinates
};

/// By sine tapers: C_xy = mean of conj(X_k) Y_k; coherence |C_xy|^2/(C_xx C_yy), gain |C_xy|/C_xx.
/// Unrelated series exceed c with probability (1 - c)^(K-1). `cause` and `answer` have the same
/// length, finite. (MultitaperTest.CoherenceFindsACauseAndItsLag)
[[nodiscard]] CrossSpectrum cross_spectrum(std::span<const double> cause,
                                           std::span<const double> answer, double interval_s,
                                           std::size_t tapers = 16);

/// The periodogram of a series with gaps.
struct GappedPeriodogram {
  std::vector<double> frequency_hz; ///< k / (2 N interval), k = 1 .. N - 1
  std::vector<double> power; ///< share of the variance that a sinusoid with a free phase and offset
                             ///< explains, 0 to 1 (generalised Lomb-Scargle)
  std::vector<double> window; ///< |mean of exp(2 pi i f t)|^2 over the known values: the leakage of
                              ///< a constant or a line to this distance in frequency
};

/// Generalised Lomb-Scargle on an even grid with unknown values (NaN), which are left out. The sums
/// over the known values are transforms of the series and of its mask, so the cost is O(N log N).
/// Needs at least 8 known values; throws ArgumentError otherwise.
/// (MultitaperTest.LombScargleEqualsTheDirectSums)
[[nodiscard]] GappedPeriodogram lomb_scargle(std::span<const double> series, double interval_s);

} // namespace goingrate
