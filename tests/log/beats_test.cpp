#include "goingrate/log/beats.hpp"

#include "goingrate/base/errors.hpp"
#include "support/simulated.hpp"

#include <gtest/gtest.h>

namespace goingrate {
namespace {

ClockLog log_of(const std::vector<double>& times) {
  ClockLog log;
  log.source = "made";
  std::uint32_t line = 0;
  for (const double t : times)
    log.events.push_back(event_at(Instant::from_seconds(t), Edge::up, ++line));
  return log;
}

std::vector<double> steady(int n, double period = 2.0, double start = 0.0) {
  std::vector<double> times;
  for (int i = 0; i < n; ++i)
    times.push_back(start + period * i);
  return times;
}

TEST(BeatsTest, ASteadyLogIsCountedThrough) {
  const Beats beats = number_beats(log_of(steady(100)));
  EXPECT_EQ(beats.missed, 0);
  EXPECT_EQ(beats.spurious, 0);
  EXPECT_EQ(beats.segments, 1u);
  for (std::size_t i = 0; i < 100; ++i)
    EXPECT_EQ(beats.beats[i].cycle, static_cast<std::int64_t>(i));
}

TEST(BeatsTest, AMissedBeatLeavesItsNumberFree) {
  auto times = steady(100);
  times.erase(times.begin() + 40, times.begin() + 42);
  const Beats beats = number_beats(log_of(times));
  EXPECT_EQ(beats.missed, 2);
  ASSERT_EQ(beats.gaps.size(), 1u);
  EXPECT_EQ(beats.gaps[0].after_cycle, 39);
  EXPECT_EQ(beats.gaps[0].length, 2);
  EXPECT_GT(beats.gaps[0].probability, 0.999999);
  EXPECT_EQ(beats.beats.back().cycle, 99);
}

TEST(BeatsTest, ADoubleTriggerIsMarkedAndTheBeatKept) {
  auto times = steady(100);
  times.insert(times.begin() + 51, times[50] + 0.003);
  const Beats beats = number_beats(log_of(times));
  EXPECT_EQ(beats.spurious, 1);
  EXPECT_EQ(beats.beats[50].flag, BeatFlag::good);
  EXPECT_EQ(beats.beats[51].flag, BeatFlag::spurious);
  EXPECT_EQ(beats.beats.back().cycle, 99);
}

TEST(BeatsTest, AFalseEventJustBeforeABeatDoesNotTakeItsPlace) {
  auto times = steady(100);
  times.insert(times.begin() + 50, times[50] - 0.003);
  const Beats beats = number_beats(log_of(times));
  EXPECT_EQ(beats.beats[50].flag, BeatFlag::spurious);
  EXPECT_EQ(beats.beats[51].flag, BeatFlag::good);
}

TEST(BeatsTest, AFalseEventInPlaceOfAMissedBeatIsFoundOut) {
  auto times = steady(100);
  times[50] += 0.009; // within the tolerance of a beat
  const Beats beats = number_beats(log_of(times));
  EXPECT_EQ(beats.spurious, 1);
  EXPECT_EQ(beats.missed, 1);
  EXPECT_EQ(beats.beats[50].flag, BeatFlag::spurious);
}

TEST(BeatsTest, AStepOfTheRateIsNoOutlier) {
  auto times = steady(50);
  for (int i = 1; i < 50; ++i)
    times.push_back(98.0 + 2.002 * i);
  EXPECT_EQ(number_beats(log_of(times)).spurious, 0);
}

TEST(BeatsTest, AStoppedClockIsSplitWhereItStopped) {
  // 3600.2 s would be a whole number of periods, and no stop to be seen.
  for (const double phase : {0.05, 0.37, 0.5, 0.63, 0.8, 0.95}) {
    RandomStream random(4, StreamPurpose::jitter);
    std::vector<double> times;
    for (int i = 0; i < 1000; ++i)
      times.push_back(1.00005 * i + 1e-4 * random.normal());
    const double restart = times.back() + 3600.0 + phase;
    for (int i = 0; i < 700; ++i)
      times.push_back(restart + 1.00005 * i + 1e-4 * random.normal());
    const Beats beats = number_beats(log_of(times));
    ASSERT_FALSE(beats.gaps.empty()) << phase;
    EXPECT_EQ(beats.gaps[0].after_cycle, 999) << phase;
    EXPECT_FALSE(beats.gaps[0].bridged) << phase;
    EXPECT_EQ(beats.longest_segment().size(), 1000u) << phase;
  }
}

TEST(BeatsTest, NoGapIsBridgedThatNobodyCouldCount) {
  for (const double gap : {2e7, 1e9, 1e15}) {
    auto times = steady(200);
    const double resume = times.back() + gap;
    for (int i = 0; i < 100; ++i)
      times.push_back(resume + 2.0 * i);
    const Beats beats = number_beats(log_of(times));
    ASSERT_EQ(beats.gaps.size(), 1u) << gap;
    EXPECT_FALSE(beats.gaps[0].bridged) << gap;
    EXPECT_EQ(beats.longest_segment().size(), 200u) << gap;
  }
}

TEST(BeatsTest, FalseEventsAtTheStartAreNotTheFirstBeat) {
  auto times = steady(50);
  times.insert(times.begin(), {-0.9, -0.5});
  const Beats beats = number_beats(log_of(times));
  EXPECT_EQ(beats.spurious, 2);
  EXPECT_EQ(beats.beats[2].cycle, 0);
}

TEST(BeatsTest, AStepOfTheReferenceClockSplitsTheLog) {
  auto times = steady(60);
  for (std::size_t i = 30; i < 60; ++i)
    times[i] += 0.7;
  const Beats beats = number_beats(log_of(times));
  EXPECT_EQ(beats.segments, 2u);
  ASSERT_EQ(beats.gaps.size(), 1u);
  EXPECT_FALSE(beats.gaps[0].bridged);
  EXPECT_EQ(beats.longest_segment().size(), 30u);
}

TEST(BeatsTest, AGapTooLongToCountIsNotBridged) {
  // The rate wanders by 2e-3 from beat to beat: over 20,000 beats nobody can count.
  RandomStream random(3, StreamPurpose::jitter);
  std::vector<double> times{0.0};
  for (int i = 1; i < 2000; ++i)
    times.push_back(times.back() + 2.0 + 4e-3 * random.normal());
  const double gap = 20000 * 2.0;
  const double end = times.back();
  times.push_back(end + gap);
  for (int i = 1; i < 1500; ++i)
    times.push_back(times.back() + 2.0 + 4e-3 * random.normal());
  const Beats beats = number_beats(log_of(times));
  ASSERT_EQ(beats.gaps.size(), 1u);
  EXPECT_LT(beats.gaps[0].probability, 0.99);
  EXPECT_FALSE(beats.gaps[0].bridged);
  EXPECT_EQ(beats.longest_segment().size(), 2000u);
}

TEST(BeatsTest, AShortGapOfTheSameClockIsBridged) {
  RandomStream random(3, StreamPurpose::jitter);
  std::vector<double> times{0.0};
  for (int i = 1; i < 2000; ++i)
    times.push_back(times.back() + 2.0 + 4e-3 * random.normal());
  times.erase(times.begin() + 1000, times.begin() + 1100);
  const Beats beats = number_beats(log_of(times));
  ASSERT_EQ(beats.gaps.size(), 1u);
  EXPECT_GT(beats.gaps[0].probability, 0.99);
  EXPECT_EQ(beats.beats.back().cycle, 1999);
}

TEST(BeatsTest, AlternatingIntervalsAreBothDirections) {
  RandomStream random(5, StreamPurpose::jitter);
  for (const double out_of_beat : {0.02, 0.2}) {
    std::vector<double> times;
    for (int i = 0; i < 400; ++i)
      times.push_back(1.00005 * i + (i % 2) * out_of_beat + 1e-4 * random.normal());
    times.erase(times.begin() + 101); // a missed one must not shift the sides
    ClockLog log = log_of(times);
    EXPECT_TRUE(label_alternate_edges(log, false));
    const Beats beats = number_beats(log);
    // Six times the jitter of both ends of 200 periods.
    EXPECT_NEAR(beats.typical_period_s, 2.0001, 4e-6);
    EXPECT_EQ(beats.spurious, 0);
    EXPECT_EQ(beats.longest_segment().size(), 200u);
  }
}

// A false event in the midst of a half swing leaves the sides of the others as they are.
TEST(BeatsTest, AFalseEventDoesNotSwapTickAndTock) {
  for (const double at : {0.3, 0.49, 0.5, 0.51, 0.7}) {
    std::vector<double> times;
    for (int i = 0; i < 400; ++i)
      times.push_back(i + (i % 2) * 0.02);
    times.insert(times.begin() + 201, 200.0 + at);
    ClockLog log = log_of(times);
    EXPECT_TRUE(label_alternate_edges(log, false));
    const Beats beats = number_beats(log);
    EXPECT_EQ(beats.longest_segment().size(), 200u) << at;
    EXPECT_EQ(beats.missed, 0) << at;
  }
}

// A pendulum pushed off the vertical in every second swing: the period that is told is believed.
TEST(BeatsTest, WholePeriodsThatAlternateAreOneDirection) {
  std::vector<double> times;
  for (int i = 0; i < 400; ++i)
    times.push_back(2.0 * i + (i % 2) * 1e-4);
  ClockLog log = log_of(times);
  EXPECT_FALSE(label_alternate_edges(log, false, 2.0));
  ASSERT_EQ(log.assumptions.size(), 1U);
  EXPECT_NE(log.assumptions.front().text.find("every event is taken as a crossing in the same"),
            std::string::npos);
  EXPECT_TRUE(label_alternate_edges(log, false));
}

// Far out of beat, and slow: half the period that is told and a little more is no whole period.
TEST(BeatsTest, ASlowClockFarOutOfBeatIsBothDirections) {
  for (const double period_s : {1.9996, 2.0004}) {
    std::vector<double> times;
    for (int i = 0; i < 400; ++i)
      times.push_back(period_s * (0.5 * i + (i % 2) * 0.15));
    ClockLog log = log_of(times);
    EXPECT_TRUE(label_alternate_edges(log, false, 2.0)) << period_s;
  }
}

TEST(BeatsTest, OneDirectionWithJitterIsNotTakenForTwo) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    RandomStream random(seed, StreamPurpose::jitter);
    std::vector<double> times;
    for (int i = 0; i < 50; ++i)
      times.push_back(2.0 * i + 0.01 * random.normal());
    ClockLog log = log_of(times);
    EXPECT_FALSE(label_alternate_edges(log, false));
    EXPECT_TRUE(label_alternate_edges(log, true));
  }
}

