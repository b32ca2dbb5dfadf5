#include "file_position.hpp"

#include "goingrate/log/reading.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>

namespace goingrate::apps {
namespace {

class FilePositionTest : public testing::Test {
protected:
  void SetUp() override {
    folder_ = testing::TempDir() + "files-" +
              testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    log_ = folder_ + "/clock.log";
    write(log_, 0, 300);
    FilePosition position(folder_);
    for (std::uint32_t line = 1; line <= 300; ++line)
      position.took(log_, line);
    position.save();
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  static void write(const std::string& path, int from, int to) {
    std::ofstream file(path, std::ios::app);
    for (int n = from; n < to; ++n)
      file << 1764201600 + n << ".25\n";
  }
  // The parts as NAME:LINES.
  [[nodiscard]] std::string parts() const {
    std::string text;
    for (const auto& part : FilePosition(folder_).parts_of(log_))
      text += std::filesystem::path(part.path).filename().string() + ":" +
              std::to_string(part.known_lines) + " ";
    return text;
  }
  std::string folder_, log_;
};

TEST_F(FilePositionTest, GoesOnInTheSameFile) {
  EXPECT_EQ(parts(), "clock.log:300 ");
  write(log_, 300, 310);
  EXPECT_EQ(parts(), "clock.log:300 ");
}

TEST_F(FilePositionTest, ReadsWhatWasRotatedFirst) {
  write(log_, 300, 310);
  std::filesystem::rename(log_, log_ + ".1");
  write(log_, 310, 700);
  EXPECT_EQ(parts(), "clock.log.1:300 clock.log:0 ");
  std::filesystem::rename(log_ + ".1", log_ + ".2");
  std::filesystem::rename(log_, log_ + ".1");
  EXPECT_EQ(parts(), "clock.log.2:300 clock.log.1:0 clock.log:0 ");
}

TEST_F(FilePositionTest, ReadsACopyThatWasMadeBeforeTheFileWasCutOff) {
  std::filesystem::copy(log_, log_ + ".1");
  std::filesystem::resize_file(log_, 0);
  write(log_, 310, 700);
  EXPECT_EQ(parts(), "clock.log.1:300 clock.log:0 ");
}

TEST_F(FilePositionTest, ReadsAnotherFileFromItsBeginning) {
  std::filesystem::remove(log_);
  write(log_, 310, 700);
  EXPECT_EQ(parts(), "clock.log:0 ");
}

// A line without an end, as of a disk full of zeros, is not the end of the log.
TEST_F(FilePositionTest, ALineThatIsTooLongIsCutAndReported) {
  std::ofstream(log_, std::ios::app) << std::string(40 << 20, 'x') << '\n';
  write(log_, 300, 310);
  LogFollower log(log_, {}, [](std::string_view) { return false; });
  int events = 0;
  while (log.next())
    ++events;
  EXPECT_EQ(events, 310);
  ASSERT_EQ(log.log().issues.size(), 1U);
  EXPECT_EQ(log.log().issues[0].line, 301U);
}

TEST_F(FilePositionTest, ALineThatIsTooLongBeforeTheLayoutIsKnownIsCut) {
  for (const std::size_t lines_before : {0, 5}) {
    std::filesystem::remove(log_);
    write(log_, 0, static_cast<int>(lines_before));
    std::ofstream(log_, std::ios::app) << std::string(40 << 20, 'x') << '\n';
    write(log_, 5, 300);
    LogFollower log(log_, {}, [](std::string_view) { return false; });
    std::size_t events = 0;
    while (log.next())
      ++events;
    EXPECT_EQ(events, lines_before + 295);
  }
}

// Also behind the events that are not kept in memory any more.
TEST_F(FilePositionTest, WhatALineTellsBesideItsTimeIsHandedOut) {
  {
    std::ofstream file(log_, std::ios::trunc);
    file
        << "# goingrate log: 1\ntime_s,edge,width_s,temperature_c,pressure_mbar,humidity_percent\n";
    for (int n = 0; n < 10000; ++n)
      file << 1764201600 + n << ".25,up," << (n % 7 == 0 ? "" : "0.01") << ',' << 20 + n % 10
           << ",101" << n % 10 << ",4" << n % 10 << '\n';
  }
  LogFollower log(log_, {}, [](std::string_view) { return false; });
  int n = 0;
  for (; log.next(); ++n) {
    const EventValues values = log.values();
    ASSERT_EQ(std::isnan(values.width_s), n % 7 == 0) << n;
    ASSERT_EQ(values.temperature_c, 20 + n % 10) << n;
    ASSERT_EQ(values.pressure_mbar, 1010 + n % 10) << n;
    ASSERT_EQ(values.humidity_percent, 40 + n % 10) << n;
  }
  EXPECT_EQ(n, 10000);
}

TEST_F(FilePositionTest, IssuesOfALogThatIsFollowedDoNotGrowForEver) {
  {
    std::ofstream file(log_, std::ios::app);
    for (int n = 300; n < 1'000'000; ++n) // of the bad ones each is an issue of its own
      if (n % 20 == 0)
        file << "gar" << n << "bage\n";
      else
        file << 1764201600 + n << ".25\n";
  }
  LogFollower log(log_, {}, [](std::string_view) { return false; });
  while (log.next()) {
  }
  EXPECT_LE(log.log().issues.size(), 20'100U); // and one of each kind
}

} // namespace
} // namespace goingrate::apps
