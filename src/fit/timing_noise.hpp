// The noise of crossing times: jitter of the sensor and a random walk of the clock.
//
// Jitter is white in time, so its period differences are anticorrelated; noise of the drive is
// white in rate, so its times are a random walk. With residual r_i at cycle n_i the differences d_i
// = r_i - r_{i-1} have a tridiagonal covariance,
//   var d_i = 2 j^2 + w^2 (n_i - n_{i-1}),   cov(d_i, d_{i+1}) = -j^2,
// whose Cholesky factor has two diagonals: whitening costs O(N). Taking differences removes the
// unknown time of the first crossing without loss: for w = 0 it is least squares with a free
// offset.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace goingrate {

/// Sizes of the noise of one log.
struct TimingNoise {
  double jitter_s = 0.0; ///< j, s, of every time
  double walk_s = 0.0;   ///< w, s, of every period
};

/// Turns residuals of times into independent differences of unit variance.
class Whitening {
public:
  /// `cycle` as in TimingData; the noise must not be zero altogether.
  Whitening(std::span<const double> cycle, const TimingNoise& noise);

  /// `residual` has one entry per beat, `white` one fewer. T may carry derivatives.
  template <class T> void apply(std::span<const T> residual, std::span<T> white) const {
    for (std::size_t i = 0; i < diagonal_.size(); ++i) {
      T value = residual[i + 1] - residual[i];
      if (i > 0) value -= white[i - 1] * below_[i];
      white[i] = value / diagonal_[i];
    }
  }

  /// log det of the covariance of the differences.
  [[nodiscard]] double log_determinant() const;

private:
  std::vector<double> diagonal_; // of the Cholesky factor
  std::vector<double> below_;    // left of the diagonal, entry 0 unused
};

/// Jitter and walk that maximise the likelihood of `residual`; walk is 0 unless it raises the log
/// likelihood by more than half of log N (BIC). NoiseTest.FindsJitterAndWalk bounds the bias.
TimingNoise estimate_noise(std::span<const double> cycle, std::span<const double> residual);

/// Root mean square; 0 for no values.
double rms(std::span<const double> values);

/// Standard deviation of white noise in a series, from its third differences; NaNs are skipped.
double local_white_noise(std::span<const double> series);

/// Probability, by the Ljung-Box test at `lags` lags, that white noise is as correlated as this.
double whiteness_p(std::span<const double> white, std::size_t lags = 20);

/// Factor by which correlation of `white` raises the variance of its mean: 1 + 2 sum of the
/// autocorrelations up to the first negative pair (Geyer 1992), or the factor from the scatter of 8
/// or 16 batch means if that is larger; at least 1.
double correlation_time(std::span<const double> white);

} // namespace goingrate
