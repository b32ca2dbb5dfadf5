#include "goingrate/drive/drive_split.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/base/random.hpp"
#include "goingrate/log/rates.hpp"
#include "support/simulated.hpp"

#include <gtest/gtest.h>
#include <numbers>

namespace goingrate {
namespace {

std::vector<double> rates_of(const Scenario& scenario, std::uint64_t seed) {
  return rate_on_every_cycle(test::simulated_beats(scenario, seed), 2.0);
}

DriveSplit split_of(const Scenario& scenario, std::uint64_t seed, double split_hz = 0.0) {
  return split_drive(rates_of(scenario, seed), 2.0, *drive_response(scenario.clock), split_hz);
}

bool holds(const RmsEstimate& estimate, double truth) {
  return estimate.low68 <= truth && truth <= estimate.high68;
}

TEST(DriveSplitTest, RecoversBothParts) {
  // Slow drive of six relaxation times (1/(4 pi eps) = 318 periods = 637 s) beside 30 % fast drive.
  double fast = 0.0, slow = 0.0;
  int fast_inside = 0, slow_inside = 0;
  const int logs = 30;
  for (std::uint64_t seed = 1; seed <= logs; ++seed) {
    Scenario scenario = test::at_point_b(40000);
    scenario.drive = {0.3, 0.1, 4000.0};
    scenario.sensor.jitter_rms_s = 1e-6;
    const DriveSplit split = split_of(scenario, seed);
    fast += split.fast.rms / logs;
    slow += split.slow.rms / logs;
    fast_inside += holds(split.fast, 0.3) ? 1 : 0;
    slow_inside += holds(split.slow, 0.1) ? 1 : 0;
  }
  EXPECT_NEAR(fast, 0.3, 0.002); // 0.4 % each, thirty logs
  EXPECT_NEAR(slow, 0.1, 0.02);  // some six independent values per log, thirty logs
  EXPECT_GE(fast_inside, 13);    // 20.5 expected, within three standard deviations
  EXPECT_LE(fast_inside, 28);
  EXPECT_GE(slow_inside, 13);
  EXPECT_LE(slow_inside, 28);
}

TEST(DriveSplitTest, RecoversASlowDriveThatBendsTheResponse) {
  // The amplitude wanders by a fifth: with the response of one amplitude slow comes out 8 % low,
  // and one interval in ten holds the truth.
  double fast = 0.0, slow = 0.0;
  int slow_inside = 0;
  const int logs = 12;
  for (std::uint64_t seed = 1; seed <= logs; ++seed) {
    Scenario scenario = test::at_point_b(100000);
    scenario.drive = {0.3, 0.25, 637.0};
    const DriveSplit split = split_of(scenario, seed);
    fast += split.fast.rms / logs;
    slow += split.slow.rms / logs;
    slow_inside += holds(split.slow, 0.25) ? 1 : 0;
  }
  EXPECT_NEAR(fast, 0.3, 0.003);   // 0.8 % each, twelve logs: four standard errors
  EXPECT_NEAR(slow, 0.25, 0.0125); // 5 % each, twelve logs: three and a half
  EXPECT_GE(slow_inside, 4);       // 8.2 expected, within two and a half standard deviations
}

TEST(DriveSplitTest, SaysWhereASlowDriveIsRough) {
  Scenario scenario = test::at_point_b(100000);
  scenario.drive = {0.3, 0.3, 6370.0};
  scenario.sensor.jitter_rms_s = 1e-6;
  const auto rates = rates_of(scenario, 1000); // the clock stops in this one
  ASSERT_LT(rates.size(), 100000u);
  const DriveSplit split = split_drive(rates, 2.0, *drive_response(scenario.clock));
  EXPECT_NE(split.note.find("near a stall"), std::string::npos) << split.note;
  EXPECT_TRUE(holds(split.slow, 0.3));
}

TEST(DriveSplitTest, SaysWhereTheRateHardlyAnswersASlowDrive) {
  Scenario scenario = test::at_point_b(50000);
  scenario.clock.mu = 7e-5; // g_slow is almost zero
  scenario.drive = {0.3, 0.2, 637.0};
  const DriveSplit split = split_of(scenario, 1);
  EXPECT_NE(split.note.find("hardly responds"), std::string::npos) << split.note;
}

TEST(DriveSplitTest, ShortLogsOfAnyClockHaveIntervals) {
  // White and wandering rates of any size, of clocks from just above a stall on.
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    RandomStream stream(seed, StreamPurpose::jitter);
    ClockParameters clock{2.0, 1e-4 * std::exp(stream.normal()), 0.0, 0.02};
    const double amplitude = clock.phi0 * (1.003 + 0.08 * std::exp(1.5 * stream.normal()));
    clock.mu = amplitude * amplitude * std::numbers::pi * clock.epsilon / (2.0 * clock.phi0);
    const DriveResponse response = *drive_response(clock);
    const double memory = std::exp(-0.02 * std::exp(1.5 * stream.normal()));
    const double white = 0.3 * std::abs(response.fast_gain) * std::exp(2.0 * stream.normal());
    const double wander = std::abs(response.fast_gain) * std::exp(2.0 * stream.normal());
    std::vector<double> rates;
    double slow = wander * stream.normal();
    for (std::size_t i = 0; i < 64 + 4 * seed; ++i) {
      rates.push_back(slow + white * stream.normal());
      slow = memory * slow + std::sqrt(1.0 - memory * memory) * wander * stream.normal();
    }
    const DriveSplit split = split_drive(rates, 2.0, response);
    for (const RmsEstimate& part : {split.fast, split.slow, split.jitter_s}) {
      EXPECT_LE(part.low68, part.rms) << seed; // NaN is neither less nor more
      EXPECT_LE(part.rms, part.high68) << seed;
    }
  }
}

TEST(DriveSplitTest, JitterIsToldFromDrive) {
  Scenario scenario = test::at_point_b(20000);
  scenario.drive.fast_rms = 0.1;
  scenario.sensor.jitter_rms_s = 1e-4;
  const DriveSplit split = split_of(scenario, 3);
  EXPECT_NEAR(split.jitter_s.rms, 1e-4, 2e-6); // 2 %, four standard errors
  EXPECT_NEAR(split.fast.rms, 0.1, 0.02);
  EXPECT_LT(split.fast.low68, split.fast.rms);
  EXPECT_GT(split.fast.high68, split.fast.rms);
}

TEST(DriveSplitTest, JitterThatHidesTheDriveGivesAnUpperLimit) {
  Scenario scenario = test::at_point_b(4000);
  scenario.drive.fast_rms = 0.001;
  scenario.sensor.jitter_rms_s = 1e-3;
  const DriveSplit split = split_of(scenario, 1);
  EXPECT_EQ(split.fast.low68, 0.0);
  EXPECT_GT(split.fast.high68, 0.001);
  EXPECT_NE(split.note.find("hides"), std::string::npos);
}

TEST(DriveSplitTest, WithoutSlowDriveItIsAnUpperLimitOrNearIt) {
  int limits = 0; // a likelihood with a free memory finds a trace of something in most logs
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Scenario scenario = test::at_point_b(20000);
    scenario.drive.fast_rms = 0.3;
    const DriveSplit split = split_of(scenario, seed);
    EXPECT_LT(split.slow.rms, 0.15);
    EXPECT_LT(split.slow_gain, 8.0); // of log L: four standard deviations
    limits += split.slow.low68 == 0.0 ? 1 : 0;
  }
  EXPECT_GE(limits, 2);
}

