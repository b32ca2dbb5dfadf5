// The clock estimated from amplitudes and times together.
#include "fit/amplitude_clock.hpp"

#include "fit/fit_setup.hpp"
#include "support/prior_clocks.hpp"

#include <gtest/gtest.h>

namespace goingrate::timing_model {
namespace {

std::optional<AmplitudeClock> found_in(const TimingData& data, const FitOptions& options = {},
                                       const ModelChoice& model = {}) {
  return amplitude_clock(data, make_parameters(options, data, model));
}

TEST(AmplitudeClockTest, FindsTheClockUnderARoughDrive) {
  int found = 0;
  constexpr std::uint64_t first = 7301, clocks = 20;
  for (std::uint64_t seed = first; seed < first + clocks; ++seed) {
    const test::DrawnClock drawn = test::ClockPrior(seed).draw_rough();
    const auto clock = found_in(timing_data(test::simulated_beats(drawn.scenario, seed)));
    if (!clock) continue;
    const auto near = [&](const char* name, double value, double part) {
      return std::abs(value / drawn.truth.at(name) - 1.0) < part;
    };
    // As near as a search needs; what noise of the amplitudes hides is not to be had.
    found += near("T0", clock->T0, 1e-4) && near("epsilon", clock->epsilon, 0.2) &&
                     near("phi0", clock->phi0, 0.2)
                 ? 1
                 : 0;
  }
  EXPECT_GE(found, 15);
}

// By the averaged equations themselves nothing is left over.
TEST(AmplitudeClockTest, IsExactWithoutNoiseToFirstOrder) {
  Scenario scenario = test::at_point_b(3000);
  scenario.method.method = Method::averaged1;
  scenario.start_amplitude = 0.05;
  scenario.sensor.amplitude_rms = 0.0;
  const auto clock = found_in(timing_data(test::simulated_beats(scenario, 1)));
  ASSERT_TRUE(clock);
  // The sums over a block of eight beats stand for integrals.
  EXPECT_NEAR(clock->T0, 2.0, 1e-5);
  EXPECT_NEAR(clock->epsilon / 2.5e-4, 1.0, 0.02);
  EXPECT_NEAR(clock->phi0 / 0.03, 1.0, 0.02);
}

TEST(AmplitudeClockTest, CountsTheCircularErrorOfAWideSwing) {
  Scenario scenario;
  scenario.clock = {2.0, 1e-5, 2.4e-5, 0.06};
  scenario.periods = 1000;
  scenario.method.method = Method::direct;
  scenario.start_amplitude = 0.3;
  scenario.sensor.amplitude_rms = 0.0;
  FitOptions options;
  options.fixed = {{"epsilon", 1e-5}, {"phi0", 0.06}};
  const auto clock = found_in(timing_data(test::simulated_beats(scenario, 1)), options);
  ASSERT_TRUE(clock);
  // The escapement's part, 5e-5 s a second, is known to a few hundredths; the circular error of
  // second order is 7e-5.
  EXPECT_NEAR(clock->T0, 2.0, 8e-6);
}

TEST(AmplitudeClockTest, HoldsWhatIsHeld) {
  const test::DrawnClock drawn = test::ClockPrior(7301).draw_rough();
  const TimingData data = timing_data(test::simulated_beats(drawn.scenario, 7301));
  FitOptions options;
  options.fixed = {{"T0", drawn.truth.at("T0")}, {"phi0", 0.9 * drawn.truth.at("phi0")}};
  const auto clock = found_in(data, options);
  ASSERT_TRUE(clock);
  EXPECT_DOUBLE_EQ(clock->T0, drawn.truth.at("T0"));
  EXPECT_DOUBLE_EQ(clock->phi0, 0.9 * drawn.truth.at("phi0"));
}

TEST(AmplitudeClockTest, SaysNothingWithoutAmplitudesOrATorque) {
  const test::DrawnClock drawn = test::ClockPrior(7301).draw_rough();
  TimingData data = timing_data(test::simulated_beats(drawn.scenario, 7301));
  ModelChoice free;
  free.escapement = Escapement::none;
  EXPECT_FALSE(found_in(data, {}, free));
  for (std::size_t i = 0; i < data.size(); i += 2)
    data.amplitude_rad[i] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(found_in(data));
  data.amplitude_rad.clear();
  EXPECT_FALSE(found_in(data));
}

} // namespace
} // namespace goingrate::timing_model
