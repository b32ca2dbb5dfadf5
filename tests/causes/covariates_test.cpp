#include "causes/reading_errors.hpp"
#include "goingrate/causes/covariates.hpp"
#include "goingrate/causes/diagnosis.hpp"

#include "goingrate/base/random.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <utility>

namespace goingrate {
namespace {

// Beats of 2 s with jitter, a rate noise that is white or wanders, and an answer to a daily cause.
struct Made {
  double coefficient = 0.0, lag_s = 0.0;
  double white = 1e-6, wander = 0.0; // rate rms a period, step of a random walk of rate
  bool cause_wanders = false, by_the_day = false; // without either: a daily wave and a wander
};

TimingData made(const Made& what, std::uint64_t seed) {
  RandomStream noise(seed, StreamPurpose::jitter), walk(seed, StreamPurpose::slow_drive);
  RandomStream weather(seed, StreamPurpose::temperature_noise);
  constexpr std::size_t n = 40000;
  TimingData data;
  data.reference_period_s = 2.0;
  std::vector<double> cause;
  double late = 0.0, rate = 0.0, answer = 0.0, drifting = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = 2.0 * static_cast<double>(i);
    drifting += 0.02 * weather.normal();
    const double wave = 3.0 * std::sin(2.0 * std::numbers::pi * t / 20000.0);
    cause.push_back(what.cause_wanders ? drifting : what.by_the_day ? wave : wave + 0.3 * drifting);
    data.cycle.push_back(static_cast<double>(i));
    data.elapsed_s.push_back(t);
    data.lateness_s.push_back(late);
    rate += what.wander * walk.normal();
    answer += what.lag_s > 0.0 ? (cause.back() - answer) * 2.0 / what.lag_s : cause.back() - answer;
    late -= 2.0 * (rate + what.white * noise.normal() + what.coefficient * answer);
  }
  data.terms.push_back(rate_term("temperature", "1/K", data, cause));
  return data;
}

class CovariateThatActsTwice : public testing::TestWithParam<const char*> {};

// A rod answers at once, what compensates it through a lag; air carries the bob at once, and brakes
// a swing that follows slowly.
TEST_P(CovariateThatActsTwice, ShowsWhatComesAtOnceAndTheWhole) {
  double z2_whole = 0.0, z2_rod = 0.0, mean_lag_s = 0.0;
  constexpr int logs = 20;
  constexpr double rod = -6e-6, compensation = 5.7e-6, lag_s = 4000.0;
  for (std::uint64_t seed = 1; seed <= logs; ++seed) {
    TimingData data = made({.coefficient = rod, .white = 1e-5}, seed);
    data.terms.back().name = GetParam();
    const TimingData late = made({.coefficient = compensation, .lag_s = lag_s, .white = 0.0}, seed);
    for (std::size_t i = 0; i < data.size(); ++i)
      data.lateness_s[i] += late.lateness_s[i];
    const CovariateEffect effect = covariate_effects(data).at(0);
    const EffectPart* at_once = effect.part(EffectWay::at_once);
    ASSERT_NE(at_once, nullptr) << seed;
    mean_lag_s += effect.lag_s / logs;
    z2_whole += std::pow((effect.coefficient - rod - compensation) / effect.sigma, 2) / logs;
    z2_rod += std::pow((at_once->coefficient - rod) / at_once->sigma, 2) / logs;
  }
  EXPECT_NEAR(mean_lag_s, lag_s, 0.2 * lag_s); // one scatters by a third
  EXPECT_LT(z2_whole, 2.2); // 1, and four standard deviations of a mean of 20 squares
  EXPECT_LT(z2_rod, 2.2);
  const auto plain = covariate_effects(made({.coefficient = rod, .white = 1e-5}, 3)).at(0);
  EXPECT_TRUE(plain.parts.empty());
}

INSTANTIATE_TEST_SUITE_P(CovariateTest, CovariateThatActsTwice,
                         testing::Values("temperature", "pressure", "humidity"));

// A daily wave tells the size and the lateness of an answer, and how the lag began: all that there
// is to know of a rod and what compensates it. Errors of the thermometer vary at all frequencies,
// and the clock does not answer to them: that must not pass for knowledge of the rod.
TEST(CovariateTest, ErrorsOfAThermometerTellNothing) {
  constexpr double rod = -6e-6, compensation = 5.7e-6, error_k = 0.3;
  constexpr int logs = 10;
  double z2 = 0.0;
  for (std::uint64_t seed = 1; seed <= logs; ++seed) {
    TimingData data = made({.coefficient = rod, .by_the_day = true}, seed);
    const TimingData late = made(
        {.coefficient = compensation, .lag_s = 4000.0, .white = 0.0, .by_the_day = true}, seed);
    RandomStream error(seed, StreamPurpose::amplitude_noise);
    double sum = 0.0;
    for (std::size_t i = 0; i < data.size(); ++i) {
      data.lateness_s[i] += late.lateness_s[i];
      data.terms.back().advance_s[i] += sum;
      sum += 2.0 * error_k * error.normal();
    }
    const CovariateEffect effect = covariate_effects(data).at(0);
    z2 += std::pow((effect.coefficient - rod - compensation) / effect.sigma, 2) / logs;
  }
  EXPECT_LT(z2, 2.8); // 1, and four standard deviations of a mean of ten squares; 400 otherwise
}

// A daily wave read with errors, freed of them to what few frequencies leave; and a series that no
// weather is, which the clock follows all the same: that is taken as it is.
TEST(ReadingErrorsTest, SmoothWeatherIsFoundInNoisyReadings) {
  constexpr double error_k = 0.3;
  TimingData data = made({.coefficient = -6e-6, .by_the_day = true}, 5);
  const RateTerm truth = data.terms.back();
  RandomStream error(5, StreamPurpose::amplitude_noise);
  std::vector<double> readings;
  for (const double t : data.elapsed_s)
    readings.push_back(3.0 * std::sin(2.0 * std::numbers::pi * t / 20000.0) +
                       error_k * error.normal());
  timing_model::add_readings("temperature", "1/K", readings, data);
  const RateTerm& found = data.terms.back();
  EXPECT_NEAR(found.sigma, error_k, 0.03 * error_k); // a median of 20,000 squares: three times 1 %
  double misses2 = 0.0;
  constexpr std::size_t block = 25; // beats of which the truth is known, from the advance
  for (std::size_t i = block; i < data.size(); i += block) {
    const auto mean = [&](const RateTerm& term) {
      return (term.advance_s[i] - term.advance_s[i - block]) / (2.0 * block);
    };
    misses2 += std::pow(mean(found) - mean(truth), 2);
  }
  const double blocks = static_cast<double>(data.size()) / block;
  EXPECT_LT(std::sqrt(misses2 / blocks),
            0.5 * error_k / std::sqrt(block)); // half of what means leave

  std::vector<double> rough;
  double late = 0.0;
  for (std::size_t i = 0; i < data.size(); ++i) {
    rough.push_back(error.normal());
    data.lateness_s[i] = late;
    late -= 2.0 * 1e-5 * rough.back();
  }
  timing_model::add_readings("pressure", "1/mbar", rough, data);
  EXPECT_EQ(data.terms.back().sigma, 0.0);
}

// Air that carries the bob slows the clock by 1e-8 a mbar; air that brakes it lowers the amplitude
// by 0.1 mrad, which the circular error turns into 0.1e-3 A/8 the other way, as fast as the swing
// follows: at once beside the log's blocks, or in hours.
class BarometersTwoWays : public testing::TestWithParam<double> {};

TEST_P(BarometersTwoWays, AreToldApart) {
  constexpr double direct = -1e-8, per_mbar = -1e-4, mean = 0.05;
  constexpr double circular = -per_mbar * mean / 8.0;
  const double lag_s = GetParam();
  double z2_direct = 0.0, z2_through = 0.0;
  constexpr int logs = 20;
  for (std::uint64_t seed = 1; seed <= logs; ++seed) {
    TimingData data = made({.coefficient = direct, .white = 1e-6}, seed);
    data.terms.back().name = "pressure";
    const TimingData late = made({.coefficient = circular, .lag_s = lag_s, .white = 0.0}, seed);
    RandomStream noise(seed, StreamPurpose::missed);
    for (std::size_t i = 0; i < data.size(); ++i) {
      const std::size_t k = std::max<std::size_t>(i, 1);
      const double followed = (late.lateness_s[k - 1] - late.lateness_s[k]) / 2.0 / circular;
      data.amplitude_rad.push_back(mean + per_mbar * followed + 1e-4 * noise.normal());
    }
    for (std::size_t i = 0; i < data.size(); ++i)
      data.lateness_s[i] += late.lateness_s[i];
    auto effects = covariate_effects(data);
    tell_ways(data, FitSummary{}, effects); // no fit: the escapement is not known
    const EffectPart* through = effects.at(0).part(EffectWay::circular_error);
    const EffectPart* rest = effects.at(0).part(EffectWay::other);
    ASSERT_TRUE(through != nullptr && rest != nullptr);
    EXPECT_NEAR(effects[0].amplitude, per_mbar, 5.0 * effects[0].amplitude_sigma);
    z2_direct += std::pow((rest->coefficient - direct) / rest->sigma, 2) / logs;
    z2_through +=
        std::pow((through->coefficient + per_mbar * mean / 8.0) / through->sigma, 2) / logs;
  }
  EXPECT_LT(z2_direct, 2.2); // as above
  EXPECT_LT(z2_through, 2.2);
  auto without = covariate_effects(made({.coefficient = direct}, 3));
  tell_ways(made({.coefficient = direct}, 3), FitSummary{}, without);
  EXPECT_TRUE(without.at(0).parts.empty()) << "no amplitudes";
}

INSTANTIATE_TEST_SUITE_P(CovariateTest, BarometersTwoWays, testing::Values(0.0, 4000.0, 12000.0));

TEST(CovariateTest, FindsACoefficientWithItsSigma) {
  double z2 = 0.0;
  constexpr int logs = 40;
  for (std::uint64_t seed = 1; seed <= logs; ++seed) {
    const auto effects = covariate_effects(made({.coefficient = 1e-7, .white = 1e-5}, seed));
    ASSERT_EQ(effects.size(), 1u);
    z2 += std::pow((effects[0].coefficient - 1e-7) / effects[0].sigma, 2) / logs;
  }
  EXPECT_NEAR(z2, 1.2, 0.75); // three standard deviations; weights from the data cost some tenth
}

TEST(CovariateTest, AWanderSharedByChanceIsNotTakenForAnAnswer) {
  int found = 0, ordinary = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const auto effects = covariate_effects(made({.wander = 3e-8, .cause_wanders = true}, seed));
    found += effects.at(0).significant() ? 1 : 0;
    ordinary += std::abs(effects[0].coefficient) > effects[0].sigma ? 1 : 0;
  }
  EXPECT_LE(found, 3);     // a normal deviate exceeds three in one of 370
  EXPECT_LE(ordinary, 24); // and one in 13 of 40
}

