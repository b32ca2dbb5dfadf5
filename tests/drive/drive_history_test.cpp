#include "goingrate/drive/drive_history.hpp"

#include "goingrate/dynamics/stationary.hpp"
#include "support/simulated.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace goingrate {
namespace {

// A drive that goes up and down by a tenth in 1500 s; the simulator's own is the truth.
Scenario swaying_clock() {
  Scenario scenario = test::at_point_b(5000);
  scenario.drive.sines = {{0.1, 1500.0}};
  scenario.sensor.jitter_rms_s = 1e-5;
  return scenario;
}

double true_drive(double t) { return 1.0 + 0.1 * std::sin(2.0 * M_PI * t / 1500.0); }

DriveModel model_of(const Scenario& scenario, bool with_gains) {
  const DriveResponse response = *drive_response(scenario.clock);
  DriveModel model{scenario.clock.nominal_period_s, scenario.clock.epsilon,
                   *stationary_amplitude(scenario.clock)};
  if (with_gains) {
    model.fast_gain = response.fast_gain;
    model.slow_gain = response.slow_gain;
  }
  return model;
}

// Fraction of the blocks with the truth within one sigma, and the rms error.
struct Outcome {
  double within = 0.0, rms = 0.0, sigma = 0.0;
};

Outcome outcome_of(const DriveHistory& history) {
  Outcome outcome;
  const auto n = static_cast<double>(history.points.size());
  for (const DrivePoint& p : history.points) {
    const double error = p.relative - true_drive(p.at_s);
    outcome.within += (std::abs(error) < p.sigma) / n;
    outcome.rms += error * error / n;
    outcome.sigma += p.sigma / n;
  }
  outcome.rms = std::sqrt(outcome.rms);
  return outcome;
}

TEST(DriveHistoryTest, FromAmplitudesAlone) {
  Scenario scenario = swaying_clock();
  scenario.sensor.amplitude_rms = 1e-5;
  const TimingData data = timing_data(test::simulated_beats(scenario, 1));
  const auto history = drive_history(data, model_of(scenario, false), 40.0);
  ASSERT_TRUE(history);
  EXPECT_TRUE(history->from_amplitude && !history->from_rate);
  const Outcome outcome = outcome_of(*history);
  EXPECT_LT(outcome.rms, 0.04);   // of a sway of 0.1
  EXPECT_GT(outcome.within, 0.5); // 250 blocks that hang together by tens: 0.68 +- 0.1
  EXPECT_LT(outcome.sigma, 0.06);
}

TEST(DriveHistoryTest, FromTheRateThroughTheResponse) {
  const Scenario scenario = swaying_clock();
  const TimingData data = timing_data(test::simulated_beats(scenario, 2));
  const auto history = drive_history(data, model_of(scenario, true), 40.0);
  ASSERT_TRUE(history);
  EXPECT_TRUE(!history->from_amplitude && history->from_rate);
  // The mean rate is not known beforehand, so what slow gain leaves of a constant drive is not
  // either: the first periods of the sway are what is compared.
  const Outcome outcome = outcome_of(*history);
  EXPECT_LT(outcome.rms, 0.02);
  EXPECT_GT(outcome.within, 0.5);
}

TEST(DriveHistoryTest, BothTogetherAreBetterThanEither) {
  Scenario scenario = swaying_clock();
  scenario.sensor.amplitude_rms = 1e-5;
  const TimingData data = timing_data(test::simulated_beats(scenario, 3));
  const double alone = outcome_of(*drive_history(data, model_of(scenario, false), 40.0)).sigma;
  const double both = outcome_of(*drive_history(data, model_of(scenario, true), 40.0)).sigma;
  EXPECT_LT(both, 0.7 * alone);
}

TEST(DriveHistoryTest, NothingToGoByGivesNothing) {
  const Scenario scenario = swaying_clock();
  const TimingData data = timing_data(test::simulated_beats(scenario, 2));
  EXPECT_FALSE(drive_history(data, model_of(scenario, false)));
  EXPECT_FALSE(drive_history(data, model_of(scenario, true), 2000.0)); // five blocks
}

} // namespace
} // namespace goingrate
