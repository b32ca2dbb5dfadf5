#include "goingrate/log/beats.hpp"

#include "goingrate/base/errors.hpp"
#include "log/gap_judge.hpp"
#include "support/faulty_log.hpp"
#include "support/simulated.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace goingrate {
namespace {

// Crossings of a clock with the three kinds of noise (s), period 2 s, numbered.
std::vector<Beat> noisy_clock(int count, double jitter, double walk, double rate_walk,
                              std::uint64_t seed) {
  RandomStream random(seed, StreamPurpose::jitter);
  std::vector<Beat> beats;
  double time = 0.0, period = 2.0;
  for (int n = 0; n < count; ++n) {
    beats.push_back(event_at(Instant::from_seconds(time + jitter * random.normal())));
    beats.back().cycle = n;
    time += period + walk * random.normal();
    period += rate_walk * random.normal();
  }
  return beats;
}

void remove(std::vector<Beat>& beats, int from, int to) {
  beats.erase(beats.begin() + from, beats.begin() + to);
}

TEST(NumberingNoise, FindsJitterWalkAndRateWalk) {
  // Among 20,000 beats thousands of differences show the jitter and the walk. The walk of the rate
  // shows only over more than 1000 cycles, of which there are about ten: it is found to about a
  // third, so that twice that is allowed.
  const double j = 1e-3, w = 1e-4, r = 1e-6;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const auto beats = noisy_clock(20000, j, w, r, seed);
    SecondDifferences differences;
    differences.add(beats);
    const BeatNoise noise = differences.fit();
    EXPECT_NEAR(std::sqrt(noise.jitter2), j, 0.05 * j);
    EXPECT_NEAR(std::sqrt(noise.walk2), w, 0.3 * w);
    EXPECT_NEAR(std::sqrt(noise.rate_walk2), r, 0.7 * r);
    EXPECT_GT(differences.cautious_fit().rate_walk2, noise.rate_walk2);
  }
}

TEST(NumberingNoise, ACoarseClockIsNotNoiseless) {
  // Ticks of 10 ms, 12 beats of 13 in the same place of a tick: most differences are zero.
  std::vector<double> values(1000, 0.0);
  for (std::size_t i = 0; i < values.size(); i += 13)
    values[i] = 0.01;
  EXPECT_GT(trimmed_mean_square(values), 0.0);
}

TEST(NumberingGap, ProbabilityIsTheShareOfSimulatedClocksCountedRight) {
  // The oracle: 2000 clocks whose gap holds 300 cycles in truth. The mean probability must be the
  // share that is counted right, within three of the share's sigmas (2.7 % at 0.8).
  const double walk = 0.02, jitter = 5e-3;
  const BeatNoise noise{jitter * jitter, walk * walk, 0.0};
  const GapJudge judge(noise, 2.0, 1000);
  for (const int missing : {100, 300, 900}) {
    double claimed = 0.0, right = 0.0;
    constexpr int clocks = 2000, side = 500;
    for (std::uint64_t seed = 1; seed <= clocks; ++seed) {
      auto beats = noisy_clock(2 * side + missing, jitter, walk, 0.0, seed);
      remove(beats, side, side + missing);
      const auto count = judge.count(beats, 0, side - 1, side, beats.size(), false);
      claimed += count.probability / clocks;
      right += count.cycles == missing + 1 ? 1.0 / clocks : 0.0;
    }
    const double sigma = std::sqrt(std::max(claimed * (1.0 - claimed), 1e-3) / clocks);
    EXPECT_NEAR(claimed, right, 3.0 * sigma) << missing;
  }
}

