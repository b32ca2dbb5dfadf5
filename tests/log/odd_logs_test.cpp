// Logs that are odd but right, as people's programs and spreadsheets write them.
#include "goingrate/log/reading.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

namespace goingrate {
namespace {

struct Odd {
  const char* name;
  std::string header;
  std::string (*line)(int i);
  std::string said; // part of an assumption
};

void PrintTo(const Odd& odd, std::ostream* out) { *out << odd.name; }

constexpr int beats = 40;

// Beats every 2.0001 s, in units of 0.1 ms, from `start` on.
std::string seconds(int i, std::int64_t start = 0, char point = '.') {
  const std::int64_t ticks = start * 10000 + 20001LL * i;
  return fmt::format("{}{}{:04d}", ticks / 10000, point, ticks % 10000);
}

std::string time_of_day(int i, char point = '.') {
  const std::int64_t ticks = (23 * 3600 + 59 * 60) * 10000LL + 20001LL * i;
  const std::int64_t second = ticks / 10000;
  return fmt::format("{:02d}:{:02d}:{:02d}{}{:04d}", second / 3600 % 24, second / 60 % 60,
                     second % 60, point, ticks % 10000);
}

std::string date(int i, const char* before, const char* after) {
  return 20001LL * i >= 600000 ? after : before; // midnight after a minute
}

std::vector<Odd> odd_logs() {
  return {
      {"NumberedLines", "No.  Epoch [s]   Temp\n",
       [](int i) { return fmt::format("{}  {}  21.5", i + 1, seconds(i, 1361576280)); },
       "times are those of column 2, 'Epoch [s]'"},
      {"NumberedLinesWithoutNames", "",
       [](int i) { return fmt::format("{},{},21.5", i, seconds(i)); },
       "times are those of column 2"},
      {"TickCountFirst", "tick count,elapsed seconds\n",
       [](int i) { return fmt::format("{},{}", i, seconds(i)); },
       "times are those of column 2, 'elapsed seconds'"},
      {"ExcelWithDateAndSeconds", "Datum;Zeit (s);Amplitude (mrad)\r\n",
       [](int i) { return fmt::format("22.02.2013;{};46,4\r", seconds(i, 0, ',')); },
       "times are those of column 2, 'Zeit (s)'"},
      {"ExcelWithDateAndTimeOfDay", "Datum;Uhrzeit;Temperatur\r\n",
       [](int i) {
         return fmt::format("{};{};21,5\r", date(i, "28.02.2013", "01.03.2013"),
                            time_of_day(i, ','));
       },
       "with the dates of column 1"},
      {"DateAndTimeColumns", "date,time,temp\n",
       [](int i) {
         return fmt::format("{},{},21.5", date(i, "2013-02-28", "2013-03-01"), time_of_day(i));
       },
       "with the dates of column 1"},
      {"DateAndTimeColumnsWithoutNames", "",
       [](int i) {
         return fmt::format("{};{};21.5", date(i, "2013/02/28", "2013/03/01"), time_of_day(i));
       },
       "with the dates of column 1"},
      {"DayFirst", "",
       [](int i) {
         return fmt::format("{} {}", date(i, "28.02.2013", "01.03.2013"), time_of_day(i));
       },
       "one time per line"},
      {"TabsAndBlanksMixed", "",
       [](int i) { return fmt::format("{}{}21.5{}46.4", seconds(i), i % 2 ? "\t" : "  ", " \t"); },
       "2 other columns are not read"},
      {"BlanksBehind", "", [](int i) { return seconds(i) + "   \t "; }, "one time per line"},
      {"SeparatorBehind", "time_s,amplitude_rad,\n", [](int i) { return seconds(i) + ",0.05,"; },
       "a list of crossings"},
      {"NameOfTwoWords", "Time (s)\n# by hand\n", [](int i) { return seconds(i); }, "columns"},
      {"CommentsAndBlankLines", "\n\n",
       [](int i) { return (i == 20 ? "# checked\n\n" : "") + seconds(i); }, "one time per line"},
      {"CarriageReturnTwice", "", [](int i) { return seconds(i) + "\r\r"; }, "one time per line"},
      {"PipesAround", "| n | time | amp |\n",
       [](int i) { return fmt::format("| {} | {} | 46.4 |", i, seconds(i)); },
       "times are those of column 3, 'time'"},
      {"LatinMicroseconds",
       "Zeit (\xb5s);Temp (\xb0"
       "C)\n",
       [](int i) { return fmt::format("{};21,5", 2000100 * i); }, "column 1, 'Zeit (\\xb5s)'"},
      {"TwoTimes", "time (s),time received (s)\n",
       [](int i) { return seconds(i) + "," + seconds(i, 7); }, "an earlier one says the same"},
      {"HoleOfNuls", "",
       [](int i) { return (i == 20 ? std::string(512, '\0') + "\n" : "") + seconds(i); },
       "one time per line"},
  };
}

class OddLogs : public testing::TestWithParam<Odd> {};

TEST_P(OddLogs, AreReadRightly) {
  const Odd& odd = GetParam();
  std::string text = odd.header;
  for (int i = 0; i < beats; ++i)
    text += odd.line(i) + "\n";
  const ClockLog log = read_log(text, "odd.log");
  EXPECT_TRUE(std::any_of(log.assumptions.begin(), log.assumptions.end(), [&](const Assumption& a) {
    return a.text.find(odd.said) != a.text.npos;
  })) << log.assumptions.front().text;
  EXPECT_EQ(log.issues.empty(), std::string_view(odd.name) != "HoleOfNuls");
  ASSERT_EQ(log.events.size(), static_cast<std::size_t>(beats));
  for (int i = 1; i < beats; ++i)
    ASSERT_NEAR(log.events[static_cast<std::size_t>(i)].time - log.events[0].time, 2.0001 * i,
                1e-9);
}

INSTANTIATE_TEST_SUITE_P(Logs, OddLogs, testing::ValuesIn(odd_logs()),
                         [](const auto& entry) { return std::string(entry.param.name); });

TEST(OddLogsTest, DirectionsHaveManyNames) {
  for (const auto& [up, down] : std::initializer_list<std::pair<const char*, const char*>>{
           {"up", "down"}, {"R", "L"}, {"Right", "Left"}, {"1", "0"}, {"tick", "tock"}}) {
    std::string text = "Time (s),Direction\n";
    for (int i = 0; i < beats; ++i)
      text += fmt::format("{}.{:04d},{}\n", i, i % 7, i % 2 ? down : up);
    const ClockLog log = read_log(text, "odd.log");
    ASSERT_EQ(log.events.size(), static_cast<std::size_t>(beats));
    EXPECT_EQ(log.events[0].edge, Edge::up);
    EXPECT_EQ(log.events[1].edge, Edge::down) << down;
  }
}

TEST(OddLogsTest, NinesWithinTheRangeOfAColumnAreValues) {
  // A swing of 14.5 degrees, whose samples fall on 9.999 and -9.999; and 99.99, which none can be.
  const auto angles = [](std::string_view at_250) {
    std::string text = "Time (s);Angle (deg)\n";
    for (int i = 0; i < 400; ++i)
      text += fmt::format("{:.2f};{}\n", 0.05 * i,
                          i == 100   ? "9.999"
                          : i == 150 ? "-9.999"
                          : i == 250 ? std::string(at_250)
                                     : fmt::format("{:.3f}", 14.5 * std::sin(0.155 * i)));
    return text;
  };
  EXPECT_TRUE(read_log(angles("9.999"), "x").issues.empty());
  const ClockLog marked = read_log(angles("99.99"), "x");
  ASSERT_EQ(marked.issues.size(), 1U);
  EXPECT_EQ(marked.issues[0].line, 252U);
}

TEST(OddLogsTest, APeriodOfNinesIsOneAmongItsLike) {
  std::string periods, errors;
  for (int i = 0; i < 60; ++i) {
    periods += i == 30   ? "9.999\n"
               : i == 40 ? "9999\n"
                         : fmt::format("{:.3f}\n", 9.998 + 1e-3 * (i * i % 5));
    errors += fmt::format("{} {} {}\n", 1364774400 + 2 * i,
                          i == 30 ? "9.999" : fmt::format("{:.3f}", 9.9 + 2e-3 * i),
                          i == 20 ? "9999.999" : "46.4");
  }
  const ClockLog log = read_log(periods, "x");
  ASSERT_EQ(log.events.size(), 60U);
  EXPECT_NEAR(log.events[30].time - log.events[29].time, 9.999, 1e-12); // a rounding of 600 s
  ASSERT_EQ(log.issues.size(), 1U);
  EXPECT_EQ(log.issues[0].line, 41U);
  const ClockLog read = read_log(errors, "x");
  EXPECT_EQ(read.events.size(), 60U);
  EXPECT_TRUE(std::isnan(read.events[20].amplitude_rad));
}

TEST(OddLogsTest, ManyScatteredFaultsOfOneKindAreOneIssue) {
  std::string text;
  constexpr int lines = 5000;
  for (int i = 0; i < lines; ++i)
    text += i % 3 == 2 ? "x\n" : fmt::format("{}\n", 2 * i);
  const ClockLog log = read_log(text, "odd.log");
  EXPECT_LE(log.issues.size(), 502U);
  std::size_t told = 0;
  for (const LineIssue& issue : log.issues)
    told += issue.lines;
  EXPECT_EQ(told, static_cast<std::size_t>(lines / 3)) << "none is forgotten";
  EXPECT_TRUE(log.issues.back().scattered);
  EXPECT_EQ(log.issues.back().last_line, static_cast<std::size_t>(lines / 3 * 3));
}

} // namespace
} // namespace goingrate
