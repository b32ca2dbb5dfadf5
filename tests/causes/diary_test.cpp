#include "goingrate/causes/diary.hpp"

#include "support/simulated.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace goingrate {
namespace {

TEST(DiaryTest, FindsAndDatesAJumpOfTheDrive) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Diary diary =
        keep_diary(test::simulated_beats(test::jump_from_a_to_b(2000, 1e-5), seed), 2.0);
    ASSERT_EQ(diary.changes.size(), 1u) << seed;
    EXPECT_NEAR(static_cast<double>(diary.changes[0].cycle), 150, 1) << seed;
    // The rate jumps from 1.13e-4 to 3.22e-4 and then falls as the amplitude grows; only the jump
    // counts.
    EXPECT_NEAR(diary.changes[0].rate_change, 2.07e-4, 5e-6) << seed;
  }
}

TEST(DiaryTest, QuietLogsStayQuiet) {
  // Thirty logs without a change: a stationary clock, one with a noisy drive and a free decay.
  int alarms = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Scenario steady = test::at_point_a(3000);
    steady.sensor.jitter_rms_s = 1e-5;
    Scenario noisy = test::at_point_b(3000);
    noisy.drive.fast_rms = 0.3;
    for (const Scenario& scenario : {steady, noisy, test::ring_down(3000, 1e-5)})
      alarms +=
          static_cast<int>(keep_diary(test::simulated_beats(scenario, seed), 2.0).changes.size());
  }
  EXPECT_EQ(alarms, 0);
}

TEST(DiaryTest, NoiselessLogsRaiseNoAlarm) {
  EXPECT_TRUE(keep_diary(test::simulated_beats(test::at_point_a(2000), 1), 2.0).changes.empty());
  EXPECT_TRUE(
      keep_diary(test::simulated_beats(test::ring_down(2000, 0.0), 1), 2.0).changes.empty());
}

// Point B with the drive off from period 500 to period 600.
Scenario interrupted() {
  Scenario scenario = test::at_point_b(4000);
  ClockEvent off, on;
  off.at_period = 500;
  off.mu = 0.0;
  on.at_period = 600;
  on.mu = 4e-5;
  scenario.events = {off, on};
  scenario.sensor.jitter_rms_s = 2e-5;
  scenario.sensor.amplitude_rms = 1e-5;
  return scenario;
}

TEST(DiaryTest, AnInterruptionIsDatedAndItsTimesAreThoseOfTheFriction) {
  DiaryOptions options;
  options.recovery_window_s = 4000.0;
  const Diary diary = keep_diary(test::simulated_beats(interrupted(), 1), 2.0, options);
  ASSERT_EQ(diary.interruptions.size(), 1u);
  const Interruption& event = diary.interruptions.front();
  EXPECT_NEAR(static_cast<double>(event.begin.cycle), 500, 2);
  EXPECT_NEAR(static_cast<double>(event.end.cycle), 600, 2);
  EXPECT_NEAR(event.rate_change, -3.87e-4, 2e-5); // all that the drive adds to the rate at B
  ASSERT_TRUE(event.decay);
  ASSERT_TRUE(event.recovery);
  const double decay = 2.0 / (2 * std::numbers::pi * 2.5e-4); // T0 / (2 pi epsilon) = 1273 s
  EXPECT_NEAR(event.decay->time_constant_s, decay, 4 * event.decay->sigma_s);
  EXPECT_LT(event.decay->sigma_s, 0.05 * decay);
  // lambda^2 recovers with half the time constant of the decay. lambda itself does so only in the
  // limit of a small dip; here the dip is 15 %, hence the wide tolerance.
  EXPECT_NEAR(event.recovery->time_constant_s, 0.5 * decay, 0.1 * decay);
}

TEST(DiaryTest, DriveNoiseIsNoUnevenReturn) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Scenario scenario = interrupted();
    scenario.drive.fast_rms = 0.03;
    const Diary diary = keep_diary(test::simulated_beats(scenario, seed), 2.0);
    ASSERT_EQ(diary.interruptions.size(), 1u) << seed;
    ASSERT_TRUE(diary.interruptions[0].recovery) << seed;
    EXPECT_TRUE(diary.interruptions[0].recovery->exponential) << seed;
  }
}

TEST(DiaryTest, ABlankAmplitudeHidesNoInterruption) {
  auto beats = test::simulated_beats(interrupted(), 1);
  beats[300].amplitude_rad = NAN;
  beats[550].amplitude_rad = NAN;
  EXPECT_EQ(keep_diary(beats, 2.0).interruptions.size(), 1u);
}

// A clock whose friction, drive or regulation changes at period 1500 of 4000, by `part` relative to
// the value before.
Beats changed(ChangeKind kind, double part, std::uint64_t seed, bool amplitudes) {
  Scenario scenario = test::at_point_b(4000);
  ClockEvent event;
  event.at_period = 1500;
  if (kind == ChangeKind::friction) event.epsilon = scenario.clock.epsilon * (1.0 + part);
  if (kind == ChangeKind::drive) event.mu = scenario.clock.mu * (1.0 + part);
  if (kind == ChangeKind::regulation) event.nominal_period_s = 2.0 * (1.0 + part);
  scenario.events = {event};
  scenario.sensor.jitter_rms_s = 2e-5;
  if (amplitudes) scenario.sensor.amplitude_rms = 5e-5;
  return number_beats(test::simulated_log(scenario, seed));
}

