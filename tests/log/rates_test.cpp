#include "goingrate/log/rates.hpp"

#include "goingrate/base/errors.hpp"
#include "support/simulated.hpp"

#include <gtest/gtest.h>

namespace goingrate {
namespace {

std::vector<Beat> beats_at(const std::vector<std::pair<std::int64_t, double>>& crossings) {
  std::vector<Beat> beats;
  for (const auto& [cycle, t] : crossings)
    beats.push_back({Instant::from_seconds(t), cycle, NAN, 0, 0, BeatFlag::good});
  return beats;
}

TEST(RatesTest, ASlowClockLoses) {
  const auto beats = beats_at({{0, 0.0}, {1, 2.002}, {2, 4.004}});
  const RateSummary summary = summarise_rates(beats, 2.0);
  EXPECT_NEAR(summary.rate_excess, 2.0 / 2.002 - 1.0, 1e-15);         // roundings of ratios near 1
  EXPECT_NEAR(summary.mean_period_s, 2.002, 1e-15);                   // two roundings of 2 s
  EXPECT_NEAR(summary.slope_rate_excess, summary.rate_excess, 1e-15); // roundings of ratios near 1
  EXPECT_EQ(summary.periods, 2);
}

TEST(RatesTest, TheRatePerPeriodIsThePapers) {
  const auto rates = rate_per_period(beats_at({{0, 0.0}, {1, 1.9996}, {2, 3.9994}}), 2.0);
  ASSERT_EQ(rates.size(), 2u);
  EXPECT_NEAR(rates[0], 2.0 / 1.9996 - 1.0, 1e-15); // roundings of ratios near 1
  EXPECT_NEAR(rates[1], 2.0 / 1.9998 - 1.0, 1e-15); // likewise
}

TEST(RatesTest, AMissingBeatSharesItsRateWithItsNeighbour) {
  const auto beats = beats_at({{0, 0.0}, {1, 2.0}, {3, 6.02}, {4, 8.02}});
  const auto rates = rate_on_every_cycle(beats, 2.0);
  ASSERT_EQ(rates.size(), 4u);
  EXPECT_EQ(rates[1], rates[2]);
  EXPECT_NEAR(rates[1], 4.0 / 4.02 - 1.0, 1e-15); // roundings of ratios near 1
  const auto error = on_every_cycle(beats, clock_error(beats, 2.0));
  ASSERT_EQ(error.size(), 5u);
  EXPECT_TRUE(std::isnan(error[2]));
  EXPECT_NEAR(error[4], -0.02, 1e-15); // a rounding of 8 s
}

TEST(RatesTest, MeanRateSigmaCovers) {
  // White noise of rate, 400 logs of 1000 periods: the truth within one sigma in about 68 %, or
  // more often (the largest of five estimates of the scatter is taken).
  int inside = 0;
  for (int k = 0; k < 400; ++k) {
    RandomStream random(static_cast<std::uint64_t>(k), StreamPurpose::jitter);
    std::vector<std::pair<std::int64_t, double>> crossings{{0, 0.0}};
    for (int i = 1; i <= 1000; ++i)
      crossings.emplace_back(i, crossings.back().second + 2.0 * (1 + 1e-4 * random.normal()));
    const RateSummary s = summarise_rates(beats_at(crossings), 2.0);
    inside += std::abs(s.rate_excess) < s.rate_excess_sigma ? 1 : 0;
  }
  EXPECT_GE(inside, 400 * 0.66);
  EXPECT_LE(inside, 400 * 0.90);
}

TEST(RatesTest, JitterTellsOnTheEndsAlone) {
  // Jitter alone, and with a noise of rate that the blocks show: 400 logs each of 1000 periods.
  for (const double white : {0.0, 1e-5}) {
    int inside = 0;
    double mean = 0.0;
    for (int k = 0; k < 400; ++k) {
      RandomStream random(static_cast<std::uint64_t>(k), StreamPurpose::jitter);
      std::vector<std::pair<std::int64_t, double>> crossings;
      double t = 0.0;
      for (int i = 0; i <= 1000; ++i) {
        crossings.emplace_back(i, t + 1e-4 * random.normal());
        t += 2.0 * (1 + white * random.normal());
      }
      const RateSummary s = summarise_rates(beats_at(crossings), 2.0);
      inside += std::abs(s.rate_excess) < s.rate_excess_sigma ? 1 : 0;
      mean += s.rate_excess_sigma / 400;
    }
    EXPECT_GE(inside, 400 * 0.62); // 0.68 less two and a half standard deviations
    EXPECT_LE(inside, 400 * 0.92);
    const double truth = std::hypot(std::sqrt(2.0) * 1e-4 / 2000.0, white / std::sqrt(1000.0));
    EXPECT_LT(mean, 2.5 * truth); // the larger of two estimates with 3 and 7 degrees of freedom
  }
}

TEST(RatesTest, TheNominalPeriodIsGuessedOnlyWhereItIsPlain) {
  ClockLog log;
  Beats beats;
  std::vector<Assumption> assumptions;
  beats.typical_period_s = 1.9993;
  EXPECT_EQ(nominal_period(log, beats, assumptions), 2.0);
  beats.typical_period_s = 1.63;
  EXPECT_EQ(nominal_period(log, beats, assumptions), 1.63);
  EXPECT_FALSE(usual_period(1.63));
  log.nominal_period_s = 1.6;
  EXPECT_EQ(nominal_period(log, beats, assumptions), 1.6);
  EXPECT_EQ(assumptions.size(), 2u) << "each guess is said, what is given is not";
}

TEST(RatesTest, AClockThatIsReadOrStrikesHasWholeHalfMinutesOrHalfHours) {
  EXPECT_EQ(usual_period(3601.0), 3600.0); // loses 24 s/day
  EXPECT_EQ(usual_period(3599.5), 3600.0);
  EXPECT_EQ(usual_period(86'410.0), 86'400.0);
  EXPECT_EQ(usual_period(60.02), 60.0);
  EXPECT_EQ(usual_period(899.4), 900.0);
  EXPECT_FALSE(usual_period(3623.0)); // 9 minutes a day
}

TEST(RatesTest, SimulatedStationaryClockRunsAtItsExactRate) {
  const auto beats = test::simulated_beats(test::at_point_a(1000), 1);
  EXPECT_NEAR(summarise_rates(beats, 2.0).rate_excess, 1.133264436573979e-04,
              1e-14); // 2000 s, 15 digits
}

TEST(RatesTest, BlocksAndSegmentsHaveTheirOwnRates) {
  std::vector<Beat> beats;
  const auto add = [&](std::int64_t cycle, double t, std::uint16_t segment, BeatFlag flag) {
    beats.push_back({Instant::from_seconds(t), cycle, 0.05, 0, segment, flag});
  };
  for (int i = 0; i <= 100; ++i) { // loses 1e-3 for 50 periods, then keeps time
    add(i, i <= 50 ? 2.002 * i : 100.1 + 2.0 * (i - 50), 0, BeatFlag::good);
    if (i == 20) add(0, 2.002 * i + 0.4, 0, BeatFlag::spurious);
  }
  for (int i = 0; i < 10; ++i)
    add(200 + i, 1000.0 + 1.998 * i, 1, BeatFlag::good);
  add(300, 2000.0, 2, BeatFlag::good); // too few for a rate
  const auto blocks = block_rates(beats, 2.0, 50.05);
  ASSERT_GE(blocks.size(), 5u);
  EXPECT_NEAR(blocks[0].rate.rate_excess, -1e-3 / 1.001, 1e-15); // a rounding of 50 s, over 50 s
  EXPECT_EQ(blocks[1].from_cycle, blocks[0].to_cycle) << "no period falls between blocks";
  EXPECT_NEAR(blocks[2].rate.rate_excess, 0.0, 5e-5); // one of its 25 periods is a slow one
  const auto segments = segment_rates(beats, 2.0);
  ASSERT_EQ(segments.size(), 2u);
  EXPECT_NEAR(segments[1].rate.rate_excess, 1e-3 / 0.999, 2e-14); // roundings of 1018 s, over 18 s
  EXPECT_EQ(segments[1].from_cycle, 200);
  EXPECT_NEAR(segments[0].amplitude_rad, 0.05, 1e-15); // a mean of a hundred
  EXPECT_THROW((void)block_rates(beats, 2.0, 0.0), ArgumentError);
}

TEST(RatesTest, TwoBeatsAreNotEnough) {
  EXPECT_THROW((void)summarise_rates(beats_at({{0, 0.0}, {1, 2.0}}), 2.0), ArgumentError);
}

} // namespace
} // namespace goingrate
