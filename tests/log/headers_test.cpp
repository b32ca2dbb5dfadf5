// What the header and the lines below it say together of a log's columns.
#include "goingrate/base/errors.hpp"
#include "goingrate/log/reading.hpp"

#include "log/assumed.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <gtest/gtest.h>
#include <string>

namespace goingrate {
namespace {

using test::says;

constexpr int lines = 40;           // of each log here
constexpr double rounding_s = 1e-9; // of sums of decimal numbers with four places

// A header, and `lines` lines below it.
std::string under(std::string_view header, const std::function<std::string(int)>& line) {
  std::string text(header);
  for (int i = 0; i < lines; ++i)
    text += "\n" + line(i);
  return text + "\n";
}

// In ten-thousandths of a second: beats 1.4997 s apart with a scatter of some tenths of a
// millisecond.
int period_of(int i) { return 14997 + (i * i * 7) % 11; }
int time_of(int i) {
  int sum = 0;
  for (int k = 0; k <= i; ++k)
    sum += period_of(k);
  return sum;
}

std::string with_comma(int ten_thousandths) {
  return fmt::format("{},{:04d}", ten_thousandths / 10000, ten_thousandths % 10000);
}

std::string refusal(const std::string& text, const ReadingOptions& options = {}) {
  try {
    (void)read_log(text, "log.csv", options);
  } catch (const std::exception& error) {
    return error.what();
  }
  return "read";
}

void expect_beats(const ClockLog& log) {
  ASSERT_EQ(log.events.size(), static_cast<std::size_t>(lines));
  for (int i = 1; i < lines; ++i)
    ASSERT_NEAR(log.events[i].time - log.events[i - 1].time, 1e-4 * period_of(i), rounding_s) << i;
}

TEST(HeadersTest, ACommaBelowOneNameIsTheDecimalPoint) {
  const auto time = [](int i) { return with_comma(time_of(i)); };
  for (const char* header : {"Zeit (s)", "time", "Time in s", "Uhrzeit\nt in s"}) {
    const ClockLog log = read_log(under(header, time), "log.txt");
    SCOPED_TRACE(header);
    expect_beats(log);
    EXPECT_TRUE(says(log, "a comma is the decimal point"));
    EXPECT_TRUE(log.issues.empty());
  }
}

TEST(HeadersTest, PeriodsWithADecimalCommaMayHaveAnyName) {
  const auto period = [](int i) { return with_comma(period_of(i)); };
  for (const char* header : {"Period (s)", "T (s)", "T in s", "Schwingungsdauer T in s"}) {
    SCOPED_TRACE(header);
    expect_beats(read_log(under(header, period), "log.txt"));
  }
  ReadingOptions given;
  given.columns = {"period=1"};
  expect_beats(read_log(under("Schwingungsdauer T in s", period), "log.txt", given));
}

TEST(HeadersTest, DecimalsMayBeOfAnyLengthBelowOneName) {
  const auto short_ones = [](int i) {
    return i % 20 == 0 ? fmt::format("{}", 2 * i) : fmt::format("{},{}", 2 * i, i % 5);
  };
  const ClockLog log = read_log(under("Zeit (s)", short_ones), "log.txt");
  ASSERT_EQ(log.events.size(), static_cast<std::size_t>(lines));
  EXPECT_NEAR(log.events[3].time - log.events[1].time, 4.2, rounding_s);
}

TEST(HeadersTest, TwoNamesOverTwoWholeNumbersAreTwoColumns) {
  const auto both = [](int i) { return fmt::format("{},{}", 1500 * i, 1010 + i % 3); };
  for (const char* header : {"Time (ms),Pressure", "Hall\nTime (ms),Pressure"})
    EXPECT_NEAR(read_log(under(header, both), "log.txt").events[1].time -
                    read_log(under(header, both), "log.txt").events[0].time,
                1.5, rounding_s)
        << header;
}

TEST(HeadersTest, CommasThatAreBothPointAndSeparatorAreRefused) {
  const auto both = [](int i) { return with_comma(time_of(i)) + ",0,03" + std::to_string(i % 10); };
  const std::string told = refusal(under("time,amplitude", both));
  EXPECT_NE(told.find("log.csv:2"), told.npos) << told;
  EXPECT_NE(told.find("commas are decimal points"), told.npos) << told;
}

TEST(HeadersTest, ATimeThatDoesNotRiseIsAPeriod) {
  const auto period = [](int i) { return fmt::format("{:.4f}", 1e-4 * period_of(i)); };
  const ClockLog log = read_log(under("t (s)", period), "log.txt");
  expect_beats(log);
  EXPECT_TRUE(says(log, "holds periods"));
}

TEST(HeadersTest, AFormatThatIsGivenHoldsUnderAnyName) {
  const auto value = [](int i) { return fmt::format("{:.4f}", 1e-4 * period_of(i)); };
  ReadingOptions given;
  given.format = LogFormat::periods;
  expect_beats(read_log(under("my times", value), "log.csv", given));
  given.format = LogFormat::phase;
  const ClockLog log = read_log(under("time_s", value), "log.csv", given);
  ASSERT_TRUE(log.grid);
  EXPECT_NEAR(log.grid->phase_s[3], 1e-4 * period_of(3), rounding_s);
}

TEST(HeadersTest, AnAdviceIsOneThatWorks) {
  const auto columns = [](int i) {
    return fmt::format("{:.3f},{:.4f}", 0.05 + 1e-3 * (i * i % 7), 1e-4 * time_of(i));
  };
  const std::string text = under("amplitude,n", columns);
  try {
    (void)read_log(text, "x");
    FAIL();
  } catch (const ImpossibleReading& error) {
    ReadingOptions advised;
    advised.columns = error.others().at(0).columns;
    expect_beats(read_log(text, "x", advised));
  }
  const auto noise = [](int i) {
    return fmt::format("{}.5,{}.5", i * i % 97 - 40, i * i % 89 - 50);
  };
  EXPECT_THROW((void)read_log(under("amplitude,temperature", noise), "x"), InputError);
}

TEST(HeadersTest, DecimalCommasThatAreNotThereAreMissed) {
  ReadingOptions commas;
  commas.decimal_comma = true;
  const auto time = [](int i) { return fmt::format("{:.4f}", 1e-4 * time_of(i)); };
  const std::string told = refusal(under("time_s", time), commas);
  EXPECT_NE(told.find("log.csv:2"), told.npos) << told;
  EXPECT_NE(told.find("no line whose decimal point is a comma"), told.npos) << told;
}

TEST(HeadersTest, AUnitAgainstThatOfTheHeaderIsTold) {
  const auto time = [](int i) { return fmt::format("{:.4f}", 1e-4 * time_of(i)); };
  ReadingOptions hours;
  hours.unit = in_hours;
  const std::string told = refusal(under("time_s", time), hours);
  EXPECT_NE(told.find("'time_s', in s by its name"), told.npos) << told;
  EXPECT_NE(told.find("times in h, as was said"), told.npos) << told;
  const auto milliseconds = [](int i) { return fmt::format("{:.1f}", 0.1 * time_of(i)); };
  ReadingOptions right;
  right.unit = in_milliseconds;
  expect_beats(read_log(under("time_s", milliseconds), "log.csv", right)); // the header is wrong
}

// The beats of time_of(), as dates on 2 June 2024 from 20:00 on.
std::string clock_time(int i) {
  const int ten_thousandths = time_of(i), seconds = ten_thousandths / 10000;
  return fmt::format("20:{:02}:{:02}.{:04}", seconds / 60, seconds % 60, ten_thousandths % 10000);
}

TEST(HeadersTest, ADateThatBlanksCutIsOneTimeUnderOneName) {
  for (const char* header : {"time", "Date", "timestamp"})
    for (const char* date : {"2024-06-02", "02/06/2024", "02.06.2024"})
      for (const std::vector<std::string>& columns :
           {std::vector<std::string>{}, std::vector<std::string>{"time=1"}}) {
        SCOPED_TRACE(fmt::format("{} {}", header, date));
        ReadingOptions options;
        options.columns = columns;
        const ClockLog log = read_log(
            under(header, [&](int i) { return fmt::format("{} {}", date, clock_time(i)); }),
            "log.csv", options);
        expect_beats(log);
        EXPECT_EQ(log.events.front().time.seconds, 1717358401); // 20:00:01
        EXPECT_TRUE(log.issues.empty());
      }
}

TEST(HeadersTest, QuotedDatesAreNotCut) {
  const ClockLog log = read_log(
      under("\"time\"", [](int i) { return fmt::format("\"2024-06-02 {}\"", clock_time(i)); }),
      "log.csv");
  expect_beats(log);
  EXPECT_EQ(log.events.front().time.seconds, 1717358401);
}

TEST(HeadersTest, AZoneBehindABlankBelongsToItsTime) {
  const ClockLog log = read_log(
      under("time", [](int i) { return fmt::format("2024-06-02 {} +01:00", clock_time(i)); }),
      "log.csv");
  expect_beats(log);
  EXPECT_EQ(log.events.front().time.seconds, 1717354801);
}

// A clock that loses 2 s a day, read once a day at eight and some minutes.
std::string error_of(int i) { return fmt::format("{:+.2f}", 12.0 - 2.0 * i); }

void expect_daily_readings(const std::string& text) {
  const ClockLog log = read_log(text, "log.csv");
  ASSERT_EQ(log.events.size(), static_cast<std::size_t>(lines)) << text.substr(0, 60);
  ASSERT_TRUE(log.nominal_period_s);
  EXPECT_EQ(*log.nominal_period_s, 86400.0);
  constexpr double moved_s = 0.02; // what 10 minutes change of the error, either way
  EXPECT_NEAR(log.events[20].time - log.events[0].time, 20 * 86402.0, moved_s);
  EXPECT_TRUE(log.issues.empty());
}

TEST(HeadersTest, ReadingsOfAClockMayBeDatedInAnyWay) {
  const auto day = [](int i) { return i % 28 + 1; };
  const auto month = [](int i) { return i / 28 + 2; }; // February 2023 has 28 days
  const auto minute = [](int i) { return i * i * 7 % 11; };
  constexpr const char* names[] = {"Feb", "March"};
  expect_daily_readings(under("date,time,error", [&](int i) {
    return fmt::format("{:02}/{:02}/2023,08:{:02},{}", day(i), month(i), minute(i), error_of(i));
  }));
  expect_daily_readings(under("Date,Time,Error (s)", [&](int i) {
    return fmt::format("2023-{:02}-{:02},08:{:02},{}", month(i), day(i), minute(i), error_of(i));
  }));
  expect_daily_readings(under("date,error", [&](int i) {
    return fmt::format("{:02} {} 2023 08:{:02},{}", day(i), names[month(i) - 2], minute(i),
                       error_of(i));
  }));
  expect_daily_readings(under("date,error", [&](int i) { // the month first
    return fmt::format("{:02}/{:02}/2023 08:{:02},{}", month(i), day(i), minute(i), error_of(i));
  }));
}

TEST(HeadersTest, DaysAloneDateReadingsAndNoBeats) {
  const auto days = [](int i) { return fmt::format("2023-{:02}-{:02}", i / 28 + 2, i % 28 + 1); };
  const std::string readings =
      under("date,error", [&](int i) { return days(i) + "," + error_of(i); });
  expect_daily_readings(readings);
  EXPECT_TRUE(says(read_log(readings, "log.csv"), "no time of day"));
  const std::string told = refusal(under("date,flag", [&](int i) { return days(i) + ",1"; }));
  EXPECT_NE(told.find("dates without a time of day"), told.npos) << told;
  EXPECT_NE(told.find("log.csv:2"), told.npos) << told;
  const std::string nameless =
      refusal(under("", [&](int i) { return days(i) + "," + error_of(i); }));
  EXPECT_NE(nameless.find("a known layout"), nameless.npos) << nameless;
  ReadingOptions given;
  given.columns = {"time=1", "error=2"};
  EXPECT_EQ(read_log(under("", [&](int i) { return days(i) + "," + error_of(i); }), "x", given)
                .events.size(),
            static_cast<std::size_t>(lines));
}

TEST(HeadersTest, ADateInAnotherFormIsToldWhichAreRead) {
  const std::string told = refusal(
      under("date,error", [](int i) { return fmt::format("{} brumaire an 2 08:00,1.{}", i, i); }));
  EXPECT_NE(told.find("22 Feb 2013"), told.npos) << told;
}

// The state of a gate at a flag 20 ms wide, which the bob passes 0.999 s and 1.003 s after.
std::string gate_log(std::string_view name, bool covered_at_one) {
  std::string text = fmt::format("Time (s),{}\n", name);
  double middle = 0.5;
  for (int i = 0; i < lines; ++i) {
    text += fmt::format("{:.5f},{}\n{:.5f},{}\n", middle - 0.01, covered_at_one ? 1 : 0,
                        middle + 0.01, covered_at_one ? 0 : 1);
    middle += i % 2 == 0 ? 0.999 : 1.003;
  }
  return text;
}

TEST(HeadersTest, TheStateOfAGateIsTwoEdgesOfAPassage) {
  for (const char* name : {"GateState", "Gate State", "state"})
    for (const bool covered_at_one : {true, false}) {
      SCOPED_TRACE(fmt::format("{} {}", name, covered_at_one));
      const ClockLog log = read_log(gate_log(name, covered_at_one), "gate.csv");
      ASSERT_EQ(log.events.size(), static_cast<std::size_t>(lines));
      EXPECT_TRUE(log.directions_are_open);
      EXPECT_TRUE(says(log, "the state of a light gate"));
      EXPECT_NEAR(log.events[2].time - log.events[0].time, 2.002, rounding_s);
      EXPECT_NEAR(log.columns.width_s[3], 0.02, rounding_s);
    }
}

TEST(HeadersTest, AStateThatIsNoGatesIsNotRead) {
  const auto any = [](int i) {
    return fmt::format("{:.4f},{}", 1e-4 * time_of(i), i % 7 == 0 ? 1 : 0);
  };
  const ClockLog log = read_log(under("time,state", any), "log.csv");
  expect_beats(log);
  EXPECT_EQ(log.events[1].edge, Edge::up);
}

TEST(HeadersTest, ALostEdgeOfAGateCostsItsPassageOnly) {
  std::string text = gate_log("GateState", true);
  const std::size_t line = text.find('\n', text.find('\n', 60) + 1);
  text.erase(line, text.find('\n', line + 1) - line);
  const ClockLog log = read_log(text, "gate.csv");
  EXPECT_EQ(log.events.size(), static_cast<std::size_t>(lines - 1));
  EXPECT_EQ(log.issues.size(), 1u);
}

} // namespace
} // namespace goingrate
