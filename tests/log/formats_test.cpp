// Every layout of log found in practice, each written from the same crossings.
#include "goingrate/base/errors.hpp"
#include "goingrate/log/reading.hpp"
#include "log/calendar.hpp"
#include "log/unwrapper.hpp"

#include "log/assumed.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <numbers>
#include <zlib.h>

namespace goingrate {
namespace {

using test::says;

// Crossings every 2.0001 s on a grid of 0.1 us, from 2013-02-22 23:38:00.2279906 UTC on.
std::int64_t crossing_in_tenths_of_us(int i) {
  return 13615762802279906LL + 20001000LL * i + (i * 37) % 11;
}

std::vector<std::int64_t> true_crossings(int count = 60) {
  std::vector<std::int64_t> ticks;
  for (int i = 0; i < count; ++i)
    ticks.push_back(crossing_in_tenths_of_us(i));
  return ticks;
}

std::string seconds_text(std::int64_t ticks, char point = '.') {
  return fmt::format("{}{}{:07d}", ticks / 10000000, point, ticks % 10000000);
}

// The log's times against the truth: equal steps, to the last digit.
void expect_same_steps(const ClockLog& log, const std::vector<std::int64_t>& ticks,
                       double within_s = 1e-15) {
  ASSERT_EQ(log.events.size(), ticks.size());
  for (std::size_t i = 1; i < ticks.size(); ++i)
    ASSERT_NEAR(log.events[i].time - log.events[0].time,
                1e-7 * static_cast<double>(ticks[i] - ticks[0]),
                within_s + 3e-14) // two roundings of a double of two minutes
        << "event " << i;
}

struct Wild {
  const char* name;
  std::string (*line)(std::int64_t tick, int i);
  std::string header;
  LogFormat format;
  const char* said;
  double within_s = 1e-15;
  ReadingOptions options{};
};

std::string calendar(std::int64_t ticks, const char* pattern) {
  const std::int64_t of_day = ticks / 10000000 - 1361577600 + 86400; // since 2013-02-22 0:00
  const std::int64_t day = 22 + of_day / 86400, s = of_day % 86400;
  return fmt::format(fmt::runtime(pattern), day, s / 3600, s / 60 % 60, s % 60, ticks % 10000000);
}

std::vector<Wild> wild_formats() {
  using F = LogFormat;
  std::vector<Wild> list;
  const auto add = [&](Wild wild) { list.push_back(std::move(wild)); };
  add({"UnixSeconds", [](std::int64_t t, int) { return seconds_text(t); }, "", F::timestamps,
       "one time per line"});
  add({"DateAndTime",
       [](std::int64_t t, int) { return calendar(t, "2013-02-{:02} {:02}:{:02}:{:02}.{:07}"); }, "",
       F::timestamps, "one time per line"});
  add({"DateAndTimeIso",
       [](std::int64_t t, int) { return calendar(t, "2013-02-{:02}T{:02}:{:02}:{:02}.{:07}Z"); },
       "", F::timestamps, "one time per line"});
  add({"DateAndTimeZone",
       [](std::int64_t t, int) {
         return calendar(t, "2013-02-{:02} {:02}:{:02}:{:02}.{:07}+00:00");
       },
       "", F::timestamps, "one time per line"});
  add({"DateUnderscores",
       [](std::int64_t t, int) { return calendar(t, "2013_02_{:02}_{:02}-{:02}-{:02}.{:07}"); }, "",
       F::timestamps, "one time per line"});
  add({"TimeOfDayOverMidnight",
       [](std::int64_t t, int) {
         const auto text = calendar(t + 12600000000LL, "{:02}/{:02}:{:02}:{:02}.{:07}");
         return text.substr(3);
       },
       "", F::timestamps, "begin again 1 time"});
  add({"SecondsOfDayOverMidnight",
       [](std::int64_t t, int) { return seconds_text((t + 12600000000LL) % 864000000000LL); }, "",
       F::timestamps, "begin again 1 time, every 86400 s"});
  add({"Periods",
       [](std::int64_t, int i) {
         return seconds_text(
             crossing_in_tenths_of_us(i) -
             (i > 0 ? crossing_in_tenths_of_us(i - 1) : crossing_in_tenths_of_us(0) - 20001000));
       },
       "", F::periods, "one period per line"});
  add({"ClockError",
       [](std::int64_t t, int i) {
         const std::int64_t label = 1361576280 + 2 * i;
         return fmt::format("{} {:.7f} {:.6f}", label,
                            1e-7 * static_cast<double>(label * 10000000 - t), 46.4);
       },
       "", F::clock_error, "clock-error", 1e-9});
  add({"Ticc",
       [](std::int64_t t, int) { return seconds_text(t - 13615690000000000LL) + "0000 chA"; },
       "# timestamp (seconds with 11 decimal places)\n", F::ticc, "TICC timestamps"});
  add({"TiccRollsOverAt100",
       [](std::int64_t t, int) { return seconds_text(t % 1000000000LL) + " chA"; }, "# TICC\n",
       F::ticc, "every 100 s"});
  add({"StableThirtyTwoPhase",
       [](std::int64_t t, int i) {
         return fmt::format("{:.15e}",
                            -1e-7 * static_cast<double>(t - 13615762802279906LL - 20000000LL * i));
       },
       "# Stable32\n",
       F::phase,
       "phase data",
       1e-9,
       {.tau0_s = 2.0}});
  add({"CsvWithNamedColumns",
       [](std::int64_t t, int i) {
         return fmt::format("{},{},3.3737645,9.7653027,26.64,18.97,CO", i,
                            calendar(t, "2013-02-{:02} {:02}:{:02}:{:02}.{:07}+00:00"));
       },
       "id,timestamp,a,b,temperature,humidity,state\n", F::table, "columns with names"});
  add({"CsvWithoutHeader",
       [](std::int64_t t, int i) {
         return fmt::format("{},{},3.3737645,9.7653027,26.64,18.97,CO", i,
                            calendar(t, "2013-02-{:02} {:02}:{:02}:{:02}.{:07}+00:00"));
       },
       "", F::table, "6 other columns are not read"});
  add({"PhyphoxStopwatch",
       [](std::int64_t t, int) { return fmt::format("{},{}", seconds_text(t), "2.0"); },
       "\"Event time (s)\",\"Interval (s)\"\n", F::table, "times are read"});
  add({"DecimalComma", [](std::int64_t t, int) { return seconds_text(t, ','); }, "", F::timestamps,
       "comma is the decimal point"});
  add({"MicrosecondsThatWrap",
       [](std::int64_t t, int) { return fmt::format("{}", t / 10 % 4294967296LL); }, "",
       F::timestamps, "times are in us", 2e-6});
  add({"SixteenBitCounter",
       [](std::int64_t t, int) { return fmt::format("{}", t / 10 % 65536); },
       "",
       F::timestamps,
       "every 0.065536 s",
       2e-6,
       {.nominal_period_s = 2.0, .unit = in_microseconds, .wrap_s = 0.065536}});
  add({"ArduinoHalfPeriods",
       [](std::int64_t, int i) {
         // the half-periods sum to the crossings of both directions; every second one is a line
         // here
         const auto step = crossing_in_tenths_of_us(i) - crossing_in_tenths_of_us(i - 1);
         return fmt::format("{},{:.1f},{},{},{}", 1361576280 + 2 * i,
                            0.1 * static_cast<double>(step), 15234, 21.5, 1013.2);
       },
       "timestamp,half-period us,pulse width us,temperature C,pressure mbar\n", F::table,
       "periods are added up"});
  add({"SemicolonTable",
       [](std::int64_t t, int) { return fmt::format("{};1,2345E0;NaN", seconds_text(t, ',')); },
       "\"Time (s)\";\"Amplitude (mrad)\";\"Temperature (C)\"\n", F::table,
       "comma is the decimal"});
  add({"GermanDatesAndTimes",
       [](std::int64_t t, int) { return calendar(t, "{:02}.02.2013;{:02}:{:02}:{:02},{:07}"); },
       "Datum;Uhrzeit\n", F::table, "comma is the decimal"});
  add({"HalfDays",
       [](std::int64_t t, int) {
         const std::string day = calendar(t, "2013-02-{:02} {:02}:{:02}:{:02}.{:07}");
         const int hour = std::stoi(day.substr(11, 2));
         return fmt::format("{}{:02}{} {}", day.substr(0, 11), (hour + 11) % 12 + 1, day.substr(13),
                            hour < 12 ? "AM" : "PM");
       },
       "", F::timestamps, "one time per line"});
  add({"GermanTimestamps",
       [](std::int64_t t, int i) {
         return fmt::format("{}\t{}", calendar(t, "{:02}.02.2013 {:02}:{:02}:{:02},{:07}"), i);
       },
       "Zeit\tNr\n", F::table, "comma is the decimal"});
  add({"VernierBlock",
       [](std::int64_t t, int) {
         return fmt::format("{}\t46.4", seconds_text(t - 13615762800000000LL));
       },
       "Vernier Format 3\nUntitled\nRun 1\nTime\tAmplitude\nt\tA\ns\tmrad\n\n", F::table,
       "columns with names"});
  add({"NewestFirst", nullptr, "", F::timestamps, "newest line is first"});
  add({"LatinComments", [](std::int64_t t, int) { return seconds_text(t); },
       "% d\xe9"
       "but de l'exp\xe9rience, 20 \xb0"
       "C\n",
       F::timestamps, "one time per line"});
  add({"ExplicitPlus",
       [](std::int64_t t, int i) {
         return fmt::format(
             "{}{:.12E}", t >= 13615762802279906LL + 20000000LL * i ? "-" : "+",
             std::abs(1e-7 * static_cast<double>(t - 13615762802279906LL - 20000000LL * i)));
       },
       "",
       F::phase,
       "phase data",
       1e-9,
       {.tau0_s = 2.0}});
  add({"WrongUnitInTheHeader",
       [](std::int64_t t, int) { return fmt::format("{},5", t / 10 - 1361576280000000LL); },
       "Time (s),n\n", F::table, "the header's unit (s) would make a beat of 2000000 s", 2e-6});
  return list;
}

void PrintTo(const Wild& wild, std::ostream* out) { *out << wild.name; }

class Formats : public testing::TestWithParam<Wild> {};

TEST_P(Formats, ReadsInTheWild) {
  const Wild& wild = GetParam();
  auto ticks = true_crossings();
  std::string text = wild.header;
  for (std::size_t i = 0; i < ticks.size(); ++i)
    text += (wild.line ? wild.line(ticks[i], static_cast<int>(i))
                       : seconds_text(ticks[ticks.size() - 1 - i])) +
            "\n";
  const ClockLog log = read_log(text, "wild.log", wild.options);
  EXPECT_EQ(log.format, wild.format);
  EXPECT_TRUE(says(log, wild.said)) << log.assumptions.front().text;
  EXPECT_TRUE(log.issues.empty()) << log.issues.front().found << log.issues.front().action;
  expect_same_steps(log, ticks, wild.within_s);
}

INSTANTIATE_TEST_SUITE_P(Logs, Formats, testing::ValuesIn(wild_formats()),
                         [](const auto& entry) { return std::string(entry.param.name); });

TEST(FormatsTest, MjdIsReadToItsLastDigit) {
  std::string text;
  for (int i = 0; i < 30; ++i) // 2 s are 0.0000231481 days
    text += fmt::format("56345.{:010d}\n", 9847248610LL + 231481LL * i);
  const ClockLog log = read_log(text, "x");
  EXPECT_TRUE(says(log, "days, as MJD"));
  // Read without loss: a rounding of 58 s.
  EXPECT_NEAR(log.events[29].time - log.events[0].time, 86400e-10 * 231481.0 * 29, 1e-13);
}

TEST(FormatsTest, IntervalsOfATiccAreTheClocksError) {
  std::string text;
  for (int i = 0; i < 30; ++i)
    text += fmt::format("{:.12f} TI(A->B)\n", 0.3 + 1.2e-8 * i);
  const ClockLog log = read_log(text, "x");
  EXPECT_EQ(log.format, LogFormat::ticc_interval);
  // A rounding of 29 s.
  EXPECT_NEAR(log.events[29].time - log.events[0].time, 29.0 - 29 * 1.2e-8, 1e-14);
}

TEST(FormatsTest, AnInteriorZeroOfPhaseIsAGapAndTheFirstIsNot) {
  const ClockLog log = read_log("0\n1e-6\n-2e-6\n0\n3e-6\n2e-6\n-1e-6\n", "x");
  EXPECT_EQ(log.format, LogFormat::phase);
  EXPECT_EQ(log.events.size(), 6u);
  ASSERT_EQ(log.issues.size(), 1u);
  EXPECT_EQ(log.issues[0].line, 4u);
  EXPECT_EQ(log.issues[0].kind, IssueKind::gap);
}

TEST(FormatsTest, FrequencyDataAddUpToTimes) {
  ReadingOptions options;
  options.format = LogFormat::frequency;
  options.tau0_s = 10.0;
  const ClockLog log = read_log("1e-3\n2e-3\n-1e-3\n0\n", "x", options);
  ASSERT_EQ(log.events.size(), 5u); // the first is where the first interval begins
  EXPECT_NEAR(log.events[1].time.to_double(), 9.99, 1e-14);        // a rounding of 10 s
  EXPECT_NEAR(log.events[4].time.to_double(), 40.0 - 0.02, 1e-14); // a rounding of 40 s
}

TEST(FormatsTest, SigmaThetaColumnsGoByTheNameOfTheFile) {
  std::string text = "% SigmaTheta \xe9\n";
  for (int i = 0; i < 20; ++i)
    text += fmt::format("{} {:.16e}\n", i, i % 2 ? 1e-9 : -1e-9);
  EXPECT_EQ(read_log(text, "a.ykt").format, LogFormat::frequency);
  EXPECT_EQ(read_log(text, "a.xtt").format, LogFormat::phase);
}

std::string phases_of_dates(const std::string& header, double days, double unit_s) {
  std::string text = header + "\n";
  const char separator = header.find(',') == std::string::npos ? ' ' : ',';
  for (int i = 0; i < 40; ++i)
    text += fmt::format("{:.8f}{}{:.6f}\n", 56000.0 + days * i, separator,
                        (1e-6 * i + 1e-7 * (i * 37 % 11)) / unit_s);
  return text;
}

TEST(FormatsTest, PhasesBesideTheirDatesAreKnownByTheirNames) {
  for (const double days : {1.0 / 48.0, 1.0}) {
    const std::string seconds = phases_of_dates("mjd,phase_s", days, 1.0);
    ReadingOptions by_hand;
    by_hand.columns = {"time=1:mjd", "phase=2"};
    const ClockLog expected = read_log(seconds, "x", by_hand);
    for (const auto& [header, unit_s] : {std::pair("mjd,phase_s", 1.0),
                                         {"MJD,Phase (s)", 1.0},
                                         {"# MJD, phase", 1.0},
                                         {"MJD phase", 1.0},
                                         {"MJD (UTC),phase_ns", 1e-9},
                                         {"mjd_utc,phase_ns", 1e-9},
                                         {"MJD phase (us)", 1e-6}}) {
      const ClockLog log = read_log(phases_of_dates(header, days, unit_s), "x");
      EXPECT_EQ(log.format, LogFormat::phase) << header;
      EXPECT_EQ(log.origin, expected.origin) << header;
      // The rounding of a header's digits to a double.
      EXPECT_NEAR(log.nominal_period_s.value_or(0.0), 86400.0 * days, 1e-9) << header;
      ASSERT_EQ(log.events.size(), 40u) << header;
      for (std::size_t i = 0; i < 40; ++i) // rounded to six decimals of the unit
        EXPECT_NEAR(log.events[i].time - expected.events[i].time, 0.0, 1e-6) << header << " " << i;
    }
  }
}

// 56000 is 2012-03-14.
TEST(FormatsTest, DatesBesidePhasesMayBeCalendarOrSeconds) {
  const ClockLog expected = read_log(phases_of_dates("mjd,phase_s", 1.0 / 48.0, 1.0), "x");
  const auto rewritten = [](const std::string& header, const auto& date) {
    std::string text = header + "\n";
    for (int i = 0; i < 40; ++i)
      text += fmt::format("{},{:.6f}\n", date(i), 1e-6 * i + 1e-7 * (i * 37 % 11));
    return text;
  };
  const auto calendar = [](int i) {
    return fmt::format("2012-03-{:02}T{:02}:{:02}:00", 14 + i / 48, i / 2 % 24, i % 2 * 30);
  };
  const auto unix_s = [](int i) { return std::to_string(1331683200 + 1800 * i); };
  ReadingOptions by_hand;
  by_hand.columns = {"time=1", "phase=2"};
  for (const ClockLog& log : {read_log(rewritten("time,phase_s", calendar), "x"),
                              read_log(rewritten("when,offset", calendar), "x", by_hand),
                              read_log(rewritten("unix_s,phase_s", unix_s), "x")}) {
    EXPECT_EQ(log.format, LogFormat::phase);
    EXPECT_EQ(log.nominal_period_s, 1800.0);
    ASSERT_EQ(log.events.size(), 40u);
    EXPECT_EQ(log.events[39].time - log.events[0].time,
              expected.events[39].time - expected.events[0].time);
    Instant first = log.events[0].time;
    first.seconds -= seconds_before_1970(log.origin);
    EXPECT_EQ(first.seconds, 1331683200);
  }
}

// The nominal period is that of the pendulum, which may swing many times from one phase to the next.
TEST(FormatsTest, ANominalPeriodDoesNotMoveDatedPhases) {
  ReadingOptions options;
  options.nominal_period_s = 2.0;
  const std::string text = phases_of_dates("mjd,phase_s", 1.0 / 48.0, 1.0);
  const ClockLog plain = read_log(text, "x"), told = read_log(text, "x", options);
  ASSERT_EQ(told.events.size(), plain.events.size());
  EXPECT_EQ(told.events.back().time - told.events.front().time,
            plain.events.back().time - plain.events.front().time);
}

TEST(FormatsTest, DaysAloneAreNoTimes) {
  std::string text = "date,phase_s\n";
  for (int i = 1; i <= 28; ++i)
    text += fmt::format("2012-02-{:02},{:.6f}\n", i, 1e-6 * i);
  EXPECT_THROW((void)read_log(text, "x"), InputError);
}

TEST(FormatsTest, AUnitAfterANameMakesATimeOfATimeAlone) {
  std::string text = "t_ms,x_s\n";
  for (int i = 0; i < 40; ++i)
    text += fmt::format("{},{:.7f}\n", 2000 * i + i * 37 % 11, 1e-6 * i);
  EXPECT_EQ(read_log(text, "x").format, LogFormat::table);
}

TEST(FormatsTest, APhaseThatIsNoTimeIsNotRead) {
  for (const char* header : {"mjd,phase_deg", "mjd,phase (cycles)", "mjd,moon phase", "time,phase"})
    EXPECT_EQ(read_log(phases_of_dates(header, 1.0 / 48.0, 1.0), "x").format, LogFormat::table)
        << header;
  ReadingOptions options;
  options.format = LogFormat::table;
  EXPECT_EQ(read_log(phases_of_dates("mjd,phase_s", 1.0 / 48.0, 1.0), "x", options).format,
            LogFormat::table);
}

TEST(FormatsTest, ColumnsAreSetByHand) {
  std::string text;
  for (int i = 0; i < 20; ++i)
    text += fmt::format("{} {} {}\n", 20 - i, 46.0, 2.5 * i);
  ReadingOptions options;
  options.columns = {"time=3", "amplitude=2:mrad"};
  const ClockLog log = read_log(text, "x", options);
  EXPECT_NEAR(log.events[19].time - log.events[0].time, 47.5, 1e-14); // a rounding of 48 s
  EXPECT_NEAR(log.events[0].amplitude_rad, 0.046, 1e-17);             // a rounding of 0.046
  for (const char* wrong : {"time", "time=4", "tide=1", "time=0", "amplitude=2:m", "time=names"}) {
    options.columns = {wrong};
    EXPECT_THROW((void)read_log(text, "x", options), ArgumentError) << wrong;
  }
}

TEST(FormatsTest, NewestFirstAndWrapsGoTogether) {
  std::string ticc, day;
  for (int i = 99; i >= 0; --i) {
    ticc += seconds_text((20002000LL * i + 35000000) % 100000000) + " chA\n";
    day += seconds_text((20002000LL * i + 863000000000LL) % 864000000000LL) + "\n";
  }
  for (const std::string& text : {ticc, day}) {
    const ClockLog log = read_log(text, "x");
    ASSERT_EQ(log.events.size(), 100u);
    EXPECT_TRUE(says(log, "newest line is first"));
    // Four roundings of 198 s.
    EXPECT_NEAR(log.events[99].time - log.events[0].time, 99 * 2.0002, 1e-13);
  }
}

TEST(FormatsTest, MidnightMayHideInAGap) {
  std::string text;
  for (int i = 0; i < 200; ++i) // an hour is missing after the hundredth
    text += seconds_text((20002000LL * i + 847000000000LL + (i >= 100 ? 36000000000LL : 0)) %
                         864000000000LL) +
            "\n";
  const ClockLog log = read_log(text, "x");
  // Two roundings of 4000 s.
  EXPECT_NEAR(log.events[199].time - log.events[0].time, 199 * 2.0002 + 3600.0, 1e-12);
}

TEST(FormatsTest, ACounterThatWrapsWithinABeatMayMissSome) {
  std::string text;
  for (int i = 0; i < 100; ++i)
    if (i != 20 && i != 21 && i != 55) text += fmt::format("{}\n", 2000200LL * i % 65536);
  ReadingOptions options;
  options.unit = in_microseconds;
  options.wrap_s = 65536e-6;
  options.nominal_period_s = 2.0;
  const ClockLog log = read_log(text, "x", options);
  // Four roundings of 198 s.
  EXPECT_NEAR(log.events.back().time - log.events[0].time, 99 * 2.0002, 1e-13);
}

TEST(FormatsTest, PeriodsOfAMainsCycleArePeriods) {
  EXPECT_EQ(read_log("0.0166664\n0.0166665\n0.0166663\n0.0166664\n", "x").format,
            LogFormat::periods);
}

TEST(FormatsTest, FrequenciesWithTimesHaveTheirStep) {
  std::string text;
  for (int i = 0; i < 30; ++i)
    text += fmt::format("{} {:.6e}\n", 2 * i, 1e-4 * (1 + i % 2));
  const ClockLog log = read_log(text, "a.ykt");
  EXPECT_NEAR(log.events[29].time - log.events[0].time, 58.0, 0.01);
}

TEST(FormatsTest, WhatTurnsOutInOrderAfterAllIsNotTurnedRoundUnsorted) {
  // The head falls, the rest rises: turned round, the rest has to be sorted.
  std::string text;
  for (int i = 0; i < 1000; ++i)
    text += fmt::format("{}.5\n", 1360004000 - 2 * i);
  for (int i = 0; i < 200; ++i)
    text += fmt::format("{}.5\n", 1360005000 + 2 * i);
  const ClockLog log = read_log(text, "x");
  EXPECT_TRUE(says(log, "newest line is first"));
  for (std::size_t i = 1; i < log.events.size(); ++i)
    ASSERT_LT(log.events[i - 1].time, log.events[i].time);
}

// As the programs of schools' gates name it.
TEST(FormatsTest, TheTimeInAGateIsAWidth) {
  for (const char* name : {"Time in gate (s)", "Gate Time (s)", "Dark time (s)", "Dunkelzeit (s)",
                           "Time blocked (s)"}) {
    const ClockLog log = read_log(fmt::format("Time (s),{}\n0.5,0.020\n2.5,0.021\n4.5,0.022\n"
                                              "6.5,0.023\n",
                                              name),
                                  "gate.csv");
    ASSERT_EQ(log.columns.width_s.size(), 4U) << name;
    EXPECT_EQ(log.columns.width_s[2], 0.022) << name;
  }
}

TEST(FormatsTest, WidthsTemperaturesAndGateEdgesBecomeColumns) {
  const ClockLog log = read_log("time_s,edge,temperature_c\n0.00,up-in,20\n0.02,up-out,20\n"
                                "1.00,down-in,20\n1.02,down-out,21\n2.00,up-in,20\n2.02,up-out,22\n"
                                "3.00,down-in,20\n4.00,up-in,20\n4.02,up-out,20\n",
                                "x");
  ASSERT_EQ(log.events.size(), 4u);
  EXPECT_NEAR(log.events[0].time.to_double(), 0.01, 2e-18); // a rounding of 0.01
  EXPECT_NEAR(log.columns.width_s[3], 0.02, 1e-17);         // three roundings of 0.02
  EXPECT_EQ(log.columns.temperature_c[2], 22.0);
  ASSERT_EQ(log.issues.size(), 1u);
  EXPECT_EQ(log.issues[0].kind, IssueKind::incomplete);
  EXPECT_EQ(log.issues[0].line, 8u);
}

TEST(CalendarTest, ReadsWhatLoggersWrite) {
  for (const char* text : {"2013-02-22 23:38:00.2279906", "2013-02-22T23:38:00.2279906Z",
                           "2013-02-22T23:38:00.2279906+00:00", "2013/02/22 23:38:00.2279906",
                           "2013_02_22_23_38_00.2279906", "2013-02-22-23-38-00.2279906",
                           "2013-02-23 00:38:00.2279906+01:00", "2013-02-22 18:08:00.2279906 -0530",
                           "2013-02-22 11:38:00.2279906 PM", "2013-02-22 11:38:00.2279906pm",
                           "2013-02-23 12:38:00.2279906 a.m. +01:00"}) {
    const auto time = parse_calendar(text);
    ASSERT_TRUE(time) << text;
    EXPECT_EQ(time->time.seconds, 1361576280) << text;
    EXPECT_EQ(time->time.fraction, 0.2279906) << text;
  }
  for (const char* text : {"2013-02-30 0:00:00", "2013-13-01 0:0:0", "12:60:00", "25:00:00", "12",
                           "2013-02-22", "13:00:00 PM", "0:00:00 AM", "12:00:00 QM",
                           "12:00:00 +99:00", "12:00:00x", "2013-02-22 12"})
    EXPECT_FALSE(parse_calendar(text)) << text;
}

TEST(CalendarTest, StrokesMayHaveEitherOrder) {
  const auto seconds = [](const char* text, DateOrder order) {
    const auto time = parse_calendar(text, '.', order);
    return time ? time->time.seconds : -1;
  };
  constexpr std::int64_t april = 1365026400, march = 1362434400; // 3 April and 4 March 2013, 22 h
  EXPECT_EQ(seconds("03/04/2013 22:00:00", DateOrder::day_first), april);
  EXPECT_EQ(seconds("03/04/2013 10:00:00 PM", DateOrder::month_first), march);
  EXPECT_EQ(seconds("03/04/2013 22:00:00", DateOrder::either), april);
  EXPECT_EQ(seconds("22/02/2013 23:38:00", DateOrder::month_first), -1);
  EXPECT_EQ(seconds("02/22/2013 23:38:00", DateOrder::either), 1361576280);
}

TEST(FormatsTest, TheOrderOfADateIsFoundOrTold) {
  const auto text = [](const char* first_day, const char* second_day) {
    std::string lines;
    for (int i = 0; i < 20; ++i)
      lines += fmt::format("{} 23:{:02}:{:02}\n", first_day, 59 - (19 - i) * 2 / 60, 20 + 2 * i);
    for (int i = 0; i < 20; ++i)
      lines += fmt::format("{} 0:00:{:02}\n", second_day, 2 * i);
    return lines;
  };
  const auto step = [](const ClockLog& log) { return log.events[20].time - log.events[19].time; };
  const auto first = [](const ClockLog& log) { return log.events[0].time.seconds; };
  // Only one order exists; both do, and the number that changes is the day's.
  EXPECT_EQ(step(read_log(text("02/22/2013", "02/23/2013"), "x")), 2.0);
  EXPECT_EQ(step(read_log(text("22/02/2013", "23/02/2013"), "x")), 2.0);
  EXPECT_EQ(step(read_log(text("02/03/2013", "02/04/2013"), "x")), 2.0);
  EXPECT_EQ(step(read_log(text("03/02/2013", "04/02/2013"), "x")), 2.0);
  const std::string open = text("03/04/2013", "03/04/2013").substr(0, 20 * 20);
  const ClockLog guessed = read_log(open, "x");
  EXPECT_EQ(first(guessed) / 86400, 15798) << "3 April";
  EXPECT_TRUE(std::any_of(guessed.assumptions.begin(), guessed.assumptions.end(),
                          [](const Assumption& a) { return a.setting == Setting::date_order; }));
  ReadingOptions told;
  told.month_first = true;
  EXPECT_EQ(first(read_log(open, "x", told)) / 86400, 15768) << "4 March";
}

TEST(FormatsTest, AMeasurementOfCassyIsATable) {
  const auto values = [](auto value) {
    std::string text = "<values count=\"40\">";
    for (int i = 0; i < 40; ++i)
      text += value(i);
    return text + "</values></channel>";
  };
  const std::string measurement =
      "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<cassylab version=\"1.8\">\n<cassys/><ios/>"
      "<channels count=\"3\"><channel><quantity>Index</quantity><unit/>" +
      values([](int) { return std::string("<value/>"); }) +
      "<channel><quantity>Zeit</quantity><symbol>t</symbol><unit>s</unit>" +
      values([](int i) { return fmt::format("<value>{:.4f}</value>\n", 2.0001 * i); }) +
      "<channel><quantity>Temperatur</quantity><unit>&#176;C</unit>" + values([](int i) {
        return i == 5 ? "<value />" : fmt::format("<value>{}</value>", 20 + i);
      }) +
      "</channels></cassylab>\n";
  const ClockLog log = read_log(measurement, "m.labx");
  ASSERT_EQ(log.events.size(), 40u);
  // A few roundings of 78 s.
  EXPECT_NEAR(log.events[39].time - log.events[0].time, 39 * 2.0001, 1e-13);
  EXPECT_EQ(log.columns.temperature_c.at(6), 26.0);
  EXPECT_TRUE(std::isnan(log.columns.temperature_c.at(5)));
  const std::string path = testing::TempDir() + "goingrate_m.labx";
  std::ofstream(path, std::ios::binary) << measurement;
  EXPECT_EQ(read_log_file(path).events.size(), 40u);
  std::remove(path.c_str());
  for (const char* cut : {"<cassylab", "<cassylab><channels><channel><values><value>1",
                          "<cassylab/>", "<cassylab><channels></channels></cassylab>"})
    EXPECT_THROW((void)read_log(cut, "cut"), InputError) << cut;
}

TEST(FormatsTest, AChannelOfCassyIsNoRecordingWhateverItsName) {
  for (const std::string name : {"fLaC", "RIFF", "OggS"}) {
    std::string values;
    for (int i = 0; i < 8; ++i)
      values += "<value>" + std::to_string(2 * i) + "</value>";
    const ClockLog log = read_log("<cassylab><channels><channel><quantity>" + name +
                                      " Zeit</quantity><unit>s</unit><values>" + values +
                                      "</values></channel></channels></cassylab>",
                                  "m.labx", {.columns = {"time=1"}});
    EXPECT_EQ(log.events.size(), 8U) << name;
  }
}

// A light gate's four intervals, of a period of 2.0001 s; the flag is in the gate for 20 ms, the
// tick takes 1.004 s. The counter runs at `rate`.
std::string gate_row(double rate, double tick_light = 0.984) {
  const auto cycles = [&](double seconds) { return std::llround(seconds * rate); };
  return fmt::format("{},{},{},{}", cycles(tick_light), cycles(0.020), cycles(0.9761),
                     cycles(0.020));
}

TEST(FormatsTest, IntervalsOfALightGateAreBothPassages) {
  std::string text = "tick,tick_block,tock,tock_block\n";
  for (int i = 0; i < 30; ++i)
    text += gate_row(16e6) + '\n';
  const ClockLog log = read_log(text, "gate.csv");
  EXPECT_EQ(log.format, LogFormat::ticktock);
  EXPECT_TRUE(says(log, "16000000 Hz"));
  ASSERT_EQ(log.events.size(), 60u);
  for (std::size_t i = 0; i < 60; ++i) { // whole cycles: 31 ns
    EXPECT_EQ(log.events[i].edge, i % 2 == 0 ? Edge::up : Edge::down);
    const double expected = 0.01 + 2.0001 * static_cast<double>(i / 2) + (i % 2 == 1 ? 1.004 : 0.0);
    EXPECT_NEAR(log.events[i].time.to_double(), expected, 1e-13) << i; // sums of 60 intervals
    EXPECT_NEAR(log.columns.width_s.at(i), 0.020, 1e-17);              // three roundings of 0.02
  }
  // The same without a header, of a counter of another rate.
  std::string bare;
  for (int i = 0; i < 30; ++i)
    bare += gate_row(1e6) + '\n';
  const ClockLog slow =
      read_log(bare, "bare.csv", {.format = LogFormat::ticktock, .counter_hz = 1e6});
  ASSERT_EQ(slow.events.size(), 60u);
  // Sums of 60 intervals.
  EXPECT_NEAR(slow.events[59].time - slow.events[0].time, 29 * 2.0001 + 1.004, 1e-13);
}

TEST(FormatsTest, AGatesCounterHasTheRateBesideIt) {
  // As the firmware's receiver writes it: 40 parts in a million fast, two rows lost after the tenth
  // and one broken.
  std::string text = "host_utc_iso,tick,tick_adj,tick_block,tock,tock_block,tick_total_f_hat_hz,"
                     "pps_seq_row\n";
  const double rate = 16e6 * (1.0 + 40e-6);
  double s = 0.0;
  for (int i = 0; i < 30; ++i) {
    s += 2.0001;
    if (i == 10 || i == 11) continue;
    const std::string row = gate_row(rate);
    const std::size_t comma = row.find(',');
    text += fmt::format("2026-03-01T10:00:{:02}Z,{},0{},{:.0f},{}\n", i, row.substr(0, comma),
                        i == 20 ? ",x,x,x" : row.substr(comma), rate, 7 + static_cast<int>(s));
  }
  const ClockLog log = read_log(text, "smp.csv");
  EXPECT_EQ(log.format, LogFormat::ticktock);
  ASSERT_EQ(log.events.size(), 2u * 27);
  const auto after = [&](std::size_t i) { return log.events[i].time - log.events[0].time; };
  const double rounded = 4 * 0.5 / 16e6; // four counts of whole cycles an oscillation
  EXPECT_NEAR(after(18), 9 * 2.0001, 9 * rounded);
  EXPECT_NEAR(after(20), 12 * 2.0001, 1e-3); // two rows: 4 whole seconds of the reference
  EXPECT_NEAR(after(36) - after(34), 2 * 2.0001, 2 * rounded); // over the broken row
  ASSERT_EQ(log.issues.size(), 1u);
  EXPECT_EQ(log.issues[0].line, 20u);
}

TEST(FormatsTest, AGatesRowThatIsCutShortTakesItsTime) {
  std::string text = "tick,tick_block,tock,tock_block\n";
  for (int i = 0; i < 30; ++i)
    text += i == 9 ? "15744000,320\n" : i == 19 ? "STS,rebooted\n" : gate_row(16e6) + '\n';
  const ClockLog log = read_log(text, "gate.csv");
  ASSERT_EQ(log.events.size(), 2u * 28);
  // Sums of 58 intervals.
  EXPECT_NEAR(log.events.back().time - log.events.front().time, 28 * 2.0001 + 1.004, 1e-13);
  EXPECT_EQ(log.issues.size(), 2u);
}

TEST(FormatsTest, AGateWithoutAllIntervalsIsToldSo) {
  try {
    (void)read_log("tick,tick_block,tock\n15740800,320000,15620800\n15740800,320000,15620800\n",
                   "gate.csv", {.format = LogFormat::ticktock});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("tock_block"), std::string::npos) << error.what();
  }
}

// Samples of a column of that name, which swings.
std::string samples_named(std::string_view name) {
  std::string text = fmt::format("\"Time (s)\",\"{}\",\"other\"\n", name);
  for (int i = 0; i < 2000; ++i)
    text += fmt::format("{:.4f},{:.6f},0.001\n", 0.01 * i, std::sin(0.035 * i));
  return text;
}

TEST(FormatsTest, SamplesOfAnUnknownNameAreNoBeats) {
  try {
    (void)read_log(samples_named("Channel A"), "swing.csv");
    FAIL();
  } catch (const ImpossibleReading& error) {
    EXPECT_NE(std::string(error.what()).find("column 2, 'Channel A', which swings"),
              std::string::npos);
    EXPECT_EQ(error.others().at(0).columns, std::vector<std::string>{"angle=2"});
  }
}

TEST(FormatsTest, ASpeedOfTurningIsNoAngle) {
  for (const char* name : {"Gyroscope x (rad/s)", "AngVel/rad/s", "Angular velocity (deg/s)"}) {
    const std::string text = samples_named(name);
    try {
      (void)read_log(text, "gyro.csv");
      FAIL() << name;
    } catch (const ImpossibleReading& error) {
      EXPECT_NE(std::string(error.what()).find("a speed of turning, no angle"), std::string::npos);
      ReadingOptions advised;
      advised.columns = error.others().at(0).columns;
      const ClockLog log = read_log(text, "gyro.csv", advised);
      // A whole number of swings; the samples have six decimals.
      EXPECT_NEAR(log.events[12].time - log.events[0].time, 12.0 * std::numbers::pi / 3.5, 1e-5);
      EXPECT_FALSE(log.has_amplitude);
    }
    ReadingOptions wrong;
    wrong.columns = {"angle=2"};
    EXPECT_THROW((void)read_log(text, "gyro.csv", wrong), ArgumentError) << name;
    wrong.columns = {"angle=2:rad"}; // who says so may know that the header is wrong
    EXPECT_TRUE(read_log(text, "gyro.csv", wrong).has_amplitude) << name;
  }
}

TEST(FormatsTest, AWrongUnitIsTold) {
  const auto refusal = [](const char* column) {
    ReadingOptions options;
    options.columns = {column};
    try {
      (void)read_log(samples_named("a:b"), "x", options);
    } catch (const ArgumentError& error) {
      return error.legal();
    }
    return std::string("read");
  };
  EXPECT_NE(refusal("time=1:fortnight").find("one of s, ms,"), std::string::npos);
  EXPECT_NE(refusal("time=1:fortnight").find("not 'fortnight'"), std::string::npos);
  EXPECT_NE(refusal("angle=2:rad/s").find("'rad/s', a speed of turning"), std::string::npos);
  EXPECT_NE(refusal("edge=2:deg").find("without a unit"), std::string::npos);
  EXPECT_NE(refusal("time=9:s").find("a place from 1 to 3"), std::string::npos);
  EXPECT_NE(refusal("time=9:t").find("a number from 1"), std::string::npos);
  EXPECT_EQ(refusal("angle=a:b"), "read");
}

TEST(FormatsTest, SettingsBeforeTheHeaderAreNoData) {
  std::string text = "SampleRate=1000\nGain=2\ntime_s,edge\n";
  for (int i = 0; i < 20; ++i)
    text += fmt::format("{}.25,{}\n", i, i % 2 == 0 ? "up" : "down");
  const ClockLog log = read_log(text, "x");
  EXPECT_EQ(log.events.size(), 20u);
  EXPECT_EQ(log.events[1].edge, Edge::down);
  EXPECT_TRUE(log.issues.empty());
}

TEST(FormatsTest, WordsAndKeysMayStandBeforeTheNumbers) {
  std::string text;
  for (int i = 0; i < 40; ++i)
    text += fmt::format("{} {} t={:.6f}\n", i % 2 == 0 ? "tick" : "tock", i,
                        1000.0 + i + (i % 2 == 0 ? 0.0 : 0.02));
  const ClockLog log = read_log(text, "x");
  ASSERT_EQ(log.events.size(), 40u);
  EXPECT_EQ(log.events[1].edge, Edge::down);
  EXPECT_NEAR(log.events[1].time - log.events[0].time, 1.02, 1e-15); // a few roundings of 1 s
  EXPECT_TRUE(log.issues.empty());
}

TEST(FormatsTest, PointsOfADateAreNoDecimalPoints) {
  std::string text = "Zeit;Periode (s)\n";
  for (int i = 0; i < 30; ++i)
    text += fmt::format("24.11.2025 16:{:02}:{:02};2,0003{}0\n", i / 30, 2 * i % 60, i % 3);
  const ClockLog log = read_log(text, "x");
  ASSERT_EQ(log.events.size(), 30u);
  EXPECT_NEAR(log.events[2].time - log.events[0].time, 4.00063, 2e-15); // two roundings of 4 s
}

TEST(UnwrapperTest, CountersOfManyWrapsStayExact) {
  Unwrapper unwrap({65536e-6, {}, 1.0, in_microseconds});
  for (std::int64_t us = 0; us < 3000000000LL; us += 1000017) {
    const Instant t = unwrap(*whole_units(us % 65536, in_microseconds), [] { return 1.0; });
    ASSERT_EQ(t.seconds, us / 1000000);
    ASSERT_NEAR(t.fraction, 1e-6 * static_cast<double>(us % 1000000), 2.3e-16); // one rounding
  }
}

TEST(FormatsTest, AGzipFileIsReadAsItIs) {
  const std::string path = testing::TempDir() + "goingrate_formats.gz";
  const auto ticks = true_crossings();
  gzFile file = gzopen(path.c_str(), "wb");
  for (const std::int64_t tick : ticks)
    gzputs(file, (seconds_text(tick) + "\n").c_str());
  gzclose(file);
  expect_same_steps(read_log_file(path), ticks);
  // Cut short, it is refused: nobody knows how much is missing.
  std::ifstream whole(path, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(whole)), {});
  std::ofstream(path, std::ios::binary) << bytes.substr(0, bytes.size() / 2);
  EXPECT_THROW((void)read_log_file(path), InputError);
  std::remove(path.c_str());
}

} // namespace
} // namespace goingrate
