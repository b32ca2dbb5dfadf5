#include "causes/step_search.hpp"

#include "goingrate/base/random.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace goingrate::timing_model {
namespace {

constexpr std::size_t blocks_of_test = 48;

// White noise of 1, and what `at(block)` says.
template <class Course> RateBlocks noisy_blocks(std::uint64_t seed, const Course& at) {
  RandomStream noise(seed, StreamPurpose::jitter);
  RateBlocks blocks;
  blocks.length_s = 100.0;
  for (std::size_t i = 0; i < blocks_of_test; ++i)
    blocks.rate.push_back(noise.normal() + at(static_cast<double>(i)));
  return blocks;
}

double visit_of(double i, double from, double to) { return i >= from && i < to ? 8.0 : 0.0; }

// The scan against every place by a regression of its own.
TEST(StepScanTest, FindsThePlaceThatARegressionFinds) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const auto blocks = noisy_blocks(seed, [](double i) { return i < 20.0 ? 0.0 : 3.0; });
    const Account account(blocks, {.wanders = false});
    const CourseMaker make(blocks);
    std::size_t best = 0;
    double most = -1e9;
    for (std::size_t b = 2; b + 2 < blocks_of_test; ++b) {
      const double gain = account.gain_of(Courses{{make.step(static_cast<double>(b))}, {}});
      if (gain > most) {
        most = gain;
        best = b;
      }
    }
    EXPECT_EQ(StepScan(account, blocks).best_steps(1, 4).at(0), best) << seed;
  }
}

TEST(StepScanTest, FindsAVisitThatNoStepShows) {
  for (const std::uint64_t seed : {4U, 5U, 6U}) {
    const auto blocks = noisy_blocks(seed, [](double i) { return visit_of(i, 21.0, 29.0); });
    const Account account(blocks, {.wanders = false});
    const auto [from, to] = StepScan(account, blocks).best_visit();
    EXPECT_EQ(from, 21U) << seed; // a step of eight sigma is not a block off
    EXPECT_EQ(to, 29U) << seed;
    const FittedVisit visit = fitted_visit(account, blocks, from, to);
    EXPECT_GT(account.gain_of(visit.courses), convincing_gain);
    // A block's mean tells the place to 1/8 of it at one sigma.
    EXPECT_NEAR(visit.from, 21.0, 0.5) << seed;
    EXPECT_NEAR(visit.to, 29.0, 0.5) << seed;
  }
}

TEST(StepScanTest, PlacesStayApart) {
  const auto blocks = noisy_blocks(7, [](double i) { return i < 20.0 ? 0.0 : 6.0; });
  const auto found = StepScan(Account(blocks, {.wanders = false}), blocks).best_steps(3, 4);
  for (std::size_t a = 0; a < found.size(); ++a)
    for (std::size_t b = 0; b < a; ++b)
      EXPECT_GE(std::max(found[a], found[b]) - std::min(found[a], found[b]), 4U);
}

// The sizes of the noise as fitted with a step that is then taken are those of a fresh start.
TEST(RateNoiseTest, ComesBackFromAnUnexplainedStep) {
  RandomStream noise(8, StreamPurpose::jitter);
  std::vector<double> rate;
  double before = 0.0;
  for (std::size_t i = 0; i < 185; ++i) { // white times: the rate's noise grows as f^2
    const double now = noise.normal();
    rate.push_back(now - before);
    before = now;
  }
  std::vector<double> stepped = rate;
  for (std::size_t i = 110; i < rate.size(); ++i)
    stepped[i] += 40.0;
  const NoiseKinds healthy{.wanders = false, .corner = 0.04};
  RateNoise warm(1, healthy), cold(1, healthy);
  warm.fit(cosines(stepped, false));
  warm.fit(cosines(rate, false));
  cold.fit(cosines(rate, false));
  EXPECT_NEAR(warm.deviance(), cold.deviance(), 0.5); // each is good to a tenth or two
}

} // namespace
} // namespace goingrate::timing_model
