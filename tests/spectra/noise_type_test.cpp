// Identification of power-law noise, degrees of freedom and intervals, against slow obvious
// oracles.
#include "goingrate/spectra/stability.hpp"
#include "spectra/degrees_of_freedom.hpp"
#include "spectra/noise_type.hpp"

#include "support/nan.hpp"

#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "goingrate/base/errors.hpp"
#include "goingrate/base/random.hpp"

namespace goingrate {
namespace {

using test::nan;

// Phase with S_y ~ f^alpha: white noise through the fractional integrator (1 - z^-1)^(-beta/2),
// beta = 2 - alpha (N. J. Kasdin, Proc. IEEE 83 (1995) 802). The first half is run-in.
std::vector<double> power_law_phase(int alpha, std::size_t points, std::uint64_t seed) {
  RandomStream stream(seed, StreamPurpose::jitter);
  const std::size_t all = 2 * points;
  std::vector<double> white(all), h(all, 1.0), phase(points, 0.0);
  for (double& v : white)
    v = stream.normal();
  const double half_beta = 0.5 * (2.0 - alpha);
  for (std::size_t k = 1; k < all; ++k) {
    const double order = static_cast<double>(k);
    h[k] = h[k - 1] * (order - 1.0 + half_beta) / order;
  }
  for (std::size_t i = 0; i < points; ++i)
    for (std::size_t k = 0; k <= i + points; ++k)
      phase[i] += h[k] * white[i + points - k];
  return phase;
}

TEST(NoiseType, IsRightForLongSimulatedSeries) {
  for (int alpha : {2, 0, -2})
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const NoiseType noise = identify_noise(power_law_phase(alpha, 1000, seed), 1);
      EXPECT_TRUE(noise.identified);
      EXPECT_EQ(noise.alpha, alpha) << "seed " << seed << ", exponent " << noise.exponent;
      EXPECT_EQ(noise.points, 1000u);
    }
}

TEST(NoiseType, SeesFlickerBetweenItsNeighbours) {
  for (int alpha : {1, -1}) {
    double mean = 0.0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed)
      mean += identify_noise(power_law_phase(alpha, 1000, seed), 1).exponent / 20.0;
    // lag 1 of a flicker series is biased by the parabola removed and its slow convergence; a third
    // of the distance to the next integer still tells the kinds apart
    EXPECT_NEAR(mean, alpha, 0.33);
  }
}

TEST(NoiseType, TellsWhatDominatesAtLongAveraging) {
  // white phase noise of 10 against steps of 1: at m = 2000 a step of the walk is 45
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    RandomStream stream(seed, StreamPurpose::jitter);
    std::vector<double> phase(400000);
    double walk = 0.0;
    for (double& x : phase) {
      walk += stream.normal();
      x = walk + 10.0 * stream.normal();
    }
    EXPECT_EQ(identify_noise(phase, 1).alpha, 2);
    EXPECT_EQ(identify_noise(phase, 2000).alpha, 0);
  }
}

TEST(NoiseType, ErrsUpwardsOnFewPoints) {
  int right = 0, above = 0;
  for (std::uint64_t seed = 1; seed <= 600; ++seed) {
    const int alpha = identify_noise(power_law_phase(0, 40, seed), 1).alpha;
    right += alpha == 0 ? 1 : 0;
    above += alpha > 0 ? 1 : 0;
  }
  EXPECT_NEAR(right / 600.0, 5.0 / 6.0, 0.05); // three standard errors of a share in 600
  EXPECT_GT(above, 5 * (600 - right - above));
}

TEST(NoiseType, DoesNotSeeOffsetRateOrDrift) {
  std::vector<double> phase = power_law_phase(0, 500, 7);
  const double plain = identify_noise(phase, 3).exponent;
  for (std::size_t i = 0; i < phase.size(); ++i) {
    const double t = static_cast<double>(i);
    phase[i] += 1e3 + 10.0 * t + 0.1 * t * t;
  }
  EXPECT_NEAR(identify_noise(phase, 3).exponent, plain, 1e-8); // 1e5 added costs 5 of 16 digits
}

TEST(NoiseType, SurvivesGaps) {
  for (int alpha : {2, 0, -2}) {
    std::vector<double> phase = power_law_phase(alpha, 2000, 11);
    RandomStream stream(12, StreamPurpose::missed);
    for (double& x : phase)
      if (stream.uniform() < 0.1) x = nan;
    const NoiseType noise = identify_noise(phase, 1);
    ASSERT_TRUE(noise.identified);
    EXPECT_EQ(noise.alpha, alpha) << noise.exponent;
    EXPECT_LT(noise.points, 2000u);
  }
}

