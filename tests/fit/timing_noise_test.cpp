#include "fit/timing_noise.hpp"

#include "fit/noise_guess.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/base/random.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

namespace goingrate {
namespace {

std::vector<double> made(std::span<const double> cycle, const TimingNoise& noise,
                         std::uint64_t seed) {
  RandomStream jitter(seed, StreamPurpose::jitter), walk(seed, StreamPurpose::fast_drive);
  std::vector<double> r;
  double at = 0.0;
  for (std::size_t i = 0; i < cycle.size(); ++i) {
    if (i > 0) at += noise.walk_s * std::sqrt(cycle[i] - cycle[i - 1]) * walk.normal();
    r.push_back(at + noise.jitter_s * jitter.normal());
  }
  return r;
}

std::vector<double> counted(std::size_t n) {
  std::vector<double> cycle(n);
  for (std::size_t i = 0; i < n; ++i)
    cycle[i] = static_cast<double>(i);
  return cycle;
}

TEST(NoiseTest, WhiteningEqualsTheDenseCholesky) {
  const std::vector<double> cycle{0, 1, 2, 5, 6, 10, 11};
  const TimingNoise noise{0.7, 1.3};
  const auto n = static_cast<Eigen::Index>(cycle.size());
  Eigen::MatrixXd covariance(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index k = 0; k < n; ++k)
      covariance(i, k) =
          (i == k ? 0.49 : 0.0) +
          1.69 * std::min(cycle[static_cast<std::size_t>(i)], cycle[static_cast<std::size_t>(k)]);
  Eigen::MatrixXd difference = Eigen::MatrixXd::Zero(n - 1, n);
  for (Eigen::Index i = 0; i + 1 < n; ++i)
    difference.row(i)[i] = -(difference.row(i)[i + 1] = 1.0);
  const Eigen::MatrixXd dense = difference * covariance * difference.transpose();
  const Eigen::LLT<Eigen::MatrixXd> cholesky(dense);
  const std::vector<double> residual{0.1, -0.3, 0.2, 0.5, -0.9, 0.4, 0.0};
  const Eigen::VectorXd slow =
      cholesky.matrixL().solve(difference * Eigen::Map<const Eigen::VectorXd>(residual.data(), n));
  std::vector<double> fast(residual.size() - 1);
  const Whitening whitening(cycle, noise);
  whitening.apply<double>(residual, fast);
  for (Eigen::Index i = 0; i + 1 < n; ++i)
    EXPECT_NEAR(fast[static_cast<std::size_t>(i)], slow[i], 1e-14);
  EXPECT_NEAR(whitening.log_determinant(), std::log(dense.determinant()), 1e-12);
}

TEST(NoiseTest, FindsJitterAndWalk) {
  const auto cycle = counted(4000);
  for (const auto& [j, w] : {std::pair{1e-5, 0.0}, {1e-5, 1e-6}, {1e-5, 1e-5}, {1e-7, 1e-5}}) {
    double jitter = 0.0, walk = 0.0;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const TimingNoise found = estimate_noise(cycle, made(cycle, {j, w}, seed));
      jitter += found.jitter_s / 10;
      walk += found.walk_s / 10;
    }
    if (j > 1e-6) {
      EXPECT_NEAR(jitter, j, 0.03 * j) << w; // 1.5 % for one log of equal parts
    }
    if (w == 0.0)
      EXPECT_LT(walk, 1e-8); // the criterion lets a false walk through in few logs
    else
      EXPECT_NEAR(walk, w, 0.08 * w) << w;
  }
}

TEST(NoiseTest, LocalWhiteNoiseIsBlindToDrift) {
  auto r = made(counted(5000), {1e-5, 0.0}, 4);
  for (std::size_t i = 0; i < r.size(); ++i)
    r[i] += 1e-3 * std::sin(0.01 * static_cast<double>(i));
  EXPECT_NEAR(local_white_noise(r), 1e-5, 5e-7); // 5 %: 2.5 standard errors
}

TEST(NoiseTest, WhitenessPIsUniformForWhiteNoiseAndSmallForRed) {
  int below = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    RandomStream random(seed, StreamPurpose::jitter);
    std::vector<double> x(500);
    for (double& v : x)
      v = random.normal();
    below += whiteness_p(x) < 0.1 ? 1 : 0;
  }
  EXPECT_GT(below, 8); // 20 expected, 4.2 standard deviation
  EXPECT_LT(below, 36);
  std::vector<double> red(500);
  for (std::size_t i = 0; i < red.size(); ++i)
    red[i] = std::sin(0.05 * static_cast<double>(i));
  EXPECT_LT(whiteness_p(red), 1e-6);
}

TEST(NoiseTest, CorrelationTimeIsThatOfAnAutoregression) {
  RandomStream random(1, StreamPurpose::jitter);
  std::vector<double> x(100000);
  double at = 0.0;
  for (double& v : x)
    v = at = 0.8 * at + random.normal();
  EXPECT_NEAR(correlation_time(x), (1 + 0.8) / (1 - 0.8), 1.0); // 9; a tenth for the truncation
}

TEST(NoiseTest, NoNoiseAtAllIsAnError) {
  EXPECT_THROW(Whitening(counted(3), {}), ArgumentError);
  const std::vector<double> zero(10, 0.0);
  EXPECT_EQ(estimate_noise(counted(10), zero).jitter_s, 0.0);
}

TimingData of_residuals(const std::vector<double>& residual) {
  TimingData data;
  data.reference_period_s = 2.0;
  data.cycle = counted(residual.size());
  data.lateness_s = residual;
  for (const double cycle : data.cycle)
    data.elapsed_s.push_back(2.0 * cycle);
  return data;
}

// A walk that equals the jitter only after 25 beats, and none at all.
TEST(NoiseTest, AFaintWalkIsSeenOverManyBeats) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto faint = made(counted(100'000), {1e-5, 2e-6}, seed);
    EXPECT_TRUE(timing_model::walks(of_residuals(faint), faint)) << seed;
    for (const std::size_t beats : {1000U, 10'000U, 100'000U}) {
      const auto none = made(counted(beats), {1e-5, 0.0}, seed);
      EXPECT_FALSE(timing_model::walks(of_residuals(none), none)) << beats << ", " << seed;
    }
  }
}

// A swing that settles in 300 beats, by a hundred times the jitter, is no walk; nor is a rate that
// turns slowly.
TEST(NoiseTest, WhatIsSmoothDoesNotWalk) {
  for (const std::size_t beats : {600U, 2000U, 10'000U})
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      auto settling = made(counted(beats), {1e-5, 0.0}, seed), turning = settling;
      for (std::size_t i = 0; i < beats; ++i) {
        const auto x = static_cast<double>(i);
        settling[i] += 1e-3 * std::exp(-x / 300.0);
        turning[i] += 1e-3 * std::sin(6.0 * x / static_cast<double>(beats));
      }
      EXPECT_FALSE(timing_model::walks(of_residuals(settling), settling)) << beats << ", " << seed;
      EXPECT_FALSE(timing_model::walks(of_residuals(turning), turning)) << beats << ", " << seed;
    }
}

} // namespace
} // namespace goingrate