TEST(DriveSplitTest, AtAFrequencyTheWholeDriveIsParted) {
  Scenario scenario = test::at_point_b(20000);
  scenario.drive.fast_rms = 0.3;
  const DriveSplit split = split_of(scenario, 2, 0.0625); // a quarter of Nyquist's
  EXPECT_TRUE(split.at_frequency);
  EXPECT_NEAR(split.slow.rms, 0.15, 0.01); // a quarter of the variance
  EXPECT_NEAR(split.fast.rms, 0.3 * std::sqrt(0.75), 0.01);
}

TEST(DriveSplitTest, WhatItCostsIsWhatClocksLose) {
  // The scatter of the time after 4000 s of 300 clocks against what the true parts predict.
  Scenario scenario = test::at_point_b(40000);
  scenario.drive = {0.3, 0.1, 2000.0};
  const auto rates = rates_of(scenario, 1);
  const DriveSplit split = split_drive(rates, 2.0, *drive_response(scenario.clock));
  ASSERT_EQ(split.costs.size(), 3u);
  scenario.periods = 43200;
  double sum2 = 0.0, sum = 0.0;
  constexpr int clocks = 200;
  for (std::uint64_t seed = 1; seed <= clocks; ++seed) {
    ClockRun run(scenario, 5000 + seed);
    double last = 0.0;
    while (const auto period = run.next())
      last = period->time_s.value();
    sum += last / clocks;
    sum2 += last * last / clocks;
  }
  const double scatter = std::sqrt(sum2 - sum * sum);
  const DriveCost& day = split.costs[0];
  EXPECT_EQ(day.after_s, 86400.0);
  const double predicted = std::hypot(day.fast_s.rms, day.slow_s.rms);
  // The scatter is known to 5 %, the prediction to what its interval says: some 15 %.
  EXPECT_NEAR(predicted, scatter, 0.4 * scatter);
  EXPECT_LT(day.slow_s.low68, day.slow_s.rms);
  EXPECT_GT(day.slow_s.high68, day.slow_s.rms);
}