TEST(NumberingGap, ADriftOverTheGapIsCountedFromBothSides) {
  // The period grows by 2e-3 over 1000 missing cycles. Whoever predicts the end of the gap from one
  // side alone is off by the mean of that, 1e-3 in each of 1000 cycles: a whole period. Two steps
  // could look the same as a drift, so the probability must tell of a doubt.
  RandomStream random(5, StreamPurpose::jitter);
  std::vector<Beat> events;
  double time = 0.0;
  for (int n = 0; n < 5000; ++n) {
    if (n < 2000 || n >= 3000)
      events.push_back(event_at(Instant::from_seconds(time + 1e-4 * random.normal())));
    time += 2.0 * (1.0 + 2e-6 * n);
  }
  const Beats beats = number_beats(std::move(events), "drift");
  EXPECT_EQ(beats.beats.back().cycle, 4999);
  ASSERT_EQ(beats.gaps.size(), 1u);
  EXPECT_EQ(beats.gaps[0].kind, GapKind::gap);
  EXPECT_FALSE(beats.gaps[0].bridged);
  EXPECT_GT(beats.gaps[0].probability, 0.3);
}

TEST(NumberingGap, TheLongestCountableGapIsCounted) {
  const auto whole = noisy_clock(8000, 1e-3, 4e-3, 0.0, 7);
  const auto longest = number_beats(std::vector<Beat>(whole), "whole").longest_countable_gap;
  EXPECT_GT(longest, 50);
  EXPECT_LT(longest, 3000);
  auto broken = whole;
  remove(broken, 3000, 3000 + static_cast<int>(longest) / 2);
  const Beats beats = number_beats(std::move(broken), "broken");
  EXPECT_EQ(beats.segments, 1u);
  EXPECT_EQ(beats.beats.back().cycle, 7999);
}

TEST(NumberingGap, KindsAreTold) {
  auto events = noisy_clock(1200, 1e-4, 0.0, 0.0, 3);
  for (std::size_t i = 600; i < events.size(); ++i)
    events[i].time = events[i].time + 0.7; // the reference is set
  for (std::size_t i = 900; i < events.size(); ++i)
    events[i].time = events[i].time + 100.9; // the clock stops
  remove(events, 300, 302);
  const Beats beats = number_beats(std::move(events), "kinds");
  ASSERT_EQ(beats.gaps.size(), 3u);
  EXPECT_EQ(beats.gaps[0].kind, GapKind::missed);
  EXPECT_EQ(beats.gaps[1].kind, GapKind::step);
  EXPECT_EQ(beats.gaps[1].length, 0);
  EXPECT_EQ(beats.gaps[2].kind, GapKind::stop);
  EXPECT_EQ(beats.segments, 3u);
  EXPECT_EQ(name_of(GapKind::stop), "stop");
  EXPECT_EQ(beats.spurious, 0) << "the first beats after a step are good";
}

TEST(NumberingGap, AFalseBeatBesideAShortGapDoesNotSplitTheLog) {
  auto events = noisy_clock(600, 1e-6, 0.0, 0.0, 4);
  events[300].time = events[300].time + 0.015; // in place of a missed beat, far beyond the noise
  remove(events, 301, 303);
  const Beats beats = number_beats(std::move(events), "beside");
  EXPECT_EQ(beats.segments, 1u);
  for (const Gap& gap : beats.gaps)
    EXPECT_GT(gap.probability, 0.99);
}

TEST(Numbering, TwoLikelyEventsAreRivals) {
  auto events = noisy_clock(500, 0.01, 0.0, 0.0, 2);
  events.insert(events.begin() + 251, event_at(events[250].time + 0.004));
  const Beats beats = number_beats(std::move(events), "rivals");
  EXPECT_EQ(beats.rivals, 1);
  EXPECT_EQ(beats.spurious, 0);
  EXPECT_EQ(beats.beats.back().cycle, 499);
  EXPECT_EQ(name_of(BeatFlag::rival), "rival");
}

TEST(Numbering, MissedUpwardCrossingsDoNotMisnumberDownwardOnes) {
  std::vector<Beat> events;
  for (int n = 0; n < 300; ++n) {
    if (n != 100 && n != 101) events.push_back(event_at(Instant{2 * n, 0.0}));
    events.push_back(event_at(Instant{2 * n + 1, 0.06}, Edge::down));
    if (n == 200) events.push_back(event_at(Instant{2 * n + 1, 0.4}, Edge::down));
  }
  const Beats beats = number_beats(std::move(events), "both");
  EXPECT_EQ(beats.spurious, 1);
  for (const Beat& beat : beats.beats) {
    if (beat.flag == BeatFlag::down) {
      EXPECT_EQ(beat.cycle, beat.time.seconds / 2);
    }
  }
}

