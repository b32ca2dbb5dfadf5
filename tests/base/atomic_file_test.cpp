#include "goingrate/base/atomic_file.hpp"

#include "goingrate/base/errors.hpp"

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <unistd.h>

namespace goingrate {
namespace {

namespace fs = std::filesystem;

class AtomicFileTest : public testing::Test {
protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("goingrate-atomic-" + std::to_string(::getpid()));
    fs::create_directory(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  static std::string content(const fs::path& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  fs::path folder_;
};

TEST_F(AtomicFileTest, WritesAndReplaces) {
  const fs::path target = folder_ / "a.txt";
  write_whole_file(target, "old\n");
  write_whole_file(target, "new\n");
  EXPECT_EQ(content(target), "new\n");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1) << "a draft was left behind";
}

TEST_F(AtomicFileTest, AFailureLeavesTheOldFileAndNoDraft) {
  const fs::path target = folder_ / "taken";
  fs::create_directory(target); // a folder in the way: the rename at the end must fail
  std::ofstream(target / "inside") << "old";
  EXPECT_THROW(write_whole_file(target, "new"), OutputError);
  EXPECT_EQ(content(target / "inside"), "old");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
}

TEST_F(AtomicFileTest, AMissingFolderIsAnOutputError) {
  EXPECT_THROW(write_whole_file(folder_ / "none" / "a.txt", "x"), OutputError);
}

TEST_F(AtomicFileTest, OfSeveralFilesNoneIsReplacedIfOneFails) {
  write_whole_file(folder_ / "a.txt", "old");
  EXPECT_THROW(write_whole_files({{folder_ / "a.txt", "new"}, {folder_ / "none" / "b.txt", "new"}}),
               OutputError);
  EXPECT_EQ(content(folder_ / "a.txt"), "old");
  EXPECT_THROW(write_whole_files({{folder_ / "a.txt", "new"}, {"-", "x"}, {"-", "y"}}),
               ArgumentError);
  EXPECT_EQ(content(folder_ / "a.txt"), "old");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
}

TEST_F(AtomicFileTest, ALinkIsFollowedAndTheModeKept) {
  write_whole_file(folder_ / "real.txt", "old");
  fs::permissions(folder_ / "real.txt", fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink(folder_ / "real.txt", folder_ / "link.txt");
  write_whole_file(folder_ / "link.txt", "new");
  EXPECT_TRUE(fs::is_symlink(folder_ / "link.txt"));
  EXPECT_EQ(content(folder_ / "real.txt"), "new");
  EXPECT_EQ(fs::status(folder_ / "real.txt").permissions(),
            fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(AtomicFileTest, WhatIsReadIsNotReplaced) {
  write_whole_file(folder_ / "log.csv", "measured once");
  fs::create_symlink(folder_ / "log.csv", folder_ / "link.csv");
  keep_input(folder_ / "log.csv");
  EXPECT_THROW(write_whole_file(folder_ / "log.csv", "rates"), ArgumentError);
  EXPECT_THROW(write_whole_file(folder_ / "link.csv", "rates"), ArgumentError);
  EXPECT_THROW(write_whole_files({{folder_ / "a.csv", "x"}, {folder_ / "log.csv", "y"}}),
               ArgumentError);
  EXPECT_EQ(content(folder_ / "log.csv"), "measured once");
  EXPECT_FALSE(fs::exists(folder_ / "a.csv"));
  write_whole_file(folder_ / "b.csv", "rates");
}

TEST_F(AtomicFileTest, ADeviceIsWrittenToAndNotReplaced) {
  write_whole_file("/dev/null", "gone");
  EXPECT_FALSE(fs::is_regular_file("/dev/null"));
}

TEST_F(AtomicFileTest, AFullDeviceIsAnOutputError) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full on this system";
  EXPECT_THROW(write_whole_file("/dev/full", "x"), OutputError);
}

} // namespace
} // namespace goingrate
