#include "sound_events.hpp"

#include "sound/recordings.hpp"

#include <cmath>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <unistd.h>

namespace goingrate::apps {
namespace {

struct Heard {
  double at_s;
  bool is_down;
};

// What a sound card gives that hears these samples: a program named arecord that writes them.
class MonitorSoundTest : public testing::Test {
protected:
  void SetUp() override {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::vector<Heard> hear(const std::vector<float>& samples) {
    std::ofstream raw(folder_ + "/raw", std::ios::binary);
    for (const float sample : samples) {
      const auto word = static_cast<std::int16_t>(std::lround(32767.0F * sample));
      raw.write(reinterpret_cast<const char*>(&word), 2);
    }
    raw.close();
    std::ofstream(folder_ + "/arecord") << "#!/bin/sh\nexec cat '" << folder_ << "/raw'\n";
    std::filesystem::permissions(folder_ + "/arecord", std::filesystem::perms::owner_all);
    const std::string path = std::getenv("PATH");
    ::setenv("PATH", (folder_ + ":" + path).c_str(), 1);
    const int lines =
        ::open((folder_ + "/lines").c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    EXPECT_EQ(write_sound_events("hw:'1'", lines), 0);
    ::close(lines);
    ::setenv("PATH", path.c_str(), 1);
    return read_lines();
  }
  std::vector<Heard> read_lines() {
    std::ifstream file(folder_ + "/lines");
    std::vector<Heard> heard;
    for (std::string line; std::getline(file, line);)
      if (const auto comma = line.find(','); std::isdigit(line[0]) != 0)
        heard.push_back({std::stod(line.substr(0, comma)), line.substr(comma + 1) == "down"});
    return heard;
  }

  std::string folder_ =
      testing::TempDir() + "sound-" + testing::UnitTest::GetInstance()->current_test_info()->name();
};

TEST_F(MonitorSoundTest, WindowsAreHeardAsOneClock) {
  for (const double period_s : {1.0, 1.37}) { // beats where windows meet, and not
    test::ClockSound clock;
    clock.period_s = period_s;
    clock.seconds = 260.0;
    clock.tick_minus_tock_s = period_s > 1.0 ? 0.02 : 0.0; // out of beat; in beat
    const test::Recorded recorded = test::record(clock);
    const auto heard = hear(recorded.samples);
    // The last window ends at 240 s, told up to 225 s.
    std::vector<Heard> truth;
    for (const Tick& tick : recorded.truth)
      if (tick.at / clock.rate_hz < 225.0) truth.push_back({tick.at / clock.rate_hz, tick.is_tock});
    ASSERT_EQ(heard.size(), truth.size()) << period_s << " s"; // none twice, none left out
    const bool swapped = heard[0].is_down != truth[0].is_down;
    for (std::size_t i = 0; i < heard.size(); ++i) {
      EXPECT_NEAR(heard[i].at_s, truth[i].at_s, 1e-3) << i; // a rise of a click
      EXPECT_EQ(heard[i].is_down, truth[i].is_down != swapped) << i;
    }
  }
}

TEST_F(MonitorSoundTest, TheCountGoesOnBehindAStop) {
  test::ClockSound clock;
  clock.seconds = 300.0;
  clock.gap_s = 40.0;
  const test::Recorded recorded = test::record(clock);
  const auto heard = hear(recorded.samples);
  ASSERT_GT(heard.size(), 200U);
  for (const Heard& beat : heard) { // ticks stay ticks: at whole periods from the first
    const double periods = (beat.at_s - heard[0].at_s) / clock.period_s;
    const bool is_half = std::lround(2.0 * periods) % 2 != 0;
    EXPECT_EQ(beat.is_down != heard[0].is_down, is_half) << beat.at_s;
  }
}

} // namespace
} // namespace goingrate::apps
