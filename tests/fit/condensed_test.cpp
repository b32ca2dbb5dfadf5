#include "fit/condensed.hpp"

#include "fit/fit_starts.hpp"
#include "support/fit_scenes.hpp"

#include <gtest/gtest.h>

namespace goingrate::timing_model {
namespace {

struct JumpLog {
  test::FitScene scene = test::jump_scene("jump", 2000, 1e-4, false);
  TimingData data = timing_data(test::simulated_beats(scene.scenario, 3));
  FitProblem problem = make_problem(data, scene.options, ModelChoice{});
  std::vector<double> x = at_truth();

  std::vector<double> at_truth() const {
    std::vector<double> place(problem.parameters.free_count, 0.0);
    for (const Slot& slot : problem.parameters.slots)
      place[slot.index] = slot.coordinate_of(scene.truth.at(problem.parameters.name_of(slot)));
    return place;
  }
  FitProblem condensed() const {
    FitProblem few = problem;
    few.condensed = CondensedLog::of(data, problem.parameters.event_cycles, 318.0);
    return few;
  }
};

TEST(CondensedLogTest, SaysWhatAllBeatsSay) {
  const JumpLog log;
  const FitProblem few = log.condensed();
  ASSERT_NE(few.condensed, nullptr);
  EXPECT_LT(10 * few.condensed->nodes().size(), log.data.size());
  const auto all = evaluate(log.problem, log.x), same = evaluate(few, log.x);
  ASSERT_TRUE(all && same);
  // The jitter in the time at which the model is asked, 1e-4 s of rate times 1e-4, is left.
  EXPECT_NEAR(same->value, all->value, 1e-5);
  const Eigen::MatrixXd information = all->triangle.transpose() * all->triangle;
  const Eigen::MatrixXd condensed = same->triangle.transpose() * same->triangle;
  EXPECT_LT((condensed - information).norm(), 1e-10 * information.norm()); // (1/6)^12
  const Eigen::VectorXd gradient = all->triangle.transpose() * all->projected;
  EXPECT_LT((same->triangle.transpose() * same->projected - gradient).norm(),
            1e-8 * gradient.norm()); // sums that cancel to 1e-3
}

TEST(CondensedLogTest, SpreadsACorrectionOverAllBeats) {
  const JumpLog log;
  const auto condensed = log.condensed().condensed;
  const auto smooth = [](double cycle) { return std::exp(-cycle / 318.0); };
  std::vector<double> at_nodes;
  for (const double cycle : condensed->nodes().cycle)
    at_nodes.push_back(smooth(cycle));
  const std::vector<double> spread = condensed->spread(at_nodes);
  ASSERT_EQ(spread.size(), log.data.size());
  for (std::size_t i = 0; i < spread.size(); ++i)
    EXPECT_NEAR(spread[i], smooth(log.data.cycle[i]),
                1e-13); // Chebyshev: (1/6)^12/12! and rounding
}

TEST(CondensedLogTest, LeavesAShortLogAlone) {
  const JumpLog log;
  EXPECT_EQ(CondensedLog::of(log.data, {}, 20.0), nullptr); // a block of ten beats gains nothing
  EXPECT_EQ(CondensedLog::of(log.data, {2.0}, 318.0), nullptr); // three beats before the event
  EXPECT_NE(CondensedLog::of(log.data, {150.0}, 318.0), nullptr);
}

// Nodes are spread evenly over the beats there are: a hole would let the polynomials swing.
TEST(CondensedLogTest, LeavesALogOfHolesAlone) {
  const JumpLog log;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < log.data.size(); ++i)
    if (i % 150 < 40) kept.push_back(i);
  EXPECT_EQ(CondensedLog::of(subset(log.data, kept), {}, 636.0), nullptr);
}

} // namespace
} // namespace goingrate::timing_model