TEST(NoiseType, ScalesSumsToThePairsThatGapsLeave) {
  RandomStream stream(13, StreamPurpose::jitter);
  std::vector<double> whole(4000);
  double before = 0.0;
  for (double& x : whole) { // neighbours anticorrelated, so that a lost pair would be missed
    const double fresh = stream.normal();
    x = fresh - 0.8 * before;
    before = fresh;
  }
  std::vector<double> holed = whole;
  for (double& x : holed)
    if (stream.uniform() < 0.4) x = nan;
  const double r1 = -0.8 / 1.64;
  const double expected = 2.0 - 2.0 * r1 / (1.0 + r1);
  // r1 errs by 0.012 whole and 0.03 holed; d(exponent)/d(r1) is 2/(1 + r1)^2 = 7.6; three of them
  EXPECT_NEAR(identify_noise(whole, 1).exponent, expected, 0.3);
  EXPECT_NEAR(identify_noise(holed, 1).exponent, expected, 0.7);
}

// The textbook, step by step: decimate, take the parabola away, correlate, difference.
double textbook_exponent(const std::vector<double>& phase, std::size_t m) {
  std::vector<double> z;
  for (std::size_t i = 0; i < phase.size(); i += m)
    z.push_back(phase[i]);
  Eigen::MatrixXd powers(static_cast<Eigen::Index>(z.size()), 3);
  for (Eigen::Index i = 0; i < powers.rows(); ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(powers.rows()) - 0.5;
    powers.row(i) << 1.0, t, t * t;
  }
  Eigen::Map<Eigen::VectorXd> values(z.data(), powers.rows());
  values -= powers * powers.colPivHouseholderQr().solve(values.eval());
  for (int d = 0;; ++d) {
    double mean = 0.0, products = 0.0, squares = 0.0;
    for (const double v : z)
      mean += v / static_cast<double>(z.size());
    for (std::size_t i = 0; i < z.size(); ++i) {
      squares += (z[i] - mean) * (z[i] - mean);
      if (i > 0) products += (z[i] - mean) * (z[i - 1] - mean);
    }
    const double rho = products / squares / (1.0 + products / squares);
    if (rho < 0.25 || d == 2) return 2.0 - 2.0 * (rho + d);
    for (std::size_t i = 0; i + 1 < z.size(); ++i)
      z[i] = z[i + 1] - z[i];
    z.pop_back();
  }
}

TEST(NoiseType, IsThatOfTheTextbookInSeriesOfAnyLength) {
  for (const int alpha : {2, 0, -2})
    for (const std::size_t points : {30u, 1024u, 1025u, 1026u, 4099u}) {
      const std::vector<double> phase = power_law_phase(alpha, points, points);
      for (const std::size_t m : {1u, 3u}) {
        if (points / m < least_points_for_noise_type) continue;
        // Sums of thousands of terms in another order, of a walk that is thousands of steps wide.
        EXPECT_NEAR(identify_noise(phase, m).exponent, textbook_exponent(phase, m), 1e-8)
            << alpha << ' ' << points << ' ' << m;
      }
    }
}

// MVAR/AVAR with windows summed one by one, and what it says: 2 or 1.
int phase_noise_by_definition(const std::vector<double>& x, std::size_t m) {
  const auto mean = [&](std::size_t i) {
    double sum = 0.0;
    for (std::size_t k = i; k < i + m; ++k)
      sum += x[k];
    return sum / static_cast<double>(m);
  };
  double modified = 0.0, plain = 0.0, windows = 0.0, points = 0.0;
  for (std::size_t i = 0; i + 2 * m < x.size(); i += m / 16) {
    plain += std::pow(x[i + 2 * m] - 2.0 * x[i + m] + x[i], 2);
    ++points;
    if (i + 3 * m > x.size()) continue;
    modified += std::pow(mean(i + 2 * m) - 2.0 * mean(i + m) + mean(i), 2);
    ++windows;
  }
  const double factor = static_cast<double>(m);
  const double flicker =
      1.5 * std::log(256.0 / 27.0) / (1.038 + 3.0 * std::log(std::acos(-1.0) * factor));
  return modified / windows / (plain / points) < std::sqrt(flicker / factor) ? 2 : 1;
}

