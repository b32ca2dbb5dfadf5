// Loading a log, from its text to numbered beats, as every command does it.
#include "goingrate/analysis/analyse.hpp"
#include "goingrate/analysis/load.hpp"

#include "goingrate/analysis/simulated_logs.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/base/random.hpp"
#include "goingrate/log/rates.hpp"
#include "support/faulty_text.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace goingrate {
namespace {

std::string seconds(int beats, double period_s, double start_s = 0.0, double jitter_s = 1e-4,
                    std::uint64_t seed = 1) {
  RandomStream random(seed, StreamPurpose::jitter);
  std::string text;
  for (int n = 0; n < beats; ++n)
    text += fmt::format("{:.6f}\n", start_s + n * period_s + jitter_s * random.normal());
  return text;
}

NumberedLog loaded(const std::string& text, std::optional<double> nominal_period_s = {}) {
  LoadRequest request;
  request.path = "log";
  request.reading.nominal_period_s = nominal_period_s;
  return load_text(text, request);
}

TEST(LoadTest, ALoggerThatBeginsAgainBeginsASegment) {
  const NumberedLog log = loaded(seconds(1000, 2.0001, 1.0) + seconds(700, 2.0001, 0.3, 1e-4, 2) +
                                 seconds(40, 2.0001, 1.9, 1e-4, 3));
  EXPECT_EQ(log.beats.segments, 3u);
  EXPECT_EQ(log.good.size(), 1000u);
  EXPECT_EQ(log.beats.spurious, 0);
  EXPECT_EQ(log.beats.missed, 0);
  EXPECT_EQ(log.beats.beats.back().cycle, 1739);
  ASSERT_EQ(log.beats.gaps.size(), 2u);
  EXPECT_EQ(log.beats.gaps[0].kind, GapKind::restart);
  EXPECT_FALSE(log.sensor.beat_error_s) << "the blocks are not interleaved";
}

TEST(LoadTest, DatedBlocksThatAreApartArePutInOrder) {
  const NumberedLog log = loaded(seconds(1000, 2.0, 1.36e9 + 4000.0) + seconds(1000, 2.0, 1.36e9));
  EXPECT_EQ(log.beats.segments, 1u);
  EXPECT_EQ(log.beats.beats.back().cycle, 2999);
  EXPECT_EQ(log.beats.missed, 1000);
  const NumberedLog twice = loaded(seconds(1000, 2.0, 1.36e9) + seconds(1000, 2.0, 1.36e9 + 0.4));
  EXPECT_EQ(twice.beats.segments, 2u) << "the same hours";
}

TEST(LoadTest, LinesThatComeLateOrStrayAreStillSorted) {
  std::string text = seconds(500, 2.0, 0.0, 0.0);
  text += "1000.000000\n1004.000000\n1002.000000\n37.0\n1006.000000\n1008.000000\n";
  const NumberedLog log = loaded(text);
  EXPECT_EQ(log.beats.segments, 1u);
  EXPECT_EQ(log.good.size(), 505u);
  EXPECT_EQ(log.beats.spurious, 1);
}

TEST(LoadTest, CopiesOfLinesAreLeftOut) {
  const std::string text = seconds(300, 2.0);
  std::string tail;
  for (std::size_t at = 0, line = 0; at < text.size(); ++line) {
    const std::size_t end = text.find('\n', at) + 1;
    if (line >= 250) tail += text.substr(at, end - at);
    at = end;
  }
  for (const std::string& twice : {text + tail, text + text}) {
    const NumberedLog log = loaded(twice);
    EXPECT_EQ(log.good.size(), 300u);
    EXPECT_EQ(log.beats.rivals, 0);
    EXPECT_EQ(log.log.issues.back().kind, IssueKind::repeated);
  }
}

TEST(LoadTest, AnHourThatIsSetBeginsASegmentAndNoGapIsCounted) {
  for (const double set_s : {3600.0, -3600.0}) {
    const NumberedLog log =
        loaded(seconds(2500, 2.0, 1.6e9) + seconds(2000, 2.0, 1.6e9 + 5000.0 + set_s, 1e-4, 2));
    EXPECT_EQ(log.beats.segments, 2u) << set_s;
    EXPECT_EQ(log.beats.missed, 0);
    EXPECT_EQ(log.good.size(), 2500u);
  }
}

TEST(LoadTest, ABreakLongerThanCanBeCountedSplitsTheLog) {
  // The rate walks so much that few cycles can be counted; the break is a hundred times that.
  RandomStream random(9, StreamPurpose::jitter);
  std::string text;
  double time = 0.0, rate = 0.0;
  for (int n = 0; n < 6000; ++n) {
    if (n < 3000 || n >= 4000) text += fmt::format("{:.6f}\n", time);
    rate += 3e-6 * random.normal();
    time += 2.0 * (1.0 + rate);
  }
  const NumberedLog log = loaded(text, 2.0);
  ASSERT_EQ(log.beats.gaps.size(), 1u);
  EXPECT_LT(log.beats.longest_countable_gap, 1000);
  EXPECT_FALSE(log.beats.gaps[0].bridged);
}

TEST(LoadTest, BeatsBetweenLongGapsAreBeats) {
  std::string text = seconds(400, 1.0, 0.0, 1e-4);
  for (int n = 430; n < 900; n += 37)
    text += fmt::format("{:.6f}\n", n + 1e-5);
  text += seconds(400, 1.0, 930.0, 1e-4, 2);
  const NumberedLog log = loaded(text);
  EXPECT_EQ(log.beats.spurious, 0);
  EXPECT_EQ(log.beats.segments, 1u);
  EXPECT_EQ(log.beats.beats.back().cycle, 1329);
}

TEST(LoadTest, MostBeatsMayBeLost) {
  RandomStream random(4, StreamPurpose::missed);
  std::string text;
  for (int n = 0; n < 4000; ++n)
    if (random.uniform() < 0.3) text += fmt::format("{:.6f}\n", 1.0001 * n);
  for (const std::optional<double> nominal : {std::optional(1.0), std::optional<double>()}) {
    const NumberedLog log = loaded(text, nominal);
    EXPECT_NEAR(log.beats.typical_period_s, 1.0001, 1e-4);
    EXPECT_EQ(log.beats.spurious, 0);
    EXPECT_EQ(log.beats.segments, 1u);
    const RateSummary rate = summarise_rates(log.good, log.nominal_period_s);
    EXPECT_NEAR(rate.mean_period_s, 1.0001, 1e-7);
  }
}

TEST(LoadTest, AGivenPeriodIsBelieved) {
  // Half of it between the events: both directions. Twice: every other beat is missing.
  EXPECT_EQ(loaded(seconds(1000, 1.0), 2.0).good.size(), 500u);
  const NumberedLog every_other = loaded(seconds(1000, 2.0), 1.0);
  EXPECT_EQ(every_other.beats.missed, 999);
  EXPECT_NEAR(every_other.beats.typical_period_s, 1.0, 1e-6);
  EXPECT_NE(every_other.log.assumptions.back().text.find("if a full swing takes 2 s"),
            std::string::npos)
      << every_other.log.assumptions.back().text; // perhaps half the period was given
  try {                                           // neither half nor twice: no reading at all
    (void)loaded(seconds(1000, 1.6), 2.0);
    FAIL() << "1.6 s are no whole number of 2 s";
  } catch (const ImpossibleReading& error) {
    ASSERT_GE(error.others().size(), 2u);
    ASSERT_TRUE(error.others()[0].nominal_period_s);
    EXPECT_NEAR(*error.others()[0].nominal_period_s, 1.6, 1e-3); // one interval, with its jitter
  }
}

TEST(LoadTest, PeriodsAreAddedUpButForThePausesThatTheirStampsTell) {
  std::string text = "time,period (s)\n";
  double time = 1.6e9;
  for (int run = 0; run < 20; ++run, time += 1000.37)
    for (int n = 0; n < 30; ++n, time += 2.0004)
      text += fmt::format("{:.0f},2.0004\n", std::floor(time));
  const NumberedLog log = loaded(text);
  EXPECT_GE(log.beats.segments, 18u) << "one or two pauses may end by chance on a beat";
  EXPECT_NEAR(log.beats.beats.back().time - log.beats.beats.front().time, time - 1.6e9 - 1000.37,
              20.0); // a second for each pause
}

TEST(LoadTest, DatesWithAllTheirDigitsComeBeforePeriods) {
  std::string text = "id,timestamp,period_s,temperature\n";
  for (int run = 0; run < 20; ++run)
    for (int n = 0; n < 15; ++n) {
      const double second = 3.3737 * n;
      text +=
          fmt::format("{},2022-01-18 {:02d}:{:02d}:{:09.6f}+00:00,3.3737645,26.6\n", run, run,
                      static_cast<int>(second) / 60, second - 60 * (static_cast<int>(second) / 60));
    }
  const NumberedLog log = loaded(text);
  EXPECT_EQ(log.beats.segments, 20u);
  EXPECT_EQ(log.beats.spurious, 0);
  EXPECT_NEAR(log.beats.typical_period_s, 3.3737, 1e-5);
}

TEST(LoadTest, WhatIsToldAndNotUsedIsSaid) {
  LoadRequest request;
  request.path = "log";
  request.reading.rest_angle_rad = 0.01;
  request.reading.clock_ppm = 3.0;
  const NumberedLog log = load_text(seconds(100, 2.0), request);
  std::vector<Setting> unused;
  for (const Assumption& one : log.log.assumptions)
    if (one.text.ends_with("not used")) unused.push_back(one.setting);
  EXPECT_EQ(unused, (std::vector{Setting::rest_angle, Setting::clock_ppm}));
}

TEST(LoadTest, GridDataAreNotNumbered) {
  LoadRequest request;
  request.path = "x";
  request.reading.format = LogFormat::phase;
  request.reading.tau0_s = 10.0;
  const NumberedLog log = load_text("0\n1e-6\n-2e-6\n0\n3e-6\n", request);
  EXPECT_EQ(log.good.size(), 4u);
  EXPECT_EQ(log.beats.missed, 1); // an exact zero is a gap
  EXPECT_EQ(log.beats.beats.back().cycle, 4);
  EXPECT_EQ(log.nominal_period_s, 10.0);
  const PhaseSeries series = phase_series(log);
  ASSERT_EQ(series.phase_s.size(), 5u);
  EXPECT_EQ(series.phase_s[2], -2e-6);
  EXPECT_TRUE(std::isnan(series.phase_s[3]));
  // Phases that no clock can have pass only where phases will do.
  const std::string wild = "0\n3\n-4\n2\n29\n";
  EXPECT_THROW((void)load_text(wild, request), InputError) << "time would go back";
  request.phases_will_do = true;
  request.reading.tau0_s = 1.0;
  EXPECT_EQ(phase_series(load_text(wild, request)).phase_s,
            (std::vector{0.0, 3.0, -4.0, 2.0, 29.0}));
}

TEST(LoadTest, TimesAreNoPhasesWhoeverSaysSo) {
  std::string times, steps;
  for (int i = 0; i < 200; ++i) {
    times += fmt::format("{:.4f}\n", 5.0 + 1.7 * i + 1e-4 * (i * i % 7));
    steps += fmt::format("{:.4f}\n", 1e-3 * i + 0.3 * (i * i % 7)); // large, but no time
  }
  LoadRequest request;
  request.path = "x";
  request.reading.format = LogFormat::phase;
  for (const bool phases_will_do : {false, true}) {
    request.phases_will_do = phases_will_do;
    try {
      (void)load_text(times, request);
      FAIL();
    } catch (const ImpossibleReading& error) {
      EXPECT_NE(std::string(error.what()).find("rise by 1.7"), std::string::npos) << error.what();
      EXPECT_EQ(error.others().at(0).format, LogFormat::timestamps);
    }
  }
  EXPECT_EQ(phase_series(load_text(steps, request)).phase_s.size(), 200U);
}

TEST(LoadTest, WhatCannotBeIsRefusedWithOtherReadings) {
  std::string phases, labels, counter;
  for (int n = 0; n < 300; ++n) {
    phases += fmt::format("{:.1f}\n", 100.0 + 33.3 * ((n * 7) % 11));
    labels += fmt::format("{} {:.6f}\n", 1000 + 2 * n, -0.39 * n);
    counter += fmt::format("{}\n", (1000003LL * n) % 65536);
  }
  for (const std::string& text : {phases, labels, counter}) {
    try {
      (void)loaded(text);
      FAIL() << text.substr(0, 40);
    } catch (const ImpossibleReading& error) {
      EXPECT_LE(error.others().size(), 2u);
      for (const OtherReading& other : error.others())
        EXPECT_FALSE(other.words.empty());
    }
  }
}

// Crossings once a second of a clock that is said to have another period, one way and the other.
TEST(LoadTest, WhatIsOfferedInsteadCanBeRead) {
  std::string times;
  for (int n = 0; n < 600; ++n)
    times += fmt::format("{:.5f}\n", n + (n % 2 == 0 ? 0.0 : 0.003) + 1e-5 * ((7 * n) % 11));
  for (const bool both : {false, true}) {
    LoadRequest request;
    request.path = "day";
    request.reading.nominal_period_s = both ? 4.0 : 3.0;
    request.both_edges = both;
    try {
      (void)load_text(times, request);
      FAIL();
    } catch (const ImpossibleReading& error) {
      ASSERT_FALSE(error.others().empty());
      for (const OtherReading& other : error.others()) {
        request.reading.nominal_period_s = other.nominal_period_s;
        request.both_edges |= other.both_edges;
        // Those of one direction at least.
        EXPECT_GE(load_text(times, request).good.size(), 299u) << other.words;
      }
    }
  }
}

// Each fault of loggers and users, along the whole road; the long form is
// tests/studies/numbering.txt.
class FaultyTexts : public testing::TestWithParam<std::size_t> {};

TEST_P(FaultyTexts, AreNumberedRight) {
  const test::TextFault fault = test::all_text_faults[GetParam()];
  test::NumberingJudge judge;
  for (std::uint64_t seed = 101; seed <= 112; ++seed)
    EXPECT_TRUE(test::judge_text(test::FaultyTextMaker(fault, seed).make(), judge)) << seed;
  const test::NumberingScore& score = judge.score();
  const auto all = static_cast<double>(score.good);
  EXPECT_LE(score.logs_wrong, 1); // of twelve: where 70 % are lost and the period is not known
  EXPECT_LE(static_cast<double>(score.bad), 1e-3 * all);
  EXPECT_LE(static_cast<double>(score.accepted), 2e-3 * all);
}

INSTANTIATE_TEST_SUITE_P(OfLoggers, FaultyTexts,
                         testing::Range<std::size_t>(0, test::all_text_faults.size()));

// Events handed over in memory are numbered like those of a file.
TEST(LoadTest, EventsInMemoryTravelTheSameRoad) {
  const std::string text = seconds(300, 2.0001);
  const NumberedLog read = loaded(text);
  ClockLog log = read_log(text, "log");
  log.assumptions.clear();
  const NumberedLog made = load_events(std::move(log), {});
  ASSERT_EQ(made.beats.beats.size(), read.beats.beats.size());
  for (std::size_t i = 0; i < made.good.size(); ++i) {
    EXPECT_EQ(made.good[i].time, read.good[i].time);
    EXPECT_EQ(made.good[i].cycle, read.good[i].cycle);
  }
  EXPECT_EQ(made.nominal_period_s, read.nominal_period_s);
  LoadRequest request;
  request.reading.nominal_period_s = 1.999;
  EXPECT_EQ(load_events(read_log(text, "log"), request).nominal_period_s, 1.999);
  ClockLog few;
  few.source = "few";
  few.events = {event_at({0, 0.0}), event_at({2, 0.0})};
  EXPECT_THROW((void)load_events(std::move(few), {}), InputError);
}

TEST(LoadTest, AContactOnceAMinuteCountsSwings) {
  std::string text =
      seconds(400, 59.997, 1.0, 3e-3) + seconds(400, 59.997, 1.0 + 405 * 59.997, 3e-3, 2);
  const NumberedLog log = loaded(text, 2.0);
  EXPECT_EQ(log.beats.segments, 1u);
  EXPECT_EQ(log.good.size(), 800u);
  EXPECT_EQ(log.good.back().cycle, 30 * 804);
  EXPECT_EQ(log.beats.missed, 5);
  ASSERT_EQ(log.beats.gaps.size(), 1u);
  EXPECT_EQ(log.beats.gaps[0].after_cycle, 30 * 399);
  EXPECT_EQ(log.beats.gaps[0].length, 30 * 5);
  EXPECT_NEAR(mean_rate(log).rate_excess, 3.0 / 59.997 * 1e-3, 1e-6); // 4e-3 s in 48,000 s: 1e-7
  EXPECT_THROW(loaded(text, 2.05), ImpossibleReading);                // 29.27 swings
  EXPECT_THROW(loaded(seconds(100, 500.0), 2.0), ImpossibleReading);  // 250 swings: no contact
}

// Half-hourly phases with dates: the step is that of the dates, and the events have them.
TEST(LoadTest, PhasesWithDatesKeepThem) {
  for (const bool newest_first : {false, true}) {
    std::string text = "# latitude_deg: 51.5\n# longitude_deg: -0.1\n";
    for (int i = 0; i < 100; ++i) {
      const int n = newest_first ? 99 - i : i;
      text += fmt::format("{:.6f} {:.9e}\n", 60000.5 + n / 48.0, 1e-3 + 1e-6 * n);
    }
    LoadRequest request;
    request.path = "phases";
    request.reading.columns = {"time=1:mjd", "phase=2"};
    const NumberedLog log = load_text(text, request);
    ASSERT_EQ(log.good.size(), 100u);
    EXPECT_EQ(log.nominal_period_s, 1800.0);
    EXPECT_EQ(log.log.origin, TimeOrigin::mjd);
    EXPECT_NEAR(log.good[0].time.to_double(), 60000.5 * 86400.0, 0.1); // six decimals of a day
    ASSERT_TRUE(log.log.site);
    EXPECT_EQ(log.log.site->latitude_deg, 51.5);
    const TimingData data = fit_data(log);
    EXPECT_EQ(data.terms.back().name, "tide");
    EXPECT_NEAR(mean_rate(log).rate_excess, 1e-6 / 1800.0, 1e-14); // rounding of 1e-9 in phases
  }
}

TEST(LoadTest, PhasesCountTheSwingsOfAStatedPeriod) {
  LoadRequest request;
  request.path = "phases";
  request.reading.format = LogFormat::phase;
  request.reading.tau0_s = 60.0;
  const std::string text = "0.001\n0.002\n0.0025\n0.003\n";
  EXPECT_EQ(load_text(text, request).good.back().cycle, 3);
  request.reading.nominal_period_s = 1.5;
  const NumberedLog log = load_text(text, request);
  EXPECT_EQ(log.good.back().cycle, 120);
  EXPECT_EQ(log.beats.missed, 0);
  EXPECT_NEAR(mean_rate(log).rate_excess, 0.002 / (180.0 - 0.002), 1e-13); // 1e-8 of the rate
  request.reading.nominal_period_s = 1.7;
  EXPECT_THROW(load_text(text, request), ArgumentError);
}

TEST(LoadTest, NoPendulumIsFittedToWhatIsNoSwing) {
  const NumberedLog minutes = loaded(seconds(100, 60.0, 1.0, 3e-3));
  const FitSummary fit = fit_clock(fit_data(minutes), minutes.nominal_period_s, {});
  EXPECT_EQ(fit.status, FitStatus::no_valid_model);
  EXPECT_NE(fit.termination.find("60 s apart"), std::string::npos);
  LoadRequest request;
  request.reading.format = LogFormat::phase;
  const NumberedLog phases = load_text("0.001\n0.002\n0.0025\n0.003\n", request);
  EXPECT_EQ(fit_clock(fit_data(phases), 1.0, {}).status, FitStatus::no_valid_model);
}

// A simulated torsion clock says what it is; a request has the last word.
TEST(LoadTest, ALogStatesItsShareOfGravity) {
  Scenario scenario;
  scenario.clock.gravity_share = 0.25;
  scenario.start_amplitude = 0.1; // such a clock has no stationary swing
  scenario.periods = 20;
  const std::string text = SimulatedLogs(scenario).make(std::array{std::uint64_t{5}}).front().text;
  EXPECT_EQ(load_text(text, {}).sensor.gravity_share, 0.25);
  LoadRequest request;
  request.gravity_share = 1.0;
  EXPECT_EQ(load_text(text, request).sensor.gravity_share, 1.0);
}

} // namespace
} // namespace goingrate
