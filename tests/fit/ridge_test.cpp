#include "fit/ridge.hpp"

#include "fit/fit_starts.hpp"
#include "fit/held.hpp"
#include "support/fit_scenes.hpp"

#include <gtest/gtest.h>

namespace goingrate::timing_model {
namespace {

// A jump seen in 400 beats, so that the likelihood is far from a parabola.
struct BentRidge {
  test::FitScene scene = test::jump_scene("jump", 400, 1e-4, true);
  TimingData data = timing_data(test::simulated_beats(scene.scenario, 11));
  FitProblem problem = make_problem(data, scene.options, ModelChoice{});
  Minimum minimum = minimise(problem, at_truth(), {100, 1e-8});
  Certainty known = certainty(problem, minimum.x, *evaluate(problem, minimum.x), {});
  ProfiledPlace place{problem, minimum, known};

  std::vector<double> at_truth() const {
    std::vector<double> x(problem.parameters.free_count, 0.0);
    for (const Slot& slot : problem.parameters.slots)
      if (slot.free)
        x[slot.index] = slot.coordinate_of(scene.truth.at(problem.parameters.name_of(slot)));
    return x;
  }
  std::size_t index_of(const std::string& name) const {
    for (const Slot& slot : problem.parameters.slots)
      if (slot.free && problem.parameters.name_of(slot) == name) return slot.index;
    return problem.parameters.free_count;
  }
  // The slow way: a search with the coordinate held, from the foot itself.
  double rise_by_search(std::size_t k, const Foot& foot) const {
    std::vector<double> others = foot.x;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
    return minimise(with_held(problem, k, foot.x[k]), others, {200, 1e-8}).value - minimum.value;
  }
};

TEST(RidgeTest, FeetAreWhereASearchEnds) {
  const BentRidge bent;
  ASSERT_TRUE(bent.minimum.usable);
  double largest_bend = 0.0;
  for (const char* name : {"epsilon", "mu", "phi0"}) {
    const std::size_t k = bent.index_of(name);
    ASSERT_LT(k, bent.problem.parameters.free_count) << name;
    for (const double side : {-1.0, 1.0}) {
      Ridge ridge(bent.place, k, 1.0);
      while (ridge.last().rise < 1.92 && ridge.advance(side)) {
        const Foot& foot = ridge.last();
        // Steps of scoring end where one promises 0.02 of L.
        EXPECT_NEAR(foot.rise, bent.rise_by_search(k, foot), 0.02)
            << name << " at " << foot.z << " sigma";
        largest_bend = std::max(largest_bend, std::abs(foot.rise / (0.5 * foot.z * foot.z) - 1.0));
      }
      EXPECT_GE(ridge.last().rise, 1.92) << name << ", lost at " << ridge.last().z << " sigma";
    }
  }
  EXPECT_GT(largest_bend, 0.3); // a parabola would test little
}

TEST(RidgeTest, IsLostWhereItsStepsAreSpent) {
  const BentRidge bent;
  const std::size_t k = bent.index_of("mu");
  constexpr int most_steps = 5;
  Ridge ridge(bent.place, k, 1.0, most_steps);
  while (ridge.advance(1.0)) {
  }
  EXPECT_LE(ridge.steps_taken(), most_steps);
  const Foot lost = ridge.last();
  EXPECT_GT(lost.z, 0.0);
  EXPECT_FALSE(ridge.advance(1.0));
  EXPECT_EQ(ridge.last().z, lost.z);
  // The other side has all its steps again.
  ridge.restart();
  EXPECT_EQ(ridge.steps_taken(), 0);
  EXPECT_TRUE(ridge.advance(-1.0));
  EXPECT_LT(ridge.last().z, 0.0);
}

} // namespace
} // namespace goingrate::timing_model
