// The clocks of data/scenarios/clocks: each runs, and swings as its first lines say.
#include "goingrate/dynamics/clock_run.hpp"

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <sstream>
#include <string>

namespace goingrate {
namespace {

const std::filesystem::path folder{GOINGRATE_SOURCE_DIR "/data/scenarios/clocks"};

// Amplitude, rad, as the file's heading has it.
const std::map<std::string, double> amplitudes{
    {"longcase-anchor", 0.053}, {"turret-gravity", 0.046}, {"synchronome", 0.035},
    {"shortt", 0.016},          {"hipp", 0.035},           {"torsion-400-day", 2.36}};

Scenario scenario_of(const std::filesystem::path& path) {
  std::ifstream in(path);
  std::stringstream text;
  text << in.rdbuf();
  return parse_scenario(text.str(), path.string());
}

TEST(ClocksTest, EachSwingsAsItsHeadingSays) {
  std::size_t seen = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    ++seen;
    const std::string name = entry.path().stem().string();
    ASSERT_TRUE(amplitudes.contains(name)) << name;
    Scenario scenario = scenario_of(entry.path());
    scenario.drive = {}; // the swing without its disturbances
    scenario.duration_s.reset();
    scenario.periods = 500;
    ClockRun run(scenario, 1);
    double sum = 0.0;
    while (const auto period = run.next())
      sum += period->amplitude_rad;
    ASSERT_EQ(run.status(), SwingStatus::crossed) << name;
    // Headings are rounded to two digits; a Hipp's swing stays up to 5 % above its limit.
    EXPECT_NEAR(sum / 500.0 / amplitudes.at(name), 1.0, 0.02) << name;
  }
  EXPECT_EQ(seen, amplitudes.size());
}

} // namespace
} // namespace goingrate
