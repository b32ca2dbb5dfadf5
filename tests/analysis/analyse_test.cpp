#include "goingrate/analysis/analyse.hpp"

#include "goingrate/analysis/simulated_logs.hpp"
#include "goingrate/base/random.hpp"
#include "support/changed_in_a_swing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <numbers>

namespace goingrate {
namespace {

AnalysisRequest without_profiles() {
  AnalysisRequest request;
  request.traces_profiles = false;
  return request;
}

// The drive is doubled after 300 s, which no small change of the rate's course describes: the fit
// does, and so the change itself is the cause, and the only one.
TEST(AnalyseTest, AChangeThatTheFitExplainsIsTheCause) {
  LoadRequest log;
  log.path = GOINGRATE_SOURCE_DIR "/data/logs/jump.csv";
  AnalysisRequest request;
  request.fit.fixed["T0"] = 2.0;
  const Analysis analysis = analyse(load(log), request);
  EXPECT_EQ(analysis.fit.status, FitStatus::converged);
  ASSERT_EQ(analysis.suspicions.size(), 1u);
  EXPECT_EQ(analysis.suspicions.front().cause, Cause::drive_step);
  ASSERT_EQ(analysis.stretches.size(), 2u);
  const double moved =
      analysis.stretches[1].rate.rate_excess - analysis.stretches[0].rate.rate_excess;
  EXPECT_GT(moved, 5e-5); // from 1.13e-4 at point A through 3.2e-4 to 1.96e-4 at B
  ASSERT_EQ(analysis.diary.changes.size(), 1u); // with the same rates on its sides
  const Change& change = analysis.diary.changes.front();
  EXPECT_EQ(change.rate_before, analysis.stretches[0].rate.rate_excess);
  EXPECT_EQ(change.rate_before_sigma, analysis.stretches[0].rate.rate_excess_sigma);
  EXPECT_EQ(change.rate_after, analysis.stretches[1].rate.rate_excess);
  EXPECT_EQ(change.rate_after_sigma, analysis.stretches[1].rate.rate_excess_sigma);
  const FittedParameter& epsilon = analysis.fit["epsilon"];
  EXPECT_NEAR(epsilon.value, 2.5e-4, 3.5 * epsilon.sigma);
}

// A weight is taken off in the middle of a swing, of a clock that still settles after its start:
// the diary tells of the weight, and not of the settling.
TEST(AnalyseTest, ASettlingSwingIsNoChange) {
  const ClockParameters before{1.37, 1.0 / 1200.0, 4e-5, 0.02};
  ClockParameters after = before;
  after.mu *= 0.9;
  const auto times =
      test::crossings_of_a_changed_clock(before, after, 0.045, 1094.76, 2190, 8e-5, 3);
  ClockLog log;
  for (const double time : times)
    log.events.push_back(event_at(Instant::from_seconds(time)));
  const Analysis analysis = analyse(load_events(std::move(log), {}), {});
  ASSERT_EQ(analysis.diary.changes.size(), 1u);
  EXPECT_NEAR(static_cast<double>(analysis.diary.changes.front().cycle), 1095.0, 2.0);
  EXPECT_EQ(analysis.diary.changes.front().kind, ChangeKind::drive);
  const FittedParameter& T0 = analysis.fit["T0"];
  EXPECT_NEAR(T0.value, 1.37, 3.5 * T0.sigma);
}

// The nut follows the clock as it goes now: since its last change, and while the clock still
// settles after that, in the last quarter of the log.
// A steady clock that loses 13 s/day, told in steps: whole seconds of one that shows no rate in
// them, tenths, hundredths with a wheel's look, milliseconds.
TEST(AnalyseTest, ACoarseLoggerShowsNoChange) {
  for (const double step_s : {1.0, 0.1, 0.01, 1e-3}) {
    std::string text;
    for (int n = 0; n < 2500; ++n)
      text += fmt::format("{:.3f}\n", step_s * std::floor(n * 2.0003 / step_s));
    LoadRequest request;
    request.path = "coarse";
    request.reading.nominal_period_s = 2.0;
    const Analysis data = analyse(load_text(text, request));
    EXPECT_TRUE(data.diary.changes.empty()) << step_s;
    EXPECT_TRUE(data.suspicions.empty()) << step_s;
    EXPECT_EQ(data.numbered.segments, 1u) << step_s;
    EXPECT_EQ(data.numbered.missed, 0) << step_s;
    EXPECT_NEAR(data.rate.rate_excess, 2.0 / 2.0003 - 1.0, 2.0 * data.rate.rate_excess_sigma);
    // Both ends are rounded, a step at most each; a uniform error has a twelfth of its square.
    EXPECT_GE(data.rate.rate_excess_sigma, 0.9 * step_s * std::sqrt(2.0 / 12.0) / 5000.0);
  }
}

// Steady times with nothing but the rounding of a double, or of the last decimal, in them.
TEST(AnalyseTest, AnExactLogShowsNoWheelAndNoPushes) {
  for (const double period_s : {0.4, 1.99977337279554, 2.0003, 15.0}) {
    std::string text;
    for (int n = 0; n < 3001; ++n)
      text += fmt::format("{:.15f}\n", n * period_s);
    LoadRequest request;
    request.path = "exact";
    const Analysis data = analyse(load_text(text, request), without_profiles());
    EXPECT_FALSE(data.fit.impulses) << period_s;
    EXPECT_TRUE(data.suspicions.empty()) << period_s;
    EXPECT_TRUE(data.diary.changes.empty()) << period_s;
  }
}

// A clock whose times walk, seen by a logger of whole milliseconds: the pattern of the rounding
// drifts with the rate. A wheel that moves the times by a step and a half is told all the same.
TEST(AnalyseTest, ACoarseLoggerShowsNoWheel) {
  for (const double wheel_s : {0.0, 1.5e-3})
    for (const std::uint64_t seed : {31, 32, 33}) {
      RandomStream random(seed, StreamPurpose::temperature_noise);
      const double period_s = 1.7 * (1.0 - 1e-5 * static_cast<double>(seed));
      std::string text;
      double late = 0.0;
      for (int n = 0; n < 2500; ++n) {
        late += 1.4e-5 * random.normal();
        const double turn = wheel_s * std::sin(2.0 * std::numbers::pi * n / 36.0);
        text += fmt::format("{:.3f}\n", n * period_s + late + turn);
      }
      LoadRequest request;
      request.path = "coarse";
      request.reading.nominal_period_s = 1.7;
      const Analysis data = analyse(load_text(text, request), without_profiles());
      const bool is_told =
          std::any_of(data.suspicions.begin(), data.suspicions.end(),
                      [](const Suspicion& suspicion) { return suspicion.cause == Cause::wheel; });
      EXPECT_EQ(is_told, wheel_s > 0.0) << seed;
    }
}

// The log of a clock that follows the temperature of the day ends in its warmest hours: the rate to
// go by is that of the whole.
TEST(AnalyseTest, WeatherIsNotTakenForTheRateOfNow) {
  RandomStream random(51, StreamPurpose::temperature_noise);
  std::string text = "time_s,temperature_c\n";
  double time = 0.0;
  for (int n = 0; n < 6000; ++n) {
    const double warmth = -3.0 * std::sin(2.0 * std::numbers::pi * (n / 6000.0 - 0.125));
    text += fmt::format("{:.7f},{:.3f}\n", time + 1e-5 * random.normal(), 18.0 + warmth);
    time += 2.0 * (1.0 - 2e-5 + 1e-5 * warmth) + 4e-6 * random.normal();
  }
  LoadRequest request;
  request.path = "warm";
  request.reading.nominal_period_s = 2.0;
  const Analysis data = analyse(load_text(text, request), without_profiles());
  EXPECT_EQ(data.now.from_cycle, data.stretches.back().from_cycle);
}

// A clock that stopped twice: the stop that ends the analysed part is dated by its beats.
TEST(AnalyseTest, AStopIsDatedWhereTheBeatsEnd) {
  RandomStream random(52, StreamPurpose::jitter);
  std::string text;
  double time = 0.0;
  for (int n = 0; n < 9000; ++n) {
    if (n == 2000) time += 5000.7;
    if (n == 7000) time += 20000.9;
    text += fmt::format("{:.6f}\n", time + 2e-5 * random.normal());
    time += 2.0003;
  }
  LoadRequest request;
  request.path = "stops";
  request.reading.nominal_period_s = 2.0;
  const Analysis data = analyse(load_text(text, request));
  const auto stop = std::find_if(data.suspicions.begin(), data.suspicions.end(),
                                 [](const Suspicion& s) { return s.cause == Cause::stop; });
  ASSERT_NE(stop, data.suspicions.end());
  const double length_s = data.beats.back().time - data.beats.front().time;
  EXPECT_NEAR(length_s, 4999 * 2.0003, 1.0);
  // At the end of the part, or before its beginning if only that break is taken for a stop.
  EXPECT_TRUE(std::abs(stop->numbers.at_s - length_s) < 1.0 || stop->numbers.at_s < -5000.0)
      << stop->numbers.at_s;
}

// The hands are put forward by two minutes in a log of daily readings, which is too short for
// causes that show in the course of the rate.
TEST(AnalyseTest, HandsThatAreSetAreTold) {
  RandomStream random(53, StreamPurpose::jitter);
  std::string text = "Date,Error (s)\n";
  double error = 2.0;
  for (int day = 1; day <= 90; ++day) {
    error += -2.4 + 0.3 * random.normal() + (day == 61 ? 120.0 : 0.0);
    const int month = day > 59 ? 3 : day > 31 ? 2 : 1; // of 2023
    const int of_month = day - (month == 3 ? 59 : month == 2 ? 31 : 0);
    text += fmt::format("2023-{:02}-{:02} 09:00,{:+.1f}\n", month, of_month, error);
  }
  LoadRequest request;
  request.path = "daily";
  const Analysis data = analyse(load_text(text, request));
  ASSERT_EQ(data.suspicions.size(), 1u);
  EXPECT_EQ(data.suspicions.front().cause, Cause::sensor_shift);
  EXPECT_NEAR(data.suspicions.front().numbers.size, -120.0, 1.5);
}

// The drive of this clock jumps and has no noise; of the beats two in five are missing.
TEST(AnalyseTest, MissedBeatsAreNoNoiseOfTheDrive) {
  const Scenario scenario = parse_scenario(R"(
    clock = {nominal_period = 2.0, epsilon = 2.5e-4, mu = 2e-5, phi0 = 0.03}
    run = {periods = 2000}
    event = [{at_period = 150, mu = 4e-5}]
    sensor = {jitter_rms = 1e-5, missed = 0.4})",
                                           "jump");
  for (const std::uint64_t seed : {21u, 22u}) {
    const Analysis data =
        analyse(load_text(SimulatedLogs(scenario).make(std::array{seed}).front().text, {}),
                without_profiles());
    ASSERT_TRUE(data.drive.split) << seed;
    EXPECT_EQ(data.drive.split->fast.low68, 0.0) << seed;
  }
}

// Two months of daily readings to half a second; the keeper turns the nut on day 30, or does not.
TEST(AnalyseTest, TwoMonthsOfReadingsTellAChangeOfRegulation) {
  for (const double change_s : {0.0, -6.0})
    for (const std::uint64_t seed : {61, 62, 63, 64}) {
      RandomStream random(seed, StreamPurpose::jitter);
      std::string text = "Date,Error (s)\n";
      for (int day = 0; day < 60; ++day)
        text += fmt::format("2024-{:02}-{:02},{:+.2f}\n", 4 + day / 30, 1 + day % 30,
                            8.0 * day + change_s * std::max(0, day - 30) + 0.5 * random.normal());
      LoadRequest request;
      request.path = "daily";
      const Analysis data = analyse(load_text(text, request));
      ASSERT_EQ(data.diary.changes.size(), change_s == 0.0 ? 0u : 1u) << seed;
      if (change_s == 0.0) continue;
      EXPECT_NEAR(data.diary.changes.front().at_s, 30.0 * 86400.0, 1.5 * 86400.0) << seed;
      EXPECT_NEAR(data.now.rate.rate_excess * 86400.0, 2.0,
                  3.0 * data.now.rate.rate_excess_sigma * 86400.0)
          << seed;
    }
}

TEST(AnalyseTest, TheNutIsForTheRateOfTheEndOfTheLog) {
  LoadRequest log;
  log.path = GOINGRATE_SOURCE_DIR "/data/logs/jump.csv";
  AnalysisRequest request;
  request.fit.fixed["T0"] = 2.0;
  request.nut_pitch_m = 1e-3;
  const Analysis analysis = analyse(load(log), request);
  ASSERT_TRUE(analysis.nut);
  const double length_m = mathematical_length(2.0);
  const NutTurns now = turns_to_zero_rate({1e-3, length_m}, analysis.now.rate.rate_excess, 0.0);
  EXPECT_GT(analysis.now.from_cycle, analysis.stretches.back().from_cycle);
  const NutTurns mean = turns_to_zero_rate({1e-3, length_m}, analysis.rate.rate_excess, 0.0);
  EXPECT_EQ(analysis.nut->turns, now.turns);
  EXPECT_NE(analysis.nut->turns, mean.turns);
}

} // namespace
} // namespace goingrate