TEST(NoiseType, ByRatioTellsPhaseNoisesApartByWindowsOfAnyLength) {
  int phase_noises = 0;
  for (const std::size_t m :
       {47u, 130u, 300u}) // windows that are summed in parts of different size
    for (std::uint64_t seed = 1; seed <= 10; ++seed)
      for (const int alpha : {2, 1}) {
        const std::vector<double> phase = power_law_phase(alpha, 12 * m, seed);
        const int found = identify_noise_by_ratio(phase, m).alpha;
        if (found < 1) continue;
        ++phase_noises;
        EXPECT_EQ(found, phase_noise_by_definition(phase, m)) << m << ' ' << seed << ' ' << alpha;
      }
  EXPECT_GT(phase_noises, 40);
}

TEST(NoiseType, AsksForThirtyNeighbouringPoints) {
  const std::vector<double> phase = power_law_phase(0, 30, 3);
  EXPECT_TRUE(identify_noise(phase, 1).identified);
  EXPECT_FALSE(identify_noise(std::span(phase).first(29), 1).identified);
  std::vector<double> holed = power_law_phase(0, 31, 3);
  holed[15] = nan; // 30 points, but only 28 pairs where 30 unbroken points have 29
  EXPECT_FALSE(identify_noise(holed, 1).identified);
  std::vector<double> sieve = power_law_phase(0, 200, 3);
  for (std::size_t i = 0; i < sieve.size(); i += 2)
    sieve[i] = nan; // no two neighbours left
  EXPECT_FALSE(identify_noise(sieve, 1).identified);
}

TEST(NoiseType, IsNotClaimedForAConstantAndIsWhitePhaseForAnAlternation) {
  EXPECT_FALSE(identify_noise(std::vector<double>(100, 0.0), 1).identified);
  std::vector<double> alternating(100);
  for (std::size_t i = 0; i < alternating.size(); ++i)
    alternating[i] = i % 2 == 0 ? 1.0 : -1.0;
  EXPECT_EQ(identify_noise(alternating, 1).alpha, 2);
  EXPECT_THROW((void)identify_noise(alternating, 0), ArgumentError);
}

TEST(NoiseType, ByRatioIsRightAboutHalfTheTime) {
  for (int alpha : {0, -2}) {
    int right = 0;
    for (std::uint64_t seed = 1; seed <= 600; ++seed)
      right += identify_noise_by_ratio(power_law_phase(alpha, 13, seed), 1).alpha == alpha ? 1 : 0;
    EXPECT_GT(right, 240) << alpha; // three standard errors (of 12) below half
  }
  EXPECT_FALSE(identify_noise_by_ratio(power_law_phase(0, 6, 1), 1).identified);
  EXPECT_TRUE(identify_noise_by_ratio(power_law_phase(0, 7, 1), 1).identified);
  EXPECT_FALSE(identify_noise_by_ratio(std::vector<double>(20, 1.0), 1).identified);
  EXPECT_THROW((void)identify_noise_by_ratio(std::vector<double>(20, 1.0), 0), ArgumentError);
}

// The formula of Greenhall and Riley as printed: lags in units of tau, long double.
long double power_law_w(long double t, int alpha) {
  t = std::abs(t);
  const long double log_t = t == 0.0L ? 0.0L : std::log(t);
  const long double sign = alpha == 2 || alpha == -1 || alpha == -2 ? -1 : 1;
  return sign * std::pow(t, 3.0L - static_cast<long double>(alpha)) * (alpha % 2 == 0 ? 1 : log_t);
}

// order: 2 or 3; f: m, or 1 for means over tau.
long double formula_sz(long double t, int alpha, std::size_t order, long double f) {
  const auto sx = [&](long double u) {
    return f * f *
           (2 * power_law_w(u, alpha) - power_law_w(u - 1 / f, alpha) -
            power_law_w(u + 1 / f, alpha));
  };
  if (order == 2) return 6 * sx(t) - 4 * sx(t - 1) - 4 * sx(t + 1) + sx(t - 2) + sx(t + 2);
  return 20 * sx(t) - 15 * (sx(t - 1) + sx(t + 1)) + 6 * (sx(t - 2) + sx(t + 2)) - sx(t - 3) -
         sx(t + 3);
}

double formula_edf(int alpha, std::size_t m, std::size_t n, const DifferenceVariance& variance) {
  const std::size_t s = variance.stride == DifferenceStride::one_sample ? m : 1;
  const std::size_t j_max = std::min(n, (variance.order + 1) * s);
  const long double f = variance.filter == PhaseFilter::none ? static_cast<long double>(m) : 1.0L;
  const auto square = [&](std::size_t j) {
    const long double z = formula_sz(static_cast<long double>(j) / static_cast<long double>(s),
                                     alpha, variance.order, f);
    return z * z;
  };
  const long double count = static_cast<long double>(n);
  long double sum = square(0) + (1 - static_cast<long double>(j_max) / count) * square(j_max);
  for (std::size_t j = 1; j < j_max; ++j)
    sum += 2 * (1 - static_cast<long double>(j) / count) * square(j);
  return static_cast<double>(count * square(0) / sum);
}

