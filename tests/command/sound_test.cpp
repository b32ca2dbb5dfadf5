// Recordings of sound, as a user has them.
#include "sound/recordings.hpp"
#include "support/command_fixture.hpp"

#include <cmath>

namespace goingrate::test {
namespace {

class SoundCommandTest : public CommandTest {
protected:
  static Recorded clock(double seconds) {
    ClockSound clock;
    clock.period_s = 1.5;
    clock.tick_minus_tock_s = -0.03;
    clock.loudness_db = 30.0;
    clock.rate_hz = 16000.0;
    clock.triple = true;
    clock.seconds = seconds;
    clock.seed = 42;
    return record(clock);
  }
};

TEST_F(SoundCommandTest, EveryContainerTellsTheSameClock) {
  const auto recorded = clock(60.0);
  for (const char* name : {"a.wav", "a.flac", "a.ogg"})
    write_sound((folder_ / name).string(), {recorded.samples}, 16000.0);
  for (const char* log : {"a.wav", "a.flac", "a.ogg", "- < a.flac"}) {
    const Outcome outcome = run(std::string("rate --json a.json -o a.csv ") + log);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("ticks and tocks are heard in 60 s"), std::string::npos) << outcome.err;
    const auto rate = json("a.json");
    EXPECT_EQ(rate["format"], "wav");
    EXPECT_EQ(rate["segments"], 1);
    EXPECT_EQ(rate["missed"], 0);
    EXPECT_NEAR(rate["mean_period_s"].get<double>(), 1.5, 1e-5) << log; // 0.5 ms in 58 s: the OGG's
    // An OGG sounds up to some milliseconds before the beat.
    const double largest = std::string(log) == "a.ogg" ? 5e-3 : 5e-4;
    EXPECT_NEAR(std::abs(rate["beat_error_s"]["value"].get<double>()), 0.03, largest) << log;
    EXPECT_EQ(rate["sound"]["sampling_rate_hz"], 16000.0);
  }
}

TEST_F(SoundCommandTest, AReportShowsOneMeanBeat) {
  write_sound((folder_ / "a.wav").string(), {clock(60.0).samples}, 16000.0);
  const Outcome outcome = run("report a.wav -o a.html --figures f --json a.json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_TRUE(std::filesystem::exists(folder_ / "f/mean-beat.csv"));
  EXPECT_NE(content(folder_ / "a.html").find("One beat"), std::string::npos);
}

TEST_F(SoundCommandTest, EveryRateIsAsUncertainAsTheRecordersClock) {
  write_sound((folder_ / "a.wav").string(), {clock(120.0).samples}, 16000.0);
  write_sound((folder_ / "b.wav").string(), {clock(110.0).samples}, 16000.0);
  const Outcome outcome = run("report a.wav -o a.html --json a.json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  // 50 parts in a million are 4.32 s a day; what the beats add is less than 0.2.
  constexpr double faster = 4.32, beats = 0.2;
  const auto report = json("a.json");
  EXPECT_NEAR(report["rate"]["rate_sigma_s_per_day"].get<double>(), faster, beats);
  EXPECT_NEAR(report["rate_now"]["rate_sigma_s_per_day"].get<double>(), faster, beats);
  for (const auto& part : report["segment_rates"])
    EXPECT_NEAR(part["rate_sigma_s_per_day"].get<double>(), faster, beats);
  for (const auto& part : report["rate"]["segment_rates"])
    EXPECT_NEAR(part["rate_sigma_s_per_day"].get<double>(), faster, beats);
  EXPECT_NE(outcome.out.find(" ± 4"), std::string::npos) << outcome.out;
  ASSERT_EQ(run("fit a.wav --json f.json -o f.txt").code, 0);
  const auto fit = json("f.json");
  EXPECT_NEAR(fit["derived"]["rate_s_per_day"]["sigma"].get<double>(), faster, beats);
  for (const auto& known : fit["combinations"])
    if (known["name"] == "mean period") {
      EXPECT_NEAR(known["sigma"].get<double>(), 1.5 * 50e-6, 1e-6);
    }
  ASSERT_EQ(run("compare a.wav b.wav --json c.json -o c.txt").code, 0);
  for (const auto& one : json("c.json")["clocks"])
    EXPECT_NEAR(one["rate_excess_sigma"].get<double>(), 50e-6, 1e-6);
}

TEST_F(SoundCommandTest, SeveralRecordingsAreNotJoined) {
  std::filesystem::create_directories(folder_ / "one");
  const auto recorded = clock(20.0);
  write_sound((folder_ / "one/a.wav").string(), {recorded.samples}, 16000.0);
  write_sound((folder_ / "b.wav").string(), {recorded.samples}, 16000.0);
  EXPECT_EQ(run("rate one -o a.csv").code, 0) << "one alone in its folder";
  const Outcome two = run("rate one/a.wav b.wav -o a.csv");
  EXPECT_EQ(two.code, 3);
  EXPECT_NE(two.err.find("a recording of sound among several files"), std::string::npos);
  put("one/notes.txt", "wound at noon\n");
  EXPECT_EQ(run("rate one -o a.csv").code, 0) << "notes are no log";
  put("one/log.txt", "0\n1\n2\n3\n4\n5\n6\n7\n8\n9\n");
  const Outcome mixed = run("rate one -o a.csv");
  EXPECT_EQ(mixed.code, 3);
  EXPECT_NE(mixed.err.find("a recording of sound among several files"), std::string::npos)
      << mixed.err;
  const Outcome followed = run("rate --follow b.wav");
  EXPECT_EQ(followed.code, 3);
  EXPECT_NE(followed.err.find("expected a log that grows line by line"), std::string::npos);
}

TEST_F(SoundCommandTest, ChannelsAreCountedAndNamed) {
  write_sound((folder_ / "a.wav").string(), {pulses(16000.0, 0.0, 30.0), clock(30.0).samples},
              16000.0);
  EXPECT_EQ(run("rate a.wav --channel beat=2 --channel pps=1 --json a.json -o a.csv").code, 0);
  EXPECT_TRUE(json("a.json")["sound"]["pps"].get<bool>());
  EXPECT_LT(json("a.json")["sound"]["time_base_sigma_ppm"].get<double>(), 2.0);
  EXPECT_EQ(run("rate a.wav --channel 2 --channel pps=1 --json b.json -o b.csv").code, 0);
  EXPECT_EQ(json("b.json"), json("a.json")) << "a bare number is that of the clock's channel";
  for (const char* wrong :
       {"beat=0", "0", "3", "99999999999999999999", "pps=3", "beat=x", "tick=1", "beat="}) {
    const Outcome outcome = run(std::string("rate a.wav --channel ") + wrong);
    EXPECT_EQ(outcome.code, 2) << wrong;
  }
  EXPECT_EQ(run("rate a.wav --clock-ppm -1").code, 2);
}

} // namespace
} // namespace goingrate::test