TEST(CovariateTest, ALagIsFound) {
  const auto effects =
      covariate_effects(made({.coefficient = 1e-6, .lag_s = 4000.0, .white = 1e-6}, 3));
  EXPECT_NEAR(effects.at(0).lag_s, 4000.0, 600.0); // steps of the grid are 30 %, halved
  EXPECT_TRUE(effects[0].helps());
}

TEST(CovariateTest, TheHalfNotSeenIsTheJudge) {
  const auto good = covariate_effects(made({.coefficient = 1e-6}, 5)).at(0);
  EXPECT_TRUE(good.helps());
  EXPECT_LT(good.with_s, 0.2 * good.without_s);
  EXPECT_NE(covariate_text(good).find("lowers"), std::string::npos);
  const auto none = covariate_effects(made({}, 6)).at(0);
  EXPECT_FALSE(none.helps());
  EXPECT_NE(covariate_text(none).find("not distinguishable"), std::string::npos);
}

TEST(CovariateTest, AnEffectThatDoesNotHelpLeavesTheDiagnosisItsOwn) {
  CovariateEffect effect;
  effect.name = "temperature";
  effect.coefficient = 1e-6;
  std::vector<Suspicion> suspicions(1);
  suspicions[0].cause = Cause::temperature;
  suspicions[0].numbers.size = -5e-7;
  suspicions[0].numbers.sigma = 1e-8;
  effect.sigma = 2e-6; // does not show
  name_weather({&effect, 1}, suspicions);
  EXPECT_EQ(suspicions[0].numbers.size, -5e-7);
  effect.sigma = 1e-7;
  effect.without_s = 1.0; // and with it there is no error
  name_weather({&effect, 1}, suspicions);
  EXPECT_EQ(suspicions[0].numbers.size, 1e-6);
}

