// Sizes of causes against many random series of which the truth is known.
#include "causes/account.hpp"

#include "support/white_noise.hpp"

#include <Eigen/QR>
#include <cmath>
#include <gtest/gtest.h>

namespace goingrate::timing_model {
namespace {

// Rates of blocks of a clock whose drive is noisy: white noise that shows only at the lowest
// frequencies, below that of the times.
RateBlocks drifting_blocks(std::size_t count, double white, double drift_per_day,
                           std::uint64_t seed) {
  RateBlocks blocks;
  blocks.length_s = 3600.0;
  const std::vector<double> rough = test::noise(count, seed);
  const std::vector<double> late = test::noise(count + 1, seed + 1000000);
  for (std::size_t i = 0; i < count; ++i) {
    const double day = static_cast<double>(i) * blocks.length_s / 86400.0;
    blocks.rate.push_back(drift_per_day * day + white * rough[i] + late[i + 1] - late[i]);
  }
  return blocks;
}

// The noise in which a drift stands is known from a few coefficients, which the drift follows: the
// likeliest noise is often none there.
TEST(AccountTest, ADriftLeavesTheNoiseThatItStandsIn) {
  constexpr std::size_t blocks = 96;
  constexpr double white = 0.4, drift = 0.1;
  constexpr int logs = 400;
  double z2 = 0.0;
  int within = 0;
  for (unsigned log = 0; log < logs; ++log) {
    const RateBlocks made = drifting_blocks(blocks, white, drift, 1 + log);
    const Account account(made, {.wanders = false});
    const Sizes sizes = account.sizes_of({.rate = {CourseMaker(made).power(1)}, .amplitude = {}});
    const double z = (sizes.rate[0] - drift) / sizes.rate_sigma[0];
    z2 += z * z;
    within += std::abs(z) < 1.0 ? 1 : 0;
  }
  // 1.36 and 0.64; with the likeliest noise 2.09 and 0.56.
  EXPECT_LT(std::sqrt(z2 / logs), 1.6);
  EXPECT_GT(within, static_cast<int>(0.60 * logs));
}

// Course by course the gain is that of a least-squares fit of all of them at once, also if one
// shows nothing new.
TEST(AccountTest, GainsThatGrowAreThoseOfLeastSquares) {
  constexpr std::size_t blocks = 200;
  const RateBlocks made = drifting_blocks(blocks, 0.5, 0.0, 7);
  const CourseMaker make(made);
  Account account(made, {.wanders = false});
  account.take({.rate = {make.power(1)}, .amplitude = {}});
  const FixedNoiseAccount fixed = account.in_noise_beside();
  Courses courses{.rate = {make.step(80.0)}, .amplitude = {}, .dates = 1, .times = 1};
  GrowingGains gains(fixed);
  double last = 0.0;
  for (const auto& more :
       {make.approach(80.0, 40'000.0), make.approach(80.0, 20'000.0), make.step(80.0)}) {
    const Eigen::MatrixXd x = fixed.rate.without_taken(courses.rate);
    const Eigen::VectorXd& y = fixed.rate.rest();
    const Eigen::VectorXd fitted = x * x.completeOrthogonalDecomposition().solve(y);
    const double price = fixed.price * static_cast<double>(3 + courses.rate.size());
    last = gains.gain_of(courses);
    // Rounding, in courses that are nearly alike.
    EXPECT_NEAR(last, fitted.squaredNorm() - price, 1e-8);
    EXPECT_NEAR(fixed.gain_of(courses), fitted.squaredNorm() - price, 1e-8);
    courses.rate.push_back(more);
  }
  EXPECT_NEAR(gains.gain_of(courses), last - fixed.price, 1e-8); // the first course again
}

} // namespace
} // namespace goingrate::timing_model