TEST(BeatsTest, DownwardCrossingsStandBetweenTheBeats) {
  Scenario scenario = test::at_point_a(20);
  scenario.sensor.edges = SensorEdges::both;
  const Beats beats = number_beats(test::simulated_log(scenario, 1));
  ASSERT_EQ(beats.beats.size(), 41u);
  EXPECT_EQ(beats.beats[1].flag, BeatFlag::down);
  EXPECT_EQ(beats.beats[1].cycle, 0);
  EXPECT_EQ(beats.beats[2].cycle, 1);
}

// Events tagged by the simulation: which cycle each belongs to, -1 for a false one.
struct Tagged {
  double time;
  std::int64_t cycle;
};

std::vector<Tagged> faulty_log(std::uint64_t seed, double missed, double spurious,
                               double jitter_s) {
  RandomStream noise(seed, StreamPurpose::jitter), faults(seed, StreamPurpose::missed);
  std::vector<Tagged> events;
  double t = 0.0;
  for (std::int64_t n = 0; n < 2000; ++n) {
    const bool seen = faults.uniform() >= missed || n < 5; // the first beats define cycle 0
    if (seen) events.push_back({t + jitter_s * noise.normal(), n});
    if (faults.uniform() < spurious && n >= 5) events.push_back({t + 2.0 * faults.uniform(), -1});
    t += 2.0 * (1.0 + 1e-4 * std::sin(0.003 * static_cast<double>(n))); // a slowly changing rate
  }
  std::stable_sort(events.begin(), events.end(),
                   [](const Tagged& a, const Tagged& b) { return a.time < b.time; });
  return events;
}

