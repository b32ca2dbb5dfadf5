// Logs whose sensor was moved, or in which one beat was knocked.
#include "goingrate/fit/clock_fit.hpp"

#include "support/simulated.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace goingrate {
namespace {

TimingData displaced(TimingData data, std::size_t from, double late_s) {
  for (std::size_t i = from; i < data.size(); ++i)
    data.lateness_s[i] += late_s;
  return data;
}

TEST(FitDisplacedTest, AMovedSensorLeavesTheClock) {
  FitOptions options;
  options.fixed["T0"] = 2.0;
  options.events = {{150, {"mu"}}};
  const TimingData undisturbed =
      timing_data(test::simulated_beats(test::jump_from_a_to_b(2000, 1e-5), 5));
  TimingData moved = displaced(undisturbed, 900, 3e-3);
  level_displacements(moved);
  ASSERT_EQ(moved.displaced.size(), 1u);
  EXPECT_EQ(moved.displaced[0].beat, 900u);
  EXPECT_NEAR(moved.displaced[0].late_s, 3e-3, 5e-5); // five times the jitter
  const FitSummary there = fit_clock(undisturbed, 2.0, options);
  const FitSummary here = fit_clock(moved, 2.0, options);
  ASSERT_EQ(here.status, FitStatus::converged);
  for (const FittedParameter& parameter : there.parameters) {
    if (parameter.status != ParameterStatus::free) continue;
    // What is left of the displacement is as large as the jitter of the means beside it.
    EXPECT_NEAR(here.find(parameter.name)->value, parameter.value, parameter.sigma)
        << parameter.name;
  }
  EXPECT_EQ(here.notes.back().kind, NoteKind::displacement);
}

TEST(FitDisplacedTest, KicksThatFollowEachOtherAreANoise) {
  const TimingData undisturbed =
      timing_data(test::simulated_beats(test::jump_from_a_to_b(4000, 1e-5), 6));
  TimingData kicked = undisturbed;
  for (std::size_t kick = 1; kick <= 40; ++kick) // each of another size
    kicked = displaced(kicked, 90 * kick, 1e-4 * static_cast<double>(kick % 7 + 3));
  const std::vector<double> times = kicked.lateness_s;
  level_displacements(kicked);
  EXPECT_TRUE(kicked.displaced.empty());
  EXPECT_EQ(kicked.lateness_s, times);
}

TEST(FitDisplacedTest, LogsWithoutOneStayAsTheyAre) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Scenario noisy = test::at_point_b(4000);
    noisy.drive.fast_rms = 0.3;
    noisy.sensor.jitter_rms_s = 1e-5;
    for (const Scenario& scenario : {test::jump_from_a_to_b(4000, 1e-5), noisy}) {
      TimingData data = timing_data(test::simulated_beats(scenario, seed));
      level_displacements(data);
      EXPECT_TRUE(data.displaced.empty()) << seed;
    }
  }
}

} // namespace
} // namespace goingrate