TEST(CovariateTest, AStraightLineIsNoAnswer) {
  TimingData data = made({}, 9);
  data.terms = {rate_term("temperature", "1/K", data, data.elapsed_s)};
  EXPECT_TRUE(covariate_effects(data).empty()) << "it is a drift";
  EXPECT_TRUE(weather_parts(data).empty());
}

TEST(CovariateTest, PartsAreFoundTogether) {
  // Pressure follows the temperature closely; the rate answers to the temperature alone.
  TimingData data = made({.coefficient = 1e-6}, 7);
  std::vector<double> pressure;
  for (std::size_t i = 0; i < data.size(); ++i)
    pressure.push_back(6.0 * std::sin(2.0 * std::numbers::pi * data.elapsed_s[i] / 20000.0) +
                       0.5 * std::sin(2.0 * std::numbers::pi * data.elapsed_s[i] / 3000.0));
  data.terms.push_back(rate_term("pressure", "1/mbar", data, pressure));
  const auto parts = weather_parts(data);
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_NEAR(parts[0].coefficient, 1e-6, 4.0 * parts[0].sigma);
  EXPECT_LT(std::abs(parts[1].coefficient), 4.0 * parts[1].sigma);
  EXPECT_GT(std::abs(covariate_effects(data).at(1).coefficient), 10.0 * parts[1].sigma)
      << "alone it stands for the temperature";
}

