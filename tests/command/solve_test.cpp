// What a clock must be to lose less than a given error: the command's figures against formulas
// worked out by hand.
#include "support/command_fixture.hpp"

#include <cmath>
#include <sstream>
#include <string>

namespace goingrate::test {
namespace {

constexpr double pi = 3.14159265358979324, day = 86400.0, week = 7.0 * day;

// Point B of the paper in a room whose temperature swings by 2 K a day, its drive noisy.
constexpr const char* clock_in_a_room = R"([clock]
nominal_period = 2.0
epsilon = 2.5e-4
mu = 4e-5
phi0 = 0.03
[drive]
fast_rms = 0.3
[length]
temperature_coefficient = 1.2e-5
[temperature]
sine = [{amplitude = 2.0, period = 86400.0}]
[run]
periods = 100
)";

// A Hipp whose impulse varies.
constexpr const char* hipp = R"([clock]
nominal_period = 2.0
epsilon = 1e-4
escapement = "single-impulse"
impulse = 3e-4
below = 0.035
[drive]
fast_rms = 0.1
[run]
periods = 100
)";

class SolveTest : public CommandTest {
protected:
  nlohmann::json solved(const std::string& scenario, const std::string& options) {
    put("clock.toml", scenario);
    const Outcome outcome = run("map --under clock.toml --json answer.json " + options);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome.code == 0 ? json("answer.json") : nlohmann::json();
  }
  static nlohmann::json find(const nlohmann::json& list, const std::string& key) {
    for (const auto& entry : list)
      if (entry["key"] == key) return entry;
    ADD_FAILURE() << key;
    return {};
  }
};

// White noise of relative size s, renewed every T0, of the drive moves the rate at once by the gain
// F = eps sqrt(q^2 - 1), in the end by G = -lambda^2/16 + eps q^2/(2 sqrt(q^2 - 1)), q =
// lambda/phi0, with the time constant tau = T0/(4 pi eps): after t the square of the time's error
// is s^2 T0 (G^2 t + (2 G (F - G) + (F - G)^2) tau), half of the last term from noise before t = 0.
double by_drive(double s, double t) {
  const double lambda2 = 2.0 * 4e-5 * 0.03 / (pi * 2.5e-4), q2 = lambda2 / 9e-4;
  const double at_once = 2.5e-4 * std::sqrt(q2 - 1.0);
  const double in_the_end = -lambda2 / 16.0 + 2.5e-4 * q2 / (2.0 * std::sqrt(q2 - 1.0));
  const double first = at_once - in_the_end, tau = 2.0 / (4.0 * pi * 2.5e-4);
  return s * std::sqrt(2.0 * (in_the_end * in_the_end * t +
                              (2.0 * in_the_end * first + first * first) * tau));
}
// A sine of the length of relative size c A: the rate's is half of it, and half a day collects
// c A/2 day/pi, whose rms over the phase is over sqrt 2.
double by_temperature(double coefficient) {
  return 0.5 * coefficient * 2.0 * day / pi / std::sqrt(2.0);
}

TEST_F(SolveTest, TheErrorIsThatOfTheFormulas) {
  const auto answer = solved(clock_in_a_room, "--solve error=0.05");
  const double drive = by_drive(0.3, week), warmth = by_temperature(1.2e-5);
  EXPECT_NEAR(find(answer["parts"], "drive.fast_rms")["rms_s"].get<double>() / drive, 1.0,
              1e-3); // the quadrature over frequencies
  EXPECT_NEAR(find(answer["parts"], "length.temperature_coefficient")["rms_s"].get<double>(),
              warmth, 1e-6 * warmth);
  EXPECT_NEAR(answer["error_s"].get<double>() / std::hypot(drive, warmth), 1.0, 1e-3);
  EXPECT_EQ(answer["after_s"], week);
}