TEST(BeatsTest, NumbersEveryEventUnderFaults) {
  // 10 % missed, 10 % spurious, 0.5 % jitter: 30 logs, 54,000 good events.
  std::size_t good = 0, wrong_number = 0, lost = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const auto events = faulty_log(seed, 0.1, 0.1, 0.01);
    std::vector<double> times;
    for (const Tagged& e : events)
      times.push_back(e.time);
    const Beats beats = number_beats(log_of(times));
    ASSERT_EQ(beats.segments, 1u) << seed;
    for (std::size_t i = 0; i < events.size(); ++i) {
      if (events[i].cycle < 0) continue;
      ++good;
      if (beats.beats[i].flag == BeatFlag::spurious)
        ++lost;
      else if (beats.beats[i].flag != BeatFlag::rival && beats.beats[i].cycle != events[i].cycle)
        ++wrong_number;
    }
  }
  EXPECT_EQ(wrong_number, 0u) << "of " << good;
  // A false event that falls as near to the foreseen time as the jittered beat is a rival, so that
  // no good event need be lost but in 1 of 1e4.
  EXPECT_LE(static_cast<double>(lost), 1e-4 * static_cast<double>(good)) << "of " << good;
}

TEST(BeatsTest, TwoEventsAreNotEnough) {
  EXPECT_THROW((void)number_beats(log_of({0.0, 2.0})), InputError);
  EXPECT_THROW((void)number_beats(log_of({1.0, 1.0, 1.0, 1.0})), InputError);
}

} // namespace
} // namespace goingrate
