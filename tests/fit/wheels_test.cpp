// Logs that show the wheels of the clock's train, and logs that only seem to.
#include "goingrate/fit/clock_fit.hpp"

#include "support/simulated.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace goingrate {
namespace {

constexpr double turn_cycles = 9.3;

// The data with a sinusoid in times and amplitudes.
TimingData with_wheel(TimingData data, double late_s, double amplitude_rad) {
  for (std::size_t i = 0; i < data.size(); ++i) {
    const double turned = 2.0 * std::numbers::pi * data.cycle[i] / turn_cycles;
    data.lateness_s[i] += late_s * std::sin(turned);
    if (data.has_amplitude()) data.amplitude_rad[i] += amplitude_rad * std::cos(turned);
  }
  return data;
}

Scenario jump_with_amplitudes() {
  Scenario scenario = test::jump_from_a_to_b(3000, 1e-5);
  scenario.sensor.amplitude_rms = 1e-5;
  return scenario;
}

double rms_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values)
    sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

TEST(WheelsTest, AWheelLeavesTheClock) {
  FitOptions options;
  options.events = {{150, {"mu"}}};
  const TimingData undisturbed = timing_data(test::simulated_beats(jump_with_amplitudes(), 11));
  TimingData turning = with_wheel(undisturbed, 5e-5, 3e-5);
  level_wheels(turning);
  ASSERT_EQ(turning.wheels.size(), 2u);
  const auto &of_times = turning.wheels[0], &of_amplitudes = turning.wheels[1];
  // A hundredth of a turn in the whole log; a size to four standard errors, jitter sqrt(2/N) each.
  const double turn_s = turn_cycles * turning.reference_period_s;
  EXPECT_NEAR(of_times.turn_s, turn_s, 0.01 * turn_s * turn_cycles / 3000.0);
  EXPECT_NEAR(of_times.late_s, 5e-5, 4.0 * 1e-5 * std::sqrt(2.0 / 3000.0));
  EXPECT_EQ(of_times.amplitude_rad, 0.0);
  EXPECT_NEAR(of_amplitudes.amplitude_rad, 3e-5, 4.0 * 1e-5 * std::sqrt(2.0 / 3000.0));
  const FitSummary there = fit_clock(undisturbed, 2.0, options);
  const FitSummary here = fit_clock(turning, 2.0, options);
  ASSERT_EQ(here.status, FitStatus::converged);
  EXPECT_EQ(here.model.noise(), "jitter");
  for (const FittedParameter& parameter : there.parameters) {
    if (parameter.status != ParameterStatus::free) continue;
    // A sinusoid fitted to noise takes no more than noise off.
    EXPECT_NEAR(here.find(parameter.name)->value, parameter.value, 0.5 * parameter.sigma)
        << parameter.name;
  }
  EXPECT_EQ(here.notes.back().kind, NoteKind::wheel);
  // The residuals are those of the log as it is: they swing by 5e-5 and 3e-5, rms over sqrt 2.
  EXPECT_NEAR(rms_of(here.residual_s), std::hypot(5e-5 / std::sqrt(2.0), 1e-5), 2e-6);
  EXPECT_NEAR(rms_of(here.amplitude_residual_rad), std::hypot(3e-5 / std::sqrt(2.0), 1e-5), 2e-6);
}

TEST(WheelsTest, BothDirectionsAndMissedBeats) {
  Scenario scenario = test::at_point_b(2000);
  scenario.sensor.edges = SensorEdges::both;
  scenario.sensor.offset_rad = 2e-3; // a beat error, which alternates
  scenario.sensor.jitter_rms_s = 1e-5;
  scenario.sensor.missed = 0.05;
  TimingData data = timing_data(test::simulated_beats(scenario, 12));
  const TimingData undisturbed = data;
  level_wheels(data);
  EXPECT_TRUE(data.wheels.empty());
  data = with_wheel(data, 5e-5, 0.0);
  level_wheels(data);
  ASSERT_EQ(data.wheels.size(), 1u);
  double left = 0.0;
  for (std::size_t i = 0; i < data.size(); ++i)
    left += std::pow(data.lateness_s[i] - undisturbed.lateness_s[i], 2);
  // Beats that are missing are put between their neighbours, which costs a per cent of its size.
  EXPECT_LT(std::sqrt(left / static_cast<double>(data.size())), 0.05 * 5e-5);
}

TEST(WheelsTest, ALogWithoutOneStaysAsItIs) {
  Scenario noisy = test::at_point_b(4000);
  noisy.drive.fast_rms = 0.3;
  noisy.sensor.jitter_rms_s = 1e-5;
  noisy.sensor.amplitude_rms = 1e-5;
  for (std::uint64_t seed = 1; seed <= 20; ++seed)
    for (const Scenario& scenario :
         {jump_with_amplitudes(), noisy, test::ring_down(4000, 1e-5), test::ring_down(4000, 0.0)}) {
      const TimingData undisturbed = timing_data(test::simulated_beats(scenario, seed));
      TimingData data = undisturbed;
      level_wheels(data);
      EXPECT_TRUE(data.wheels.empty()) << seed;
      EXPECT_EQ(data.lateness_s, undisturbed.lateness_s);
    }
}

TEST(WheelsTest, RoundedTimesAreNoWheel) {
  // Steps of a tenth of a millisecond make a steady clock's times a saw-tooth.
  Scenario scenario = test::at_point_b(4000);
  TimingData data = timing_data(test::simulated_beats(scenario, 13));
  for (std::size_t i = 0; i < data.size(); ++i) {
    const double rounded = 1e-4 * std::round(1e4 * data.elapsed_s[i]);
    data.lateness_s[i] += rounded - data.elapsed_s[i];
    data.elapsed_s[i] = rounded;
  }
  level_wheels(data);
  EXPECT_TRUE(data.wheels.empty());
}

} // namespace
} // namespace goingrate
