#include "goingrate/spectra/lines.hpp"

#include "goingrate/base/errors.hpp"
#include "support/white_noise.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace goingrate {
namespace {

using std::numbers::pi;
using test::noise;

void add_line(std::vector<double>& x, double amplitude, double turns_a_value, double phase) {
  for (std::size_t i = 0; i < x.size(); ++i)
    x[i] += amplitude * std::sin(2.0 * pi * turns_a_value * static_cast<double>(i) + phase);
}

TEST(LinesTest, NoiseShowsALineNoOftenerThanItSays) {
  std::size_t shown = 0;
  constexpr int runs = 400;
  for (int run = 0; run < runs; ++run)
    shown += find_lines(noise(1000, static_cast<std::uint64_t>(run + 1)), 2.0,
                        {.false_alarm = 0.1, .most = 1})
                 .size();
  // 40 are allowed, 6 their scatter; 15 come, for the finer grid has not quite N chances.
  EXPECT_GT(shown, 3u);
  EXPECT_LT(shown, 52u);
}

TEST(LinesTest, FindsALineToItsBound) {
  // Rife and Boorstyn: var f = 6 sigma^2/(pi^2 A^2 N^3) a value squared, var A = 2 sigma^2/N.
  constexpr std::size_t n = 2000;
  constexpr double amplitude = 0.5, turns = 0.123456;
  const double sigma_f = std::sqrt(6.0 / (pi * pi * amplitude * amplitude * n)) / n;
  double f2 = 0.0, a2 = 0.0;
  constexpr int runs = 50;
  for (int run = 0; run < runs; ++run) {
    auto x = noise(n, static_cast<std::uint64_t>(run + 1));
    add_line(x, amplitude, turns, 1.0);
    const auto lines = find_lines(x, 2.0, {.most = 1});
    ASSERT_EQ(lines.size(), 1u);
    EXPECT_LT(lines[0].false_alarm, 1e-8);     // R is 102 on the average, 20 its scatter
    EXPECT_NEAR(lines[0].phase_rad, 1.0, 0.4); // four standard deviations, sqrt(8/(A^2 N)) = 0.13
    f2 += std::pow((lines[0].frequency_hz * 2.0 - turns) / sigma_f, 2) / runs;
    a2 += std::pow((lines[0].amplitude - amplitude) / lines[0].amplitude_sigma, 2) / runs;
  }
  EXPECT_NEAR(f2, 1.0, 0.6); // fifty squares scatter by 0.2
  EXPECT_NEAR(a2, 1.0, 0.6); // likewise
}

TEST(LinesTest, AStrongLineDoesNotPassForSeveral) {
  auto x = noise(5000, 3);
  add_line(x, 30.0, 0.0712345, 0.3);
  add_line(x, 0.4, 0.0755, 2.0); // 21 resolutions beside it, in its side lobes
  const auto lines = find_lines(x, 1.0);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_NEAR(lines[0].frequency_hz, 0.0712345, 1e-6); // a thousandth of the resolution
  EXPECT_NEAR(lines[1].frequency_hz, 0.0755, 4e-5);    // a fifth of it
  const auto rest = without_lines(x, 1.0, lines);
  EXPECT_TRUE(find_lines(rest, 1.0).empty());
}

TEST(LinesTest, ALineThatSwellsIsOneWithSidebands) {
  constexpr std::size_t n = 20000;
  auto x = noise(n, 4);
  for (std::size_t i = 0; i < n; ++i) { // half as strong again three times in the series
    const double swell = 1.0 + 0.5 * std::sin(2.0 * pi * 3.0 * static_cast<double>(i) / n);
    x[i] += 2.0 * swell * std::sin(2.0 * pi * 0.1111 * static_cast<double>(i));
  }
  add_line(x, 1.5, 0.1111 + 8.0 / n, 0.0); // another, eight resolutions away
  std::size_t by_themselves = 0, swells = 0;
  for (const SpectralLine& line : find_lines(x, 1.0)) {
    if (!line.sideband_of) {
      ++by_themselves;
      continue;
    }
    EXPECT_EQ(*line.sideband_of, 0u);
    const double apart = std::abs(line.frequency_hz - 0.1111) * n;
    EXPECT_LT(apart, 3.2); // what the sinusoids taken out leave stands closer
    swells += std::abs(apart - 3.0) < 0.2 && std::abs(line.amplitude - 0.5) < 0.05 ? 1 : 0;
  }
  EXPECT_EQ(by_themselves, 2u);
  EXPECT_EQ(swells, 2u); // a quarter of the line on either side; 0.05 is five of their sigma
}

TEST(LinesTest, ARedContinuumHasNoLines) {
  int shown = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    auto x = noise(4000, seed);
    for (std::size_t i = 1; i < x.size(); ++i)
      x[i] += 0.99 * x[i - 1];
    shown += find_lines(x, 1.0).empty() ? 0 : 1;
  }
  EXPECT_LE(shown, 5); // 0.5 expected at a hundredth; the level is uneven where the slope is
}

