#include "goingrate/clock/scenario.hpp"

#include "goingrate/base/errors.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace goingrate {
namespace {

constexpr const char* minimal = "[clock]\nepsilon = 2.5e-4\nmu = 2e-5\nphi0 = 0.03\n"
                                "[run]\nperiods = 10\n";

TEST(ScenarioTest, ReadsEverySection) {
  const Scenario s = parse_scenario(R"(
[clock]
nominal_period = 3.0
epsilon = 1e-4
mu = 2e-5
phi0 = 0.02
escapement = "constant-torque"
[start]
amplitude = 0.05
[run]
duration = 600.0
method = "auto"
[[event]]
at_period = 20
mu = 4e-5
[[event]]
at = 300.0
epsilon = 2e-4
[drive]
fast_rms = 0.3
slow_rms = 0.05
slow_time = 900.0
[sensor]
edges = "both"
jitter_rms = 1e-6
resolution = 1e-7
missed = 0.01
spurious = 0.02
amplitude_rms = 1e-5
)",
                                    "s.toml");
  EXPECT_EQ(s.clock.nominal_period_s, 3.0);
  EXPECT_EQ(s.clock.epsilon, 1e-4);
  EXPECT_EQ(s.start_amplitude, 0.05);
  EXPECT_EQ(s.duration_s, 600.0);
  ASSERT_EQ(s.events.size(), 2u);
  EXPECT_EQ(s.events[0].at_period, 20);
  EXPECT_EQ(s.events[1].at_s, 300.0);
  EXPECT_EQ(s.events[1].applied_to(s.clock).epsilon, 2e-4);
  EXPECT_EQ(s.events[1].applied_to(s.clock).mu, 2e-5);
  EXPECT_EQ(s.drive.slow_time_s, 900.0);
  EXPECT_EQ(s.sensor.edges, SensorEdges::both);
  EXPECT_EQ(s.sensor.amplitude_rms, 1e-5);
}

TEST(ScenarioTest, WhatIsNotSaidIsTheDefault) {
  const Scenario s = parse_scenario(minimal, "s.toml");
  EXPECT_EQ(s.clock.nominal_period_s, 2.0);
  EXPECT_FALSE(s.start_amplitude) << "stationary";
  EXPECT_EQ(s.drive.fast_rms, 0.0);
  EXPECT_FALSE(s.sensor.amplitude_rms);
}

TEST(ScenarioTest, WhatIsNotModelledMayBeThereAtZero) {
  EXPECT_NO_THROW(
      (void)parse_scenario(minimal, "s.toml", {"sensor.flag_width=0.02", "sensor.offset=1e-3"}));
  EXPECT_THROW((void)parse_scenario(minimal, "s.toml", {"sensor.offset=2"}), InputError);
  EXPECT_THROW((void)parse_scenario(minimal, "s.toml", {"sensor.edges='gate'"}), InputError)
      << "two edges need a flag";
}

TEST(ScenarioTest, OverridesReplaceOneKeyAndKeepTheRest) {
  const Scenario s = parse_scenario(minimal, "s.toml", {"clock.mu=5e-5", "sensor.jitter_rms=1e-3"});
  EXPECT_EQ(s.clock.mu, 5e-5);
  EXPECT_EQ(s.clock.epsilon, 2.5e-4);
  EXPECT_EQ(s.sensor.jitter_rms_s, 1e-3);
}

struct Bad {
  const char* text;
  std::size_t line, column;
  const char* says;
};

void PrintTo(const Bad& bad, std::ostream* out) { *out << '"' << bad.text << '"'; }

class BadScenario : public testing::TestWithParam<Bad> {};

TEST_P(BadScenario, IsRefusedWithItsPlace) {
  const Bad& bad = GetParam();
  try {
    (void)parse_scenario(bad.text, "s.toml");
    FAIL() << "accepted: " << bad.text;
  } catch (const InputError& error) {
    EXPECT_EQ(error.place().line, bad.line) << error.what();
    EXPECT_EQ(error.place().column, bad.column) << error.what();
    EXPECT_NE(std::string(error.what()).find(bad.says), std::string::npos) << error.what();
  }
}

INSTANTIATE_TEST_SUITE_P(
    Texts, BadScenario,
    testing::Values(Bad{"[clock\nepsilon=1", 1, 7, "not TOML"},
                    Bad{"[clock]\nepsilom = 1e-4\n", 2, 1, "unknown key 'clock.epsilom'"},
                    Bad{"[cloc]\n", 1, 2, "unknown section 'cloc'"},
                    Bad{"[clock]\nepsilon = \"much\"\n", 2, 11, "a number"},
                    Bad{"[run]\nperiods = 1.5\n", 2, 11, "a whole number"},
                    Bad{"[clock]\nescapement = \"anchor\"\n", 2, 14, "constant-torque"},
                    Bad{"[run]\nmethod = \"euler\"\n", 2, 10, "direct"},
                    Bad{"[clock]\nepsilon = nan\n", 2, 11, "a finite number"},
                    Bad{"event = 3\n[run]\nperiods=3\n", 1, 9, "[[event]]"},
                    Bad{"[clock]\nepsilon=-1\n[run]\nperiods=3\n", 2, 9, "epsilon = -1"},
                    Bad{"[clock]\nepsilon=1e-4\n", 0, 0, "periods or by duration"},
                    Bad{"[run]\nperiods=3\nduration=4.0\n", 1, 1, "not by both"},
                    Bad{"[run]\nperiods=3\n[start]\namplitude=2.5\n", 4, 11, "below 2"},
                    Bad{"[run]\nperiods=3\n[sensor]\nmissed=1.0\n", 4, 8, "missed"},
                    Bad{"[run]\nperiods=3\n[[event]]\nmu=1e-5\n", 3, 1, "at_period"},
                    Bad{"[run]\nperiods=3\n[clock]\nmu=1e-5\n", 0, 0, "phi0"}));

TEST(ScenarioTest, AKeyOfManyLevelsIsRefused) {
  std::string key = "a";
  for (int i = 0; i < 50000; ++i)
    key += ".a";
  std::string quoted = "'a'";
  for (int i = 0; i < 50000; ++i)
    quoted += ".'a'";
  for (const std::string& text :
       {fmt::format("{} = 1\n", key), fmt::format("[{}]\n", key),
        fmt::format("[[{}]]\nb = 1\n", key), fmt::format("{} = 1\n", quoted),
        fmt::format("{}c = {{{} = 1}}\n", minimal, key)}) {
    try {
      (void)parse_scenario(text, "deep.toml");
      FAIL();
    } catch (const InputError& error) {
      EXPECT_GT(error.place().line, 0u);
    }
  }
}

} // namespace
} // namespace goingrate