TEST(Numbering, EventsKeepTheirPlaces) {
  const auto made = test::FaultyLogMaker(3).make();
  const Beats beats = number_beats(made.log);
  ASSERT_EQ(beats.beats.size(), made.log.events.size());
  for (std::size_t i = 0; i < beats.beats.size(); ++i)
    EXPECT_EQ(beats.beats[i].line, i + 1);
}

TEST(Numbering, MoreSegmentsThanANumberHoldsAreRefused) {
  // The reference is set by a third of a period every fourteen beats.
  std::vector<Beat> events;
  for (int n = 0; n < 66000 * 14; ++n)
    events.push_back(event_at(Instant::from_seconds(2.0 * n + 0.67 * (n / 14))));
  EXPECT_THROW((void)number_beats(std::move(events), "steps"), InputError);
}

TEST(NumberingStudy, ShortForm) {
  test::NumberingJudge judge;
  bool sane = true;
  for (std::uint64_t seed = 1001; seed <= 1040; ++seed) {
    const auto made = test::FaultyLogMaker(seed).make();
    const Beats beats = number_beats(made.log);
    judge.add(made, beats);
    for (const Gap& gap : beats.gaps)
      sane = sane && gap.probability >= 0.0 && gap.probability <= 1.0;
  }
  const auto& score = judge.score();
  EXPECT_TRUE(sane) << "a probability outside 0 to 1";
  EXPECT_GE(static_cast<double>(score.right),
            0.99 * static_cast<double>(score.right + score.wrong));
  EXPECT_LE(score.logs_wrong, 1);
  EXPECT_LE(static_cast<double>(score.bad), 1e-4 * static_cast<double>(score.good));
  // Splitting everywhere would not do: most gaps are counted.
  const auto sure = score.bins[3].gaps + score.bins[4].gaps;
  std::int64_t all = 0;
  for (const auto& bin : score.bins)
    all += bin.gaps;
  EXPECT_GT(2 * sure, all);
}

TEST(NumberingTest, ARingDownFromALargeSwingIsCountedThrough) {
  // The period falls by 4 % on the way: its first beats are far from the typical one.
  for (const SensorEdges edges : {SensorEdges::up, SensorEdges::both}) {
    Scenario scenario = test::ring_down(400, 1e-4);
    scenario.start_amplitude = 0.8;
    scenario.clock.epsilon = 2e-3;
    scenario.sensor.edges = edges;
    const Beats beats = number_beats(test::simulated_log(scenario, 1));
    EXPECT_EQ(beats.spurious, 0);
    EXPECT_EQ(beats.missed, 0);
    EXPECT_EQ(beats.segments, 1u);
    EXPECT_EQ(beats.longest_segment().size(), 401u);
  }
}

// A clock that is read every hour by day and not at night: the readings of the next morning come
// whole hours later, as if the reference had been set, and are counted all the same.
TEST(NumberingTest, NightsWithoutReadingsAreCounted) {
  for (const std::uint64_t seed : {71, 72, 73, 74}) {
    RandomStream random(seed, StreamPurpose::jitter);
    ClockLog log;
    for (int day = 0; day < 15; ++day)
      for (int hour = 8; hour < 20; ++hour) {
        if (random.normal() < -1.5) continue; // one reading of fifteen is forgotten
        const double true_s = 3600.0 * (24 * day + hour);
        const double late_s = 4e-5 * true_s + 0.2 * random.normal();
        log.events.push_back(event_at(Instant::from_seconds(true_s + late_s)));
      }
    const Beats beats = number_beats(log, {});
    EXPECT_EQ(beats.segments, 1u) << seed;
    EXPECT_EQ(beats.beats.back().cycle - beats.beats.front().cycle,
              std::llround((beats.beats.back().time - beats.beats.front().time) / 3600.14))
        << seed;
  }
}

} // namespace
} // namespace goingrate
