#include "goingrate/base/errors.hpp"
#include "goingrate/base/random.hpp"
#include "goingrate/log/beats.hpp"

#include <gtest/gtest.h>

namespace goingrate {
namespace {

// Beats every `period_s` with jitter of 0.1 ms, a share of which is followed by one to four
// bounces, 2 to 6 ms apart.
ClockLog bouncing(int beats, double period_s, double share, std::uint64_t seed) {
  RandomStream random(seed, StreamPurpose::jitter);
  ClockLog log;
  for (int n = 0; n < beats; ++n) {
    double time = n * period_s + 1e-4 * random.normal();
    log.events.push_back(event_at(Instant::from_seconds(time)));
    if (random.uniform() >= share) continue;
    for (int k = static_cast<int>(1.0 + 4.0 * random.uniform()); k > 0; --k) {
      time += 0.002 + 0.004 * random.uniform();
      log.events.push_back(event_at(Instant::from_seconds(time)));
      log.events.back().line = 1; // tells it from a beat
    }
  }
  return log;
}

TEST(BouncesTest, AreFoundWithoutBeingTold) {
  for (const double share : {1.0, 0.33, 0.05})
    for (const double period : {0.9, 2.0, 3.0}) {
      ClockLog log = bouncing(600, period, share, 7);
      const double dead_time = mark_bounces(log);
      EXPECT_GT(dead_time, 0.004) << share;
      EXPECT_LT(dead_time, 0.03) << share; // four of 6 ms, and a fifth more
      for (const Beat& event : log.events)
        EXPECT_EQ(event.flag == BeatFlag::bounce, event.line == 1) << share << " " << period;
      ASSERT_FALSE(log.assumptions.empty());
      const Beats beats = number_beats(log);
      EXPECT_EQ(beats.longest_segment().size(), 600u);
      EXPECT_EQ(beats.bounces, static_cast<std::int64_t>(log.events.size()) - 600);
      EXPECT_EQ(beats.spurious, 0);
    }
}

TEST(BouncesTest, FalseEventsAtAnyTimeAreNone) {
  RandomStream random(3, StreamPurpose::jitter);
  ClockLog log;
  for (int n = 0; n < 2000; ++n) {
    log.events.push_back(event_at(Instant::from_seconds(2.0 * n)));
    if (n % 3 == 0)
      log.events.push_back(event_at(Instant::from_seconds(2.0 * n + 2.0 * random.uniform())));
  }
  EXPECT_EQ(mark_bounces(log), 0.0);
  EXPECT_TRUE(log.assumptions.empty());
}

TEST(BouncesTest, ShortRunsFarApartAreNone) {
  // Intervals of 3 s look short next to pauses of hours; no contact bounces for seconds.
  ClockLog log;
  for (int run = 0; run < 10; ++run)
    for (int n = 0; n < 12; ++n)
      log.events.push_back(event_at(Instant::from_seconds(8000.0 * run + 3.37 * n)));
  EXPECT_EQ(mark_bounces(log), 0.0);
}

TEST(BouncesTest, TheTurningPointOfASwingIsNone) {
  // The beam stands near the end of the swing: the pendulum is back within a twentieth of a period.
  ClockLog log;
  for (int n = 0; n < 500; ++n) {
    log.events.push_back(event_at(Instant::from_seconds(1.0 * n)));
    log.events.push_back(event_at(Instant::from_seconds(1.0 * n + 0.04), Edge::down));
  }
  EXPECT_EQ(mark_bounces(log), 0.0);
}

TEST(BouncesTest, ADeadTimeIsTaken) {
  ClockLog log = bouncing(100, 2.0, 1.0, 2);
  ClockLog untouched = log;
  EXPECT_EQ(mark_bounces(untouched, 0.0), 0.0);
  for (const Beat& event : untouched.events)
    EXPECT_EQ(event.flag, BeatFlag::good);
  EXPECT_EQ(mark_bounces(log, 0.5), 0.5);
  for (const Beat& event : log.events)
    EXPECT_EQ(event.flag == BeatFlag::bounce, event.line == 1);
  EXPECT_THROW(mark_bounces(log, -1.0), ArgumentError);
}

TEST(BouncesTest, AFalseEventShortlyBeforeABeatDoesNotHideIt) {
  ClockLog log = bouncing(400, 2.0, 0.3, 5);
  // 8 ms before the beat, far beyond its jitter: the beat comes within the dead time of it.
  for (std::size_t i = log.events.size(); i-- > 0;)
    if (log.events[i].line == 0 && i % 50 == 0 && i > 0)
      log.events.insert(log.events.begin() + static_cast<std::ptrdiff_t>(i),
                        event_at(log.events[i].time + -0.008, Edge::up, 1));
  ASSERT_GT(mark_bounces(log), 0.008);
  const Beats beats = number_beats(log);
  std::size_t good = 0;
  for (const Beat& beat : beats.beats) {
    if (beat.flag != BeatFlag::good) continue;
    EXPECT_EQ(beat.line, 0u);
    ++good;
  }
  EXPECT_EQ(good, 400u);
}

} // namespace
} // namespace goingrate