TEST_F(SolveTest, WhatItAsksForMeetsTheLimit) {
  const double most = 0.1; // s a week; the temperature alone makes 0.23
  const auto answer = solved(clock_in_a_room, "--solve error=0.1");
  // All but the temperature makes by_drive: the rod may have what is left of the square.
  const double room = std::sqrt(most * most - std::pow(by_drive(0.3, week), 2));
  const auto rod = find(answer["requirements"], "length.temperature_coefficient");
  ASSERT_TRUE(rod["limit"].is_number()) << answer.dump(1);
  EXPECT_NEAR(rod["limit"].get<double>() / (1.2e-5 * room / by_temperature(1.2e-5)), 1.0, 0.01);
  EXPECT_TRUE(find(answer["requirements"], "drive.fast_rms")["limit"].is_null()); // not by this
  // And with that rod the clock is as good as that.
  const auto better = solved(
      clock_in_a_room, fmt::format("--solve error=0.1 --set length.temperature_coefficient={:.17g}",
                                   rod["limit"].get<double>()));
  EXPECT_NEAR(better["error_s"].get<double>(), most, 1e-6 * most);
}

// The last lines, each value put in the place of what there is, make a clock as good as asked for.
TEST_F(SolveTest, AllCausesTogetherMeetTheLimit) {
  const double most = 0.1;
  std::string compensated = clock_in_a_room;
  const std::string rod = "temperature_coefficient = 1.2e-5\n";
  compensated.insert(compensated.find(rod) + rod.size(),
                     "compensation = 1e-5\ncompensation_lag = 9000\n");
  put("clock.toml", compensated);
  const std::string text = run("map --under clock.toml --solve error=0.1").out;
  std::istringstream last(text.substr(text.find("Or all the causes together")));
  std::string line, options, key, now, then;
  for (std::getline(last, line); last >> key >> now >> then;)
    options += fmt::format(" --set {}={}", key, then);
  const auto better = solved(compensated, "--solve error=0.1" + options);
  EXPECT_NEAR(better["error_s"].get<double>(), most, 0.01 * most) // three digits are printed
      << text << options;
}

TEST_F(SolveTest, OtherTimesThanAWeek) {
  const auto answer = solved(clock_in_a_room, "--solve error=1 --after 0.25");
  // A quarter of a turn: the sine of it.
  EXPECT_NEAR(find(answer["parts"], "length.temperature_coefficient")["rms_s"].get<double>(),
              by_temperature(1.2e-5) * std::sin(0.25 * pi), 1e-9);
  EXPECT_NE(run("map --under clock.toml --solve error=1").out.find("within 7 days"),
            std::string::npos);
}

// Each impulse of energy J f lifts lambda^2 from the limit by 2 J f, and is done with when it has
// fallen back: the time moves by dt/df = -(L/32 eps)(1 - m/h), L = 2 J, h = limit^2 + L, m =
// L/ln(h/ limit^2), once in ln(h/limit^2)/(2 eps).
TEST_F(SolveTest, AClockThatWaitsForItsSwingToFall) {
  const auto answer = solved(hipp, "--solve error=1e-4");
  const double low = 0.035 * 0.035, lift = 6e-4, high = low + lift, fall = std::log(high / low);
  const double each = lift / 32e-4 * (1.0 - lift / fall / high) * 2.0 / (2.0 * pi);
  const double impulses = week / (fall / 2e-4 * 2.0 / (2.0 * pi));
  EXPECT_NEAR(answer["error_s"].get<double>() / (0.1 * each * std::sqrt(impulses)), 1.0, 0.01);
  EXPECT_EQ(find(answer["requirements"], "clock.below")["present"], 0.035);
}

TEST_F(SolveTest, WhatIsNoQuestionIsRefused) {
  put("clock.toml", clock_in_a_room);
  EXPECT_EQ(run("map --solve error=1").code, 2);
  EXPECT_EQ(run("map --under clock.toml --solve error=1 mu=1e-5").code, 2);
  EXPECT_EQ(run("map --under clock.toml --solve error=0").code, 2);
  EXPECT_EQ(run("map --under clock.toml --solve epsilon=1e-4 mu=1e-5").code, 2);
}

} // namespace
} // namespace goingrate::test
