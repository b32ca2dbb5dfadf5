#include "goingrate/analysis/load.hpp"

#include "sound/recordings.hpp"
#include "support/scratch_folder.hpp"

#include "goingrate/base/errors.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

namespace goingrate::test {
namespace {

class SoundLogTest : public ScratchFolderTest {
protected:
  static ClockSound clock() {
    ClockSound clock;
    clock.period_s = 1.0002;
    clock.tick_minus_tock_s = 0.02;
    clock.loudness_db = 30.0;
    clock.rate_hz = 22050.0;
    clock.seconds = 90.0;
    clock.seed = 41;
    return clock;
  }
  [[nodiscard]] NumberedLog loaded(const std::string& name, ReadingOptions reading = {}) const {
    LoadRequest request;
    request.path = path(name);
    request.reading = std::move(reading);
    return load(request);
  }
};

TEST_F(SoundLogTest, TheRateIsAsUncertainAsTheRecordersClock) {
  write_sound(path("clock.wav"), {record(clock()).samples}, 22050.0);
  const NumberedLog log = loaded("clock.wav");
  EXPECT_EQ(log.log.format, LogFormat::sound);
  EXPECT_EQ(log.beats.segments, 1U);
  EXPECT_EQ(log.beats.missed, 0);
  const RateSummary rate = mean_rate(log);
  EXPECT_NEAR(rate.mean_period_s, 1.0002, 2e-6); // ends to 10 us over 89 s, and more
  EXPECT_NEAR(rate.mean_period_sigma_s, 50e-6, 1e-6);
  ASSERT_TRUE(log.sensor.beat_error_s);
  // The difference of the two half periods, twice how far tock is from the middle; each kind begins
  // to within its rise.
  EXPECT_NEAR(std::abs(log.sensor.beat_error_s->value), 0.02, 3.0 * log.sensor.beat_error_s->sigma);
  EXPECT_LT(log.sensor.beat_error_s->sigma, 1e-3);
  ReadingOptions measured;
  measured.clock_ppm = 2.0;
  EXPECT_NEAR(mean_rate(loaded("clock.wav", measured)).mean_period_sigma_s, 2e-6, 5e-7);
}

TEST_F(SoundLogTest, PulsesOfASecondChannelMakeTheRateAbsolute) {
  // The recorder is 80 ppm fast: in its samples the clock is slow, which the pulses undo.
  ClockSound heard = clock();
  heard.period_s *= 1.0 + 80e-6;
  heard.tick_minus_tock_s *= 1.0 + 80e-6;
  const auto samples = record(heard).samples;
  write_sound(path("both.wav"), {samples, pulses(22050.0, 80e-6, 90.0, {30})}, 22050.0);
  const RateSummary by_itself = mean_rate(loaded("both.wav"));
  EXPECT_NEAR(by_itself.mean_period_s, 1.0002 * (1.0 + 80e-6), 2e-6);
  ReadingOptions reading;
  reading.pps_channel = 2;
  const NumberedLog log = loaded("both.wav", reading);
  ASSERT_TRUE(log.log.sound);
  EXPECT_TRUE(log.log.sound->has_pps);
  const RateSummary rate = mean_rate(log);
  EXPECT_LT(rate.mean_period_sigma_s, 2e-6); // two ends to a tenth of a sample over 89 s
  EXPECT_NEAR(rate.mean_period_s, 1.0002, 3.0 * rate.mean_period_sigma_s);
  reading.beat_channel = 2;
  EXPECT_THROW((void)loaded("both.wav", reading), ArgumentError) << "a clock against itself";
  reading.beat_channel = 1;
  ClockSound slow = heard;
  slow.period_s = 1.4;
  write_sound(path("two.wav"), {samples, record(slow).samples}, 22050.0);
  EXPECT_THROW((void)loaded("two.wav", reading), InputError) << "such ticks are no seconds";
}

TEST_F(SoundLogTest, BytesInMemoryAreReadAsTheFile) {
  write_sound(path("clock.flac"), {record(clock()).samples}, 22050.0);
  std::ifstream file(path("clock.flac"), std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  const ClockLog by_memory = read_log(bytes.str(), "clock.flac");
  const ClockLog by_file = read_log_file(path("clock.flac"));
  ASSERT_EQ(by_memory.events.size(), by_file.events.size());
  for (std::size_t i = 0; i < by_file.events.size(); ++i)
    EXPECT_EQ(by_memory.events[i].time, by_file.events[i].time);
}

TEST_F(SoundLogTest, AWatchsNominalPeriodIsThatOfItsTrain) {
  ClockSound watch = clock();
  watch.period_s = 0.25 * 1.0003;
  watch.tick_minus_tock_s = 0.001;
  watch.seconds = 30.0;
  write_sound(path("watch.wav"), {record(watch).samples}, 22050.0);
  const NumberedLog log = loaded("watch.wav");
  EXPECT_EQ(log.nominal_period_s, 0.25); // 28,800 beats an hour
  EXPECT_NEAR(mean_rate(log).rate_excess, -3e-4, 3e-6);
}

TEST_F(SoundLogTest, SaysWhatIsWrong) {
  const auto fault = [&](const std::string& name, const ReadingOptions& reading = {}) {
    try {
      (void)loaded(name, reading);
    } catch (const std::exception& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  ClockSound stands;
  stands.rate_hz = 8000.0;
  stands.seconds = 20.0;
  stands.is_silent = true;
  write_sound(path("noise.wav"), {record(stands).samples}, 8000.0);
  EXPECT_NE(fault("noise.wav").find("in which nothing repeats"), std::string::npos);
  ReadingOptions reading;
  reading.beat_channel = 2;
  EXPECT_NE(fault("noise.wav", reading).find("a channel of the recording, 1 to 1"),
            std::string::npos);
  reading = {};
  reading.format = LogFormat::table;
  EXPECT_NE(fault("noise.wav", reading).find("found a recording of sound"), std::string::npos);
  reading.format = LogFormat::sound;
  std::ofstream(path("log.txt")) << "1\n2\n3\n4\n";
  EXPECT_NE(fault("log.txt", reading).find("expected a recording: WAV, FLAC or OGG"),
            std::string::npos);
  std::ofstream(path("broken.wav"), std::ios::binary) << "RIFF\x10\x20\x30\x40WAVEfmt nonsense";
  EXPECT_NE(fault("broken.wav").find("broken.wav: found a recording"), std::string::npos);
  write_sound(path("cut.wav"), {record(clock()).samples}, 22050.0);
  std::filesystem::resize_file(path("cut.wav"), 2'000'000); // half of it
  const NumberedLog cut = loaded("cut.wav");
  EXPECT_TRUE(std::any_of(cut.log.assumptions.begin(), cut.log.assumptions.end(),
                          [](const Assumption& one) {
                            return one.text.find("the recording breaks off") != std::string::npos;
                          }));
  write_sound(path("short.flac"), {pulses(8000.0, 0.0, 3.0)}, 8000.0);
  std::filesystem::resize_file(path("short.flac"), 12000);
  EXPECT_NE(fault("short.flac").find("cannot be read on"), std::string::npos);
  std::ofstream(path("broken.ogg"), std::ios::binary) << "OggS" << std::string(5000, '\x7f');
  EXPECT_NE(fault("broken.ogg").find("a recording that cannot be read"), std::string::npos);
}

} // namespace
} // namespace goingrate::test
