// Sizes of causes against many random series of which the truth is known.
#include "causes/account.hpp"

#include "support/white_noise.hpp"

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

} // namespace
} // namespace goingrate::timing_model
