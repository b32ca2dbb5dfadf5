#include "goingrate/log/writing.hpp"

#include "goingrate/log/reading.hpp"
#include "support/simulated.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace goingrate {
namespace {

TEST(WritingTest, ReadsBackWhatWasWritten) {
  Scenario scenario = test::at_point_a(200);
  scenario.sensor.edges = SensorEdges::both;
  scenario.sensor.jitter_rms_s = 1e-5;
  scenario.sensor.amplitude_rms = 1e-5;
  const ClockLog written = test::simulated_log(scenario, 3);
  const std::string text = native_log_text(written, 15);
  const ClockLog read = read_log(text, "x");
  ASSERT_EQ(read.events.size(), written.events.size());
  for (std::size_t i = 0; i < read.events.size(); ++i) {
    EXPECT_NEAR(read.events[i].time - written.events[i].time, 0.0, 5.1e-16); // half the last digit
    EXPECT_EQ(read.events[i].edge, written.events[i].edge);
  }
  EXPECT_EQ(native_log_text(read, 15), text) << "and the second time to the last bit";
}

TEST(WritingTest, DecimalTimesComeBackToTheBit) {
  std::string text = "# goingrate log: 1\n# nominal_period_s: 2\ntime_s\n";
  std::uint64_t state = 7;
  for (int i = 0; i < 20000; ++i) {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    text += fmt::format("{}.{:012d}\n", 1361605080 + 2 * i, (state >> 20) % 1000000000000ULL);
  }
  const ClockLog log = read_log(text, "x");
  EXPECT_EQ(native_log_text(log, 12), text);
  const ClockLog again = read_log(native_log_text(log, 12), "x");
  for (std::size_t i = 0; i < log.events.size(); ++i)
    ASSERT_EQ(again.events[i].time, log.events[i].time);
}

TEST(WritingTest, EveryColumnComesBack) {
  ClockLog log = read_log("# flag_width_rad: 0.02\ntime_s,edge,width_s,amplitude_rad,temperature_c,"
                          "pressure_mbar\n0.5,up,0.25,0.05,20.5,1013.25\n1.5,down,,0.05,,\n"
                          "2.5,up,0.25,,20.25,1013\n",
                          "x");
  const std::string text = native_log_text(log, 9);
  const ClockLog again = read_log(text, "x");
  EXPECT_EQ(native_log_text(again, 9), text);
  EXPECT_EQ(again.flag_width_rad, 0.02);
  EXPECT_EQ(again.columns.width_s[2], 0.25);
  EXPECT_EQ(again.columns.pressure_mbar[0], 1013.25);
  EXPECT_TRUE(std::isnan(again.columns.temperature_c[1]));
  EXPECT_EQ(again.events[0].time, log.events[0].time);
}

TEST(WritingTest, Stable32PhaseComesBackToTheBit) {
  Scenario scenario = test::at_point_a(500);
  scenario.sensor.jitter_rms_s = 1e-5;
  scenario.sensor.missed = 0.05;
  const auto beats = test::simulated_beats(scenario, 3);
  const std::string text = stable32_text(beats, 2.0);
  const auto errors = on_every_cycle(beats, clock_error(beats, 2.0));
  const ClockLog log = read_log(text, "x", {.tau0_s = 2.0});
  ASSERT_TRUE(log.grid);
  const auto& read = log.grid->phase_s;
  ASSERT_EQ(read.size(), errors.size());
  std::size_t gaps = 0;
  for (std::size_t i = 0; i < read.size(); ++i) {
    if (!std::isnan(errors[i])) {
      EXPECT_EQ(read[i], errors[i]) << i;
    }
    EXPECT_EQ(std::isnan(read[i]), std::isnan(errors[i])) << i;
    gaps += std::isnan(errors[i]) ? 1 : 0;
  }
  EXPECT_GT(gaps, 10u);
  EXPECT_EQ(log.format, LogFormat::phase);
  EXPECT_EQ(log.events.size(), beats.size());
}

TEST(WritingTest, TiccLinesComeBackToTheirElevenDecimals) {
  Scenario scenario = test::at_point_a(100);
  scenario.sensor.jitter_rms_s = 1e-5;
  const auto beats = test::simulated_beats(scenario, 3);
  const std::string text = ticc_text(beats);
  const ClockLog log = read_log(text, "x");
  EXPECT_EQ(log.format, LogFormat::ticc);
  ASSERT_EQ(log.events.size(), beats.size());
  EXPECT_EQ(ticc_text(log.events), text);
  for (std::size_t i = 0; i < beats.size(); ++i)
    // Two times of eleven decimals.
    EXPECT_NEAR(log.events[i].time - log.events[0].time, beats[i].time - beats[0].time, 1.1e-11);
}

TEST(WritingTest, TheParFileHasNameValueFlagSigma) {
  const auto beats = test::simulated_beats(test::at_point_a(100), 1);
  Beats all;
  all.beats = beats;
  const std::string text = par_text(summarise_rates(beats, 2.0), all);
  EXPECT_NE(text.find("\nPERIOD 1.999"), std::string::npos) << text;
  EXPECT_NE(text.find("\nNBEATS 101 0\n"), std::string::npos);
}

} // namespace
} // namespace goingrate