TEST(LinesTest, ASeriesThatDriftsHasNoLines) {
  // What its ends differ by leaks into every second frequency.
  constexpr std::size_t n = 2000;
  constexpr double interval_s = 3.0, fine_hz = 0.5 / (n * interval_s);
  auto x = noise(n, 1);
  for (std::size_t i = 0; i < n; ++i)
    x[i] += 0.05 * static_cast<double>(i);
  for (int first = 10; first < 30; ++first)
    EXPECT_TRUE(find_lines(x, interval_s, {.from_hz = first * fine_hz}).empty()) << first;
}

TEST(LinesTest, FoldingGivesTheMeanCourse) {
  auto x = noise(30000, 5);
  add_line(x, 0.5, 1.0 / 30.0, 0.0);
  const FoldedProfile profile = folded(x, 2.0, 60.0, 30);
  ASSERT_EQ(profile.mean.size(), 30u);
  double chi2 = 0.0;
  for (std::size_t b = 0; b < 30; ++b) { // each bin holds one value of a turn: its own phase
    const double expected = 0.5 * std::sin(2.0 * pi * static_cast<double>(b) / 30.0);
    chi2 += std::pow((profile.mean[b] - expected) / profile.sigma[b], 2);
  }
  EXPECT_NEAR(chi2, 30.0, 31.0); // four standard deviations, sqrt(60)
}

TEST(LinesTest, FoldingLeavesOutUnknownValues) {
  auto x = noise(3000, 6);
  const FoldedProfile whole = folded(x, 2.0, 60.0, 30);
  x.front() = x[777] = std::nan("");
  const FoldedProfile profile = folded(x, 2.0, 60.0, 30);
  for (std::size_t b = 0; b < 30; ++b) // one value of a hundred less
    EXPECT_NEAR(profile.mean[b], whole.mean[b], 0.06) << b;
}

TEST(LinesTest, TheTrainOfASecondsPendulum) {
  const std::vector<int> train{60, 8, 64, 8, 30};
  const auto periods = train_periods(train, 2.0);
  ASSERT_EQ(periods.size(), 5u);
  EXPECT_EQ(periods[0].period_s, 3600.0); // carries the minute hand
  EXPECT_EQ(periods[0].place, 1u);
  EXPECT_EQ(periods[1].period_s, 480.0);
  EXPECT_EQ(periods[2].period_s, 60.0); // 30 teeth at 2 s; as the mesh of the first pair, 480/8
  EXPECT_EQ(periods[3].period_s, 60.0);
  EXPECT_EQ(periods[4].period_s, 7.5);
  EXPECT_THROW((void)train_periods(std::vector<int>{60, 8}, 2.0), ArgumentError);
  EXPECT_THROW((void)train_periods(std::vector<int>{1}, 2.0), ArgumentError);
}

TEST(LinesTest, RefusesWhatItCannotUse) {
  EXPECT_THROW((void)find_lines(noise(63, 1), 1.0), ArgumentError);
  EXPECT_THROW((void)find_lines(noise(64, 1), 0.0), ArgumentError);
  EXPECT_THROW((void)folded(noise(100, 1), 1.0, 2.0, 2), ArgumentError);
  EXPECT_THROW((void)folded(noise(100, 1), 1.0, 10.0, 11), ArgumentError);
  EXPECT_TRUE(find_lines(std::vector<double>(100, 3.0), 1.0).empty());
}

} // namespace
} // namespace goingrate
