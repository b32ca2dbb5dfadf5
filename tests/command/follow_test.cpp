// `goingrate rate --follow` where a log does not simply grow.
#include "support/command_fixture.hpp"
#include "support/sanitizers.hpp"

#include <chrono>
#include <signal.h>
#include <sstream>
#include <thread>
#include <vector>

namespace goingrate::test {
namespace {

namespace fs = std::filesystem;

std::string beats(int count, double start, double period = 2.0001) {
  std::string text;
  for (int i = 0; i < count; ++i)
    text += fmt::format("{:.6f}\n", start + period * i);
  return text;
}

class FollowTest : public CommandTest {
protected:
  void TearDown() override {
    if (child_ > 0) stop();
    CommandTest::TearDown();
  }

  // Follows a.log in the background.
  void start() {
    fs::remove(folder_ / "rows.csv");
    child_ = ::fork();
    if (child_ == 0) {
      const std::string line =
          fmt::format("cd '{}' && exec '{}' rate a.log --follow > rows.csv 2> notes.txt",
                      folder_.string(), GOINGRATE_COMMAND);
      ::execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
      ::_exit(127);
    }
  }
  void stop() {
    ::kill(child_, SIGTERM);
    ::waitpid(child_, nullptr, 0);
    child_ = 0;
  }
  void append(const std::string& text) const {
    std::ofstream(folder_ / "a.log", std::ios::app | std::ios::binary) << text;
  }
  [[nodiscard]] std::vector<std::string> rows() const {
    std::istringstream in(content(folder_ / "rows.csv"));
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);)
      lines.push_back(line);
    return lines;
  }
  // Whether there are `count` rows of beats within five seconds.
  [[nodiscard]] bool has_rows(std::size_t count) const {
    for (int tenths = 0; tenths < 50 && rows().size() < count + 1; ++tenths)
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    return rows().size() >= count + 1;
  }
  // Cycles without a gap from 0 on, each once, and the times as they stand in the logs.
  void expect_rows(const std::vector<std::string>& logs) const {
    std::string times;
    for (const std::string& log : logs)
      times += log;
    std::istringstream expected(times);
    const auto lines = rows();
    std::size_t i = 1;
    for (std::string time; std::getline(expected, time); ++i) {
      ASSERT_LT(i, lines.size()) << content(folder_ / "notes.txt");
      ASSERT_EQ(lines[i].substr(0, lines[i].find(',', lines[i].find(',') + 1)),
                fmt::format("{},{}000", i - 1, time))
          << lines[i];
    }
    EXPECT_EQ(lines.size(), i) << lines.back();
  }

  pid_t child_ = 0;
};

TEST_F(FollowTest, AFileThatIsCutOffAndWrittenAnewGoesOn) {
  put("a.log", beats(30, 100.0));
  start();
  ASSERT_TRUE(has_rows(30));
  put("a.log", beats(2, 160.003)); // shorter
  ASSERT_TRUE(has_rows(32));
  append(beats(10, 164.0032));
  ASSERT_TRUE(has_rows(42));
  put("a.log", beats(40, 184.0042)); // longer, at once
  ASSERT_TRUE(has_rows(82)) << content(folder_ / "notes.txt");
  stop();
  expect_rows({beats(82, 100.0)});
}

TEST_F(FollowTest, AFileThatIsRenamedAndCreatedAnewGoesOn) {
  const std::string head = "# goingrate log: 1\n# nominal_period_s: 2\ntime_s\n";
  put("a.log", head + beats(30, 100.0));
  start();
  ASSERT_TRUE(has_rows(30));
  fs::rename(folder_ / "a.log", folder_ / "a.log.1");
  std::this_thread::sleep_for(std::chrono::milliseconds(500)); // there is none for a while
  put("a.log", head + beats(1, 160.003));
  ASSERT_TRUE(has_rows(31)) << "the first line of the new one";
  append(beats(9, 162.0031));
  ASSERT_TRUE(has_rows(40));
  put("b.log", beats(20, 180.004)); // without the header
  fs::rename(folder_ / "b.log", folder_ / "a.log");
  EXPECT_TRUE(has_rows(60));
  stop();
  expect_rows({beats(60, 100.0)});
}

