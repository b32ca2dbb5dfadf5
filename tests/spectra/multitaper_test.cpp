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
  const double level = 2.0 * 2.0; // one-sided density of white noise: 2 * interval * variance
  // The sigma of an ordinate is level/sqrt(8). Tapers correlate about 8 neighbouring ordinates, so
  // that 40 * 460/8 of them are independent: three sigma of their mean are 2.2 %.
  EXPECT_NEAR(sum / count, level, 0.03 * level);
  const double variance = sum2 / count - std::pow(sum / count, 2);
  // Relative variance 1/K; three sigma of its estimate are 10 %.
  EXPECT_NEAR(variance * tapers, level * level, 0.1 * level * level);
}

TEST(MultitaperTest, TheIntegralIsTheVariance) {
  // The integral is a weighted sum of squares; the weights, means of the squared tapers, are equal
  // but for a share of about 1/(2K) of the series at either end, where they fall to zero.
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
  EXPECT_NEAR(integral, variance, 0.008 * variance); // four sigma, from the unequal weights
}

TEST(MultitaperTest, AnIntervalHoldsTheLevel) {
  const DensityInterval interval = density_interval(16.0);
  int inside = 0, count = 0;
  const Spectrum s = multitaper_spectrum(noise(20000, 5), 1.0, 8);
  // Ordinates 16 apart are independent: the eight tapers spread a frequency over 9.
  for (std::size_t i = 20; i + 20 < s.density.size(); i += 16, ++count)
    inside += s.density[i] * interval.low < 2.0 && 2.0 < s.density[i] * interval.high ? 1 : 0;
  // The tolerance is three sigma of a share of 623 ordinates.
  EXPECT_NEAR(static_cast<double>(inside) / count, 0.683, 0.056);
}

TEST(MultitaperTest, CoherenceFindsACauseAndItsLag) {
  const auto x = noise(4000, 1), other = noise(4000, 2);
  std::vector<double> y(4000);
  constexpr std::size_t lag = 3;
  for (std::size_t i = 0; i < y.size(); ++i)
    y[i] = 0.5 * (i >= lag ? x[i - lag] : 0.0) + 0.1 * other[i];
  const CrossSpectrum cross = cross_spectrum(x, y, 1.0, 16);
  const std::size_t k = 400;                                   // 0.1 Hz
  EXPECT_NEAR(cross.gain[k], 0.5, 0.08);                       // sigma: 0.1/sqrt(2 * 16) = 0.018
  EXPECT_NEAR(cross.phase_rad[k], -2.0 * pi * 0.1 * lag, 0.2); // sigma: 0.018/0.5 = 0.04
  EXPECT_GT(cross.coherence[k], 0.9); // expected: 0.5^2/(0.5^2 + 0.1^2) = 0.96
  int exceedances = 0;
  const CrossSpectrum unrelated = cross_spectrum(x, other, 1.0, 16);
  for (std::size_t i = 16; i < 1984; i += 16)
    exceedances += unrelated.coherence[i] > unrelated.significant ? 1 : 0;
  EXPECT_LE(exceedances, 6); // of 123; 1.2 expected, 7 or more with probability 3e-4
}

TEST(MultitaperTest, LombScargleEqualsTheDirectSums) {
  auto x = noise(101, 7);
  for (const std::size_t gap : {3u, 4u, 50u, 51u, 52u, 53u, 99u})
    x[gap] = std::numeric_limits<double>::quiet_NaN();
  const GappedPeriodogram periodogram = lomb_scargle(x, 2.0);
  for (std::size_t k = 0; k < periodogram.frequency_hz.size(); k += 7) {
    // Least-squares fit of a constant, a cosine and a sine to the known values; subtracting the
    // means eliminates the constant.
    const double w = 2.0 * pi * periodogram.frequency_hz[k] * 2.0;
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
    const double direct_power =
        (yc * yc * ss - 2 * yc * ys * cs + ys * ys * cc) / ((cc * ss - cs * cs) * yy);
    // The transforms are accurate to 1e-13; the normal equations, nearly singular at the first and
    // last frequencies, magnify that.
    EXPECT_NEAR(periodogram.power[k], direct_power, 1e-10) << k;
    EXPECT_NEAR(periodogram.window[k], (c * c + s * s) / (n * n), 1e-12);
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
