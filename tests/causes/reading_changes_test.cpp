#include "causes/reading_changes.hpp"

#include "goingrate/base/random.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace goingrate::timing_model {
namespace {

constexpr double day_s = 86400.0;

// A clock that is read once a day, at an hour that varies.
struct ReadClock {
  int days = 28;
  double reading_s = 0.3, walk_s = 0.1; // errors of reading; random walk of the clock in a day
  double wander_s = 0.0;                // random walk of the rate in a day, s/day
  int turned_on = 0;
  double turned_by = 0.0; // s/day
  int set_on = 0;
  double set_by_s = 0.0;
};

std::vector<ReadingChange> changes_of(const ReadClock& clock, std::uint64_t seed) {
  RandomStream random(seed, StreamPurpose::jitter);
  std::vector<double> time_s, late_s;
  double late = 3.0, rate = -6.0;
  for (int day = 0; day < clock.days; ++day) {
    time_s.push_back(day_s * day);
    late_s.push_back(late + clock.reading_s * random.normal() +
                     (clock.set_on > 0 && day >= clock.set_on ? clock.set_by_s : 0.0));
    rate += clock.wander_s * random.normal();
    late += rate + clock.walk_s * random.normal();
    if (clock.turned_on > 0 && day >= clock.turned_on) late -= clock.turned_by;
  }
  return changes_among_readings(time_s, late_s);
}

TEST(ReadingChangesTest, FindsATurnOfTheNut) {
  for (const int days : {12, 28, 90})
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      ReadClock clock{.days = days};
      clock.turned_on = days / 2;
      clock.turned_by = -7.5;
      const auto found = changes_of(clock, seed);
      ASSERT_EQ(found.size(), 1U) << days << ' ' << seed;
      EXPECT_TRUE(found[0].is_of_rate);
      EXPECT_NEAR(found[0].at_s / day_s, clock.turned_on, 0.51); // midway between two readings
      // The readings of six days and the walk of twelve leave some 0.15 s/day; four of these.
      EXPECT_NEAR(found[0].size * day_s, -7.5, 0.6) << days << ' ' << seed;
    }
}

// Turned, and turned back: neither turn shows alone.
TEST(ReadingChangesTest, FindsATurnAndItsReturn) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    RandomStream random(seed, StreamPurpose::jitter);
    std::vector<double> time_s, late_s;
    double late = 0.0;
    for (int day = 0; day < 45; ++day) {
      time_s.push_back(day_s * day);
      late_s.push_back(late + 0.3 * random.normal());
      late += (day >= 15 && day < 30 ? 8.0 : 0.0) + 0.1 * random.normal();
    }
    const auto found = changes_among_readings(time_s, late_s);
    ASSERT_EQ(found.size(), 2U) << seed;
    EXPECT_NEAR(found[0].at_s / day_s, 15.0, 0.51);
    EXPECT_NEAR(found[1].at_s / day_s, 30.0, 0.51);
    EXPECT_NEAR(found[0].size * day_s, -8.0, 0.6) << seed; // as of a single turn
  }
}

// The nut was turned while nobody read the clock for a month.
TEST(ReadingChangesTest, FindsATurnWithinAGap) {
  for (const int turned_on : {25, 32, 45}) {
    RandomStream random(7, StreamPurpose::jitter);
    std::vector<double> time_s, late_s;
    for (int day = 0; day < 70; ++day) {
      if (day >= 20 && day < 50) continue;
      time_s.push_back(day_s * day);
      late_s.push_back(4.0 * std::max(0, day - turned_on) + 0.3 * random.normal());
    }
    const auto found = changes_among_readings(time_s, late_s);
    ASSERT_EQ(found.size(), 1U) << turned_on;
    // Half a step of the search, in a gap of 20 intervals' worth of places.
    EXPECT_NEAR(found[0].at_s / day_s, turned_on, 1.0);
  }
}

// The beats stand in for readings the first of which came before the first beat.
TEST(ReadingChangesTest, TheirTimesCountFromTheFirstBeat) {
  TimingData data;
  data.reference_period_s = day_s;
  RandomStream random(8, StreamPurpose::jitter);
  for (int day = 0; day < 30; ++day) {
    data.cycle.push_back(day);
    data.elapsed_s.push_back(day_s * day);
    data.lateness_s.push_back(day >= 12 ? 60.0 : 0.0);
    data.as_read.elapsed_s.push_back(day_s * (day - 0.4));
    data.as_read.late_s.push_back((day >= 12 ? 60.0 : 0.0) + 0.3 * random.normal());
  }
  level_settings(data);
  ASSERT_EQ(data.displaced.size(), 1U);
  EXPECT_EQ(data.displaced[0].beat, 12U);
  EXPECT_NEAR(data.as_read.late_s[20], 0.0, 1.5); // five times the error of a reading
}

