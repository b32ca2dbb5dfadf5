#include "goingrate/spectra/multitaper.hpp"

#include "goingrate/base/errors.hpp"
#include "support/white_noise.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>

namespace goingrate {
namespace {

using std::numbers::pi;
using test::noise;

TEST(MultitaperTest, WhiteNoiseHasItsLevelAndScatter) {
  constexpr std::size_t tapers = 8;
  double sum = 0.0, sum2 = 0.0, count = 0.0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const Spectrum s = multitaper_spectrum(noise(999, seed), 2.0, tapers);
    for (std::size_t i = 20; i + 20 < s.density.size(); ++i, ++count) {
      sum += s.density[i];
      sum2 += s.density[i] * s.density[i];
    }
  }
  const double level = 2.0 * 2.0;                // 2 interval variance
  EXPECT_NEAR(sum / count, level, 0.03 * level); // 40 * 460/8 independent values: 2 % for 3 sigma
  const double variance = sum2 / count - std::pow(sum / count, 2);
  EXPECT_NEAR(variance * tapers, level * level, 0.1 * level * level);
}

TEST(MultitaperTest, TheIntegralIsTheVariance) {
  // With all the weight of the tapers spread evenly the sum is that of squares; eight of many
  // tapers weigh the ends less, by 1/(2K) of them.
  auto x = noise(20000, 3);
  double mean = 0.0, variance = 0.0;
  for (const double v : x)
    mean += v / 20000.0;
  for (const double v : x)
    variance += (v - mean) * (v - mean) / 20000.0;
  const Spectrum s = multitaper_spectrum(x, 0.5, 16, false);
  double integral = 0.0;
  for (const double d : s.density)
    integral += d * s.resolution_hz;
  EXPECT_NEAR(integral, variance, 0.02 * variance); // 2 % of the weight is uneven
}

TEST(MultitaperTest, AnIntervalHoldsTheLevel) {
  const DensityInterval interval = density_interval(16.0);
  int inside = 0, count = 0;
  const Spectrum s = multitaper_spectrum(noise(20000, 5), 1.0, 8);
  for (std::size_t i = 20; i + 20 < s.density.size(); i += 16, ++count) // independent ordinates
    inside += s.density[i] * interval.low < 2.0 && 2.0 < s.density[i] * interval.high ? 1 : 0;
  EXPECT_NEAR(static_cast<double>(inside) / count, 0.683, 0.056); // three standard deviations
}

TEST(MultitaperTest, CoherenceFindsACauseAndItsLag) {
  const auto x = noise(4000, 1), other = noise(4000, 2);
  std::vector<double> y(4000);
  constexpr std::size_t lag = 3;
  for (std::size_t i = 0; i < y.size(); ++i)
    y[i] = 0.5 * (i >= lag ? x[i - lag] : 0.0) + 0.1 * other[i];
  const CrossSpectrum cross = cross_spectrum(x, y, 1.0, 16);
  const std::size_t k = 400;             // f = 0.1
  EXPECT_NEAR(cross.gain[k], 0.5, 0.08); // 0.1/sqrt(32) is a sigma of 0.018
  EXPECT_NEAR(cross.phase_rad[k], -2.0 * pi * 0.1 * lag, 0.2);
  EXPECT_GT(cross.coherence[k], 0.9); // 25/26 expected
  int above = 0;
  const CrossSpectrum none = cross_spectrum(x, other, 1.0, 16);
  for (std::size_t i = 16; i < 1984; i += 16)
    above += none.coherence[i] > none.significant ? 1 : 0;
  EXPECT_LE(above, 6); // one in a hundred of 123
}

TEST(MultitaperTest, LombScargleEqualsTheDirectSums) {
  auto x = noise(101, 7);
  for (const std::size_t gap : {3u, 4u, 50u, 51u, 52u, 53u, 99u})
    x[gap] = std::numeric_limits<double>::quiet_NaN();
  const GappedPeriodogram fast = lomb_scargle(x, 2.0);
  for (std::size_t k = 0; k < fast.frequency_hz.size(); k += 7) {
    // Least squares of 1, cos, sin on the known values, by Gram-Schmidt.
    const double w = 2.0 * pi * fast.frequency_hz[k] * 2.0;
    double n = 0, y = 0, c = 0, s = 0;
    for (std::size_t i = 0; i < x.size(); ++i)
      if (!std::isnan(x[i]))
        n += 1, y += x[i], c += std::cos(w * static_cast<double>(i)),
            s += std::sin(w * static_cast<double>(i));
    double yy = 0, yc = 0, ys = 0, cc = 0, cs = 0, ss = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (std::isnan(x[i])) continue;
      const double v = x[i] - y / n, a = std::cos(w * static_cast<double>(i)) - c / n,
                   b = std::sin(w * static_cast<double>(i)) - s / n;
      yy += v * v, yc += v * a, ys += v * b, cc += a * a, cs += a * b, ss += b * b;
    }
    const double slow =
        (yc * yc * ss - 2 * yc * ys * cs + ys * ys * cc) / ((cc * ss - cs * cs) * yy);
    EXPECT_NEAR(fast.power[k], slow, 1e-10)
        << k; // transforms to 1e-13, near-singular ends included
    EXPECT_NEAR(fast.window[k], (c * c + s * s) / (n * n), 1e-12);
  }
}

TEST(MultitaperTest, RefusesWhatItCannotUse) {
  const auto x = noise(100, 1);
  EXPECT_THROW((void)multitaper_spectrum(x, 1.0, 26), ArgumentError);
  EXPECT_THROW((void)multitaper_spectrum(x, 0.0), ArgumentError);
  EXPECT_THROW((void)cross_spectrum(x, noise(99, 1), 1.0), ArgumentError);
  EXPECT_THROW((void)lomb_scargle(std::vector<double>(7, 1.0), 1.0), ArgumentError);
  EXPECT_THROW((void)density_interval(0.0), ArgumentError);
}

} // namespace
} // namespace goingrate