TEST(DriveSplitTest, AWheelsFaultIsFoundAndIsNoFastDrive) {
  // A fault of 2 % of the drive every 60 s in 30 % noise over 1e5 periods.
  Scenario scenario = test::at_point_b(100000);
  scenario.drive.fast_rms = 0.3;
  scenario.drive.sines = {{0.02, 60.0}};
  const auto beats = test::simulated_beats(scenario, 4);
  const auto rates = rate_on_every_cycle(beats, 2.0);
  const auto lines = find_lines(rates, 2.0);
  ASSERT_EQ(lines.size(), 1u);
  const DriveResponse response = *drive_response(scenario.clock);
  EXPECT_NEAR(1.0 / lines[0].frequency_hz, 60.0, 0.02);   // the resolution, 0.018 s
  EXPECT_NEAR(drive_of(lines[0], response), 0.02, 0.006); // sigma 0.3 sqrt(2/1e5) = 0.0013
  const DriveSplit split = split_drive(without_lines(rates, 2.0, lines), 2.0, response);
  EXPECT_TRUE(split.fast.low68 < 0.301 && split.fast.high68 > 0.299);
}

TEST(DriveSplitTest, RefusesWhatItCannotSplit) {
  const DriveResponse response{3e-4, 1e-4, 2.5e-4};
  const std::vector<double> few(63, 0.0);
  EXPECT_THROW((void)split_drive(few, 2.0, response), ArgumentError);
  EXPECT_THROW((void)split_drive(std::vector<double>(64, NAN), 2.0, response), ArgumentError);
  EXPECT_THROW((void)split_drive(std::vector<double>(64, 0.0), 0.0, response), ArgumentError);
}

