#include "fit/refinement.hpp"

#include "fit/fit_starts.hpp"
#include "fit/reference_run.hpp"
#include "support/fit_scenes.hpp"

#include <gtest/gtest.h>

namespace goingrate::timing_model {
namespace {

// A clock of Q 500 whose drive wanders by a tenth, seen to many digits: a change of the drive for
// good differs from such wandering only in that it does not return, so that errors of 1e-9 of a
// period in what either does pass for knowledge of mu.
struct WanderingDrive {
  std::map<std::string, double> truth{
      {"T0", 1.0},          {"epsilon", 1e-3},      {"mu", 2e-4},       {"phi0", 0.04},
      {"lambda0", 0.0755},  {"jitter_rms", 1e-5},   {"drive_rms", 0.2}, {"slow_rms", 0.1},
      {"slow_time", 300.0}, {"amplitude_rms", 2e-5}};
  TimingData data = timing_data(test::simulated_beats(scenario(), 5));
  FitProblem problem = make_problem(data, {}, with_drive());
  std::vector<double> x = at_truth();

  static Scenario scenario() {
    Scenario s;
    s.clock = {1.0, 1e-3, 2e-4, 0.04};
    s.periods = 5000;
    s.drive.fast_rms = 0.2;
    s.drive.slow_rms = 0.1;
    s.drive.slow_time_s = 300.0;
    s.sensor.jitter_rms_s = 1e-5;
    s.sensor.amplitude_rms = 2e-5;
    return s;
  }
  static ModelChoice with_drive() {
    ModelChoice model;
    model.drive = model.slow = true;
    return model;
  }
  std::vector<double> at_truth() const {
    std::vector<double> place(problem.parameters.free_count, 0.0);
    for (const Slot& slot : problem.parameters.slots)
      if (slot.free)
        place[slot.index] = slot.coordinate_of(truth.at(problem.parameters.name_of(slot)));
    return place;
  }
  FitProblem corrected(const std::vector<double>& at, bool with_slopes) const {
    FitProblem by_map = problem;
    extend(by_map, at);
    by_map.parameters.start_ratio = limit_cycle_ratio(by_map.parameters, at);
    by_map.correction = *difference_to(FitDynamics::map, by_map, at);
    if (with_slopes) by_map.correction.slopes = *slopes_of_difference(FitDynamics::map, by_map, at);
    return by_map;
  }
  // The slow way: the dynamics themselves at every place.
  double by_itself(const std::vector<double>& at) const {
    return minus_log_likelihood(corrected(at, false), at).value();
  }
};

std::vector<double> moved(std::vector<double> x, const Eigen::VectorXd& way, double by) {
  for (std::size_t k = 0; k < x.size(); ++k)
    x[k] += by * way[static_cast<Eigen::Index>(k)];
  return x;
}

TEST(RefinementTest, TheScoreIsThatOfTheDynamicsThemselves) {
  const WanderingDrive clock;
  const FitProblem problem = clock.corrected(clock.x, true);
  const Evaluation at = evaluate(problem, clock.x).value();
  const Eigen::VectorXd gradient = at.triangle.transpose() * at.projected;
  for (const Slot& slot : problem.parameters.slots) {
    if (!slot.free || !is_of_clock(slot.quantity)) continue;
    const auto k = static_cast<Eigen::Index>(slot.index);
    const double step = 0.3 / at.triangle.col(k).norm(); // sigma, if the others were known
    const Eigen::VectorXd way = Eigen::VectorXd::Unit(gradient.size(), k);
    const double difference = 0.5 * (clock.by_itself(moved(clock.x, way, step)) -
                                     clock.by_itself(moved(clock.x, way, -step)));
    // The truncation of the quotient: 0.3^3/6 of the third derivative, a few tenths where L rises
    // by less than that.
    EXPECT_NEAR(gradient[k] * step, difference, 3e-3 + 0.01 * std::abs(difference))
        << problem.parameters.name_of(slot);
  }
}

TEST(RefinementTest, MuIsKnownNoBetterThanTheMeanOfAWanderingDrive) {
  const WanderingDrive clock;
  const Evaluation at = evaluate(clock.corrected(clock.x, true), clock.x).value();
  // More drive for good, and relative variations that are less by as much.
  Eigen::VectorXd way = Eigen::VectorXd::Zero(at.projected.size());
  for (const Slot& slot : clock.problem.parameters.slots) {
    const auto k = static_cast<Eigen::Index>(slot.index);
    if (slot.quantity == Quantity::mu) way[k] = 1.0;
    if (slot.quantity == Quantity::drive_rms || slot.quantity == Quantity::slow_rms) way[k] = -1.0;
    if (slot.quantity == Quantity::lambda0) way[k] = 0.3;
  }
  const double step = 0.03;
  const double rise = 0.5 * (clock.by_itself(moved(clock.x, way, step)) +
                             clock.by_itself(moved(clock.x, way, -step))) -
                      clock.by_itself(clock.x);
  const double information = (at.triangle * way).squaredNorm();
  // Expected information against the curvature of one log: a few of some 20 correlation times.
  EXPECT_NEAR(information * step * step / (2.0 * rise), 1.0, 0.25);
  // The mean of an Ornstein-Uhlenbeck process over 5000 s: 0.1 sqrt(2 300/5600).
  EXPECT_NEAR(1.0 / std::sqrt(information), 0.1 * std::sqrt(600.0 / 5600.0), 0.01);
}

// In these logs condensed beats are no longer enough once the corrections of second order are in,
// so that the slopes of the corrections are needed at every beat. First order is 260 sigma off.
TEST(RefinementTest, SlopesAreThoseOfTheBeatsThatAreFitted) {
  const test::FitScene scene = test::jump_scene("jump, T0 known", 20000, 1e-6, true);
  for (const std::uint64_t seed : {161000006, 161000012, 161000017}) {
    const auto data = timing_data(test::simulated_beats(scene.scenario, seed));
    const FitSummary fit = fit_clock(data, 2.0, scene.options);
    EXPECT_NE(fit.dynamics, FitDynamics::averaged1) << seed;
    for (const auto& [name, truth] : scene.truth) {
      if (scene.options.fixed.contains(name)) continue;
      const FittedParameter* found = fit.find(name);
      ASSERT_NE(found, nullptr) << name;
      // Of 18 values one is that far off by chance once in 1e5 runs of other seeds.
      EXPECT_LT(std::abs(found->value - truth), 5.0 * found->sigma) << name << " " << seed;
    }
  }
}

} // namespace
} // namespace goingrate::timing_model
