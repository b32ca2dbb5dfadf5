// Allan deviations against published tables, slow obvious sums and simulated clocks.
#include "goingrate/spectra/stability.hpp"

#include "support/nan.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "goingrate/base/errors.hpp"
#include "goingrate/base/random.hpp"
#include "spectra/degrees_of_freedom.hpp"
#include "spectra/noise_type.hpp"
#include "support/simulated_phase.hpp"

namespace goingrate {
namespace {

using test::simulated_phase;

using test::nan;

std::vector<double> values(DeviationKind kind, std::span<const double> phase, double tau0,
                           std::vector<std::size_t> factors) {
  std::vector<double> result;
  for (const DeviationRow& row : stability_table(kind, phase, tau0, factors).rows)
    result.push_back(row.value);
  return result;
}

TEST(Stability, ReproducesTheNist1000PointSet) {
  std::vector<double> y; // the generator printed in SP 1065, p. 108
  for (std::uint64_t n = 1234567890; y.size() < 1000; n = 16807 * n % 2147483647)
    y.push_back(static_cast<double>(n) / 2147483647.0);
  const std::vector<double> phase = phase_from_frequency(y, 1.0);
  const auto adev = values(DeviationKind::adev, phase, 1.0, {1, 10, 100});
  const auto oadev = values(DeviationKind::oadev, phase, 1.0, {1, 10, 100});
  const std::array adev_printed = {2.922319e-01, 9.965736e-02, 3.897804e-02};
  const std::array oadev_printed = {2.922319e-01, 9.159953e-02, 3.241343e-02};
  for (std::size_t i = 0; i < 3; ++i) { // half a unit of the seventh printed digit
    const double half_digit = i == 0 ? 0.5e-7 : 0.5e-8;
    EXPECT_NEAR(adev[i], adev_printed[i], half_digit);
    EXPECT_NEAR(oadev[i], oadev_printed[i], half_digit);
  }
}

TEST(Stability, ReproducesTheTenPhasesOfNbs14) {
  const std::vector<double> phase = {0,        103.11111, 123.22222, 157.33333, 166.44444,
                                     48.55555, -96.33333, -2.22222,  111.88889, 0};
  const auto adev = values(DeviationKind::adev, phase, 1.0, {1, 2});
  const auto oadev = values(DeviationKind::oadev, phase, 1.0, {1, 2});
  EXPECT_NEAR(adev[0], 91.22945, 0.5e-5);  // half a unit of the last printed digit, here and below
  EXPECT_NEAR(adev[1], 115.8082, 0.5e-4);  // half the last digit of the table
  EXPECT_NEAR(oadev[0], 91.22945, 0.5e-5); // likewise
  EXPECT_NEAR(oadev[1], 85.95287, 0.5e-5); // likewise
}

TEST(Stability, EqualsTheSlowOracleOnDataWithGaps) {
  std::vector<double> phase = simulated_phase(1, 700, 5);
  RandomStream stream(6, StreamPurpose::missed);
  for (double& x : phase)
    if (stream.uniform() < 0.05) x = nan;
  for (std::size_t i = 200; i < 240; ++i)
    phase[i] = nan;
  phase.front() = phase.back() = nan;
  const double tau0 = 2.5;
  const std::vector<std::size_t> factors = all_factors(phase.size());
  for (const DeviationKind kind : {DeviationKind::adev, DeviationKind::oadev})
    for (const DeviationRow& row : stability_table(kind, phase, tau0, factors).rows) {
      long double sum = 0;
      std::size_t n = 0;
      for (std::size_t i = 0; i + 2 * row.m < phase.size(); ++i) {
        if (kind == DeviationKind::adev && i % row.m != 0) continue;
        const long double second = static_cast<long double>(phase[i + 2 * row.m]) -
                                   2 * static_cast<long double>(phase[i + row.m]) +
                                   static_cast<long double>(phase[i]);
        if (second == second) sum += second * second, ++n;
      }
      EXPECT_EQ(row.n, n) << row.m;
      EXPECT_EQ(row.tau_s, static_cast<double>(row.m) * tau0);
      if (n == 0) {
        EXPECT_TRUE(std::isnan(row.value) && std::isnan(row.low) && !row.interval) << row.m;
        continue;
      }
      const auto slow = static_cast<double>(std::sqrt(sum / (2 * static_cast<long double>(n))) /
                                            static_cast<long double>(row.tau_s));
      // a rounding of 1e-16 of the walk's reach (some 50), against second differences of order 1
      EXPECT_NEAR(row.value, slow, 1e-12 * slow) << row.m;
    }
}

TEST(Stability, IsImmuneToOffsetAndSlope) {
  // Phases on a grid of 2^-20 s stay exact under an offset of 1e9 s and a slope of 2^-10: whatever
  // differs then was lost by us and not by the representation of the data.
  std::vector<double> plain = simulated_phase(1, 3000, 8);
  for (double& x : plain)
    x = std::ldexp(std::round(std::ldexp(1e-3 * x, 20)), -20);
  std::vector<double> moved = plain;
  for (std::size_t i = 0; i < moved.size(); ++i)
    moved[i] += 1e9 + std::ldexp(static_cast<double>(i), -10);
  moved[50] = plain[50] = nan;
  const std::vector<std::size_t> factors = octave_factors(plain.size());
  const DeviationTable a = stability_table(DeviationKind::oadev, plain, 1.0, factors);
  const DeviationTable b = stability_table(DeviationKind::oadev, moved, 1.0, factors);
  for (std::size_t i = 0; i < factors.size(); ++i) {
    EXPECT_NEAR(b.rows[i].value, a.rows[i].value, 1e-12 * a.rows[i].value); // a few roundings
    EXPECT_EQ(b.rows[i].alpha, a.rows[i].alpha);
  }
}

TEST(Stability, FollowsASlopeOfOneInAThousandThatIsNotExact) {
  const std::vector<double> plain = simulated_phase(1, 3000, 9);
  std::vector<double> moved = plain;
  for (std::size_t i = 0; i < moved.size(); ++i)
    moved[i] += 1e9 + 1e-3 * static_cast<double>(i);
  const auto a = values(DeviationKind::oadev, plain, 1.0, {1, 100, 1000});
  const auto b = values(DeviationKind::oadev, moved, 1.0, {1, 100, 1000});
  for (std::size_t i = 0; i < a.size(); ++i)
    EXPECT_NEAR(b[i], a[i], 1e-7 * a[i]); // a phase of 1e9 is rounded to 1.2e-7 before we see it
}

double slope_of_deviation(int walks, std::uint64_t seed) {
  const std::vector<double> phase = simulated_phase(walks, 40001, seed);
  const auto d = values(DeviationKind::oadev, phase, 1.0, {4, 64});
  return std::log(d[1] / d[0]) / std::log(16.0);
}

TEST(Stability, HasTheSlopeAndTheNoiseTypeOfTheNoisePutIn) {
  // 0.03: a deviation over 40000 points at m = 64 scatters by 3 to 4 %, ln 16 is 2.8
  EXPECT_NEAR(slope_of_deviation(0, 21), -1.0, 0.03);
  EXPECT_NEAR(slope_of_deviation(1, 22), -0.5, 0.03);
  EXPECT_NEAR(slope_of_deviation(2, 23), 0.5, 0.03);
  for (int walks : {0, 1, 2}) {
    const std::vector<double> phase = simulated_phase(walks, 40001, 24);
    const std::vector<std::size_t> factors = {1, 4, 16, 64};
    for (const DeviationRow& row : stability_table(DeviationKind::oadev, phase, 1.0, factors).rows)
      EXPECT_EQ(row.alpha, 2 - 2 * walks) << row.m;
  }
}

double coverage(DeviationKind kind, std::size_t points, std::size_t m) {
  int covered = 0;
  constexpr int runs = 400;
  for (int run = 0; run < runs; ++run) {
    const auto phase = simulated_phase(1, points, static_cast<std::uint64_t>(1000 + run));
    const std::array factors = {m};
    const DeviationRow row = stability_table(kind, phase, 1.0, factors).rows[0];
    const double truth = 1.0 / std::sqrt(static_cast<double>(m)); // white FM of unit variance
    covered += row.interval && row.low <= truth && truth <= row.high ? 1 : 0;
  }
  return static_cast<double>(covered) / runs;
}

TEST(StabilityInterval, CoversTheTruthAsOftenAsItSays) {
  for (const DeviationKind kind : {DeviationKind::adev, DeviationKind::oadev})
    for (std::size_t m : {1u, 8u, 64u}) {
      const double share = coverage(kind, 5121, m);
      EXPECT_GT(share, 0.62) << m; // 0.683 less 2.7 standard errors of 400 runs
      EXPECT_LT(share, 0.75) << m; // and plus 2.9
    }
}

TEST(StabilityInterval, OfOtherKindsCoversTheTruth) {
  struct Case {
    DeviationKind kind;
    std::size_t m;
    double least, most; // 0.683 with 2.7 standard errors of 400 runs, unless said
  };
  const auto share_of = [](const Case& c) {
    int covered = 0;
    for (std::uint64_t run = 1; run <= 400; ++run) {
      const auto phase = simulated_phase(1, 1025, run);
      const std::array factors = {c.m};
      const DeviationOptions options{.alpha = 0, .threads = 1};
      const DeviationRow row = stability_table(c.kind, phase, 1.0, factors, options).rows[0];
      const double truth = 1.0 / std::sqrt(row.tau_s);
      covered += row.low <= truth && truth <= row.high ? 1 : 0;
    }
    return covered / 400.0;
  };
  for (const Case& c :
       {Case{DeviationKind::hdev, 32, 0.62, 0.75}, Case{DeviationKind::ohdev, 32, 0.62, 0.75},
        Case{DeviationKind::totdev, 1, 0.60, 0.75}, // phases read at instants: 8 %
        Case{DeviationKind::totdev, 128, 0.62, 0.75}, Case{DeviationKind::htotdev, 64, 0.62, 0.75},
        Case{DeviationKind::theo1, 100, 0.62, 0.75}, Case{DeviationKind::theoh, 240, 0.62, 0.75}}) {
    const double share = share_of(c);
    EXPECT_GT(share, c.least) << name_of(c.kind) << c.m;
    EXPECT_LT(share, c.most) << name_of(c.kind) << c.m;
  }
}

TEST(StabilityInterval, CoversLessWhereTheNoiseTypeRestsOnFewPoints) {
  // 2561 phases leave 41 at m = 64: one noise type in six is wrong, and then so is the interval
  EXPECT_NEAR(coverage(DeviationKind::oadev, 2561, 64), 0.64, 0.07); // three standard errors
}

TEST(StabilityInterval, TakesTheNoiseTypeFromTheRatioWhenPointsRunOut) {
  const std::vector<double> phase = simulated_phase(2, 601, 31);
  const auto rows =
      stability_table(DeviationKind::oadev, phase, 1.0, octave_factors(phase.size())).rows;
  EXPECT_FALSE(identify_noise(phase, 32).identified);
  ASSERT_EQ(rows.back().m, 256u);
  for (const DeviationRow& row : rows)
    if (row.m > 16) {
      const NoiseType noise = identify_noise_by_ratio(phase, row.m);
      // 128 and 256 leave four and two frequencies: too few even for the ratio
      EXPECT_EQ(noise.identified, row.m < 128) << row.m;
      EXPECT_EQ(row.alpha, noise.identified ? noise.alpha : rows[6].alpha) << row.m;
      EXPECT_TRUE(row.interval) << row.m;
    }
  const std::array lone = {
      std::size_t{250}}; // no row before: the longest identifiable tau is asked
  const DeviationRow row = stability_table(DeviationKind::oadev, phase, 1.0, lone).rows[0];
  EXPECT_EQ(row.alpha, identify_noise(phase, 600 / 29).alpha);
  EXPECT_TRUE(row.interval && row.low < row.value && row.value < row.high);
}

TEST(StabilityInterval, IsNotGivenWithoutANoiseType) {
  const std::vector<double> few = simulated_phase(1, 6, 32);
  for (const DeviationRow& row :
       stability_table(DeviationKind::adev, few, 1.0, octave_factors(few.size())).rows) {
    EXPECT_FALSE(row.interval);
    EXPECT_TRUE(std::isnan(row.low) && std::isnan(row.high) && std::isfinite(row.value));
  }
  std::vector<double> runaway = simulated_phase(4, 400, 33); // alpha about -6, found as -3
  const std::array one = {std::size_t{1}};
  const DeviationRow row = stability_table(DeviationKind::oadev, runaway, 1.0, one).rows[0];
  EXPECT_EQ(row.alpha, -3);
  EXPECT_FALSE(row.interval);
}

TEST(Stability, AReturningPhaseIsNotWhite) {
  // A phase that returns in 100 samples: a walk below, phase noise beyond, in steps of 100 samples.
  int inside = 0;
  constexpr int runs = 60;
  constexpr std::size_t m = 1024, n = 20000;
  double truth2 = 0.0;
  std::vector<DeviationRow> rows;
  for (int run = 0; run < runs; ++run) {
    RandomStream stream(static_cast<std::uint64_t>(run + 1), StreamPurpose::jitter);
    std::vector<double> phase{0.0};
    for (std::size_t i = 1; i < n; ++i)
      phase.push_back(0.99 * phase.back() + stream.normal());
    const auto factors = octave_factors(n);
    const auto table = stability_table(DeviationKind::oadev, phase, 1.0, factors);
    rows.push_back(table.rows[10]);
    ASSERT_EQ(rows.back().m, m);
    truth2 += rows.back().value * rows.back().value / runs;
  }
  for (const DeviationRow& row : rows)
    inside += row.interval && row.low * row.low < truth2 && truth2 < row.high * row.high ? 1 : 0;
  EXPECT_GT(inside, 28); // 41 expected, 3.6 their scatter; as white phase noise it would be 8
}

TEST(Stability, RefusesArgumentsOutsideTheirDomain) {
  const std::vector<double> phase = simulated_phase(1, 10, 1);
  using Factors = std::vector<std::size_t>;
  EXPECT_EQ(values(DeviationKind::oadev, phase, 1.0, {4}).size(), 1u); // 2 m = 8 < 10
  EXPECT_THROW((void)values(DeviationKind::oadev, phase, 1.0, {5}), ArgumentError);
  for (const Factors& bad : {Factors{0}, Factors{2, 2}, Factors{2, 1}})
    EXPECT_THROW((void)values(DeviationKind::oadev, phase, 1.0, bad), ArgumentError);
  for (double tau0 : {0.0, -1.0, nan, std::numeric_limits<double>::infinity()})
    EXPECT_THROW((void)values(DeviationKind::oadev, phase, tau0, {1}), ArgumentError);
  EXPECT_THROW((void)values(DeviationKind::oadev, std::span(phase).first(2), 1.0, {}),
               ArgumentError);
  const std::vector<double> infinite = {0.0, std::numeric_limits<double>::infinity(), 0.0};
  EXPECT_THROW((void)values(DeviationKind::oadev, infinite, 1.0, {1}), ArgumentError);
  EXPECT_TRUE(std::isnan(values(DeviationKind::oadev, std::vector<double>(5, nan), 1.0, {1})[0]));
}

TEST(AveragingFactors, AreHadByTheirNames) {
  EXPECT_EQ(factors_named("octave", 100), octave_factors(100));
  EXPECT_EQ(factors_named("decade", 100, DeviationKind::mdev),
            decade_factors(100, DeviationKind::mdev));
  EXPECT_EQ(factors_named("all", 30), all_factors(30));
  EXPECT_FALSE(factors_named("century", 100));
  for (const DeviationKind kind : deviation_kinds)
    EXPECT_EQ(deviation_named(name_of(kind)), kind);
  EXPECT_FALSE(deviation_named("nodev"));
}

TEST(AveragingFactors, StopWhereOneSecondDifferenceIsLeft) {
  using Factors = std::vector<std::size_t>;
  EXPECT_EQ(octave_factors(3), Factors({1}));
  EXPECT_EQ(octave_factors(8), Factors({1, 2}));
  EXPECT_EQ(octave_factors(9), Factors({1, 2, 4})); // N = 2 m + 1: one difference
  EXPECT_EQ(decade_factors(80), Factors({1, 2, 4, 10, 20}));
  EXPECT_EQ(decade_factors(81), Factors({1, 2, 4, 10, 20, 40}));
  EXPECT_EQ(all_factors(8), Factors({1, 2, 3}));
  EXPECT_THROW((void)octave_factors(2), ArgumentError);
  EXPECT_THROW((void)decade_factors(2), ArgumentError);
  EXPECT_THROW((void)all_factors(0), ArgumentError);
}

TEST(Phase, AddsUpFrequenciesWithoutAccumulatingRounding) {
  const std::vector<double> y(1000000, 0.1); // 0.1 is not a binary fraction
  const std::vector<double> phase = phase_from_frequency(y, 2.0);
  ASSERT_EQ(phase.size(), y.size() + 1);
  EXPECT_EQ(phase[0], 0.0);
  const double exact = static_cast<double>(2e6L * static_cast<long double>(0.1));
  EXPECT_NEAR(phase.back(), exact, 6e-11); // two ulp of 2e5; a plain sum is off by 2e-6
}

TEST(Phase, HoldsTheLastValueOverAGapAndSteadyRateNeedsItsMean) {
  const std::vector<double> y = {1.0, 2.0, nan, nan, 3.0, nan};
  const std::vector<double> held = phase_from_frequency(y, 10.0);
  const std::vector<double> expected = {0.0, 10.0, 30.0, nan, nan, 60.0, nan};
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_TRUE(held[i] == expected[i] || (std::isnan(held[i]) && std::isnan(expected[i]))) << i;
  std::vector<double> steady(100, 0.25);
  steady[40] = steady[41] = nan;
  EXPECT_GT(values(DeviationKind::oadev, phase_from_frequency(steady, 1.0), 1.0, {8})[0], 1e-3);
  EXPECT_EQ(values(DeviationKind::oadev, phase_from_frequency(steady, 1.0, 0.25), 1.0, {8})[0],
            0.0);
  EXPECT_THROW((void)phase_from_frequency(y, 0.0), ArgumentError);
  EXPECT_THROW((void)phase_from_frequency(y, 1.0, nan), ArgumentError);
}

} // namespace
} // namespace goingrate
