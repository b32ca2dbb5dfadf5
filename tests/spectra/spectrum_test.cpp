// Fourier transforms compared with the defining sum; Welch spectra with levels known beforehand.
#include "goingrate/spectra/spectrum.hpp"

#include "support/nan.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "goingrate/base/errors.hpp"
#include "goingrate/base/random.hpp"

namespace goingrate {
namespace {

using test::nan;
constexpr double infinity = std::numeric_limits<double>::infinity();

std::vector<double> white_noise(std::size_t points, std::uint64_t seed) {
  RandomStream stream(seed, StreamPurpose::jitter);
  std::vector<double> series(points);
  for (double& x : series)
    x = stream.normal();
  return series;
}

std::complex<long double> defining_sum(const std::vector<double>& x, std::size_t k) {
  std::complex<long double> sum = 0;
  const auto n = static_cast<long double>(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) { // k i modulo n: no digits are lost in large angles
    const auto turns = static_cast<long double>(k * i % x.size()) / n;
    sum += static_cast<long double>(x[i]) *
           std::polar(1.0L, -2 * std::numbers::pi_v<long double> * turns);
  }
  return sum;
}

TEST(Transform, EqualsTheDefiningSum) {
  for (std::size_t n : {1u, 2u, 3u, 8u, 9u, 64u, 97u, 100u, 105u, 251u, 1009u}) {
    const std::vector<double> x = white_noise(n, n);
    const auto transform = real_transform(x);
    ASSERT_EQ(transform.size(), n / 2 + 1);
    for (std::size_t k = 0; k < transform.size(); ++k) {
      const std::complex<long double> difference =
          std::complex<long double>(transform[k]) - defining_sum(x, k);
      // Rounding errors grow as eps sqrt(n log n); the tolerance is about fifty times as large.
      EXPECT_LT(std::abs(difference), 1e-13L * std::sqrt(static_cast<long double>(n)))
          << "n " << n << " k " << k;
    }
  }
}

TEST(Transform, CosineTransformEqualsTheDefiningSum) {
  // 8 comes twice: a plan for another length must not spoil that of an earlier one.
  for (std::size_t n : {1u, 2u, 3u, 8u, 9u, 97u, 384u, 8u}) {
    const std::vector<double> x = white_noise(n, n);
    const auto transform = cosine_transform(x);
    ASSERT_EQ(transform.size(), n);
    const auto count = static_cast<long double>(n);
    for (std::size_t k = 0; k < n; ++k) {
      long double sum = 0;
      for (std::size_t i = 0; i < n; ++i)
        sum += static_cast<long double>(x[i]) *
               std::cos(std::numbers::pi_v<long double> *
                        static_cast<long double>(k * (2 * i + 1) % (4 * n)) / (2 * count));
      // Rounding errors grow as eps sqrt(log n).
      EXPECT_NEAR(transform[k], static_cast<double>(sum * std::sqrt(2 / count)), 1e-13)
          << "n " << n << " k " << k;
    }
  }
}

TEST(Transform, SquaredTransformEqualsThatOfThePaddedSeries) {
  const std::vector<double> series{0.3, -1.0, 2.5, 0.7, -0.2};
  for (const std::size_t length : {5U, 8U, 10U}) {
    std::vector<double> padded = series;
    padded.resize(length, 0.0);
    const auto transform = real_transform(padded);
    const auto squares = squared_transform(series, length);
    ASSERT_EQ(squares.size(), transform.size());
    for (std::size_t k = 0; k < squares.size(); ++k) // both are the same sum, apart from rounding
      EXPECT_NEAR(squares[k], std::norm(transform[k]), 1e-13);
  }
  EXPECT_THROW((void)squared_transform(series, 4), ArgumentError);
}

TEST(Transform, InverseRestoresTheSeries) {
  for (std::size_t n : {1u, 2u, 3u, 8u, 9u, 97u, 1000u, 4099u}) {
    const std::vector<double> x = white_noise(n, 2 * n);
    const std::vector<double> back = inverse_real_transform(real_transform(x), n);
    ASSERT_EQ(back.size(), n);
    for (std::size_t i = 0; i < n; ++i)
      EXPECT_NEAR(back[i], x[i], 5e-15) << n; // 1e-14 of the largest value, which exceeds 1/2
  }
}

TEST(Transform, ObeysParsevalsTheorem) {
  for (std::size_t n : {500u, 501u, 503u}) {
    const std::vector<double> x = white_noise(n, n);
    const auto transform = real_transform(x);
    double squares = 0.0, power = 0.0;
    for (double v : x)
      squares += v * v;
    for (std::size_t k = 0; k < transform.size(); ++k)
      power += (k == 0 || 2 * k == n ? 1.0 : 2.0) * std::norm(transform[k]);
    EXPECT_NEAR(power / static_cast<double>(n), squares, 1e-12 * squares); // equal up to rounding
  }
}

TEST(Transform, InverseIgnoresImaginaryPartsWithoutARealCounterpart) {
  std::vector<std::complex<double>> transform = {{3.0, 9.0}, {1.0, 2.0}, {4.0, 9.0}};
  const std::vector<double> x = inverse_real_transform(transform, 4);
  transform[0].imag(0.0);
  transform[2].imag(0.0);
  EXPECT_EQ(x, inverse_real_transform(transform, 4));
  EXPECT_NEAR(x[0], (3.0 + 2.0 + 4.0) / 4.0, 1e-15); // a rounding error of one operation
}

TEST(Transform, RefusesEmptyOrInfiniteSeriesAndWrongLengths) {
  EXPECT_THROW((void)real_transform({}), ArgumentError);
  EXPECT_THROW((void)cosine_transform({}), ArgumentError);
  EXPECT_THROW((void)cosine_transform(std::vector<double>{1.0, nan}), ArgumentError);
  EXPECT_THROW((void)real_transform(std::vector<double>{1.0, nan}), ArgumentError);
  const std::vector<std::complex<double>> three(3), broken(3, {0.0, infinity});
  EXPECT_EQ(inverse_real_transform(three, 5).size(), 5u);
  EXPECT_THROW((void)inverse_real_transform(three, 3), ArgumentError);
  EXPECT_THROW((void)inverse_real_transform(three, 6), ArgumentError);
  EXPECT_THROW((void)inverse_real_transform({}, 0), ArgumentError);
  EXPECT_THROW((void)inverse_real_transform(broken, 4), ArgumentError);
}

TEST(Transform, IsSafeInSeveralThreads) {
  const std::vector<double> x = white_noise(300, 4);
  const auto all_lengths = [&] { // each length needs a plan, and all threads make plans at once
    std::vector<std::complex<double>> firsts;
    for (std::size_t n = 2; n <= x.size(); ++n)
      firsts.push_back(real_transform(std::span(x).first(n))[1]);
    return firsts;
  };
  const auto expected = all_lengths();
  std::vector<int> wrong(4, 0);
  std::vector<std::thread> threads;
  for (int& count : wrong)
    threads.emplace_back([&] {
      for (int run = 0; run < 4; ++run)
        count += all_lengths() == expected ? 0 : 1;
    });
  for (std::thread& thread : threads)
    thread.join();
  EXPECT_EQ(wrong, std::vector<int>(4, 0));
}

double integral(const Spectrum& spectrum) {
  double sum = 0.0;
  for (double density : spectrum.density)
    sum += density * spectrum.resolution_hz;
  return sum;
}

// The variance of a series less its least-squares line, weighted by the Hann window. The line comes
// from the normal equations, not from the code under test.
double windowed_variance(const std::vector<double>& x) {
  long double st = 0, stt = 0, sx = 0, stx = 0, squares = 0, weight = 0;
  const auto n = static_cast<long double>(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const auto t = static_cast<long double>(i);
    st += t, stt += t * t, sx += x[i], stx += t * x[i];
  }
  const long double slope = (n * stx - st * sx) / (n * stt - st * st);
  const long double level = (sx - slope * st) / n;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const auto t = static_cast<long double>(i);
    const long double sine = std::sin(std::numbers::pi_v<long double> * t / n);
    const long double rest = sine * sine * (x[i] - level - slope * t);
    squares += rest * rest;
    weight += std::pow(sine, 4.0L);
  }
  return static_cast<double>(squares / weight);
}

TEST(Spectrum, IntegratesToTheWindowedVariance) {
  for (std::size_t n : {997u, 1000u, 1024u}) {
    std::vector<double> x = white_noise(n, n);
    for (std::size_t i = 0; i < n; ++i)
      x[i] += 5.0 + 0.01 * static_cast<double>(i);
    SpectrumOptions options;
    options.segment = n;
    const Spectrum spectrum = welch_spectrum(x, 0.5, options);
    const double variance = windowed_variance(x);
    EXPECT_NEAR(integral(spectrum), variance, 1e-12 * variance); // Parseval, up to rounding
    // The noise has variance 1; that of 1000 windowed values scatters by about 0.05.
    EXPECT_NEAR(variance, 1.0, 0.2);
    EXPECT_EQ(spectrum.segments, 1u);
  }
}

TEST(Spectrum, FrequenciesRunFromZeroToTheNyquistFrequency) {
  const Spectrum even = welch_spectrum(white_noise(100, 1), 2.0);
  ASSERT_EQ(even.frequency_hz.size(), 51u);
  ASSERT_EQ(even.density.size(), 51u);
  EXPECT_EQ(even.segment_length, 100u); // a short series is one segment
  EXPECT_EQ(even.frequency_hz[0], 0.0);
  EXPECT_DOUBLE_EQ(even.frequency_hz[50], 0.25); // half of one sample every 2 s
  EXPECT_DOUBLE_EQ(even.resolution_hz, 0.005);
  const Spectrum odd = welch_spectrum(white_noise(101, 1), 2.0);
  ASSERT_EQ(odd.frequency_hz.size(), 51u);
  EXPECT_DOUBLE_EQ(odd.frequency_hz[50], 50.0 / 202.0);
}

TEST(Spectrum, ContainsThePowerOfASinusoid) {
  const double amplitude = 3.0, interval = 0.25;
  for (double bins : {40.0, 40.3, 40.5}) { // at a frequency of the spectrum, and between two
    std::vector<double> x(1000);
    for (std::size_t i = 0; i < x.size(); ++i)
      x[i] = amplitude *
             std::cos(2.0 * std::numbers::pi * bins * static_cast<double>(i) / 1000.0 + 0.7);
    SpectrumOptions options;
    options.segment = 1000;
    const Spectrum spectrum = welch_spectrum(x, interval, options);
    double near = 0.0;
    for (std::size_t k = 37; k <= 44; ++k)
      near += spectrum.density[k] * spectrum.resolution_hz;
    // Side lobes of the Hann window four or more bins away contain less than 1e-4 of the power.
    EXPECT_NEAR(near, amplitude * amplitude / 2.0, 1e-3) << bins;
    const auto peak = std::max_element(spectrum.density.begin(), spectrum.density.end());
    const double at = static_cast<double>(peak - spectrum.density.begin());
    EXPECT_LE(std::abs(at - bins), 0.5); // the nearest frequency; either of two if halfway
    // At a frequency of the spectrum the peak is the power over the window's noise bandwidth of 1.5
    // resolutions. The tolerance allows for the trend that is fitted and removed.
    if (bins == 40.0) {
      EXPECT_NEAR(*peak, 4.5 / (1.5 * spectrum.resolution_hz), 1e-6 * *peak);
    }
  }
}

TEST(Spectrum, HasTheLevelOfWhiteNoise) {
  const double interval = 0.1, sigma = 2.0;
  std::vector<double> x = white_noise(100000, 3);
  for (double& v : x)
    v *= sigma;
  const Spectrum spectrum = welch_spectrum(x, interval);
  EXPECT_GE(spectrum.segments, 16u);
  EXPECT_LE(spectrum.segments, 17u);
  const double level = 2.0 * interval * sigma * sigma; // one-sided: variance over 1/(2 interval)
  double mean = 0.0;
  for (std::size_t k = 2; k + 1 < spectrum.density.size(); ++k)
    mean += spectrum.density[k];
  mean /= static_cast<double>(spectrum.density.size() - 3);
  EXPECT_NEAR(mean, level, 0.02 * level); // four sigma: sqrt(2/1e5) = 0.45 % for 1e5 values
  EXPECT_NEAR(integral(spectrum), sigma * sigma, 0.02 * sigma * sigma);
}

TEST(Spectrum, RemovingTheTrendChangesOnlyTheLowestFrequencies) {
  SpectrumOptions options;
  options.segment = 64;
  options.overlap = 0.0;
  const Spectrum spectrum = welch_spectrum(white_noise(64 * 4000, 17), 1.0, options);
  const std::vector<double> expected = {1.0 / 3.0, 0.719, 0.994}; // of the flat level; spectrum.hpp
  // The tolerances are four sigma: an average of 4000 independent ordinates has a sigma of 1.6 %,
  // at k = 0 and 32 of 2.2 %. The density there is not doubled.
  EXPECT_NEAR(spectrum.density[0], expected[0], 0.088 * expected[0]);
  for (std::size_t k = 1; k < 3; ++k)
    EXPECT_NEAR(spectrum.density[k] / 2.0, expected[k], 0.064 * expected[k]) << k;
  for (std::size_t k = 3; k < 32; ++k)
    EXPECT_NEAR(spectrum.density[k] / 2.0, 1.0, 0.064) << k;
  EXPECT_NEAR(spectrum.density[32], 1.0, 0.088);
}

TEST(Spectrum, IsIndependentOfAStraightLine) {
  const std::vector<double> plain = white_noise(1000, 18);
  std::vector<double> tilted = plain;
  for (std::size_t i = 0; i < tilted.size(); ++i)
    tilted[i] += 7.0 - 3.0 * static_cast<double>(i);
  const Spectrum a = welch_spectrum(plain, 1.0);
  const Spectrum b = welch_spectrum(tilted, 1.0);
  for (std::size_t k = 0; k < a.density.size(); ++k)
    EXPECT_NEAR(b.density[k], a.density[k], 1e-10) << k; // the line's 3000 takes 4 of 16 digits
  SpectrumOptions mean_only;
  mean_only.detrend_linear = false;
  EXPECT_GT(welch_spectrum(tilted, 1.0, mean_only).density[1], 1e3 * a.density[1]);
}

TEST(Spectrum, DegreesOfFreedomMatchTheScatterOfManyRealisations) {
  for (double overlap : {0.0, 0.5, 0.75}) {
    SpectrumOptions options;
    options.segment = 64;
    options.overlap = overlap;
    double mean = 0.0, square = 0.0, claimed = 0.0;
    constexpr int runs = 2000;
    for (int run = 0; run < runs; ++run) {
      const auto series = white_noise(320, static_cast<std::uint64_t>(run + 1));
      const Spectrum spectrum = welch_spectrum(series, 1.0, options);
      claimed = spectrum.degrees_of_freedom;
      for (std::size_t k : {8u, 16u, 24u}) { // far apart, so nearly independent: 6000 draws in all
        mean += spectrum.density[k] / (3.0 * runs);
        square += spectrum.density[k] * spectrum.density[k] / (3.0 * runs);
      }
    }
    const double found = 2.0 * mean * mean / (square - mean * mean);
    // Three sigma: a variance estimated from 6000 draws of a chi-squared variable with 10 to 18
    // degrees of freedom scatters by 2.4 %.
    EXPECT_NEAR(found / claimed, 1.0, 0.075) << overlap << ": " << found << " against " << claimed;
  }
}

TEST(Spectrum, AnIndependentSegmentGivesTwoDegreesOfFreedom) {
  SpectrumOptions options;
  options.segment = 100;
  options.overlap = 0.0;
  const Spectrum spectrum = welch_spectrum(white_noise(1050, 2), 1.0, options);
  EXPECT_EQ(spectrum.segments, 10u);
  EXPECT_DOUBLE_EQ(spectrum.degrees_of_freedom, 20.0); // a real and an imaginary part for each
}

TEST(Spectrum, SkipsAndCountsSegmentsWithGaps) {
  std::vector<double> series = white_noise(1000, 6);
  SpectrumOptions options;
  options.segment = 100;
  options.overlap = 0.5;
  EXPECT_EQ(welch_spectrum(series, 1.0, options).segments, 19u);
  series[525] = nan; // in the segments that start at 450 and 500
  const Spectrum spectrum = welch_spectrum(series, 1.0, options);
  EXPECT_EQ(spectrum.segments, 17u);
  EXPECT_EQ(spectrum.segments_skipped, 2u);
  for (double density : spectrum.density)
    EXPECT_TRUE(std::isfinite(density));
  // The gap leaves two runs of 9 and 8 segments, with 15 pairs of neighbours correlated by 1/36 (in
  // the limit of long segments).
  const double expected = 2.0 * 17.0 * 17.0 / (17.0 + 2.0 * 15.0 / 36.0);
  EXPECT_NEAR(spectrum.degrees_of_freedom, expected, 1e-3 * expected);
}

TEST(Spectrum, IsAccurateDespiteALargeOffset) {
  std::vector<double> plain = white_noise(512, 9);
  for (double& v : plain)
    v = std::ldexp(std::round(std::ldexp(v, 20)), -20); // so that adding 1e9 is exact
  std::vector<double> raised = plain;
  for (double& v : raised)
    v += 1e9;
  for (bool linear : {true, false}) {
    SpectrumOptions options;
    options.detrend_linear = linear;
    const Spectrum a = welch_spectrum(plain, 1.0, options);
    const Spectrum b = welch_spectrum(raised, 1.0, options);
    for (std::size_t k = 0; k < a.density.size(); ++k)
      EXPECT_NEAR(b.density[k], a.density[k], 1e-12) << k; // rounding of densities of order 1
  }
}

TEST(Spectrum, RefusesArgumentsOutsideTheirDomain) {
  const std::vector<double> series = white_noise(100, 1);
  const auto with = [](std::size_t segment, double overlap) {
    SpectrumOptions options;
    options.segment = segment;
    options.overlap = overlap;
    return options;
  };
  EXPECT_EQ(welch_spectrum(series, 1.0, with(100, 0.9)).segments, 1u);
  EXPECT_THROW((void)welch_spectrum(series, 1.0, with(101, 0.5)), ArgumentError);
  EXPECT_THROW((void)welch_spectrum(series, 1.0, with(7, 0.5)), ArgumentError);
  EXPECT_THROW((void)welch_spectrum(series, 1.0, with(50, 0.91)), ArgumentError);
  EXPECT_THROW((void)welch_spectrum(series, 1.0, with(50, -0.1)), ArgumentError);
  EXPECT_THROW((void)welch_spectrum(series, 0.0), ArgumentError);
  EXPECT_THROW((void)welch_spectrum(series, nan), ArgumentError);
  EXPECT_THROW((void)welch_spectrum(std::span(series).first(7), 1.0), ArgumentError);
  EXPECT_THROW((void)welch_spectrum(std::vector<double>(100, nan), 1.0), ArgumentError);
  EXPECT_THROW((void)welch_spectrum(std::vector<double>(100, infinity), 1.0), ArgumentError);
}

} // namespace
} // namespace goingrate