TEST(DegreesOfFreedom, EqualTheDefiningFormulaInWiderArithmetic) {
  for (const auto stride : {DifferenceStride::one_sample, DifferenceStride::one_tau})
    for (const auto filter : {PhaseFilter::none, PhaseFilter::mean_of_tau})
      for (std::size_t order : {2u, 3u})
        for (int alpha = order == 2 ? -2 : -4; alpha <= 2; ++alpha)
          for (std::size_t m : {1u, 2u, 3u, 8u, 15u, 16u, 17u, 31u, 32u, 33u, 100u, 1000u})
            for (std::size_t n : {1u, 2u, 5u, 40u, 2500u}) {
              const DifferenceVariance variance{stride, order, filter};
              const double slow = formula_edf(alpha, m, n, variance);
              // the printed form multiplies roundings of 1e-19 by m^2 and by powers of the lag, the
              // eighth at m = 1000 with d = 3, where it and not ours is the worse
              const double share = order == 3 && m > 100 ? 1e-6 : 1e-9;
              EXPECT_NEAR(difference_degrees_of_freedom(alpha, m, n, variance), slow, share * slow)
                  << "alpha " << alpha << " m " << m << " n " << n << " order " << order;
            }
}

TEST(DegreesOfFreedom, OfLongAveragingLoseLittleByBlocks) {
  for (int alpha = -2; alpha <= 2; ++alpha) {
    constexpr std::size_t m = 10000;
    const double full = formula_edf(alpha, m, 100000, {});
    EXPECT_NEAR(difference_degrees_of_freedom(alpha, m, 100000, {}), full, 3e-5 * full)
        << alpha; // see the header
  }
}

// White frequency noise on a grid `fine` times finer than the samples: response of a second
// difference over m samples to one unit of it, phases averaged over a sample or read at an instant.
double simulated_white_frequency_edf(std::size_t m, std::size_t n, std::size_t fine, bool average) {
  const std::size_t reach = (2 * m + n + 2) * fine;
  const auto phase_response = [&](std::size_t sample, std::size_t cell) {
    double sum = 0.0;
    for (std::size_t k = 0; k < fine; ++k) {
      const std::size_t instant = sample * fine + (average ? k : 0);
      sum += instant > cell ? 1.0 : 0.0;
    }
    return sum / static_cast<double>(fine);
  };
  std::vector<std::vector<double>> response(n, std::vector<double>(reach));
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t cell = 0; cell < reach; ++cell)
      response[i][cell] = phase_response(i + 2 * m, cell) - 2.0 * phase_response(i + m, cell) +
                          phase_response(i, cell);
  double sum = 0.0, diagonal = 0.0; // edf = n^2 cov(0)^2 / sum of cov^2 over all pairs
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < n; ++k) {
      double covariance = 0.0;
      for (std::size_t cell = 0; cell < reach; ++cell)
        covariance += response[i][cell] * response[k][cell];
      sum += covariance * covariance;
      if (i == 0 && k == 0) diagonal = covariance;
    }
  return static_cast<double>(n * n) * diagonal * diagonal / sum;
}

TEST(DegreesOfFreedom, AreThoseOfPhasesAveragedOverASample) {
  for (std::size_t m : {1u, 2u, 5u}) {
    const std::size_t n = 12;
    const double model = allan_degrees_of_freedom(0, m, n, DifferenceStride::one_sample);
    // 16 cells a sample err by about 1/16^2 in the variance of an average; lags beyond 3 tau are 0
    EXPECT_NEAR(simulated_white_frequency_edf(m, n, 16, true) / model, 1.0, 5e-3) << "m " << m;
  }
}

TEST(DegreesOfFreedom, DifferForPhasesReadAtInstants) {
  const auto ratio = [](std::size_t m) {
    const std::size_t n = 250; // long enough that the ends do not matter to two digits
    return simulated_white_frequency_edf(m, n, 1, false) /
           allan_degrees_of_freedom(0, m, n, DifferenceStride::one_sample);
  };
  // the numbers in the header, to half a unit of the digits given there
  EXPECT_NEAR(ratio(1), 0.85, 0.005);
  EXPECT_NEAR(ratio(2), 1.05, 0.005);
  EXPECT_NEAR(ratio(4), 1.13, 0.005);
  EXPECT_NEAR(ratio(8), 1.10, 0.005);
}