TEST(CovariateTest, WhatIsNotKnownIsLeftOut) {
  double z2 = 0.0;
  constexpr int logs = 40;
  for (std::uint64_t seed = 1; seed <= logs; ++seed) {
    TimingData data = made({.coefficient = 1e-7, .white = 1e-5}, seed);
    RateTerm& term = data.terms.front();
    std::vector<double> value;
    for (std::size_t i = 0; i < data.size(); ++i)
      value.push_back(i == 0 ? std::nan("") : (term.advance_s[i] - term.advance_s[i - 1]) / 2.0);
    for (const auto& [from, to] : {std::pair{0, 3000}, {9000, 14000}, {30000, 33000}})
      std::fill(value.begin() + from, value.begin() + to, std::nan(""));
    term = rate_term("temperature", "1/K", data, value);
    const CovariateEffect effect = covariate_effects(data).at(0);
    EXPECT_NEAR(effect.known_share, 1.0 - 11000.0 / 40000.0, 0.01); // blocks
    z2 += std::pow((effect.coefficient - 1e-7) / effect.sigma, 2) / logs;
  }
  EXPECT_NEAR(z2, 1.2, 0.75); // as where all is known
}

TEST(CovariateTest, ShortLogsAndSteadyCausesHaveNone) {
  TimingData data = made({}, 1);
  data.terms = {{"drift", "1/day", data.elapsed_s},
                {"pressure", "1/mbar", std::vector<double>(data.size(), 0.0)}};
  EXPECT_TRUE(covariate_effects(data).empty());
}

} // namespace
} // namespace goingrate
