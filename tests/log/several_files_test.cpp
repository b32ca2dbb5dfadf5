// Several files of one clock, against the same lines in one file.
#include "goingrate/log/beats.hpp"
#include "goingrate/log/reading.hpp"

#include "goingrate/base/errors.hpp"
#include "support/real_data.hpp"
#include "support/scratch_folder.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <gtest/gtest.h>

namespace goingrate {
namespace {

// A log as lines, and the header that each of its files has.
struct Lines {
  const char* name;
  std::string header;
  std::string (*line)(int);
};

constexpr int lines_in_all = 900;

std::string date_and_time(int i) { // 3.0002 s a beat, over midnight
  const long long ticks = 85000LL * 10000 + 30002LL * i + (i * 37) % 7;
  const long long s = ticks / 10000;
  return fmt::format("2013-03-{:02} {:02}:{:02}:{:02}.{:04}", 30 + s / 86400, s / 3600 % 24,
                     s / 60 % 60, s % 60, ticks % 10000);
}

const std::vector<Lines>& kinds() {
  static const std::vector<Lines> all{
      {"UnixSeconds", "",
       [](int i) { return fmt::format("{}.{:06}", 1361605080 + 2 * i, 100 + (i * 37) % 11); }},
      {"Dates", "# a comment\n", date_and_time},
      {"ClockErrors", "",
       [](int i) { // every 100th label is doubled, the next one missing: mended across files too
         const int label = i % 100 == 1 ? i - 1 : i;
         return fmt::format("{} {:.6f} 46.4", 1364774403 + 3 * label, -1.2 - 1e-6 * (i % 7));
       }},
      {"Table", "time,temperature C\n",
       [](int i) { return fmt::format("{},{:.2f}", date_and_time(i), 20.0 + 0.01 * (i % 50)); }},
      {"NoDates", "", [](int i) { return fmt::format("{:.6f}", 5.0 + 1.0001 * i); }},
      {"Periods", "", [](int i) { return fmt::format("{:.6f}", 1.0001 + 1e-6 * (i % 13)); }},
      {"Frequencies", "% f\n",
       [](int i) { return fmt::format("{:.4e}", 1e-6 * ((i * 7) % 5 - 2)); }},
      {"Angles", "Time (s),Angle (rad)\n",
       [](int i) { return fmt::format("{:.3f},{:.6f}", 0.1 * i, 0.1 * std::cos(0.31 * i)); }},
  };
  return all;
}

void expect_same(const ClockLog& parts, const ClockLog& whole) {
  EXPECT_EQ(parts.format, whole.format);
  ASSERT_EQ(parts.events.size(), whole.events.size());
  const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };
  for (std::size_t i = 0; i < whole.events.size(); ++i) {
    const Beat &part = parts.events[i], &event = whole.events[i];
    ASSERT_EQ(part.time, event.time) << i;
    ASSERT_EQ(bits(part.amplitude_rad), bits(event.amplitude_rad)) << i;
    ASSERT_EQ(part.edge, event.edge) << i;
    ASSERT_EQ(part.cycle, event.cycle) << i;
  }
  EXPECT_EQ(parts.columns.temperature_c, whole.columns.temperature_c);
  EXPECT_EQ(parts.columns.sigma_s, whole.columns.sigma_s);
  EXPECT_EQ(parts.nominal_period_s, whole.nominal_period_s);
  EXPECT_EQ(parts.issues.size(), whole.issues.size());
  ASSERT_EQ(parts.grid.has_value(), whole.grid.has_value());
  if (whole.grid) {
    EXPECT_EQ(parts.grid->phase_s, whole.grid->phase_s);
  }
}

class SeveralFilesTest : public test::ScratchFolderTest {
protected:
  [[nodiscard]] std::string refusal(const std::vector<std::string>& paths) const {
    try {
      (void)read_log_files(paths);
    } catch (const InputError& error) {
      return error.what();
    }
    return "read";
  }
  static bool says(const ClockLog& log, const std::string& words) {
    return std::any_of(log.assumptions.begin(), log.assumptions.end(),
                       [&](const Assumption& a) { return a.text.find(words) != a.text.npos; });
  }
  // Beats every `period_s` from `first` on, `count` of them.
  static std::string beats(double first, int count, double period_s = 2.0) {
    std::string text;
    for (int i = 0; i < count; ++i)
      text += fmt::format("{:.6f}\n", first + period_s * i + 1e-6 * ((i * 7) % 5));
    return text;
  }
};

TEST_F(SeveralFilesTest, AreReadAsOneFileIs) {
  ReadingOptions options;
  for (const Lines& kind : kinds()) {
    SCOPED_TRACE(kind.name);
    options.tau0_s = std::string(kind.name) == "Frequencies" ? std::optional(1.0) : std::nullopt;
    if (options.tau0_s) options.format = LogFormat::frequency;
    std::string whole = kind.header;
    std::vector<std::string> parts(3, kind.header);
    for (int i = 0; i < lines_in_all; ++i) {
      const std::string line = kind.line(i) + "\n";
      whole += line;
      parts[i < 200 ? 0 : i < 701 ? 1 : 2] += line; // 701: between a doubled label and its gap
    }
    const std::string folder = std::string(kind.name) + "/";
    std::filesystem::create_directories(folder_ / kind.name);
    std::vector<std::string> paths;
    for (std::size_t k = 0; k < parts.size(); ++k) {
      paths.push_back(path(fmt::format("{}day{}.txt", folder, k)));
      put(fmt::format("{}day{}.txt", folder, k), parts[k]);
    }
    const ClockLog one = read_log(whole, "whole", options);
    expect_same(read_log_files(paths, options), one);
    expect_same(read_log_files({path(kind.name)}, options), one);
    const bool dated = one.events.front().time.seconds > 100'000'000;
    if (dated) expect_same(read_log_files({paths[2], paths[0], paths[1]}, options), one);
    options = {};
  }
}

TEST_F(SeveralFilesTest, OverlapsAndCopiesAreRefused) {
  put("a.txt", beats(1.5e9, 100));
  put("b.txt", beats(1.5e9 + 150.0, 100));
  put("c.txt", beats(1.5e9, 100));
  EXPECT_NE(refusal({path("a.txt"), path("b.txt")}).find("b.txt:1:1: found times that overlap"),
            std::string::npos)
      << refusal({path("a.txt"), path("b.txt")});
  EXPECT_NE(refusal({path("a.txt"), path("c.txt")}).find("c.txt:1:1: found the same times as in"),
            std::string::npos)
      << refusal({path("a.txt"), path("c.txt")});
}

TEST_F(SeveralFilesTest, CopiesAreRefusedWithoutDatesToo) {
  put("a.txt", beats(0.5, 100));
  put("b.txt", beats(0.5, 100));
  EXPECT_NE(refusal({path("a.txt"), path("b.txt")}).find("the same times as in"),
            std::string::npos);
  EXPECT_THROW((void)read_log_files({path("a.txt"), folder_.string() + "/./a.txt"}), ArgumentError);
}

TEST_F(SeveralFilesTest, RecordingsOfAnAngleThatOverlapAreRefused) {
  std::string text = "Time (s),Angle (rad)\n";
  for (int i = 0; i < 400; ++i)
    text += fmt::format("{:.3f},{:.6f}\n", 0.1 * i, 0.1 * std::cos(0.31 * i));
  put("a.csv", text);
  put("b.csv", text + "40.000,0.1\n");
  EXPECT_NE(refusal({path("a.csv"), path("b.csv")}).find("times that overlap"), std::string::npos)
      << refusal({path("a.csv"), path("b.csv")});
}

TEST_F(SeveralFilesTest, DatesAndNoDatesAreRefused) {
  put("a.txt", beats(1.5e9, 100));
  put("b.txt", beats(10.0, 100));
  const std::string text = refusal({path("a.txt"), path("b.txt")});
  EXPECT_NE(text.find("b.txt:1:1: found times without a date"), std::string::npos) << text;
}

TEST_F(SeveralFilesTest, BouncesAndBothDirectionsAreNoOtherClock) {
  std::string bouncing, both;
  for (int i = 0; i < 200; ++i) {
    bouncing += fmt::format("{0:.6f}\n{1:.6f}\n{2:.6f}\n", 1.5e9 + 2.0 * i, 1.5e9 + 2.0 * i + 0.003,
                            1.5e9 + 2.0 * i + 0.004 + 0.001 * (i % 3));
    both += fmt::format("{:.6f}\n{:.6f}\n", 1.5e9 + 2000.0 + 2.0 * i, 1.5e9 + 2000.92 + 2.0 * i);
  }
  put("a.txt", beats(1.5e9 - 1000.0, 100));
  put("b.txt", bouncing);
  put("c.txt", both);
  EXPECT_EQ(read_log_files({path("a.txt"), path("b.txt"), path("c.txt")}).events.size(), 1100u);
}

TEST_F(SeveralFilesTest, AHeaderInTheFirstFileIsThatOfAll) {
  std::string lines;
  for (int i = 0; i < 100; ++i)
    lines +=
        fmt::format("{:.6f},{:.2f},{:.4f}\n", 1.5e9 + 2.0 * i, 20.0 + 0.01 * i, 0.04 + 1e-6 * i);
  const std::string header = "time,temperature C,amplitude rad\n";
  const std::size_t cut = lines.find('\n', lines.size() / 2) + 1;
  const std::size_t last = lines.rfind('\n', lines.size() - 2) + 1; // a file of one line
  put("x1", header + lines.substr(0, cut));
  put("x2", lines.substr(cut, last - cut));
  put("x3", lines.substr(last));
  expect_same(read_log_files({folder_.string()}), read_log(header + lines, "whole"));
}

TEST_F(SeveralFilesTest, WhatAFileDoesNotHoldIsUnknownInIt) {
  std::string text = "time,width ms\n";
  for (int i = 0; i < 100; ++i)
    text += fmt::format("{:.6f},{}\n", 1.5e9 + 2.0 * (i == 50 ? 51 : i == 51 ? 50 : i), 30.5);
  put("a.csv", text); // two lines interchanged
  put("b.txt", beats(1.5e9 + 1000.0, 100));
  const ClockLog log = read_log_files({path("a.csv"), path("b.txt")});
  ASSERT_EQ(log.columns.width_s.size(), 200u);
  EXPECT_TRUE(std::isnan(log.columns.width_s.back()));
  for (std::size_t i = 1; i < log.events.size(); ++i)
    EXPECT_LT(log.events[i - 1].time, log.events[i].time) << i;
}

TEST_F(SeveralFilesTest, AFaultEndsWithItsFile) {
  put("a.txt", beats(1.5e9, 100) + "x\n");
  put("b.txt", beats(1.5e9 + 1000.0, 50) + "x\ny\n" + beats(1.5e9 + 1200.0, 50));
  put("c.txt", "z\n" + beats(1.5e9 + 2000.0, 50));
  const ClockLog log = read_log_files({path("a.txt"), path("b.txt"), path("c.txt")});
  for (const LineIssue& issue : log.issues)
    EXPECT_EQ(log.place(issue.line).file, log.place(issue.last_line).file);
}

TEST_F(SeveralFilesTest, AnotherClockIsRefused) {
  put("a.txt", beats(1.5e9, 100));
  put("b.txt", beats(1.5e9 + 1000.0, 100, 1.5));
  const std::string text = refusal({path("a.txt"), path("b.txt")});
  EXPECT_NE(text.find("b.txt: found beats 1.5 s apart"), std::string::npos) << text;
}

TEST_F(SeveralFilesTest, TheWeatherInAFolderIsToldAndNoLog) {
  std::string day, weather = "timestamp,temperature_c,pressure_hpa\n";
  for (int i = 0; i < 600; ++i)
    day += fmt::format("2026-03-01 10:{:02}:{:02}.125\n", 2 * i / 60 % 60, 2 * i % 60);
  for (int i = 0; i < 8; ++i)
    weather += fmt::format("2026-03-01 {:02}:{:02}:00,{:.1f},1013.2\n", 10 + i / 6, 10 * (i % 6),
                           18.0 + 0.1 * i);
  std::filesystem::create_directory(path("room"));
  std::ofstream(path("room/day.txt")) << day;
  std::ofstream(path("room/weather.csv")) << weather;
  const ClockLog log = read_log_files({path("room")});
  EXPECT_EQ(log.events.size(), 600u);
  const auto told = std::find_if(log.assumptions.begin(), log.assumptions.end(),
                                 [](const Assumption& a) { return a.setting == Setting::weather; });
  ASSERT_NE(told, log.assumptions.end());
  EXPECT_EQ(told->value, path("room/weather.csv"));
}

TEST_F(SeveralFilesTest, WhatIsNoLogInAFolderIsLeftOutAndTold) {
  put("a.txt", beats(1.5e9, 100));
  put("b.txt", beats(1.5e9 + 1000.0, 100));
  put("notes.md", "# Notes\n\nWound on Monday, and the hands were set.\n");
  put(".hidden", "x\n");
  const ClockLog log = read_log_files({folder_.string()});
  EXPECT_EQ(log.events.size(), 200u);
  EXPECT_EQ(log.files.size(), 2u);
  EXPECT_TRUE(says(log, "left out as no log: " + path("notes.md")));
  EXPECT_TRUE(says(log, "2 files are one log, in the order of their dates: a.txt, b.txt"));
  EXPECT_NE(refusal({path("a.txt"), path("notes.md")}).find("notes.md"), std::string::npos)
      << "a file that is named is not left out";
}

TEST_F(SeveralFilesTest, ALineIsToldInItsFile) {
  put("a.txt", beats(1.5e9, 100));
  put("b.txt", beats(1.5e9 + 1000.0, 50) + "nothing\n" + beats(1.5e9 + 1100.0, 50));
  const ClockLog log = read_log_files({path("a.txt"), path("b.txt")});
  ASSERT_EQ(log.issues.size(), 1u);
  const TextPlace place = log.place(log.issues[0].line);
  EXPECT_EQ(place.file, path("b.txt"));
  EXPECT_EQ(place.line, 51u);
}

TEST_F(SeveralFilesTest, ALoggerMayGetAnotherColumn) {
  put("a.txt", beats(1.5e9, 100));
  std::string text = "time,temperature C\n";
  for (int i = 0; i < 100; ++i)
    text += fmt::format("{:.6f},{}\n", 1.5e9 + 1000.0 + 2.0 * i, 20.5);
  put("b.txt", text);
  const ClockLog log = read_log_files({path("a.txt"), path("b.txt")});
  ASSERT_EQ(log.events.size(), 200u);
  ASSERT_EQ(log.columns.temperature_c.size(), 200u);
  EXPECT_TRUE(std::isnan(log.columns.temperature_c[99]));
  EXPECT_EQ(log.columns.temperature_c[100], 20.5);
}

TEST_F(SeveralFilesTest, AGapBetweenFilesIsAGap) {
  put("a.txt", beats(1.5e9, 1000));
  put("b.txt", beats(1.5e9 + 2.0 * 1010, 1000)); // ten beats later
  const Beats numbered = number_beats(read_log_files({path("a.txt"), path("b.txt")}));
  EXPECT_EQ(numbered.segments, 1u);
  EXPECT_EQ(numbered.missed, 10);
}

TEST_F(SeveralFilesTest, StandardInputIsNoneOfSeveral) {
  put("a.txt", beats(1.5e9, 100));
  EXPECT_THROW((void)read_log_files({path("a.txt"), "-"}), ArgumentError);
}

TEST_F(SeveralFilesTest, TheTrinityDaysAsAFolderAreThoseOfOneFile) {
  const auto folder = test::real_data("trinity-clock");
  if (!folder) GTEST_SKIP() << "the Trinity clock's logs are not beside the project";
  std::string whole;
  for (const char* day : {"clock2013-03-30.txt", "clock2013-03-31.txt"})
    whole += read_text((*folder / day).string());
  const ClockLog parts = read_log_files({folder->string()});
  EXPECT_EQ(parts.files.size(), 2u);
  expect_same(parts, read_log(whole, "whole"));
}

} // namespace
} // namespace goingrate
