// Intervals of Q if friction may lie on its bounds, and what a fit says about a free pendulum.
#include "fit/friction_cone.hpp"

#include "goingrate/base/random.hpp"
#include "goingrate/dynamics/swing_loss.hpp"
#include "goingrate/fit/clock_fit.hpp"
#include "support/simulated.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <utility>

namespace goingrate {
namespace {

using timing_model::FrictionCone;

// Three sizes that are seen together with strong correlations, as linear, quadratic and dry
// friction are by a ring-down.
struct Seen {
  Eigen::MatrixXd covariance = Eigen::MatrixXd(3, 3);
  Seen() {
    covariance << 1.0, -0.9, -0.85, //
        -0.9, 1.0, 0.6,             //
        -0.85, 0.6, 1.0;
  }
};

TEST(RingDownTest, IntervalsOnTheBoundsCover) {
  const Seen seen;
  const Eigen::MatrixXd information = seen.covariance.inverse();
  const Eigen::MatrixXd root = seen.covariance.llt().matrixL();
  RandomStream chance(20, StreamPurpose::jitter);
  constexpr int draws = 100;
  for (const Eigen::Vector3d& truth :
       {Eigen::Vector3d(6.0, 0.0, 0.0), Eigen::Vector3d(0.0, 6.0, 0.0),
        Eigen::Vector3d(0.0, 0.0, 6.0), Eigen::Vector3d(4.0, 1.0, 0.0),
        Eigen::Vector3d(8.0, 7.0, 9.0)})
    for (const Eigen::Vector3d& h : {Eigen::Vector3d(1.0, 1.0, 1.0), Eigen::Vector3d(1.0, 2.5, 0.4),
                                     Eigen::Vector3d(1.0, 0.4, 2.5)}) {
      int in68 = 0, in95 = 0;
      for (int k = 0; k < draws; ++k) {
        const Eigen::Vector3d noise(chance.normal(), chance.normal(), chance.normal());
        const FrictionCone cone(truth + root * noise, information, {true, true, true});
        const double v = h.dot(truth);
        const auto near = cone.interval(h, 1.0), wide = cone.interval(h, 1.959964);
        in68 += v >= near[0] && v <= near[1];
        in95 += v >= wide[0] && v <= wide[1];
      }
      // The draws are about the likeliest f and not the true: three per cent that they may fall
      // short by, and three standard deviations of the counts.
      EXPECT_GT(in68, draws * 0.65 - 3.0 * std::sqrt(draws * 0.68 * 0.32)) << truth.transpose();
      EXPECT_GT(in95, draws * 0.92 - 3.0 * std::sqrt(draws * 0.95 * 0.05)) << truth.transpose();
      EXPECT_LT(in68, draws * 0.9) << truth.transpose() << " by " << h.transpose();
    }
}

Scenario dry_ring_down(double T0_s, double dry, double swing, std::int64_t periods) {
  Scenario scenario;
  scenario.clock.nominal_period_s = T0_s;
  scenario.clock.escapement = Escapement::none;
  scenario.clock.epsilon = 0.0;
  scenario.clock.dry_friction = dry;
  scenario.start_amplitude = swing;
  scenario.periods = periods;
  scenario.sensor.jitter_rms_s = 1e-5;
  return scenario;
}

// Linear friction may be none at all: held at the least that a clock has, it would leave errors of
// a hundred sigma.
TEST(RingDownTest, FrictionMayBeDryAlone) {
  Scenario scenario = dry_ring_down(2.006, 3e-5, 0.15, 1000);
  scenario.sensor.amplitude_rms = 1e-5;
  const FitSummary fit =
      fit_clock(timing_data(test::simulated_beats(scenario, 3)), 2.006, FitOptions{});
  ASSERT_TRUE(fit.decay);
  for (const auto& [name, truth] :
       {std::pair{"T0", 2.006}, std::pair{"dry_friction", 3e-5}, std::pair{"lambda0", 0.15}}) {
    const FittedParameter* found = fit.find(name);
    ASSERT_NE(found, nullptr) << name;
    EXPECT_NEAR(found->value, truth, 4.0 * found->sigma) << name;
    EXPECT_LT(found->sigma, 1e-4 * truth) << name; // known to 4e-5 at worst
  }
}

// First order, by which the search begins, stops so short a swing before the log ends.
TEST(RingDownTest, AFewSwingsUnderDryFrictionTellTheirQ) {
  const FitSummary fit =
      fit_clock(timing_data(test::simulated_beats(dry_ring_down(1.2, 5.56e-4, 0.1, 30), 4)), 1.2,
                FitOptions{});
  EXPECT_EQ(fit.model.escapement, Escapement::none);
  EXPECT_EQ(fit.dynamics, FitDynamics::map);
  const FittedParameter* T0 = fit.find("T0");
  EXPECT_NEAR(T0->value, 1.2, 4.0 * T0->sigma);
  ASSERT_TRUE(fit.decay && std::isfinite(fit.decay->q.sigma));
  // By dry friction, Q is pi A/(4 f).
  const double q = std::numbers::pi * fit.decay->amplitude_rad / (4.0 * 5.56e-4);
  EXPECT_NEAR(fit.decay->q.value, q, 4.0 * fit.decay->q.sigma);
}

TEST(RingDownTest, ADrivenClockHasNoDecay) {
  FitOptions options;
  options.events = {{150, {"mu"}}};
  const FitSummary fit = fit_clock(
      timing_data(test::simulated_beats(test::jump_from_a_to_b(1000, 1e-6), 3)), 2.0, options);
  EXPECT_FALSE(fit.decay);
  EXPECT_TRUE(std::isfinite(fit.q_factor.value));
}

// Dry friction in addition to linear: 1/(2 epsilon) would be twice the Q of the swing.
// The swing of a clock falls by a twentieth in 8000 swings, as its weight nears the floor. A free
// pendulum would need a Q of 500 000 for that.
TEST(RingDownTest, AClockWhoseSwingFadesIsNotFree) {
  RandomStream noise(88, StreamPurpose::jitter);
  std::vector<Beat> beats;
  double time = 0.0;
  constexpr int swings = 8000;
  for (int n = 0; n < swings; ++n) {
    const double amplitude = 0.042 * (1.0 - 0.05 * n / swings);
    beats.push_back(event_at(Instant::from_seconds(time + 2e-5 * noise.normal()), Edge::up, 0,
                             amplitude + 1e-4 * noise.normal()));
    beats.back().cycle = n;
    time += 1.9996 * (1.0 + amplitude * amplitude / 16.0);
  }
  const FitSummary fit = fit_clock(timing_data(beats), 2.0, {});
  EXPECT_NE(fit.model.escapement, Escapement::none);
  EXPECT_FALSE(fit.decay);
}

TEST(RingDownTest, QIsNotThatOfTheLinearPartAlone) {
  Scenario scenario = test::ring_down(1000, 1e-5);
  scenario.clock.epsilon = 1e-4;
  scenario.clock.dry_friction = 6e-6;
  scenario.sensor.amplitude_rms = 1e-4;
  const FitSummary fit = fit_clock(timing_data(test::simulated_beats(scenario, 5)), 2.0, {});
  ASSERT_TRUE(fit.decay);
  const Decay& decay = *fit.decay;
  EXPECT_EQ(decay.laws.front().friction, "linear + dry");
  EXPECT_FALSE(decay.law_is_open());
  const Friction friction{1e-4, 0.0, 6e-6};
  ASSERT_EQ(decay.q_at_amplitude.size(), 9u);
  for (const QAtAmplitude& at : decay.q_at_amplitude)
    EXPECT_NEAR(at.q.value, quality_factor(friction, at.amplitude_rad), 4.0 * at.q.sigma)
        << at.amplitude_rad;
  EXPECT_LT(fit.q_factor.value, 0.8 / (2.0 * 1e-4));
  EXPECT_EQ(fit.q_factor.value, decay.q.value);
}

FitSummary free_fit(const Scenario& scenario, std::uint64_t seed) {
  FitOptions options;
  options.escapement = Escapement::none;
  return fit_clock(timing_data(test::simulated_beats(scenario, seed)), 2.0, options);
}

// A fit may have another law than the best: its swing would fall from and to other amplitudes.
TEST(RingDownTest, TheSwingFallsAsTheBestLawHasIt) {
  Scenario scenario = test::ring_down(1000, 1e-4);
  scenario.clock.epsilon = 0.0;
  scenario.clock.dry_friction = 6e-5;
  scenario.start_amplitude = 0.3;
  const FitSummary fit = free_fit(scenario, 5);
  ASSERT_TRUE(fit.decay);
  scenario.sensor.amplitude_rms = 1e-9;
  const std::vector<Beat> truth = test::simulated_beats(scenario, 5);
  for (const auto& [found, beat] :
       {std::pair{fit.decay->first, truth.front()}, std::pair{fit.decay->last, truth.back()}}) {
    ASSERT_TRUE(std::isfinite(found.rad));
    EXPECT_NEAR(found.rad, beat.amplitude_rad, 3.0 * found.sigma_rad);
    EXPECT_LT(found.sigma_rad, 0.1 * found.rad);
  }
  const FittedParameter& T0 = fit["T0"];
  EXPECT_NEAR(T0.value, scenario.clock.nominal_period_s, 4.0 * T0.sigma);
  EXPECT_LT(T0.sigma, 1e-4) << "of " << fit.model.friction();
}

// A coefficient of a law is known as far as the laws are.
TEST(RingDownTest, FrictionIsStatedForEveryOpenLaw) {
  int open = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    Scenario scenario = test::ring_down(80, 2.8e-4);
    scenario.clock.epsilon = 1e-3;
    scenario.clock.quadratic_drag = 1e-3;
    scenario.start_amplitude = 0.2;
    const FitSummary fit = free_fit(scenario, seed);
    ASSERT_TRUE(fit.decay) << seed;
    const FittedParameter& epsilon = fit["epsilon"];
    for (const FrictionLaw& law : fit.decay->laws) {
      if (!law.is_open() || law.friction == fit.model.friction()) continue;
      ++open;
      const bool has_linear = law.friction.starts_with("linear");
      EXPECT_GE(law.epsilon, 0.0) << law.friction << ", "
                                  << seed; // 0 if the other term explains all
      if (!has_linear) {
        EXPECT_EQ(law.epsilon, 0.0) << law.friction << ", " << seed;
        EXPECT_EQ(epsilon.status, ParameterStatus::undetermined) << law.friction << ", " << seed;
      } else if (std::isfinite(epsilon.value)) {
        EXPECT_LE(epsilon.low68, law.epsilon) << law.friction << ", " << seed;
        EXPECT_GE(epsilon.high68, law.epsilon) << law.friction << ", " << seed;
      }
    }
  }
  EXPECT_GT(open, 0);
}

// Times alone show gravity's share and the square of the amplitude as one product, but for what is
// beyond the circular error of first order; periods grow or fall as the swing dies away.
TEST(RingDownTest, GravitysShareFromTimesAlone) {
  for (const double share : {1.0, 0.5, -0.5}) {
    Scenario scenario = test::ring_down(400, 5e-5);
    scenario.clock.epsilon = 1e-3;
    scenario.clock.gravity_share = share;
    scenario.start_amplitude = 1.0;
    FitOptions options;
    options.freed = {"gravity_share"};
    const FitSummary fit = fit_clock(timing_data(test::simulated_beats(scenario, 9)), 2.0, options);
    EXPECT_EQ(fit.model.escapement, Escapement::none) << share;
    for (const auto& [name, truth] :
         {std::pair{"T0", 2.0}, std::pair{"epsilon", 1e-3}, std::pair{"gravity_share", share}}) {
      const FittedParameter& found = fit[name];
      EXPECT_EQ(found.status, ParameterStatus::free) << name << " at " << share;
      EXPECT_NEAR(found.value, truth, 3.0 * found.sigma) << name << " at " << share;
    }
    const FittedParameter& start = fit["lambda0"]; // of another law of friction it would be another
    EXPECT_TRUE(std::isnan(start.sigma) || start.sigma < 0.34 * start.value) << share;
  }
}

// Thirty swings seen by their times alone tell next to nothing of the friction.
TEST(RingDownTest, WhatTheLogDoesNotTellIsNotStated) {
  Scenario scenario = test::ring_down(30, 1e-4);
  scenario.start_amplitude = 0.03;
  FitOptions options;
  options.escapement = Escapement::none;
  const FitSummary fit = fit_clock(timing_data(test::simulated_beats(scenario, 8)), 2.0, options);
  EXPECT_TRUE(std::isnan(fit.q_factor.value));
  ASSERT_TRUE(fit.decay);
  for (const QAtAmplitude& at : fit.decay->q_at_amplitude)
    EXPECT_TRUE(std::isnan(at.q.value)) << at.amplitude_rad;
}

} // namespace
} // namespace goingrate