// Against the slow obvious way: the split with the gains of a clock a sigma on either side.
TEST(DriveSplitTest, WhatTheFitDoesNotKnowWidensTheIntervals) {
  Scenario scenario = test::at_point_b(20000);
  scenario.drive = {0.3, 0.1, 6000.0};
  const auto rates = rate_on_every_cycle(test::simulated_beats(scenario, 5), 2.0);
  const ClockParameters& clock = scenario.clock;
  FitSummary fit;
  const auto add = [&](const char* name, double value, double sigma) {
    FittedParameter parameter;
    parameter.name = name;
    parameter.value = value;
    parameter.sigma = sigma;
    fit.parameters.push_back(parameter);
  };
  add("T0", 2.0, 0.0);
  add("epsilon", clock.epsilon, 0.05 * clock.epsilon);
  add("mu", clock.mu, 0.05 * clock.mu);
  add("phi0", clock.phi0, 0.0);
  fit.correlated = {"epsilon", "mu"};
  const auto fast_of = [&](double factor_epsilon, double factor_mu) {
    ClockParameters other = clock;
    other.epsilon *= factor_epsilon;
    other.mu *= factor_mu;
    return split_drive(rates, 2.0, *drive_response(other)).fast.rms;
  };
  const double hz = std::sqrt(drive_response(clock)->corner_hz * 0.25);
  for (const double correlation : {0.0, 0.9}) {
    fit.correlation = {{1.0, correlation}, {correlation, 1.0}};
    const double by_epsilon = std::log(fast_of(1.025, 1.0) / fast_of(0.975, 1.0));
    const double by_mu = std::log(fast_of(1.0, 1.025) / fast_of(1.0, 0.975));
    const double expected =
        std::sqrt(by_epsilon * by_epsilon + by_mu * by_mu + 2.0 * correlation * by_epsilon * by_mu);
    // The gain is looked at in one frequency, the split looks at all above the corner.
    EXPECT_NEAR(relative_gain_sigma(fit, clock, hz), expected, 0.15 * expected + 0.002);
  }
}

// A slow drive may stand in for torque that a fit lacks; the amplitudes do not.
TEST(DriveSplitTest, TheGainsAreThoseOfTheAmplitudesThatWereLogged) {
  Scenario scenario = test::at_point_b(20000);
  scenario.drive = {0.03, 0.0, 0.0};
  scenario.sensor.amplitude_rms = 1e-5;
  const auto beats = test::simulated_beats(scenario, 7);
  const ClockParameters& clock = scenario.clock;
  constexpr double wrong = 0.9; // of the torque
  FitSummary fit;
  fit.status = FitStatus::converged;
  fit.model.escapement = Escapement::constant_torque;
  for (const auto& [name, value] :
       {std::pair{"T0", 2.0}, std::pair{"epsilon", clock.epsilon},
        std::pair{"mu", wrong * clock.mu}, std::pair{"phi0", clock.phi0}}) {
    FittedParameter parameter;
    parameter.name = name;
    parameter.value = value;
    parameter.sigma = 1e-3 * value;
    fit.parameters.push_back(parameter);
  }
  double amplitude = 0.0;
  for (const Beat& beat : beats)
    amplitude += beat.amplitude_rad / static_cast<double>(beats.size());
  for (const Beat& beat : beats)
    fit.amplitude_residual_rad.push_back(beat.amplitude_rad - std::sqrt(wrong) * amplitude);
  const DriveAnalysis drive = analyse_drive(beats, 2.0, fit);
  ASSERT_TRUE(drive.response && drive.split);
  // The mean of 20,000 drives of 3 % is off by 2e-4, the gain goes with its root.
  EXPECT_NEAR(drive.response->fast_gain / drive_response(clock)->fast_gain, 1.0, 1e-3);
  EXPECT_LT(drive.split->fast.low68, 0.03 * 1.01);
  EXPECT_GT(drive.split->fast.high68, 0.03 * 0.99);
}

TEST(DriveSplitTest, GainsThatMayBeNothingTellNoSize) {
  Scenario scenario = test::at_point_b(2000);
  scenario.drive = {0.3, 0.0, 0.0};
  const auto beats = test::simulated_beats(scenario, 7);
  FitSummary fit;
  fit.status = FitStatus::converged;
  fit.model.escapement = Escapement::constant_torque;
  // Within a sigma of its torque this clock stalls.
  const ClockParameters clock{2.0, 2.5e-4, 2.0e-5, 0.05};
  for (const auto& [name, value] :
       {std::pair{"T0", clock.nominal_period_s}, std::pair{"epsilon", clock.epsilon},
        std::pair{"mu", clock.mu}, std::pair{"phi0", clock.phi0}}) {
    FittedParameter parameter;
    parameter.name = name;
    parameter.value = value;
    parameter.sigma = name == std::string_view("mu") ? 0.099 * value : 0.0;
    fit.parameters.push_back(parameter);
  }
  EXPECT_FALSE(analyse_drive(beats, 2.0, fit).split);
}

} // namespace
} // namespace goingrate