TEST_F(FollowTest, ANewFileOfAnotherLayoutIsRead) {
  put("a.log", beats(30, 100.0));
  start();
  ASSERT_TRUE(has_rows(30));
  std::istringstream plain(beats(20, 160.003));
  std::string table = "number;time (s)\n";
  for (std::string time; std::getline(plain, time);)
    table += fmt::format("7;{}\n", time);
  put("b.log", table);
  fs::rename(folder_ / "b.log", folder_ / "a.log");
  EXPECT_TRUE(has_rows(50)) << content(folder_ / "notes.txt");
  stop();
  expect_rows({beats(50, 100.0)});
}

TEST_F(FollowTest, ASourceThatBeginsAgainIsANewSegmentWhoseCyclesGoOn) {
  put("a.log", beats(250, 50000.0)); // since fourteen hours: no midnight
  start();
  ASSERT_TRUE(has_rows(250));
  append("Booting...\nready\n" + beats(10, 0.5));
  ASSERT_TRUE(has_rows(260));
  append(beats(20, 20.501));
  ASSERT_TRUE(has_rows(280));
  append(beats(500, 0.25)); // and once more, all of it at once
  ASSERT_TRUE(has_rows(780));
  stop();
  expect_rows({beats(250, 50000.0), beats(10, 0.5), beats(20, 20.501), beats(500, 0.25)});
  const auto lines = rows();
  EXPECT_TRUE(lines[251].ends_with(",,,,,split")) << lines[251];
  EXPECT_TRUE(lines[281].ends_with(",,,,,split")) << lines[281];
  EXPECT_NE(lines[252].find(",2.0001,"), std::string::npos) << lines[252];
}

TEST_F(FollowTest, WhatALoggerSaysBeforeItsFirstBeatIsPassedOver) {
  for (const char* line : {"load:0x3fff0030,len:1184", "booting the logger", "115200 8 N 1"}) {
    put("a.log", "");
    start();
    for (int i = 0; i < 12; ++i) {
      append(fmt::format("{}\n", line));
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    append(beats(8, 50.0));
    EXPECT_TRUE(has_rows(8)) << line << '\n' << content(folder_ / "notes.txt");
    append(beats(30, 66.0008));
    EXPECT_TRUE(has_rows(38));
    stop();
    expect_rows({beats(38, 50.0)});
  }
}

TEST_F(FollowTest, GarbageInTheMiddleIsPassedOver) {
  std::string words, numbers, bytes;
  for (int i = 0; i < 60; ++i) {
    words += fmt::format("E ({}) sensor: i2c {}\n", 7 * i, i);
    numbers += fmt::format("{}\n", (i * 7919) % 10007 * 31);
    bytes += std::string(static_cast<std::size_t>(i % 7) + 1, static_cast<char>(i + 1)) + "\n";
  }
  for (const std::string& garbage : {words, numbers, bytes}) {
    put("a.log", beats(50, 100.0));
    start();
    ASSERT_TRUE(has_rows(50));
    append(garbage);
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    append(beats(50, 200.005));
    EXPECT_TRUE(has_rows(100)) << garbage;
    stop();
    expect_rows({beats(100, 100.0)});
  }
}

TEST_F(FollowTest, BeatsThatGarbageTookTheirPlaceAreMissed) {
  put("a.log", beats(50, 100.0) + "1e9\n7\n99999\n" + beats(50, 220.006));
  start();
  EXPECT_TRUE(has_rows(101));
  stop();
  const auto lines = rows();
  EXPECT_EQ(lines[51], "50,,,,,,missed");
  EXPECT_EQ(lines.back().substr(0, 10), "109,318.01") << lines.back();
}

TEST_F(FollowTest, AWeeksBacklogTakesSeconds) {
  GOINGRATE_NEEDS_THE_USUAL_PACE();
  constexpr int week = 302400;
  put("a.log", beats(week, 1000.0));
  const auto began = std::chrono::steady_clock::now();
  start();
  const auto takes = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  };
  const std::string last = fmt::format("\n{},", week - 1);
  while (takes() < 30.0 && content(folder_ / "rows.csv").find(last) == std::string::npos)
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_LT(takes(), 5.0);
  append(beats(1, 1000.0 + 2.0001 * week));
  EXPECT_TRUE(has_rows(week + 1));
}

} // namespace
} // namespace goingrate::test
