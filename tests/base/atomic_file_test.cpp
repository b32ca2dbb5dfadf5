#include "goingrate/base/atomic_file.hpp"

#include "goingrate/base/errors.hpp"

#include <array>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <set>
#include <stdexcept>
#include <sys/wait.h>
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

  [[nodiscard]] std::set<std::string> names() const {
    std::set<std::string> all;
    for (const auto& entry : fs::directory_iterator(folder_))
      all.insert(entry.path().filename());
    return all;
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

TEST_F(AtomicFileTest, WhatCannotBeWrittenIsKnownBeforehand) {
  write_whole_file(folder_ / "a.txt", "old");
  EXPECT_NO_THROW(check_writable({folder_ / "a.txt", folder_ / "b.txt", "", "-", "/dev/null"}));
  EXPECT_THROW(check_writable({folder_ / "b.txt", folder_ / "none" / "b.txt"}), OutputError);
  EXPECT_THROW(check_writable({folder_ / "b.txt", folder_ / "b.txt"}), ArgumentError);
  EXPECT_EQ(content(folder_ / "a.txt"), "old");
  EXPECT_EQ(names(), (std::set<std::string>{"a.txt"}));
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

TEST_F(AtomicFileTest, WhatWasReplacedBeforeAFailureIsPutBack) {
  write_whole_file(folder_ / "a.txt", "old");
  std::vector<StreamedFile> files;
  for (const char* name : {"a.txt", "new.txt", "b.txt", "c.txt"}) {
    files.emplace_back(folder_ / name);
    files.back().text() = "new";
  }
  fs::create_directory(folder_ / "b.txt"); // after it was looked at: its rename must fail
  EXPECT_THROW(commit_all(files), OutputError);
  files.clear();
  EXPECT_EQ(content(folder_ / "a.txt"), "old");
  EXPECT_TRUE(fs::is_directory(folder_ / "b.txt"));
  EXPECT_EQ(names(), (std::set<std::string>{"a.txt", "b.txt"}));
}

TEST_F(AtomicFileTest, AFolderIsRefusedBeforeAnythingIsReplaced) {
  write_whole_file(folder_ / "a.txt", "old");
  fs::create_directory(folder_ / "b");
  EXPECT_THROW(write_whole_files({{folder_ / "a.txt", "new"}, {folder_ / "b", "new"}}),
               OutputError);
  EXPECT_EQ(content(folder_ / "a.txt"), "old");
}

TEST_F(AtomicFileTest, OneFileTakesOneOutput) {
  fs::create_symlink("a.txt", folder_ / "link.txt"); // to what is not there yet
  fs::create_directory_symlink(".", folder_ / "here");
  for (const char* other : {"a.txt", "./a.txt", "link.txt", "here/a.txt"}) {
    EXPECT_THROW(write_whole_files({{folder_ / "a.txt", "one"}, {folder_ / other, "two"}}),
                 ArgumentError)
        << other;
    EXPECT_FALSE(fs::exists(folder_ / "a.txt")) << other;
  }
  EXPECT_THROW(write_whole_files({{"-", "x"}, {"/dev/stdout", "y"}}), ArgumentError);
  write_whole_files({{"/dev/null", "x"}, {"/dev/null", "y"}});
  write_whole_file(folder_ / "link.txt", "through the link");
  EXPECT_EQ(content(folder_ / "a.txt"), "through the link");
  EXPECT_TRUE(fs::is_symlink(folder_ / "link.txt"));
}

TEST_F(AtomicFileTest, WhatTheDeadLeftBehindIsSweptAndWhatTheLivingWriteIsNot) {
  const fs::path target = folder_ / "a.txt";
  const auto start_writing = [&] { // in a process of its own, which waits then
    std::array<int, 2> ready{};
    if (::pipe(ready.data()) != 0) throw std::runtime_error("no pipe");
    const pid_t child = ::fork();
    if (child == 0) {
      StreamedFile draft(target);
      draft.write("half");
      if (::write(ready[1], "x", 1) == 1) ::pause();
      ::_exit(1);
    }
    char byte = 0;
    EXPECT_EQ(::read(ready[0], &byte, 1), 1);
    ::close(ready[0]);
    ::close(ready[1]);
    return child;
  };
  const auto kill_it = [](pid_t child) {
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
  };
  kill_it(start_writing());
  const std::set<std::string> left = names();
  ASSERT_EQ(left.size(), 1u);
  const pid_t living = start_writing();
  write_whole_file(folder_ / "other.txt", ""); // another target: nothing of a.txt's goes
  write_whole_file(folder_ / "a.txt.part-000001", "as split makes them");
  const std::set<std::string> both = names();
  EXPECT_EQ(both.size(), 3u); // the dead one's went when the living one began
  EXPECT_FALSE(both.contains(*left.begin()));
  write_whole_file(target, "new");
  EXPECT_EQ(names().size(), 4u) << "the living one's draft is gone";
  kill_it(living);
  write_whole_file(target, "new");
  EXPECT_EQ(names(), (std::set<std::string>{"a.txt", "a.txt.part-000001", "other.txt"}));
}

TEST_F(AtomicFileTest, AnyNumberOfDraftsIsDiscarded) {
  const auto discarding = [this] {
    std::vector<StreamedFile> files;
    for (int k = 0; k < 700; ++k)
      files.emplace_back(folder_ / std::to_string(k));
    discard_drafts();
    ::_exit(names().empty() ? 0 : 1);
  };
  EXPECT_EXIT(discarding(), testing::ExitedWithCode(0), "");
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

TEST_F(AtomicFileTest, NothingIsWantedForTheNullDevice) {
  EXPECT_FALSE(StreamedFile("/dev/null").wanted());
  EXPECT_FALSE(StreamedFile("").wanted());
  EXPECT_TRUE(StreamedFile(folder_ / "a.csv").wanted());
}

TEST_F(AtomicFileTest, PiecesArriveInOrder) {
  StreamedFile file(folder_ / "pieces");
  std::string all;
  for (int i = 0; i < 40000; ++i) { // several times what is kept in memory
    const std::string piece = std::to_string(i) + '\n';
    file.text() += piece;
    all += piece;
    file.flush_if_large();
    if (i % 10007 == 0) file.write("whole\n");
    if (i % 10007 == 0) all += "whole\n";
  }
  commit_all({&file});
  EXPECT_EQ(content(folder_ / "pieces"), all);
}

TEST_F(AtomicFileTest, AFullDeviceIsAnOutputError) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full on this system";
  EXPECT_THROW(write_whole_file("/dev/full", "x"), OutputError);
}

} // namespace
} // namespace goingrate
