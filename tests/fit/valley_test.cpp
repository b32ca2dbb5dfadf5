#include "fit/valley.hpp"

#include "fit/fit_starts.hpp"
#include "support/fit_scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>

namespace goingrate::timing_model {
namespace {

// A clock whose torque and then friction change: three stretches.
struct ThreeStretches {
  Scenario scenario = test::jump_from_a_to_b(600, 1e-5);
  FitOptions options;
  std::optional<TimingData> data;
  std::optional<FitProblem> problem;
  std::vector<double> truth;

  ThreeStretches() {
    ClockEvent friction;
    friction.at_period = 350;
    friction.epsilon = 3e-4;
    scenario.events.push_back(friction);
    options.events = {{150, {"mu"}}, {350, {"epsilon"}}};
    data = timing_data(test::simulated_beats(scenario, 11));
    problem = make_problem(*data, options, ModelChoice{});
    const std::map<std::string, double> values{{"T0", 2.0},
                                               {"epsilon", 2.5e-4},
                                               {"mu", 2e-5},
                                               {"phi0", 0.03},
                                               {"lambda0", test::velocity_at_a},
                                               {"mu@1", 4e-5},
                                               {"epsilon@2", 3e-4},
                                               {"jitter_rms", 1e-5}};
    truth.resize(problem->parameters.free_count);
    for (const Slot& slot : problem->parameters.slots)
      if (slot.free)
        truth[slot.index] = slot.coordinate_of(values.at(problem->parameters.name_of(slot)));
  }
  std::vector<double> late(std::span<const double> x) const {
    return *late_after_first(problem->parameters,
                             ends_of_stretches(*data, problem->parameters.event_cycles), x);
  }
};

TEST(ValleyTest, WhatMovesAlongItKeepsTheLatenessAtTheEndOfEachStretch) {
  const ThreeStretches clock;
  const Valley valley(*clock.problem, clock.truth);
  const std::vector<double> before = clock.late(clock.truth), u = valley.u_of(clock.truth);
  ASSERT_EQ(before.size(), 3u);
  int kept = 0;
  for (std::size_t k = 0; k < u.size(); ++k) {
    std::vector<double> beside = u;
    beside[k] += 0.02; // a fiftieth of most coordinates: seconds, if nothing followed
    const std::vector<double> after = clock.late(valley.x_of(beside));
    double moves = 0.0;
    for (std::size_t i = 0; i < 3; ++i)
      moves = std::max(moves, std::abs(after[i] - before[i]));
    if (moves < 1e-9) ++kept; // s: rounding of 1200 s
  }
  // Of the eight coordinates all but the three that follow, one for each stretch.
  EXPECT_EQ(kept, static_cast<int>(u.size()) - 3);
}

TEST(ValleyTest, ItsSlopesAreThoseOfDifferences) {
  const ThreeStretches clock;
  const Valley valley(*clock.problem, clock.truth);
  std::vector<double> u = valley.u_of(clock.truth);
  for (std::size_t k = 1; k < u.size(); ++k)
    u[k] += 0.01; // away from the point about which it is built
  const Eigen::MatrixXd slopes = valley.slopes(u);
  constexpr double step = 1e-5;
  for (std::size_t k = 0; k < u.size(); ++k) {
    std::vector<double> up = u, down = u;
    up[k] += step, down[k] -= step;
    const std::vector<double> above = valley.x_of(up), below = valley.x_of(down);
    for (std::size_t i = 0; i < u.size(); ++i) {
      const double slope = (above[i] - below[i]) / (2.0 * step);
      // The slopes are differences themselves, of 1e-6, on sides that differ by the 0.01 above.
      EXPECT_NEAR(slopes(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)), slope,
                  0.03 * std::max(1.0, std::abs(slope)))
          << i << " by " << k;
    }
  }
}

TEST(ValleyTest, ThereAndBackIsTheSamePoint) {
  const ThreeStretches clock;
  const Valley valley(*clock.problem, clock.truth);
  std::vector<double> x = clock.truth;
  for (std::size_t k = 1; k < x.size(); ++k)
    x[k] += 0.05;
  const std::vector<double> again = valley.x_of(valley.u_of(x));
  for (std::size_t k = 0; k < x.size(); ++k)
    EXPECT_NEAR(again[k], x[k], 1e-9) << k; // rounding of solved lateness
}

} // namespace
} // namespace goingrate::timing_model
