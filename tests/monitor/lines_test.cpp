#include "monitor/watched_clock.hpp"
#include "source_head.hpp"

#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>

namespace goingrate::apps {
namespace {

using MonitorLinesTest = WatchedClockTest;

// A source whose own times begin at second 100, with one line that gives another time.
TEST_F(MonitorLinesTest, OneWrongLineMovesNothing) {
  for (const double wrong : {3140.0, 40.0, 9999999999.5, -5e17, 2147483648e9}) {
    std::filesystem::remove_all(options_.folder);
    ClockWatch watch(options_);
    hear(watch, 0, 40, -100.0);
    hear_event(watch, event_at(Instant::from_seconds(wrong)), 40.0, 40);
    hear(watch, 41, 200, -100.0);
    EXPECT_EQ(watch.going().last()->cycle, 199) << wrong;
    EXPECT_NEAR(watch.going().last()->time - began, 199.0, 0.2) << wrong;
    EXPECT_TRUE(watch.breaks().empty()) << wrong;
  }
}

// Ten wrong lines that agree, as by a fault of the source: none becomes an event, each is stored as
// a comment.
TEST_F(MonitorLinesTest, WrongLinesThatAgreeMoveNothing) {
  for (const double wrong_by : {4294.967296, -30.0}) {
    std::filesystem::remove_all(options_.folder);
    ClockWatch watch(options_);
    hear(watch, 0, 40, -100.0);
    hear(watch, 40, 50, -100.0 - wrong_by);
    hear(watch, 50, 200, -100.0);
    EXPECT_EQ(watch.going().last()->cycle, 199) << wrong_by;
    EXPECT_NEAR(watch.going().last()->time - began, 199.0, 0.2) << wrong_by;
    EXPECT_TRUE(watch.breaks().empty()) << wrong_by;
    std::ifstream day(options_.folder + "/" + day_of(began) + ".csv");
    int left_out = 0;
    for (std::string line; std::getline(day, line);)
      left_out += line.starts_with("# left out") ? 1 : 0;
    EXPECT_EQ(left_out, 10) << wrong_by;
  }
}

TEST_F(MonitorLinesTest, HalfALineAfterARestartMovesNothing) {
  {
    ClockWatch watch(options_);
    hear(watch, 0, 40, -5000.0);
  }
  ClockWatch watch(options_);
  hear_event(watch, event_at(Instant::from_seconds(42.0)), 42.0, 42); // the end of 5042.000000
  hear(watch, 43, 100, -5000.0);
  EXPECT_EQ(watch.going().last()->cycle, 99);
  EXPECT_NEAR(watch.going().last()->time - began, 99.0, 0.2);
}

TEST_F(MonitorLinesTest, AFileThatIsReadAgainIsNotStoredAgain) {
  options_.place.source_is_live = false;
  for (const bool is_dated : {false, true}) {
    std::filesystem::remove_all(options_.folder);
    log_.origin = is_dated ? TimeOrigin::epoch : TimeOrigin::none;
    std::vector<Beat> file;
    for (std::int64_t n = 0; n < 700; ++n)
      file.push_back(event_at(is_dated ? began + time_of(n) : Instant::from_seconds(time_of(n))));
    for (const std::size_t lines : {500, 500, 600, 700}) {
      ClockWatch watch(options_);
      for (std::size_t n = 0; n < lines; ++n)
        watch.add(file[n], log_, began + 1000.0);
      watch.end(log_, began + 1000.0);
      EXPECT_EQ(watch.going().last()->cycle, static_cast<std::int64_t>(lines) - 1);
    }
    const Archive archive(options_.folder);
    std::size_t rows = 0;
    for (const std::string& day : archive.days())
      rows += archive.events_of(day).size();
    EXPECT_EQ(rows, 700U) << is_dated;
  }
  log_.origin = TimeOrigin::none;
}

TEST_F(MonitorLinesTest, LinesWrittenBeforeItListenedAreInThePast) {
  ClockWatch watch(options_);
  for (std::int64_t n = 0; n < 12; ++n) // a burst, whose last line is heard as it is written
    watch.add(event_at(Instant::from_seconds(time_of(n))), log_, began + 11.05);
  hear(watch, 12, 60);
  EXPECT_NEAR(watch.going().last()->time - began, 59.0, 0.2);
}

TEST_F(MonitorLinesTest, ASourceThatBeganAgainInBetweenGetsANotedOrigin) {
  {
    ClockWatch watch(options_);
    hear(watch, 0, 100);
  }
  Instant last;
  {
    ClockWatch watch(options_); // the logger began again at 150
    hear(watch, 160, 300, 150.0);
    last = watch.going().last()->time;
    EXPECT_NEAR(last - began, 299.0, 0.2);
  }
  ClockWatch watch(options_); // and goes on
  hear(watch, 310, 320, 150.0);
  EXPECT_NEAR(watch.going().last()->time - last, 20.0, 1e-3);
}

// The monitor is killed while two events after a gap wait for a third to confirm them.
TEST_F(MonitorLinesTest, EventsBehindAGapAreOnDiskAtOnce) {
  for (const double amplitude_rad : {std::nan(""), 0.03}) {
    std::filesystem::remove_all(options_.folder);
    const auto heard = [&](std::int64_t n) {
      return event_at(Instant::from_seconds(time_of(n)), Edge::up, 0, amplitude_rad);
    };
    {
      ClockWatch watch(options_);
      hear(watch, 0, 100);
      hear_event(watch, heard(300), 300.0, 300);
      hear_event(watch, heard(301), 301.0, 301);
      watch.idle(log_, began + 302.5);
      EXPECT_EQ(watch.going().last()->cycle, 99);
    }
    const auto notes = [&] {
      std::ifstream day(options_.folder + "/" + day_of(began) + ".csv");
      int count = 0;
      for (std::string line; std::getline(day, line);)
        count += line.starts_with("# waits for others") ? 1 : 0;
      return count;
    };
    EXPECT_EQ(notes(), 2);
    ClockWatch watch(options_);
    hear(watch, 302, 320);
    watch.end(log_, began + 321.0);
    EXPECT_EQ(watch.going().last()->cycle, 319);
    EXPECT_EQ(notes(), 2);
    std::ifstream day(options_.folder + "/" + day_of(began) + ".csv");
    int rows = 0;
    for (std::string line; std::getline(day, line);)
      rows += std::isdigit(static_cast<unsigned char>(line[0])) != 0 ? 1 : 0;
    EXPECT_EQ(rows, 100 + 20);
  }
}

TEST_F(MonitorLinesTest, AHeadOutlivesARestart) {
  const Archive archive(options_.folder); // makes the folder
  const std::string head = "# goingrate log: 1\ntime_s,temperature_c\n";
  SourceHead(options_.folder, "/dev/ttyACM0:9600").keep(head);
  SourceHead again(options_.folder, "/dev/ttyACM0:9600");
  EXPECT_EQ(again.text(), head);
  again.keep(""); // a source that goes on does not repeat its head, which stays
  EXPECT_EQ(SourceHead(options_.folder, "/dev/ttyACM0:9600").text(), head);
  EXPECT_EQ(SourceHead(options_.folder, "another").text(), "");
}

// The source does not state its layout, and there were too few lines to tell it before the kill.
TEST_F(MonitorLinesTest, LinesThatAreNotRecognisedYetOutliveAKill) {
  const std::string first = "0.000000\n1.000020\n", more = "2.000040\n3.0000";
  {
    ClockWatch watch(options_);
    EXPECT_EQ(watch.unread(), "");
    watch.hold(first, began);
    watch.hold(first + more, began + 2.0);
    watch.idle(log_, began + 2.1); // no event yet: nothing is cleared
  }
  ClockWatch watch(options_);
  EXPECT_EQ(watch.unread(), first + "2.000040\n"); // whole lines
  hear(watch, 0, 20);
  EXPECT_EQ(watch.unread(), "");
}

TEST_F(MonitorLinesTest, ALoggerThatTellsTheSameTimesAgainIsHeard) {
  for (const std::int64_t start : {0, 200}) {
    ClockWatch watch(options_);
    watch.hold("# goingrate log: 1\n", began + static_cast<double>(start));
    for (std::int64_t n = 0; n < 100; ++n) // a logger that is switched on counts from 0
      hear_event(watch, event_at({n, 0.0}), static_cast<double>(start + n), n);
    watch.end(log_, began + static_cast<double>(start + 101));
    EXPECT_EQ(watch.heard(), 100);
  }
  std::size_t rows = 0;
  const Archive archive(options_.folder);
  for (const std::string& day : archive.days())
    rows += archive.events_of(day).size();
  EXPECT_EQ(rows, 200U);
}

TEST_F(MonitorLinesTest, LinesThatAreStoredAlreadyAreNotStoredAgain) {
  std::vector<double> times;
  for (std::int64_t n = 0; n < 100; ++n)
    times.push_back(time_of(n));
  const auto hear_these = [&](ClockWatch& watch, std::size_t from, std::size_t to) {
    for (std::size_t n = from; n < to; ++n)
      watch.add(event_at(Instant::from_seconds(times[n])), log_,
                began + times[std::max<std::size_t>(n, 4)]); // the first five at once
  };
  {
    ClockWatch watch(options_);
    watch.hold("0\n1\n2\n", began);
    hear_these(watch, 0, 8);
  } // killed before it was idle: the lines are still there
  {
    ClockWatch watch(options_);
    EXPECT_FALSE(watch.unread().empty());
    hear_these(watch, 0, 100); // three lines that were held, and what the pipe still had
    watch.end(log_, began + 100.0);
    EXPECT_EQ(watch.going().last()->cycle, 99);
    EXPECT_TRUE(watch.unread().empty());
  }
  EXPECT_EQ(Archive(options_.folder).events_of(day_of(began)).size(), 100U);
}

} // namespace
} // namespace goingrate::apps
