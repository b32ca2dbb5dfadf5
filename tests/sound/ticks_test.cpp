#include "goingrate/sound/ticks.hpp"

#include "sound/pulses.hpp"
#include "sound/tick_score.hpp"

#include "goingrate/base/errors.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace goingrate::test {
namespace {

ClockSound clock_of(double period_s, double loudness_db, std::uint64_t seed) {
  ClockSound clock;
  clock.period_s = period_s;
  clock.loudness_db = loudness_db;
  clock.triple = true;
  clock.seed = seed;
  return clock;
}

TEST(TicksTest, TimesAreRightWithinTheirSigma) {
  std::uint64_t seed = 100;
  std::size_t found = 0, within68 = 0, within95 = 0;
  for (const double loudness_db : {30.0, 20.0, 10.0})
    for (const double period_s : {0.25, 1.0, 1.7}) {
      const TickScore result = score(clock_of(period_s, loudness_db, ++seed));
      EXPECT_GE(result.recall(), 0.98) << period_s << " s, " << loudness_db << " dB"; // 240 beats
      EXPECT_LE(result.false_beats, 1U) << period_s << " s, " << loudness_db << " dB";
      EXPECT_FALSE(result.swaps);
      EXPECT_NEAR(result.period_s, period_s, 2e-4 * period_s); // a tenth of a bin in 60 s and more
      EXPECT_LT(result.sigma_s, 3.0 * result.scatter_s) << loudness_db << " dB"; // nor far too large
      found += result.found;
      within68 += result.within68;
      within95 += result.within95;
    }
  // Sigma may be too large by a half (beats differ less than it allows for), not too small.
  EXPECT_GT(static_cast<double>(within68), 0.66 * static_cast<double>(found));
  EXPECT_GT(static_cast<double>(within95), 0.93 * static_cast<double>(found));
}

TEST(TicksTest, TheFirstClickIsTheBeatThoughItIsTheWeakest) {
  const TickScore result = score(clock_of(1.0, 30.0, 7));
  // 9 dB below the third one, which comes 7.4 and 8.3 ms later; the rise takes 0.1 ms.
  EXPECT_LT(std::abs(result.bias_s[0]), 1.5e-4);
  EXPECT_LT(std::abs(result.bias_s[1]), 1.5e-4);
}

TEST(TicksTest, AClockOutOfBeatKeepsItsTicksAndTocksApart) {
  ClockSound clock = clock_of(1.3, 25.0, 8);
  clock.tick_minus_tock_s = -0.06;
  const TickScore result = score(clock);
  EXPECT_EQ(result.found, result.beats);
  EXPECT_FALSE(result.swaps);
  EXPECT_NEAR(result.period_s, 1.3, 2e-4);
}

TEST(TicksTest, NoisesThatAreAlmostAsLoudAsTheClock) {
  for (const Noise noise : {Noise::hum, Noise::music}) {
    ClockSound clock = clock_of(1.0, 5.0, 9);
    clock.noise = noise;
    clock.tick_minus_tock_s = 0.02;
    const TickScore result = score(clock);
    EXPECT_GE(result.recall(), 0.9) << static_cast<int>(noise); // notes begin upon some beats
    EXPECT_LE(result.false_beats, result.beats / 20) << static_cast<int>(noise);
  }
  ClockSound clock = clock_of(1.0, 10.0, 10);
  clock.noise = Noise::speech;
  const TickScore result = score(clock);
  EXPECT_GE(result.recall(), 0.8); // two thirds of the time somebody speaks
  EXPECT_LE(result.false_beats, result.beats / 50);
}

TEST(TicksTest, GoesOnAfterSecondsOfNothing) {
  ClockSound clock = clock_of(1.3, 20.0, 11);
  clock.gap_s = 5.0;
  const TickScore result = score(clock);
  EXPECT_EQ(result.found, result.beats);
  EXPECT_EQ(result.false_beats, 0U);
  EXPECT_FALSE(result.swaps) << "a tick stays a tick";
}

TEST(TicksTest, AClockThatStopsIsNotHeardOn) {
  for (const double stops_at_s : {12.0, 25.0, 60.0})
    for (const double loudness_db : {30.0, 15.0}) {
      ClockSound clock = clock_of(1.0, loudness_db, 15);
      clock.seconds = 120.0;
      clock.stops_at_s = stops_at_s;
      clock.tick_minus_tock_s = 0.02;
      const TickScore result = score(clock);
      EXPECT_GE(result.recall(), 0.9) << stops_at_s << " s, " << loudness_db << " dB"; // the last
      EXPECT_LE(result.false_beats, 6U)
          << stops_at_s << " s, " << loudness_db << " dB"; // five beats
    }
}

TEST(TicksTest, OneSoundAPeriodIfTheNominalPeriodSaysSo) {
  ClockSound clock = clock_of(1.0, 20.0, 12);
  clock.silent_tocks = true;
  EXPECT_NEAR(score(clock).period_s, 2.0, 1e-3) << "a sound each half period, for want of better";
  const TickScore told = score(clock, 1.0);
  EXPECT_NEAR(told.period_s, 1.0, 5e-4);
  EXPECT_EQ(told.found, told.beats);
}

TEST(TicksTest, NoiseAloneIsNoClock) {
  for (const Noise noise : {Noise::white, Noise::hum, Noise::wind}) {
    ClockSound clock = clock_of(1.0, 0.0, 13);
    clock.noise = noise;
    clock.is_silent = true;
    EXPECT_EQ(score(clock).false_beats, 0U) << static_cast<int>(noise);
  }
}

TEST(TicksTest, RefusesWhatIsNoSound) {
  SoundSamples none{100.0, 10, [](std::int64_t, std::span<float>) {}};
  EXPECT_THROW(find_ticks(none), ArgumentError);
  none.rate_hz = 8000.0;
  none.read = [](std::int64_t, std::span<float> to) { std::fill(to.begin(), to.end(), 0.0F); };
  EXPECT_TRUE(find_ticks(none).ticks.empty());
  none.count = 80000;
  EXPECT_TRUE(find_ticks(none).ticks.empty()) << "silence";
  EXPECT_THROW(find_ticks(none, 7.0), ArgumentError);
}

TEST(SecondPulsesTest, TellTheSamplingRate) {
  constexpr double rate_hz = 44100.0;
  const Recorded recorded{pulses(rate_hz, 80e-6, 60.0, {7, 8, 31}), {}};
  const SecondPulses seconds(recorded.sound(rate_hz));
  EXPECT_EQ(seconds.count(), 57U);
  // An edge between two samples is told to half a sample: 0.3 / 60 s / sqrt(5) of 44100.
  EXPECT_NEAR(seconds.rate_hz() / rate_hz - 1.0, 80e-6, 4.0 * seconds.rate_sigma());
  EXPECT_LT(seconds.rate_sigma(), 1e-6);
  const double place = 0.4 * rate_hz * (1.0 + 80e-6); // the first pulse
  EXPECT_NEAR(seconds.time_at(place + 20.5 * rate_hz * (1.0 + 80e-6)), 20.5, 1e-5); // half a sample
}

} // namespace
} // namespace goingrate::test
