#include "fit/cycle_response.hpp"

#include "fit/fit_setup.hpp"
#include "fit/reference_run.hpp"
#include "goingrate/dynamics/clock_run.hpp"
#include "goingrate/dynamics/direct.hpp"
#include "goingrate/dynamics/stationary.hpp"
#include "support/simulated.hpp"

#include <gtest/gtest.h>

namespace goingrate::timing_model {
namespace {

// Q 500, far from stalling: what first order lacks is large.
ClockParameters low_q() { return {1.0, 1e-3, 2e-4, 0.04}; }
ClockParameters dragged() {
  ClockParameters clock = low_q();
  clock.quadratic_drag = 3e-3;
  return clock;
}
ClockParameters struck() {
  ClockParameters clock;
  clock.nominal_period_s = 1.0;
  clock.epsilon = 1e-3;
  clock.escapement = Escapement::single_impulse;
  clock.impulse = 3.2e-5;
  clock.impulse_angle = 0.02;
  return clock;
}

AveragedLaws<double> laws_of(const ClockParameters& clock) {
  const bool impulse = clock.escapement == Escapement::single_impulse;
  AveragedLaws<double> laws;
  laws.escapement = clock.escapement;
  laws.linear = clock.quadratic_drag == 0.0;
  laws.epsilon = clock.epsilon;
  laws.mu = impulse ? clock.impulse : clock.mu;
  laws.phi0 = impulse ? clock.impulse_angle : clock.phi0;
  laws.quadratic = clock.quadratic_drag;
  return laws;
}

class CycleResponseTest : public testing::TestWithParam<ClockParameters (*)()> {};

TEST_P(CycleResponseTest, GainsAreTheDerivativesOfTheReturnMap) {
  const ClockParameters clock = GetParam()();
  const double speed2 = std::pow(limit_cycle(clock)->velocity, 2);
  const double amplitude2 = std::pow(*stationary_amplitude(clock), 2);
  const AveragedLaws<double> laws = laws_of(clock);
  const CycleResponse response = cycle_response(clock, speed2, laws, amplitude2);
  const double far = 0.05 * speed2; // at the course and a twentieth of the way from it
  for (const double w : {0.0, far, -far}) {
    const auto next = [&](double dw, double du) {
      return regular_period(clock, static_cast<long double>(speed2) + w + dw, 1.0L + du);
    };
    const double dw = 1e-4 * speed2, du = 1e-3;
    const auto by = [&](auto&& of, double a, double b) {
      return static_cast<double>(of(next(a, b)) - of(next(-a, -b))) / (2.0 * (a + b));
    };
    const auto amplitude = [](const auto& period) { return period.speed2_change; };
    const auto late = [](const auto& period) { return period.excess / two_pi; };
    const auto gains = response.at(laws, amplitude2 + w, 1.0, w);
    // On the course the truncation of differences 3e-3 wide, (3e-3)^2 times some third derivative;
    // beside it 0.05^2/2 times that, by which the factors bend.
    const double tolerable = w == 0.0 ? 3e-5 : 1e-3;
    EXPECT_NEAR(gains.gone / by(amplitude, dw, 0.0), 1.0, tolerable) << w;
    EXPECT_NEAR(gains.raised / by(amplitude, 0.0, du), 1.0, tolerable) << w;
    // The circular error, 1/16, and the escapement's may nearly cancel.
    EXPECT_NEAR(gains.follow, by(late, dw, 0.0), tolerable * (std::abs(gains.follow) + 1.0 / 16.0))
        << w;
    EXPECT_NEAR(gains.kick / by(late, 0.0, du), 1.0, tolerable) << w;
  }
  // The averaged equations alone are off by epsilon and mu/lambda: the factors do something.
  EXPECT_GT(std::abs(response.factor.follow - 1.0), 1e-3);
}

TEST_P(CycleResponseTest, SecondDerivativesAreThoseOfTheReturnMap) {
  const ClockParameters clock = GetParam()();
  const double speed2 = std::pow(limit_cycle(clock)->velocity, 2);
  const CycleResponse response =
      cycle_response(clock, speed2, laws_of(clock), std::pow(*stationary_amplitude(clock), 2));
  const double w = 0.02 * speed2, u = 0.05;
  const auto late = [&](double dw, double du) {
    return static_cast<double>(
        regular_period(clock, static_cast<long double>(speed2) + dw, 1.0L + du).excess / two_pi);
  };
  const double here = late(0.0, 0.0);
  // What is of fourth order in differences as wide as these, beside what a derivative comes to
  // where the circular error and the escapement's do not cancel.
  const double tolerable = 2e-3 * (1.0 / 16.0) / speed2;
  EXPECT_NEAR((late(w, 0) - 2.0 * here + late(-w, 0)) / (2.0 * w * w), response.late.ww, tolerable);
  EXPECT_NEAR((late(0, u) - 2.0 * here + late(0, -u)) / (2.0 * u * u), response.late.uu,
              2e-3 * std::abs(response.late.uu));
  EXPECT_NEAR((late(w, u) - late(w, -u) - late(-w, u) + late(-w, -u)) / (4.0 * w * u),
              response.late.wu, tolerable);
}

INSTANTIATE_TEST_SUITE_P(Laws, CycleResponseTest, testing::Values(low_q, dragged, struck));

// At the true parameters the joint step of scoring, in units of its sigma, has mean 0. Without
// amplitudes T0 and phi0 are not known to such a log, and there is nothing to test.
std::map<std::string, double> mean_steps(const Scenario& scenario, const ModelChoice& model,
                                         int logs, bool by_map) {
  std::map<std::string, double> sums;
  for (int i = 0; i < logs; ++i) {
    const TimingData data =
        timing_data(test::simulated_beats(scenario, 880001 + static_cast<std::uint64_t>(i)));
    FitProblem problem;
    problem.data = &data;
    problem.parameters = make_parameters({}, data, model);
    const AveragedLaws<double> laws = laws_of(scenario.clock);
    const std::map<Quantity, double> truth{
        {Quantity::T0, scenario.clock.nominal_period_s},
        {Quantity::epsilon, laws.epsilon},
        {Quantity::mu, laws.mu},
        {Quantity::phi0, laws.phi0},
        {Quantity::quadratic_drag, laws.quadratic},
        {Quantity::lambda0, ClockRun(scenario, 0).start_velocity()},
        {Quantity::jitter_rms, scenario.sensor.jitter_rms_s},
        {Quantity::drive_rms, scenario.drive.fast_rms},
        {Quantity::slow_rms, scenario.drive.slow_rms},
        {Quantity::slow_time, scenario.drive.slow_time_s},
        {Quantity::amplitude_rms, scenario.sensor.amplitude_rms.value_or(0.0)}};
    std::vector<double> x(problem.parameters.free_count);
    for (const Slot& slot : problem.parameters.slots)
      x[slot.index] = slot.coordinate_of(truth.at(slot.quantity));
    problem.parameters.start_ratio = limit_cycle_ratio(problem.parameters, x);
    if (by_map) problem.correction = *difference_to(FitDynamics::map, problem, x);
    const Evaluation there = *evaluate(problem, x);
    const Eigen::MatrixXd inverse = there.triangle.inverse();
    const Eigen::VectorXd step = -inverse * there.projected;
    for (const Slot& slot : problem.parameters.slots) {
      const auto k = static_cast<Eigen::Index>(slot.index);
      sums[problem.parameters.name_of(slot)] += step[k] / inverse.row(k).norm() / logs;
    }
  }
  return sums;
}

Scenario noisy(const ClockParameters& clock) {
  Scenario scenario;
  scenario.clock = clock;
  scenario.periods = 10000;
  scenario.drive.fast_rms = 0.2;
  scenario.sensor.jitter_rms_s = 1e-5;
  scenario.sensor.amplitude_rms = 2e-5;
  return scenario;
}

ModelChoice model_of(const Scenario& scenario) {
  ModelChoice model;
  model.escapement = scenario.clock.escapement;
  model.quadratic = scenario.clock.quadratic_drag > 0.0;
  model.drive = true;
  model.slow = scenario.drive.slow_rms > 0.0;
  return model;
}

constexpr int scored_logs = 16;
const double three_standard_errors = 3.0 / std::sqrt(scored_logs);

void expect_no_bias(const Scenario& scenario) {
  const auto steps = mean_steps(scenario, model_of(scenario), scored_logs, true);
  for (const std::string name : {"T0", "epsilon", "mu", "phi0"})
    EXPECT_NEAR(steps.at(name), 0.0, three_standard_errors) << name;
}

TEST(NoiseFilterTest, TheScoreIsZeroAtTheTruthWhereAmplitudesAreLogged) {
  expect_no_bias(noisy(low_q()));
}
TEST(NoiseFilterTest, TheSameUnderQuadraticDrag) { expect_no_bias(noisy(dragged())); }
TEST(NoiseFilterTest, TheSameWithBeatsMissed) {
  Scenario scenario = noisy(low_q());
  scenario.sensor.missed = 0.1;
  expect_no_bias(scenario);
}
TEST(NoiseFilterTest, TheSameWithASlowDrive) {
  Scenario scenario = noisy(low_q());
  scenario.drive.slow_rms = 0.03;
  scenario.drive.slow_time_s = 300.0;
  expect_no_bias(scenario);
}
TEST(NoiseFilterTest, FirstOrderMissesIt) {
  const Scenario scenario = noisy(low_q());
  const auto steps = mean_steps(scenario, model_of(scenario), scored_logs, false);
  EXPECT_GT(steps.at("phi0"), 3.0); // far beyond what passes for no bias
}

} // namespace
} // namespace goingrate::timing_model