struct ChangeCase {
  const char* name;
  ChangeKind kind;
  double part; // the size of the change, relative to the value before
  bool amplitudes;
};

class ChangeKindTest : public testing::TestWithParam<ChangeCase> {};

TEST_P(ChangeKindTest, IsToldWithTheRatesBeforeAndAfter) {
  const ChangeCase& one = GetParam();
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const auto beats = changed(one.kind, one.part, seed, one.amplitudes).longest_segment();
    const Diary diary = keep_diary(beats, 2.0);
    ASSERT_EQ(diary.changes.size(), 1u) << seed;
    const Change& change = diary.changes.front();
    // Five beats of tolerance: a change of friction only bends the curve of the clock's error, and
    // its date shows only once the effect has accumulated.
    EXPECT_NEAR(change.at_s, 3000.0, 10.0) << seed;
    EXPECT_EQ(change.kind, one.kind)
        << seed << ": " << name_of(change.kind) << " by " << change.kind_gain;
    if (one.kind != ChangeKind::regulation) continue;
    const double moved = change.rate_after - change.rate_before;
    const double sigma = std::hypot(change.rate_before_sigma, change.rate_after_sigma);
    EXPECT_NEAR(moved, -one.part, 4.0 * sigma) << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(
    , ChangeKindTest,
    testing::Values(ChangeCase{"FrictionWithAmplitudes", ChangeKind::friction, 0.28, true},
                    ChangeCase{"DriveWithAmplitudes", ChangeKind::drive, 0.1, true},
                    ChangeCase{"Drive", ChangeKind::drive, -0.1, false},
                    ChangeCase{"RegulationWithAmplitudes", ChangeKind::regulation, 2e-5, true},
                    ChangeCase{"Regulation", ChangeKind::regulation, -2e-5, false}),
    [](const auto& given) { return given.param.name; });

// A beat that comes 14 ms late, with all that follow, is no part of the rate before a later change.
TEST(DiaryTest, ADisplacementIsNoRate) {
  std::vector<Beat> beats;
  for (std::int64_t i = 0; i < 5000; ++i) {
    const auto n = static_cast<double>(i);
    double late = 1e-4 * std::max(0.0, n - 2500.0) + (i >= 1300 ? 14e-3 : 0.0);
    late += 1e-5 * std::sin(12.9898 * n); // neighbours differ
    Beat beat;
    beat.cycle = i;
    beat.time = Instant{} + (2.0 * n + late);
    beats.push_back(beat);
  }
  TimingData data = timing_data(beats);
  level_displacements(data);
  const auto level = without_displacements(beats, data);
  ASSERT_TRUE(level);
  Diary diary = keep_diary(*level, 2.0);
  ASSERT_EQ(diary.changes.size(), 1u);
  put_rates(*level, 2.0, diary);
  constexpr double within = 2e-8; // 1e-5 s in 2400 swings, and the first of them
  EXPECT_NEAR(diary.changes[0].rate_before, 0.0, within);
  EXPECT_NEAR(diary.changes[0].rate_after, -5e-5, within);
  TimingData again = timing_data(*level);
  level_displacements(again);
  EXPECT_TRUE(again.displaced.empty());
}

// While a sensor saw nothing the rate changed: both edges of the gap show it.
TEST(DiaryTest, AChangeWithinAGapIsOne) {
  std::vector<Beat> beats = test::simulated_beats(test::at_point_a(3000), 1);
  std::erase_if(beats, [](const Beat& beat) { return beat.cycle > 1000 && beat.cycle < 1600; });
  Diary diary;
  for (const std::int64_t cycle : {400, 998, 1601, 2500}) {
    Change change;
    change.cycle = cycle;
    change.at_s = 2.0 * static_cast<double>(cycle);
    change.significance = 20.0;
    change.rate_before = 1e-6 * static_cast<double>(cycle);
    change.rate_after = 2e-6 * static_cast<double>(cycle);
    diary.changes.push_back(change);
  }
  join_changes_across_gaps(beats, diary);
  ASSERT_EQ(diary.changes.size(), 3U);
  EXPECT_EQ(diary.changes[1].cycle, 1299);
  EXPECT_EQ(diary.changes[1].rate_before, 998e-6);
  EXPECT_EQ(diary.changes[1].rate_after, 3202e-6);
  // Opposite steps at its ends: the clock goes on as before.
  diary.changes[1].cycle = 998;
  diary.changes[1].rate_before_sigma = 1e-3;
  Change back = diary.changes[1];
  back.cycle = 1601;
  back.rate_after_sigma = 1e-3;
  diary.changes.insert(diary.changes.begin() + 2, back);
  join_changes_across_gaps(beats, diary);
  EXPECT_EQ(diary.changes.size(), 2U);
}

TEST(DiaryTest, AShortLogHasNoDiary) {
  EXPECT_TRUE(keep_diary(test::simulated_beats(test::at_point_a(50), 1), 2.0).changes.empty());
}

} // namespace
} // namespace goingrate
