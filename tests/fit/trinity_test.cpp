// The Trinity College clock, Cambridge: known facts about two of its days.
#include "goingrate/causes/diagnosis.hpp"
#include "goingrate/causes/diary.hpp"
#include "goingrate/drive/drive_history.hpp"
#include "goingrate/log/amplitude.hpp"
#include "goingrate/log/rates.hpp"
#include "goingrate/log/reading.hpp"
#include "goingrate/spectra/lines.hpp"
#include "goingrate/spectra/stability.hpp"
#include "support/real_data.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace goingrate {
namespace {

constexpr double flag_half_width = 0.012; // rad: 24 mm, one metre below the pivot

class TrinityTest : public testing::Test {
protected:
  static std::optional<ClockLog> day(const char* date) {
    const auto path = test::real_data(std::string("trinity-clock/clock") + date + ".txt");
    if (!path) return {};
    return read_log(read_text(path->string()), path->string());
  }
  static std::vector<Beat> centred(ClockLog log) {
    move_to_vertical(log, -flag_half_width, flag_half_width, 3.0);
    return number_beats(log).longest_segment();
  }
};

#define NEEDS(log)                                                                                 \
  if (!(log)) GTEST_SKIP() << "the Trinity clock's logs are not beside the project"

TEST_F(TrinityTest, FirstDayGainsWhatItsLogSays) {
  const auto log = day("2013-03-30");
  NEEDS(log);
  EXPECT_EQ(log->format, LogFormat::clock_error);
  EXPECT_TRUE(log->issues.empty());
  const Beats beats = number_beats(*log);
  EXPECT_EQ(beats.missed + beats.spurious, 0);
  const RateSummary rate = summarise_rates(beats.longest_segment(), 3.0);
  EXPECT_EQ(rate.crossings, 28800);
  EXPECT_NEAR(rate.rate_excess * 86400e3, 91.75, 0.005); // ms a day, the printed digits
  EXPECT_NEAR(rate.slope_rate_excess * 86400e3, 74.81, 0.005);
}

TEST_F(TrinityTest, FirstDaysDeviationOfTheRawDrift) {
  const auto log = day("2013-03-30");
  NEEDS(log);
  const auto beats = number_beats(*log).longest_segment();
  const std::vector<std::size_t> factors{1, 10, 100, 1000};
  const auto table = stability_table(DeviationKind::oadev, clock_error(beats, 3.0), 3.0, factors);
  EXPECT_NEAR(table.rows[0].value, 1.69e-5, 0.005e-5); // the printed digits
  EXPECT_NEAR(table.rows[1].value, 1.82e-6, 0.005e-6);
  EXPECT_NEAR(table.rows[2].value, 4.48e-7, 0.005e-7);
  EXPECT_NEAR(table.rows[3].value, 2.0e-7, 0.05e-7);
}

double robust_period_scatter(const std::vector<Beat>& beats) {
  auto rates = rate_per_period(beats, 3.0);
  const auto middle = rates.begin() + static_cast<std::ptrdiff_t>(rates.size() / 2);
  std::nth_element(rates.begin(), middle, rates.end());
  const double median = *middle;
  for (double& r : rates)
    r = std::abs(r - median);
  std::nth_element(rates.begin(), middle, rates.end());
  return 1.4826 * *middle * 3.0;
}

TEST_F(TrinityTest, EdgeCorrectionLowersTheNoise) {
  const auto log = day("2013-03-30");
  NEEDS(log);
  EXPECT_NEAR(robust_period_scatter(number_beats(*log).longest_segment()), 44.5e-6, 0.05e-6);
  EXPECT_NEAR(robust_period_scatter(centred(*log)), 31.6e-6, 0.05e-6);
}

TEST_F(TrinityTest, FirstDayIsQuiet) {
  const auto log = day("2013-03-30");
  NEEDS(log);
  EXPECT_TRUE(keep_diary(centred(*log), 3.0).changes.empty());
}

TEST_F(TrinityTest, FindsTheInterruption) {
  const auto log = day("2013-03-31");
  NEEDS(log);
  for (const bool corrected : {false, true}) {
    const auto beats = corrected ? centred(*log) : number_beats(*log).longest_segment();
    const Diary diary = keep_diary(beats, 3.0);
    ASSERT_EQ(diary.interruptions.size(), 1u);
    const Interruption& event = diary.interruptions.front();
    // 207 to 405 s. The rate begins to fall at 198 s and is back at 399 s, so a date within three
    // beats of the given ones is as good as the log allows.
    EXPECT_NEAR(event.begin.at_s, 207.0, 9.0);
    EXPECT_NEAR(event.end.at_s, 405.0, 12.0);
    EXPECT_LE(event.end.at_s, 405.0);
    EXPECT_NEAR(event.amplitude_before_rad, 46.11e-3, 0.05e-3);
    EXPECT_NEAR(event.amplitude_after_rad, 44.6e-3, 0.1e-3);
    EXPECT_LT(event.rate_change, -150e-6); // -200 to -300 ppm at once, from the vertical
    EXPECT_GT(event.rate_change, -300e-6);
    ASSERT_TRUE(event.decay);
    EXPECT_NEAR(event.decay->time_constant_s, 6500.0, 2 * event.decay->sigma_s);
    EXPECT_LT(event.decay->sigma_s, 500.0);
    ASSERT_TRUE(event.recovery);
    // About 3150 s over the first 3000 s of the log; the number depends on where the stretch ends.
    EXPECT_LT(event.recovery->longer_window_s, 3150.0);
    EXPECT_GT(event.recovery->shorter_window_s, 3150.0);
    EXPECT_NEAR(event.recovery->time_constant_s, 3150.0, 2 * event.recovery->sigma_s);
    EXPECT_LT(event.recovery->sigma_s, 500.0);
    EXPECT_FALSE(event.recovery->exponential) << "the time depends on the stretch that is fitted";
    // The amplitude follows it to the scatter of the sensor, and lambda^2 relaxes at twice the rate
    // at which lambda decays: the two frictions agree.
    EXPECT_LE(event.recovery->rms_rad, 0.021e-3);
    const double twice = 2.0 * event.recovery->time_constant_s;
    EXPECT_NEAR(twice, event.decay->time_constant_s,
                2.0 * std::hypot(2.0 * event.recovery->sigma_s, event.decay->sigma_s));
  }
}

TEST_F(TrinityTest, TheDriveStopsAndComesBack) {
  const auto log = day("2013-03-31");
  NEEDS(log);
  const TimingData data = timing_data(centred(*log));
  // Friction from the free decay, amplitude from before the interruption.
  const auto history = drive_history(data, {3.0, 7.54e-5, 46.1e-3});
  ASSERT_TRUE(history);
  double before = 0.0, without = 0.0, after = 0.0;
  int n_before = 0, n_without = 0, n_after = 0;
  for (const DrivePoint& p : history->points) {
    if (p.at_s < 170.0) before += p.relative, ++n_before;
    if (p.at_s > 230.0 && p.at_s < 360.0) without += p.relative, ++n_without;
    if (p.at_s > 600.0 && p.at_s < 3400.0) after += p.relative, ++n_after;
    EXPECT_LT(p.sigma, 0.03);
  }
  EXPECT_NEAR(before / n_before, 1.0, 0.03);   // the blocks' sigma is 0.015
  EXPECT_NEAR(without / n_without, 0.0, 0.15); // one block is a fifth of the interruption
  EXPECT_NEAR(after / n_after, 1.036, 0.01);   // and it pushes a little harder than before
}

// Why no clock with one jitter explains that day: while the drive is off, and for some minutes
// after, the beats scatter four to ten times as much as the sensor's 31 us.
TEST_F(TrinityTest, TheInterruptionShakesTheBeats) {
  const auto log = day("2013-03-31");
  NEEDS(log);
  const TimingData data = timing_data(centred(*log));
  const auto scatter_us = [&](double from_s, double to_s) { // by third differences, robust
    std::vector<double> size;
    for (std::size_t i = 0; i + 3 < data.size(); ++i) {
      const double* late = data.lateness_s.data() + i;
      if (data.elapsed_s[i] >= from_s && data.elapsed_s[i] < to_s)
        size.push_back(std::abs(late[0] - 3.0 * late[1] + 3.0 * late[2] - late[3]));
    }
    std::nth_element(size.begin(), size.begin() + size.size() / 2, size.end());
    return 1e6 * size[size.size() / 2] / 0.6745 / std::sqrt(20.0);
  };
  EXPECT_NEAR(scatter_us(0.0, 190.0), 31.0, 8.0); // 60 beats: a tenth, twice over
  EXPECT_GT(scatter_us(230.0, 430.0), 150.0);
  EXPECT_GT(scatter_us(450.0, 600.0), 60.0);
  EXPECT_NEAR(scatter_us(900.0, 50000.0), 27.0, 4.0);
}

// And why times are not white on a quiet day either: every third beat is alike (9 s), by 25 us, in
// an escapement with three legs.
TEST_F(TrinityTest, EveryThirdBeatIsAlike) {
  const auto log = day("2013-03-30");
  NEEDS(log);
  const TimingData data = timing_data(centred(*log));
  std::vector<double> rate;
  for (std::size_t i = 0; i + 1 < data.size(); ++i)
    rate.push_back((data.lateness_s[i] - data.lateness_s[i + 1]) / 3.0);
  const auto lines = find_lines(rate, 3.0);
  ASSERT_FALSE(lines.empty());
  EXPECT_NEAR(1.0 / lines.front().frequency_hz, 9.0, 1e-4);
  EXPECT_LT(lines.front().false_alarm, 1e-20);
  const auto correlation = [&](std::size_t lag) {
    double mean = 0.0, own = 0.0, shared = 0.0;
    for (const double r : rate)
      mean += r / static_cast<double>(rate.size());
    for (std::size_t i = 0; i + lag < rate.size(); ++i) {
      own += std::pow(rate[i] - mean, 2);
      shared += (rate[i] - mean) * (rate[i + lag] - mean);
    }
    return shared / own;
  };
  EXPECT_GT(correlation(3), 0.3); // jitter alone: -1/2, 0, 0; each +- 0.006
  EXPECT_LT(correlation(2), -0.2);
}

// The first day with the regulation changed by -20 ppm at some time, as a penny taken off does it.
TEST_F(TrinityTest, AChangedRegulationIsToldAsOne) {
  const auto log = day("2013-03-30");
  NEEDS(log);
  for (const double part : {0.37, 0.62}) {
    std::vector<Beat> beats = number_beats(*log).longest_segment();
    const double at_s = part * (beats.back().time - beats.front().time);
    const Instant start = beats.front().time;
    for (Beat& beat : beats)
      if (beat.time - start > at_s) beat.time = beat.time + 20e-6 * (beat.time - start - at_s);
    const Diary diary = keep_diary(beats, 3.0);
    ASSERT_EQ(diary.changes.size(), 1u);
    const Change& change = diary.changes.front();
    EXPECT_EQ(change.kind, ChangeKind::regulation);
    EXPECT_NEAR(change.at_s, at_s, 9.0); // three beats
    // The day itself wanders: its rate between any two parts of it differs by 1 ppm at most.
    EXPECT_NEAR(change.rate_after - change.rate_before, -20e-6, 1e-6);
    EXPECT_LT(std::hypot(change.rate_before_sigma, change.rate_after_sigma), 1e-6);
    const TimingData data = timing_data(beats);
    DiagnosisInput input;
    input.data = &data;
    input.nominal_period_s = 3.0;
    input.changes = diary.changes;
    const auto found = diagnose(input);
    ASSERT_FALSE(found.empty());
    EXPECT_EQ(found.front().cause, Cause::length_step) << found.front().evidence;
  }
}

} // namespace
} // namespace goingrate
