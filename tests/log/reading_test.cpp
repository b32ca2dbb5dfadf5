#include "goingrate/log/amplitude.hpp"
#include "goingrate/log/reading.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/base/random.hpp"
#include "goingrate/log/writing.hpp"
#include "support/simulated.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace goingrate {
namespace {

TEST(ReadingTest, BareTimestampsAreFoundAndSaid) {
  const ClockLog log =
      read_log("1361605080.2279906\n1361605082.2279907\n1361605084.2279911\n", "x");
  EXPECT_EQ(log.format, LogFormat::timestamps);
  ASSERT_EQ(log.events.size(), 3u);
  EXPECT_EQ(log.events[0].time.fraction, 0.2279906);
  EXPECT_NE(log.assumptions.front().text.find("one time per line"), std::string::npos);
}

TEST(ReadingTest, AClockErrorLogGivesTrueTimes) {
  const ClockLog log = read_log("1364774403 -1.275606 46.421165\n1364774406 -1.275500 46.42\n"
                                "1364774409 -1.275600 46.43\n",
                                "x");
  EXPECT_EQ(log.format, LogFormat::clock_error);
  EXPECT_EQ(log.nominal_period_s, 3.0);
  EXPECT_EQ(log.events[0].time.seconds, 1364774404); // label minus error: the clock is 1.27 s slow
  EXPECT_NEAR(log.events[0].time.fraction, 0.275606, 1e-16); // a rounding of 0.3
  EXPECT_DOUBLE_EQ(log.events[0].amplitude_rad, 46.421165e-3);
}

TEST(ReadingTest, TheNativeLogKnowsItsColumnsInAnyOrder) {
  const ClockLog log =
      read_log("# goingrate log: 1\n# nominal_period_s: 2\n\namplitude_rad,time_s,edge\r\n"
               "0.05,0.5,up\r\n,1.5,down\r\n0.051,2.5,up\r\n",
               "x");
  ASSERT_EQ(log.events.size(), 3u);
  EXPECT_EQ(log.nominal_period_s, 2.0);
  EXPECT_EQ(log.events[1].edge, Edge::down);
  EXPECT_TRUE(std::isnan(log.events[1].amplitude_rad));
  EXPECT_EQ(log.events[2].amplitude_rad, 0.051);
  EXPECT_EQ(log.events[2].line, 7u);
}

TEST(ReadingTest, ABadLineIsLeftOutAndTold) {
  const ClockLog log = read_log("0.0\n2.0\n4.0x\n6.0\n8.0 9\n", "x");
  EXPECT_EQ(log.events.size(), 3u);
  ASSERT_EQ(log.issues.size(), 2u);
  EXPECT_EQ(log.issues[0].line, 3u);
  EXPECT_EQ(log.issues[1].line, 5u);
  EXPECT_EQ(log.issues[1].column, 5u);
}

TEST(ReadingTest, DisorderIsSortedAndTold) {
  const ClockLog log = read_log("0.0\n4.0\n2.0\n6.0\n", "x");
  EXPECT_LT(log.events[1].time, log.events[2].time);
  ASSERT_EQ(log.issues.size(), 1u);
  EXPECT_EQ(log.issues[0].line, 3u);
  EXPECT_EQ(log.issues[0].kind, IssueKind::out_of_order);
}

// A blank behind the time sends a line on the long way, on which every other log is read.
TEST(ReadingTest, PlainTimesAreReadAsAnyOtherLine) {
  RandomStream random(7, StreamPurpose::jitter);
  for (int log = 0; log < 300; ++log) {
    std::string plain, padded;
    const int decimals = 1 + static_cast<int>(17.0 * random.uniform());
    const std::string end = log % 3 == 0 ? "\r\n" : "\n";
    for (int i = 0; i < 60; ++i) {
      const double t = (log % 2 == 0 ? 1e3 : 1.4e9) + 2.0 * i + 1e-3 * random.normal();
      const double what = random.uniform();
      std::string line = format_instant(Instant::from_seconds(t), decimals);
      if (what < 0.02)
        line = "# a remark";
      else if (what < 0.04)
        line = "";
      else if (what < 0.06)
        line = "999999999";
      else if (what < 0.08)
        line += "x";
      else if (what < 0.10)
        line = "-" + line;
      else if (what < 0.12)
        line = "00000000000000000000" + line;
      plain += line + (i < 59 || log % 4 < 2 ? end : "");
      padded += line + (line.empty() ? "" : " ") + (i < 59 || log % 4 < 2 ? end : "");
    }
    if (log % 4 == 3) { // cut short
      plain.resize(plain.size() - 1);
      padded.resize(padded.size() - 2);
    }
    const ClockLog a = read_log(plain, "x"), b = read_log(padded, "x");
    ASSERT_EQ(a.events.size(), b.events.size()) << plain;
    for (std::size_t i = 0; i < a.events.size(); ++i) {
      ASSERT_EQ(a.events[i].time, b.events[i].time) << plain;
      ASSERT_EQ(a.events[i].line, b.events[i].line) << plain;
    }
    ASSERT_EQ(a.issues.size(), b.issues.size()) << plain;
  }
}

TEST(ReadingTest, OptionsOverrideWhatWouldBeFound) {
  ReadingOptions options;
  options.nominal_period_s = 1.5;
  options.format = LogFormat::timestamps;
  const ClockLog log = read_log("0.0\n2.0\n4.0\n", "x", options);
  EXPECT_EQ(log.nominal_period_s, 1.5);
}

struct Bad {
  std::string text;
  std::size_t line, column;
  const char* says;
};

void PrintTo(const Bad& bad, std::ostream* out) { *out << '"' << bad.says << '"'; }

class BadLog : public testing::TestWithParam<Bad> {};

TEST_P(BadLog, IsRefusedWithItsPlace) {
  const Bad& bad = GetParam();
  try {
    (void)read_log(bad.text, "bad.log");
    FAIL() << "accepted: " << bad.text;
  } catch (const InputError& error) {
    EXPECT_EQ(error.place().line, bad.line) << error.what();
    EXPECT_EQ(error.place().column, bad.column) << error.what();
    EXPECT_NE(std::string(error.what()).find(bad.says), std::string::npos) << error.what();
    EXPECT_EQ(std::string(error.what()).find("bad.log:"), 0u) << error.what();
  }
}

INSTANTIATE_TEST_SUITE_P(
    Texts, BadLog,
    testing::Values(Bad{"", 1, 1, "an empty file"}, Bad{"\n\n", 1, 1, "no line of data"},
                    Bad{"# only a comment\n", 1, 1, "no line of data"},
                    Bad{std::string("12.0\n13\0.0\n", 10), 2, 3, "binary byte 0x00"},
                    Bad{"\x7f\x45LF\x02\x01", 1, 5, "binary byte 0x02"},
                    Bad{"1.0\n", 1, 1, "1 event"}, Bad{"hello world\n", 1, 1, "'hello world'"},
                    Bad{"1.0\nx\ny\nz\n", 2, 1, "3 unusable lines out of 4"},
                    Bad{"time_s,edge\n", 1, 1, "0 events"},
                    Bad{"time_s\n1.0\n2.0\n", 3, 1, "2 events"}));

TEST(ReadingTest, AnUnreadableFileIsAnInputError) {
  EXPECT_THROW((void)read_text("/nowhere/at/all.log"), InputError);
  EXPECT_THROW((void)read_text("/"), InputError);
}

TEST(ReadingTest, NumbersMayHaveAPlusAndLongExponents) {
  const std::string text = "# phase\n+7.5199505265349822E-012\n-2.5e-3\nnan\n1e-3\n";
  const ClockLog log = read_log(text, "p", {.format = LogFormat::phase});
  ASSERT_TRUE(log.grid);
  const auto& x = log.grid->phase_s;
  ASSERT_EQ(x.size(), 4u);
  EXPECT_EQ(x[0], 7.5199505265349822e-12);
  EXPECT_TRUE(std::isnan(x[2]));
  EXPECT_EQ(log.events.size(), 3u);
  EXPECT_EQ(log.events[2].cycle, 3);
  EXPECT_THROW((void)read_log("1\n2\n", "p", {.format = LogFormat::phase}), InputError);
}

// Lines that hold nothing but a number are read by a shorter way than lines with a blank behind it.
TEST(ReadingTest, PlainPhasesAreReadAsOthersAre) {
  const std::vector<std::string> phases{"0.0",   "1.25e-6", "-1.5E-06", "+2e-6",   "0",    "99999",
                                        "-9e-7", "nan",     "1e-6x",    ".000004", "1e12", "7.25"};
  std::string plain, others, windows;
  for (int round = 0; round < 3; ++round)
    for (const std::string& phase : phases) {
      plain += phase + '\n';
      others += phase + " \n";
      windows += phase + "\r\n";
    }
  for (const bool alone : {false, true}) {
    ReadingOptions options;
    options.format = LogFormat::phase;
    options.phases_alone = alone;
    const ClockLog expected = read_log(others, "p", options);
    for (const std::string& text : {plain, windows}) {
      const ClockLog log = read_log(text, "p", options);
      const auto &x = log.grid->phase_s, &y = expected.grid->phase_s;
      ASSERT_EQ(x.size(), 3 * phases.size());
      ASSERT_EQ(y.size(), x.size());
      for (std::size_t i = 0; i < x.size(); ++i)
        EXPECT_TRUE(x[i] == y[i] || (std::isnan(x[i]) && std::isnan(y[i]))) << i;
      EXPECT_EQ(log.issues.size(), expected.issues.size());
      EXPECT_EQ(log.events.size(), alone ? 3u : expected.events.size());
    }
  }
}

TEST(EdgeCorrectionTest, MovesAnEdgeToTheVerticalByTheSineOfItsPlace) {
  ClockLog log;
  log.events = {event_at({100, 0.0}, Edge::up, 1, 0.05), event_at({101, 0.0}, Edge::down, 2, 0.05),
                event_at({102, 0.0}, Edge::up, 3, 0.01)};
  move_to_vertical(log, -0.012, 0.012, 3.0);
  ASSERT_EQ(log.issues.size(), 1u)
      << "an amplitude that does not reach the edge cannot have crossed it: the median is taken";
  const double shift = std::asin(0.012 / 0.05) * 3.0 / (2.0 * std::numbers::pi);
  // Roundings of fractions of a second.
  EXPECT_NEAR((log.events[0].time - Instant{100, 0.0}), shift, 1e-15);
  EXPECT_NEAR((log.events[1].time - Instant{101, 0.0}), shift, 1e-15)
      << "the falling pendulum meets the other edge, as early";
  EXPECT_NEAR((log.events[2].time - Instant{102, 0.0}), shift, 1e-15); // likewise
}

// A clock that gains half a second a day, compared some time between half past seven and half past
// eight, once not at all and once twice; errors to a hundredth of a second.
TEST(ReadingTest, ErrorsReadAtUnevenTimes) {
  RandomStream moment(5, StreamPurpose::jitter);
  std::string text = "date,error_s\n";
  for (int day = 1; day <= 28; ++day) {
    if (day == 9) continue;
    for (const int hours : day == 17 ? std::vector{0, 9} : std::vector{0}) {
      const int second = 27000 + 3600 * hours + static_cast<int>(3600.0 * moment.uniform());
      text += fmt::format("2023-03-{:02} {:02}:{:02}:{:02},{:+.2f}\n", day, second / 3600,
                          second / 60 % 60, second % 60, 0.5 * (day + second / 86400.0));
    }
  }
  const ClockLog log = read_log(text, "errors");
  EXPECT_EQ(log.nominal_period_s, 86400.0);
  ASSERT_EQ(log.events.size(), 27u);
  // Rounding of the two errors.
  EXPECT_NEAR(log.events[7].time - log.events[0].time, 7.0 * 86400.0 - 3.5, 0.012);
  EXPECT_NEAR(log.events[26].time - log.events[0].time, 27.0 * 86400.0 - 13.5, 0.012);
}

// Nights are bridged, so that none of the even times is missing.
TEST(ReadingTest, ErrorsReadSeveralTimesADay) {
  RandomStream moment(6, StreamPurpose::jitter);
  constexpr double lost_a_day = 1.5;
  for (const char* name : {"error", "seconds fast", "offset_s", "deviation [s]"}) {
    std::string text = fmt::format("date,time,{}\n", name);
    for (int day = 1; day <= 14; ++day)
      for (const int hour : {8, 12, 17, 21}) {
        const int minute = static_cast<int>(60.0 * moment.uniform());
        text += fmt::format("2024-03-{:02},{:02}:{:02},{:.2f}\n", day, hour, minute,
                            -lost_a_day * (day + hour / 24.0 + minute / 1440.0));
      }
    const ClockLog log = read_log(text, "errors");
    ASSERT_EQ(log.nominal_period_s, 21600.0) << name;
    EXPECT_NEAR(static_cast<double>(log.events.size()), 55.0, 1.0); // 13.5 days
    const double step_s = 21600.0 * (1.0 + lost_a_day / 86400.0);
    for (std::size_t i = 0; i < log.events.size(); ++i) // rounding of the first and of two more
      EXPECT_NEAR(log.events[i].time - log.events[0].time, static_cast<double>(i) * step_s, 0.012)
          << name;
  }
}

// The second week stands before the first.
TEST(ReadingTest, ErrorsReadSeveralTimesADayInAnyOrder) {
  std::string text = "date,time,error\n";
  for (const int first : {8, 1})
    for (int day = first; day < first + 7; ++day)
      for (const int hour : {8, 12, 17, 21}) {
        const int minute = (7 * day + 13 * hour) % 60;
        text += fmt::format("2024-03-{:02},{:02}:{:02},{:.2f}\n", day, hour, minute,
                            -1.5 * (day + hour / 24.0 + minute / 1440.0));
      }
  const ClockLog log = read_log(text, "errors");
  EXPECT_EQ(log.nominal_period_s, 21600.0);
  EXPECT_NEAR(static_cast<double>(log.events.size()), 55.0, 1.0); // 13.5 days
  EXPECT_TRUE(std::is_sorted(log.events.begin(), log.events.end(),
                             [](const Beat& a, const Beat& b) { return a.time < b.time; }));
  ASSERT_FALSE(log.issues.empty());
  EXPECT_EQ(log.issues.front().kind, IssueKind::out_of_order);
}

} // namespace
} // namespace goingrate
