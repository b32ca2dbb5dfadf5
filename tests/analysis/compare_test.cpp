#include "goingrate/analysis/compare.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/base/random.hpp"

#include <array>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <numbers>

namespace goingrate {
namespace {

// A clock of this period whose rate is white, by so much rms a second, and answers to the weather.
struct Made {
  double period_s = 2.0, white = 1e-6, per_kelvin = 0.0, starts_s = 0.0;
};

NumberedLog made(const Made& what, double length_s, std::uint64_t seed, bool has_weather = false) {
  RandomStream drive(seed, StreamPurpose::fast_drive);
  ClockLog log;
  log.source = fmt::format("clock {}", seed);
  log.nominal_period_s = what.period_s;
  double late = 0.0;
  const int beats = static_cast<int>(length_s / what.period_s);
  for (int i = 0; i < beats; ++i) {
    const double t = what.starts_s + what.period_s * i;
    const double warm = 2.0 * std::sin(2.0 * std::numbers::pi * t / 20000.0);
    log.events.push_back(
        event_at(Instant::from_seconds(t + late), Edge::up, static_cast<std::uint32_t>(i + 1)));
    if (has_weather) log.columns.temperature_c.push_back(20.0 + warm);
    late -= what.white * std::sqrt(what.period_s) * drive.normal() +
            what.per_kelvin * warm * what.period_s;
  }
  return load_events(std::move(log), {});
}

TEST(CompareTest, RatesStandOnOneAxis) {
  std::vector<NumberedLog> logs;
  logs.push_back(made({.period_s = 2.0, .starts_s = 0.3}, 40000.0, 1));
  logs.push_back(made({.period_s = 1.5, .starts_s = 5000.0}, 40000.0, 2));
  const Comparison result = compare(logs);
  EXPECT_NEAR(result.start.to_double(), 5000.0, 1e-9);
  EXPECT_EQ(result.step_s, 2.0);
  ASSERT_EQ(result.clocks.size(), 2u);
  EXPECT_EQ(result.clocks[0].error_s.size(), result.clocks[1].error_s.size());
  EXPECT_NEAR(static_cast<double>(result.clocks[0].error_s.size()), 35000.0 / 2.0, 3.0);
  EXPECT_TRUE(result.hat.empty()) << "two clocks cannot be told apart";
  // White rate of 1e-6 per second: the deviation at 256 s is 1e-6/16, that of the difference root
  // two times as large; a quarter is three sigma of 130 averages, and interpolation costs little.
  for (const DeviationRow& row : result.pairs.at(0).deviation.rows) {
    if (row.tau_s != 256.0) continue;
    EXPECT_NEAR(row.value, std::numbers::sqrt2 * 1e-6 / 16.0, 2.5e-8);
  }
}

TEST(CompareTest, TheHatTellsEachClock) {
  std::vector<NumberedLog> logs;
  const std::array<double, 4> white{1e-6, 3e-7, 2e-6, 5e-8};
  for (std::size_t i = 0; i < white.size(); ++i)
    logs.push_back(made({.white = white[i]}, 80000.0, i + 1));
  const Comparison result = compare(logs);
  for (const HatRow& row : result.hat) {
    if (row.tau_s != 64.0) continue;
    for (std::size_t i = 0; i < white.size(); ++i) {
      const double truth = white[i] * white[i] / row.tau_s;
      EXPECT_LT(std::abs(row.clocks[i].variance - truth), 3.5 * row.clocks[i].sigma) << i;
    }
    EXPECT_TRUE(row.clocks[0].is_resolved());
    EXPECT_FALSE(row.clocks[3].is_resolved()) << "forty times below the roughest";
    EXPECT_GT(row.clocks[3].upper_limit, white[3] / 8.0);
  }
}

TEST(CompareTest, TheHatCoversAsOftenAsItSays) {
  // Differences of chi-square scatter, of clocks alike and unlike; the steadiest is often negative.
  constexpr int edf = 40, draws = 2000;
  const std::array<double, 3> truth{1.0, 4.0, 0.05};
  std::array<int, 3> within{}, below{};
  int negative = 0;
  RandomStream noise(3, StreamPurpose::jitter);
  for (int draw = 0; draw < draws; ++draw) {
    std::array<double, 3> s{}; // of 0-1, 0-2, 1-2
    for (int k = 0; k < edf; ++k) {
      std::array<double, 3> y{};
      for (std::size_t i = 0; i < 3; ++i)
        y[i] = std::sqrt(truth[i]) * noise.normal();
      s[0] += std::pow(y[0] - y[1], 2) / edf;
      s[1] += std::pow(y[0] - y[2], 2) / edf;
      s[2] += std::pow(y[1] - y[2], 2) / edf;
    }
    const auto found = hat_estimates(s, edf, 3);
    for (std::size_t i = 0; i < 3; ++i) {
      within[i] += std::abs(found[i].variance - truth[i]) < 1.959964 * found[i].sigma ? 1 : 0;
      below[i] += truth[i] < std::pow(found[i].upper_limit, 2) ? 1 : 0;
    }
    negative += found[2].variance < 0.0 ? 1 : 0;
  }
  EXPECT_GT(negative, draws / 4);
  for (std::size_t i = 0; i < 3; ++i) {
    // Two sided 95 %, and one sided: chi-square of 40 leans, which costs up to 4 %.
    EXPECT_GT(within[i], static_cast<int>(0.90 * draws)) << i;
    EXPECT_GT(below[i], static_cast<int>(0.90 * draws)) << i;
  }
}

TEST(CompareTest, WhatTheWeatherDoesToAllIsTakenOff) {
  std::vector<NumberedLog> logs;
  for (const auto& [k, per_kelvin] : {std::pair{1, -6e-6}, std::pair{2, -4e-6}, std::pair{3, 2e-6}})
    logs.push_back(made({.white = 1e-6, .per_kelvin = per_kelvin}, 80000.0,
                        static_cast<std::uint64_t>(k), true));
  const Comparison result = compare(logs);
  EXPECT_GT(result.pairs[0].correlation, 0.9);
  EXPECT_LT(result.pairs[1].correlation, -0.9);
  ASSERT_EQ(result.clocks[0].weather.size(), 1u);
  EXPECT_NEAR(result.clocks[0].weather[0].coefficient, -6e-6,
              4.0 * result.clocks[0].weather[0].sigma);
  const auto at = [](const std::vector<HatRow>& rows, double tau_s) {
    for (const HatRow& row : rows)
      if (row.tau_s == tau_s) return row.clocks[0];
    return HatEstimate{};
  };
  const double white = 1e-12 / 4096.0;
  EXPECT_GT(at(result.hat, 4096.0).variance, 100.0 * white);
  EXPECT_LT(at(result.own_hat, 4096.0).variance, 5.0 * white); // some ten averages
}

TEST(CompareTest, GapsAreLeftOut) {
  const auto with_gap = [](std::uint64_t seed) {
    RandomStream jitter(seed, StreamPurpose::jitter);
    ClockLog log;
    log.source = "gap";
    log.nominal_period_s = 2.0;
    for (int i = 0; i < 10000; ++i)
      if (seed != 1 || i < 3000 || i >= 6000)
        log.events.push_back(event_at(Instant::from_seconds(2.0 * i + 1e-4 * jitter.normal())));
    return load_events(std::move(log), {});
  };
  std::vector<NumberedLog> logs;
  logs.push_back(with_gap(1));
  logs.push_back(with_gap(2));
  const Comparison result = compare(logs);
  const double expected = std::sqrt(3.0) * 1e-4 / 2.0; // of white jitter, at 2 s
  EXPECT_NEAR(result.clocks[0].deviation.rows[0].value, expected, 0.05 * expected);
  EXPECT_NEAR(result.pairs[0].deviation.rows[0].value, std::sqrt(2.0) * expected, 0.07 * expected);
}

TEST(CompareTest, WhatCannotBeComparedIsRefused) {
  std::vector<NumberedLog> logs;
  logs.push_back(made({}, 4000.0, 1));
  EXPECT_THROW((void)compare(logs), ArgumentError);
  logs.push_back(made({.starts_s = 3990.0}, 4000.0, 2));
  EXPECT_THROW((void)compare(logs), InputError) << "five common periods";
  logs.pop_back();
  NumberedLog dated = made({}, 4000.0, 2);
  dated.log.origin = TimeOrigin::epoch;
  logs.push_back(std::move(dated));
  EXPECT_THROW((void)compare(logs), InputError);
}

} // namespace
} // namespace goingrate
