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
ClockParameters struck_clock() {
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
  const CycleResponses responses(clock, laws, 0.5 * speed2, 1.6 * speed2, amplitude2 - speed2);
  const ResponseAt response{&responses, speed2, 0.0};
  for (const double part : {0.0, 0.05, -0.05, 0.3, -0.3}) {
    const double w = part * speed2;
    const auto next = [&](double dw, double du) {
      return regular_period<Wide>(clock, static_cast<long double>(speed2) + w + dw, 1.0L + du);
    };
    const double dw = 1e-4 * speed2, du = 1e-3;
    const auto by = [&](auto&& of, double a, double b) {
      return static_cast<double>(of(next(a, b)) - of(next(-a, -b))) / (2.0 * (a + b));
    };
    const auto amplitude = [](const auto& period) { return period.speed2_change; };
    const auto late = [](const auto& period) { return period.excess / two_pi; };
    const auto gains = response.there(laws, amplitude2, 1.0, w).gains;
    // The truncation of differences 3e-3 wide, (3e-3)^2 times some third derivative, which nearer
    // the escapement is greater.
    const double tolerable = part < -0.1 ? 3e-4 : 3e-5;
    EXPECT_NEAR(gains.gone / by(amplitude, dw, 0.0), 1.0, tolerable) << part;
    EXPECT_NEAR(gains.raised / by(amplitude, 0.0, du), 1.0, tolerable) << part;
    // The circular error, 1/16, and the escapement's may nearly cancel.
    EXPECT_NEAR(gains.follow, by(late, dw, 0.0), tolerable * (std::abs(gains.follow) + 1.0 / 16.0))
        << part;
    EXPECT_NEAR(gains.kick / by(late, 0.0, du), 1.0, tolerable) << part;

    const auto [grown, later] = response.passed(laws, amplitude2, 1.0, w);
    const auto here = next(0.0, 0.0), on_course = next(-w, 0.0);
    // The truncation of the differences, and that what the averaged laws lack is taken as
    // straight between speeds 5 % apart, which costs 0.05^2/12 of how much its slope changes on the
    // way: by up to twice `part`, near the angle of an impulse.
    const double off = (3e-5 + 0.05 * 0.05 / 12.0 * 2.0 * std::abs(part)) * std::abs(w);
    EXPECT_NEAR(grown, static_cast<double>(here.speed2_change - on_course.speed2_change),
                off * std::abs(gains.gone))
        << part;
    EXPECT_NEAR(later, static_cast<double>(here.excess - on_course.excess) / two_pi, off / 16.0)
        << part;
  }
  // The averaged equations alone are off by epsilon and mu/lambda: what they lack does
  // something.
  const double averaged_kick = averaged_cycle(laws, amplitude2, 1.0).kick;
  EXPECT_GT(std::abs(response.there(laws, amplitude2, 1.0, 0.0).gains.kick / averaged_kick - 1.0), 1e-3);
}

TEST_P(CycleResponseTest, SecondDerivativesAreThoseOfTheReturnMap) {
  const ClockParameters clock = GetParam()();
  const double speed2 = std::pow(limit_cycle(clock)->velocity, 2);
  const CycleResponse<double> response =
      *cycle_response(clock, speed2, laws_of(clock), std::pow(*stationary_amplitude(clock), 2));
  const double w = 0.02 * speed2, u = 0.05;
  const auto late = [&](double dw, double du) {
    return static_cast<double>(
        regular_period<Wide>(clock, static_cast<long double>(speed2) + dw, 1.0L + du).excess /
        two_pi);
  };
  const double here = late(0.0, 0.0);
  // What is of fourth order in differences as wide as these, against what a derivative comes to
  // where the circular error and the escapement's do not cancel.
  const double tolerable = 2e-3 * (1.0 / 16.0) / speed2;
  EXPECT_NEAR((late(w, 0) - 2.0 * here + late(-w, 0)) / (2.0 * w * w), response.late.ww,
              tolerable);
  EXPECT_NEAR((late(0, u) - 2.0 * here + late(0, -u)) / (2.0 * u * u), response.late.uu,
              2e-3 * std::abs(response.late.uu));
  EXPECT_NEAR((late(w, u) - late(w, -u) - late(-w, u) + late(-w, -u)) / (4.0 * w * u),
              response.late.wu, tolerable);
}

// Those of a clock half a per cent away are foreseen to what is of second order in that.
TEST_P(CycleResponseTest, ChangesWithTheLaws) {
  const ClockParameters clock = GetParam()();
  const double speed2 = std::pow(limit_cycle(clock)->velocity, 2);
  const double offset = std::pow(*stationary_amplitude(clock), 2) - speed2;
  const AveragedLaws<double> laws = laws_of(clock);
  const CycleResponses responses(clock, laws, 0.8 * speed2, 1.2 * speed2, offset);
  ClockParameters other = clock;
  const double change = 0.005;
  other.epsilon *= 1.0 + change;
  (other.mu > 0.0 ? other.mu : other.impulse) *= 1.0 + 2.0 * change;
  (other.phi0 > 0.0 ? other.phi0 : other.impulse_angle) *= 1.0 - change;
  const AveragedLaws<double> its_laws = laws_of(other);
  const CycleResponses its_own(other, its_laws, 0.8 * speed2, 1.2 * speed2, offset);
  const auto was = responses.at(speed2, laws), foreseen = responses.at(speed2, its_laws),
             is = its_own.at(speed2, its_laws);
  const auto expect_most = [](double from, double predicted, double to, const char* what) {
    EXPECT_NEAR(predicted - from, to - from, 0.05 * std::abs(to - from) + 1e-4 * std::abs(to))
        << what; // a twentieth: second order, ten times the change
  };
  expect_most(was.beside.kick, foreseen.beside.kick, is.beside.kick, "kick");
  expect_most(was.beside.follow, foreseen.beside.follow, is.beside.follow, "follow");
  expect_most(was.amplitude2.uu, foreseen.amplitude2.uu, is.amplitude2.uu, "amplitude2.uu");
  expect_most(was.amplitude2.wu, foreseen.amplitude2.wu, is.amplitude2.wu, "amplitude2.wu");
  expect_most(was.late.uu, foreseen.late.uu, is.late.uu, "late.uu");
  expect_most(was.late.wu, foreseen.late.wu, is.late.wu, "late.wu");
}