TEST(ReadingChangesTest, ExactReadingsAreNoChange) {
  std::vector<double> time_s, late_s;
  for (int day = 0; day < 30; ++day) {
    time_s.push_back(day_s * day);
    late_s.push_back(0.1 * day);
  }
  const std::vector<double> none(30, 0.0);
  EXPECT_TRUE(changes_among_readings(time_s, late_s).empty());
  EXPECT_TRUE(changes_among_readings(time_s, none).empty());
  EXPECT_TRUE(changes_among_readings(none, late_s).empty()); // all at one time
}

TEST(ReadingChangesTest, FindsHandsThatWereSet) {
  for (const int days_after : {2, 10}) // even two days before the end
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      ReadClock clock;
      clock.set_on = clock.days - days_after;
      clock.set_by_s = 120.0;
      const auto found = changes_of(clock, seed);
      ASSERT_EQ(found.size(), 1U) << days_after << ' ' << seed;
      EXPECT_FALSE(found[0].is_of_rate);
      EXPECT_EQ(found[0].at_s, day_s * clock.set_on);
      EXPECT_NEAR(found[0].size, 120.0, 1.6); // four times the errors of two readings
    }
}

// Hands set between readings at uneven hours: a beat on the line between the last reading before
// and the first one after has a part of the setting.
TEST(ReadingChangesTest, BeatsBetweenReadingsHaveTheirShareOfASetting) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    RandomStream random(seed, StreamPurpose::jitter);
    constexpr int days = 30, set_on = 15;
    constexpr double set_by_s = -30.0;
    TimingData data;
    UnevenReadings& read = data.as_read;
    for (int day = 0; day < days; ++day) {
      read.elapsed_s.push_back(day_s * (day + 0.02 * random.normal()));
      read.late_s.push_back(0.1 * random.normal() + (day >= set_on ? set_by_s : 0.0));
    }
    std::size_t next = 1;
    for (int day = 0; day < days; ++day) {
      const double t = day_s * day;
      while (next + 1 < read.elapsed_s.size() && read.elapsed_s[next] < t)
        ++next;
      const double share = std::clamp((t - read.elapsed_s[next - 1]) /
                                          (read.elapsed_s[next] - read.elapsed_s[next - 1]),
                                      0.0, 1.0);
      data.cycle.push_back(day);
      data.elapsed_s.push_back(t);
      data.lateness_s.push_back(std::lerp(read.late_s[next - 1], read.late_s[next], share));
    }
    level_settings(data);
    ASSERT_EQ(data.displaced.size(), 1U) << seed;
    EXPECT_EQ(data.displaced[0].beat, static_cast<std::size_t>(set_on)) << seed;
    for (const double late : data.lateness_s)
      EXPECT_LT(std::abs(late), 1.0) << seed; // ten errors of reading; half a day of it is 15 s
  }
}

// A setting at one reading and another at the next are together a wrong reading: what the events so
// far explain to rounding is no further one.
TEST(ReadingChangesTest, EventsThatExplainEachOtherAreNotAdded) {
  for (std::uint64_t seed = 300; seed < 340; ++seed) {
    ReadClock clock{.days = 30, .reading_s = 0.5, .walk_s = 0.05};
    clock.set_on = 15;
    clock.set_by_s = -30.0;
    const auto found = changes_of(clock, seed);
    ASSERT_FALSE(found.empty()) << seed;
    for (const ReadingChange& change : found)
      EXPECT_TRUE(std::isfinite(change.size) && std::isfinite(change.gain)) << seed;
  }
}

TEST(ReadingChangesTest, QuietReadingsStayQuiet) {
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed)
    for (const double wander_s : {0.0, 0.05, 0.1}) // 0.1 s/day a day: 0.6 s/day in a month
      for (const int days : {10, 30, 60})
        found += static_cast<int>(changes_of({.days = days, .wander_s = wander_s}, seed).size());
  EXPECT_LE(found, 6); // of 900 logs: 0.3 %, and twice its scatter
}

TEST(ReadingChangesTest, AWrongReadingIsNoChange) {
  std::vector<double> time_s, late_s;
  RandomStream random(5, StreamPurpose::jitter);
  for (int day = 0; day < 30; ++day) {
    time_s.push_back(day_s * day);
    late_s.push_back(2.0 * day + 0.3 * random.normal());
  }
  late_s[12] += 60.0; // misread by a minute
  EXPECT_TRUE(changes_among_readings(time_s, late_s).empty());
}

} // namespace
} // namespace goingrate::timing_model
