#include "archive.hpp"
#include "index.hpp"

#include "monitor/full_disk.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/log/reading.hpp"

#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace {
// A sync in these tests can fail, and throw away `lost_bytes` at the end of the file.
bool sync_fails = false;
off_t lost_bytes = 0;
} // namespace

// In the place of the C library's.
extern "C" int fdatasync(int file) {
  if (!sync_fails) return static_cast<int>(::syscall(SYS_fdatasync, file));
  const std::string name = std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(file));
  std::fstream bytes(name, std::ios::in | std::ios::out | std::ios::binary);
  bytes.seekp(-lost_bytes, std::ios::end);
  bytes << std::string(static_cast<std::size_t>(lost_bytes), '\0');
  errno = EIO;
  return -1;
}

namespace goingrate::apps {
namespace {

class MonitorArchiveTest : public testing::Test {
protected:
  void SetUp() override {
    folder_ = testing::TempDir() + "archive-" +
              testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::remove_all(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  // Ten beats a second apart, from two seconds before a midnight on.
  void fill(std::int64_t from = 1764201598) const {
    Archive archive(folder_);
    archive.describe(columns());
    for (std::int64_t i = 0; i < 10; ++i)
      archive.append(event_at({from + i, 0.25}));
    archive.sync();
    EXPECT_TRUE(archive.is_synced());
  }
  static NativeColumns columns() {
    NativeColumns columns;
    columns.nominal_period_s = 1.0;
    return columns;
  }
  [[nodiscard]] std::string day(const std::string& name) const {
    return folder_ + "/" + name + ".csv";
  }

  std::string folder_;
};

TEST_F(MonitorArchiveTest, ADayHasItsFile) {
  fill();
  const Archive archive(folder_);
  EXPECT_EQ(archive.days(), (std::vector<std::string>{"2025-11-26", "2025-11-27"}));
  const auto events = archive.events_of("2025-11-27");
  ASSERT_EQ(events.size(), 8U);
  EXPECT_EQ(events.front().time, (Instant{1764201600, 0.25}));
  EXPECT_EQ(archive.last_time(), (Instant{1764201607, 0.25}));
}

TEST_F(MonitorArchiveTest, ATornLineIsCutOff) {
  for (const std::string& torn : {std::string("17642016"), std::string(300, '\0'),
                                  std::string("1764201608.2") + std::string(40, '\0')}) {
    std::filesystem::remove_all(folder_);
    fill();
    std::ofstream(day("2025-11-27"), std::ios::app | std::ios::binary) << torn;
    {
      Archive archive(folder_);
      EXPECT_EQ(archive.last_time(), (Instant{1764201607, 0.25}));
      archive.append(event_at({1764201608, 0.25}));
    }
    EXPECT_EQ(Archive(folder_).events_of("2025-11-27").size(), 9U); // nothing lost, nothing more
  }
}

TEST_F(MonitorArchiveTest, ATornLineIsCutOffOfADayThatIsNotTheLast) {
  fill();
  {
    std::ofstream(day("2025-12-24")) << "# a day of a clock that was wrong\n";
    std::ofstream(day("2025-11-27"), std::ios::app) << "17642016";
    Archive archive(folder_);
    archive.append(event_at({1764201608, 0.25}));
    archive.append(event_at({1764201609, 0.25}));
  }
  const auto events = Archive(folder_).events_of("2025-11-27");
  ASSERT_EQ(events.size(), 10U);
  EXPECT_EQ(events[8].time, (Instant{1764201608, 0.25}));
}

TEST_F(MonitorArchiveTest, WhatAFailedSyncLostIsWrittenAgain) {
  {
    Archive archive(folder_);
    for (std::int64_t i = 0; i < 5; ++i)
      archive.append(event_at({1764201600 + i, 0.25}));
    archive.sync();
    for (std::int64_t i = 5; i < 8; ++i)
      archive.append(event_at({1764201600 + i, 0.25}));
    sync_fails = true;
    lost_bytes = 50; // two events and part of a third
    EXPECT_THROW(archive.sync(), OutputError);
    EXPECT_FALSE(archive.is_synced());
    sync_fails = false;
    archive.append(event_at({1764201608, 0.25}));
    archive.sync();
    EXPECT_TRUE(archive.is_synced());
  }
  const auto events = Archive(folder_).events_of("2025-11-27");
  ASSERT_EQ(events.size(), 9U);
  for (std::int64_t i = 0; i < 9; ++i)
    EXPECT_EQ(events[static_cast<std::size_t>(i)].time, (Instant{1764201600 + i, 0.25}));
}

TEST_F(MonitorArchiveTest, NotesBehindTheLastEventAreFoundAfterMidnight) {
  fill();
  Archive(folder_).note("of the evening", {1764201608, 0.0});
  for (const std::int64_t days : {1, 3}) // those days have nothing but comments
    Archive(folder_).note(fmt::format("{} days later", days), {1764201608 + days * 86400, 0.0});
  auto notes = Archive(folder_).last_notes();
  std::erase_if(notes, [](const std::string& note) { return note.find(':') != note.npos; }); // heads
  EXPECT_EQ(notes, (std::vector<std::string>{"of the evening", "1 days later", "3 days later"}));
}

TEST_F(MonitorArchiveTest, DamageInTheMiddleCutsNothingOff) {
  fill();
  {
    std::fstream file(day("2025-11-27"), std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(120);
    file.put('\0');
  }
  const auto size = std::filesystem::file_size(day("2025-11-27"));
  const Archive archive(folder_);
  EXPECT_EQ(std::filesystem::file_size(day("2025-11-27")), size);
  EXPECT_GE(archive.events_of("2025-11-27").size(), 7U);
}

TEST_F(MonitorArchiveTest, AFileThatIsRemovedIsBegunAnew) {
  Archive archive(folder_);
  archive.append(event_at({1764201600, 0.0}));
  std::filesystem::remove(day("2025-11-27"));
  EXPECT_THROW(archive.append(event_at({1764201601, 0.0})), OutputError);
  for (std::int64_t i = 1; i < 5; ++i)
    archive.append(event_at({1764201600 + i, 0.0}));
  EXPECT_EQ(archive.events_of("2025-11-27").size(), 4U);
}

TEST_F(MonitorArchiveTest, DirectionsThatComeLateAreNotTakenForUpwardCrossings) {
  fill();
  {
    Archive archive(folder_);
    NativeColumns with_edges = columns();
    with_edges.edge = true;
    archive.describe(with_edges);
    archive.append(event_at({1764201608, 0.25}));
    archive.append(event_at({1764201608, 0.75}, Edge::down));
    archive.append(event_at({1764288000, 0.25}, Edge::down)); // the next day
    archive.append(event_at({1764288000, 0.75}));
  }
  const Archive archive(folder_);
  EXPECT_EQ(archive.events_of("2025-11-27").size(), 9U);
  EXPECT_EQ(archive.notes_of("2025-11-27").back(), "down 1764201608.750000000");
  const auto next = archive.events_of("2025-11-28");
  ASSERT_EQ(next.size(), 2U);
  EXPECT_EQ(next[0].edge, Edge::down);
}

// What a gate and a weather station tell besides the time.
TEST_F(MonitorArchiveTest, ADayHasTheColumnsOfItsSource) {
  const EventValues told{0.0123456789, 21.25, 1013.5, 45.0};
  const auto heard = [&](std::int64_t second) {
    return as_stored({event_at({second, 0.1234567891}, Edge::up, 0, 0.03), told});
  };
  {
    Archive archive(folder_);
    NativeColumns all = columns();
    all.width = all.temperature = all.pressure = all.humidity = true;
    all.flag_width_rad = 0.002;
    archive.describe(all);
    for (std::int64_t i = 0; i < 10; ++i)
      archive.append(heard(1764201600 + i));
  }
  const ClockLog log = read_log_file(day("2025-11-27"));
  ASSERT_EQ(log.events.size(), 10U);
  EXPECT_EQ(log.flag_width_rad, 0.002);
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_EQ(log.events[i].time, heard(1764201600 + static_cast<std::int64_t>(i)).time);
    EXPECT_EQ(log.columns.width_s[i], 0.012345679);
    EXPECT_EQ(log.columns.temperature_c[i], 21.25);
    EXPECT_EQ(log.columns.pressure_mbar[i], 1013.5);
    EXPECT_EQ(log.columns.humidity_percent[i], 45.0);
  }
  EXPECT_EQ(Archive(folder_).last_time(), heard(1764201609).time);
}

TEST_F(MonitorArchiveTest, WhatTheDayHasNoColumnForStandsInAComment) {
  fill();
  Archive archive(folder_);
  NativeColumns with_temperature = columns();
  with_temperature.temperature = true;
  archive.describe(with_temperature);
  EventValues values;
  values.temperature_c = 21.5;
  archive.append({event_at({1764201608, 0.25}), values});
  archive.append({event_at({1764288000, 0.25}), values}); // the next day
  EXPECT_EQ(archive.notes_of("2025-11-27").back(), "beside: temperature_c=21.5");
  EXPECT_TRUE(archive.notes_of("2025-11-28").back().starts_with("nominal_period_s"));
}

// Before the source has said what it tells, a comment may begin the day.
TEST_F(MonitorArchiveTest, ADayThatBeginsWithACommentHasTheColumnsOfTheLastOne) {
  {
    Archive archive(folder_);
    NativeColumns with_edges = columns();
    with_edges.edge = with_edges.temperature = true;
    archive.describe(with_edges);
    archive.append(event_at({1764201600, 0.25}));
  }
  Archive archive(folder_);
  archive.note("alarm begins stopped", {1764288000, 0.0});
  std::ifstream file(day("2025-11-28"));
  std::string text((std::istreambuf_iterator<char>(file)), {});
  EXPECT_NE(text.find("time_s,edge,amplitude_rad,temperature_c\n"), text.npos) << text;
}

// A disk that writes and never says that it is safe, for days.
TEST_F(MonitorArchiveTest, WhatIsUnsafeIsBounded) {
  Archive archive(folder_);
  archive.append(event_at({1764201600, 0.25}));
  archive.sync();
  archive.append(event_at({1764201601, 0.25}));
  sync_fails = true;
  lost_bytes = 0;
  EXPECT_THROW(archive.sync(), OutputError);
  std::int64_t written = 2;
  EXPECT_THROW(for (; written < 1'000'000; ++written)
                   archive.append(event_at({1764201600, static_cast<double>(written) * 1e-7})),
               OutputError);
  EXPECT_LT(std::filesystem::file_size(day("2025-11-27")), 5U << 20);
  EXPECT_THROW(archive.note("too much", {1764201601, 0.0}), OutputError);
  sync_fails = false;
  archive.sync();
  archive.append(event_at({1764201700, 0.25}));
  archive.sync();
  EXPECT_EQ(archive.events_of("2025-11-27").size(), static_cast<std::size_t>(written) + 1);
}

TEST_F(MonitorArchiveTest, ADayMayHaveOneEvent) {
  fill(1764201599);
  const Archive archive(folder_);
  ASSERT_EQ(archive.events_of("2025-11-26").size(), 1U);
  EXPECT_TRUE(archive.holds({1764201599, 0.25}));
  EXPECT_FALSE(archive.holds({1764201599, 0.26}));
}

TEST_F(MonitorArchiveTest, OneProcessKeepsIt) {
  const Archive archive(folder_);
  for (const auto& entry : std::filesystem::directory_iterator(folder_)) // the lock is not there
    std::filesystem::remove(entry.path());
  EXPECT_THROW(Archive{folder_}, OutputError);
}

TEST_F(MonitorArchiveTest, TheOriginIsFoundAgain) {
  {
    Archive archive(folder_);
    archive.set_origin({1764201000, 0.5});
    for (std::int64_t i = 0; i < 5; ++i)
      archive.append(event_at({1764201600 + i, 0.0}));
  }
  EXPECT_EQ(Archive(folder_).origin(), (Instant{1764201000, 0.5}));
}

// As after a failure of power in the first seconds of a day.
TEST_F(MonitorArchiveTest, ADayThatWasOnlyBegunHidesNoOrigin) {
  for (const char* begun : {"", "# goingrate log: 1\n# nominal", "# a comment\n"}) {
    std::filesystem::remove_all(folder_);
    {
      Archive archive(folder_);
      archive.describe(columns());
      archive.set_origin({1764201000, 0.5});
      archive.append(event_at({1764201598, 0.25}));
      archive.sync();
    }
    std::ofstream(folder_ + "/2025-11-28.csv") << begun;
    const Archive archive(folder_);
    ASSERT_TRUE(archive.origin()) << begun;
    EXPECT_EQ(archive.origin()->seconds, 1764201000) << begun;
    ASSERT_TRUE(archive.last_time()) << begun;
  }
}

TEST_F(MonitorArchiveTest, TheIndexHasWhatWasLearntOfTheLastDays) {
  std::filesystem::create_directories(folder_);
  {
    ArchiveIndex index(folder_);
    for (std::int64_t d = 0; d < 40; ++d)
      index.put_learnt(day_of({86400 * d, 0.0}), {static_cast<double>(d), 0.5});
  }
  const ArchiveIndex index(folder_);
  EXPECT_EQ(index.learnt("1970-02-09"), (std::vector<double>{39.0, 0.5}));
  EXPECT_TRUE(index.learnt("1970-01-02").empty());
}

TEST_F(MonitorArchiveTest, TheIndexIsMadeAgainFromNothing) {
  std::filesystem::create_directories(folder_);
  std::ofstream(folder_ + "/.index.sqlite") << "this is no database, however long it may be";
  ArchiveIndex index(folder_);
  EXPECT_TRUE(index.days().empty());
  GoingBlock hour;
  hour.start_s = 3600;
  hour.beats = 7;
  hour.mark_time = {7199, 0.125};
  index.put_day("1970-01-01", {hour}, {});
  index.put_break({{5000, 0.5}, 12, 34, 0.75});
  index.put_alarm({6000.0, "stopped", "it's quiet", true});
  const ArchiveIndex again(folder_);
  ASSERT_EQ(again.hours().size(), 1U);
  EXPECT_EQ(again.hours()[0].beats, 7);
  EXPECT_EQ(again.hours()[0].mark_time, hour.mark_time);
  ASSERT_EQ(again.breaks().size(), 1U);
  EXPECT_EQ(again.breaks()[0].probability, 0.75);
  ASSERT_EQ(again.alarms().size(), 1U);
  EXPECT_EQ(again.alarms()[0].text, "it's quiet");
}

TEST_F(MonitorArchiveTest, AnIndexIsKeptWhileItCannotBeUsed) {
  std::filesystem::create_directories(folder_);
  {
    ArchiveIndex index(folder_);
    for (std::int64_t h = 0; h < 1000; ++h) {
      GoingBlock hour;
      hour.start_s = 3600 * h;
      index.put_day(day_of({hour.start_s, 0.0}), {hour}, {});
    }
  }
  {
    const FullDisk disk(0);
    ArchiveIndex index(folder_);
    index.put_alarm({6000.0, "stopped", "in memory", true});
    EXPECT_EQ(index.alarms().size(), 1U);
  }
  EXPECT_EQ(ArchiveIndex(folder_).hours().size(), 1000U);
}

TEST_F(MonitorArchiveTest, AnIndexThatIsDamagedIsMadeAgain) {
  std::filesystem::create_directories(folder_);
  {
    ArchiveIndex index(folder_);
    for (std::int64_t h = 0; h < 20000; ++h) {
      GoingBlock hour;
      hour.start_s = 3600 * h;
      index.put_day(day_of({hour.start_s, 0.0}), {hour}, {});
    }
  }
  {
    std::fstream file(folder_ + "/.index.sqlite", std::ios::in | std::ios::out | std::ios::binary);
    for (int page = 20; page < 200; page += 7) {
      file.seekp(4096 * page);
      file << std::string(512, '\x5a');
    }
  }
  EXPECT_TRUE(ArchiveIndex(folder_).days().empty());
}

} // namespace
} // namespace goingrate::apps