TEST_P(CycleResponseTest, BeyondTheSpeedsThatAreKnownTheLastOneHolds) {
  const ClockParameters clock = GetParam()();
  const double speed2 = std::pow(limit_cycle(clock)->velocity, 2);
  const double offset = std::pow(*stationary_amplitude(clock), 2) - speed2;
  const AveragedLaws<double> laws = laws_of(clock);
  const CycleResponses responses(clock, laws, speed2, speed2, offset);
  EXPECT_EQ(responses.at(9.0 * speed2, laws).late.uu, responses.at(99.0 * speed2, laws).late.uu);
  EXPECT_EQ(responses.at(0.0, laws).late.uu, responses.at(-speed2, laws).late.uu);
  const auto [gone, follow] = responses.beside_on_the_way(9.0 * speed2, speed2, laws);
  const auto [gone_later, follow_later] = responses.beside_on_the_way(99.0 * speed2, speed2, laws);
  constexpr double rounding = 100 * 1e-15; // of integrals a hundred times as large
  EXPECT_NEAR(gone_later / gone, 1.0, rounding);
  EXPECT_NEAR(follow_later / follow, 1.0, rounding);
}

INSTANTIATE_TEST_SUITE_P(Laws, CycleResponseTest, testing::Values(low_q, dragged, struck_clock));

// At the true parameters the joint step of scoring, in units of its sigma, has mean 0. Without
// amplitudes T0 and phi0 are not known to such a log, and there is nothing to test.
std::map<std::string, double> mean_steps(const Scenario& scenario, const ModelChoice& model,
                                         int logs, bool by_map, std::size_t stride = 1) {
  std::map<std::string, double> sums;
  for (int i = 0; i < logs; ++i) {
    const TimingData every =
        timing_data(test::simulated_beats(scenario, 880001 + static_cast<std::uint64_t>(i)));
    const TimingData data = at_one_stride(every, every.size() / stride);
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

void expect_no_bias(const Scenario& scenario, std::size_t stride = 1) {
  const auto steps = mean_steps(scenario, model_of(scenario), scored_logs, true, stride);
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
  scenario.drive.slow_rms = 0.1; // the squared amplitude strays by a third of itself
  scenario.drive.slow_time_s = 300.0;
  expect_no_bias(scenario);
}
// Several cycles pass between beats, with the gains at the first.
TEST(NoiseFilterTest, TheSameOnEverySeventhBeat) {
  Scenario scenario = noisy(low_q());
  expect_no_bias(scenario, 7);
  scenario.drive.slow_rms = 0.1;
  scenario.drive.slow_time_s = 300.0;
  expect_no_bias(scenario, 7);
}
TEST(NoiseFilterTest, FirstOrderMissesIt) {
  const Scenario scenario = noisy(low_q());
  const auto steps = mean_steps(scenario, model_of(scenario), scored_logs, false);
  EXPECT_GT(steps.at("phi0"), 3.0); // far beyond what passes for no bias
}

// Isserlis' theorem for squares and products of two normal departures.
TEST(CycleBend, ItsScatterIsThatOfSquaresOfNormalDepartures) {
  const double w2 = 0.7, product = -0.4, u2 = 1.3;
  const CycleBend<double> ww{1.0, 0.0, 0.0}, wu{0.0, 1.0, 0.0}, uu{0.0, 0.0, 1.0};
  constexpr double rounding = 1e-15;
  EXPECT_NEAR(ww.covariance(ww, w2, product, u2), 2.0 * w2 * w2, rounding);
  EXPECT_NEAR(uu.covariance(uu, w2, product, u2), 2.0 * u2 * u2, rounding);
  EXPECT_NEAR(wu.covariance(wu, w2, product, u2), w2 * u2 + product * product, rounding);
  EXPECT_NEAR(ww.covariance(wu, w2, product, u2), 2.0 * w2 * product, rounding);
  EXPECT_NEAR(ww.covariance(uu, w2, product, u2), 2.0 * product * product, rounding);
  EXPECT_NEAR(wu.covariance(uu, w2, product, u2), 2.0 * product * u2, rounding);
  const CycleBend<double> all{0.3, -1.1, 0.8};
  EXPECT_NEAR(all.covariance(wu, w2, product, u2),
              0.3 * ww.covariance(wu, w2, product, u2) - 1.1 * wu.covariance(wu, w2, product, u2) +
                  0.8 * uu.covariance(wu, w2, product, u2),
              rounding);
}

} // namespace
} // namespace goingrate::timing_model