TEST(DegreesOfFreedom, PredictTheScatterOfSimulatedVariances) {
  constexpr std::size_t m = 8, points = 129, runs = 1500;
  for (int alpha : {2, 1, 0, -1, -2}) {
    double mean = 0.0, square = 0.0;
    for (std::uint64_t seed = 1; seed <= runs; ++seed) {
      const std::vector<double> x = power_law_phase(alpha, points, seed);
      double variance = 0.0;
      for (std::size_t i = 0; i + 2 * m < points; ++i)
        variance += std::pow(x[i + 2 * m] - 2.0 * x[i + m] + x[i], 2);
      mean += variance / runs;
      square += variance * variance / runs;
    }
    const double edf = 2.0 * mean * mean / (square - mean * mean);
    // a variance of variances over 1500 runs scatters by 5 to 7 %: three standard errors
    EXPECT_NEAR(
        edf / allan_degrees_of_freedom(alpha, m, points - 2 * m, DifferenceStride::one_sample), 1.0,
        0.2)
        << "alpha " << alpha;
  }
}

TEST(DegreesOfFreedom, OfTotalVariancesAreNearTheSimulated) {
  struct Case {
    DeviationKind kind;
    std::size_t m;
    double formula;
  };
  constexpr std::size_t points = 501, runs = 600;
  for (const Case& c :
       {Case{DeviationKind::totdev, 32, total_degrees_of_freedom(0, 32, points)},
        Case{DeviationKind::htotdev, 32, hadamard_total_degrees_of_freedom(0, 32, points)},
        Case{DeviationKind::mtotdev, 32, modified_total_degrees_of_freedom(0, 32, points)},
        Case{DeviationKind::theo1, 40, theo1_degrees_of_freedom(0, 40, points)}}) {
    double mean = 0.0, square = 0.0;
    for (std::uint64_t seed = 1; seed <= runs; ++seed) {
      RandomStream stream(seed, StreamPurpose::jitter);
      std::vector<double> x(points, 0.0);
      for (std::size_t i = 1; i < points; ++i)
        x[i] = x[i - 1] + stream.normal();
      const std::array factors = {c.m};
      const double value = std::pow(
          stability_table(c.kind, x, 1.0, factors, {.alpha = 0, .threads = 1}).rows[0].value, 2);
      mean += value / runs;
      square += value * value / runs;
    }
    const double edf = 2.0 * mean * mean / (square - mean * mean);
    // a variance of variances over 600 runs scatters by 8 %, and the formulas err by up to 15 %
    EXPECT_NEAR(edf / c.formula, 1.0, 0.3) << name_of(c.kind);
  }
}

TEST(DegreesOfFreedom, RefuseNoiseWithoutAnAllanVariance) {
  const auto edf = [](int alpha, std::size_t m, std::size_t n) {
    return allan_degrees_of_freedom(alpha, m, n, DifferenceStride::one_sample);
  };
  EXPECT_THROW((void)edf(-3, 1, 10), ArgumentError);
  EXPECT_THROW((void)edf(3, 1, 10), ArgumentError);
  EXPECT_THROW((void)edf(0, 0, 10), ArgumentError);
  EXPECT_THROW((void)edf(0, 1, 0), ArgumentError);
  EXPECT_NEAR(edf(0, 7, 1), 1.0, 1e-14); // one difference is one degree; a few roundings
}

TEST(ChiSquaredInterval, AgreesWithTheClosedFormForTwoDegrees) {
  for (double probability : {0.05, one_sigma_probability, 0.95}) {
    const DeviationInterval interval = chi_squared_interval(3.0, 2.0, probability);
    const double tail = 0.5 * (1.0 - probability); // quantile of chi-squared(2): -2 ln(1 - p)
    EXPECT_NEAR(interval.low, 3.0 * std::sqrt(-1.0 / std::log(tail)), 3e-12);     // a few roundings
    EXPECT_NEAR(interval.high, 3.0 * std::sqrt(-1.0 / std::log1p(-tail)), 3e-12); // in the quantile
  }
}

TEST(ChiSquaredInterval, RefusesWhatHasNoInterval) {
  EXPECT_THROW((void)chi_squared_interval(-1.0, 2.0), ArgumentError);
  EXPECT_THROW((void)chi_squared_interval(nan, 2.0), ArgumentError);
  EXPECT_THROW((void)chi_squared_interval(1.0, 0.0), ArgumentError);
  EXPECT_THROW((void)chi_squared_interval(1.0, 2.0, 1.0), ArgumentError);
  EXPECT_EQ(chi_squared_interval(0.0, 2.0).high, 0.0);
}

} // namespace
} // namespace goingrate
