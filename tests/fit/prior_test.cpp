// The search on clocks that nobody chose: the short form of tests/studies/prior.
#include "fit/change_starts.hpp"
#include "support/prior_clocks.hpp"

#include <algorithm>
#include <gtest/gtest.h>

namespace goingrate {
namespace {

class DrawnFromAPrior : public testing::TestWithParam<std::uint64_t> {};

TEST_P(DrawnFromAPrior, EndsWhereAFitFromTheTruthEnds) {
  const test::DrawnClock drawn = test::ClockPrior(GetParam()).draw();
  const TimingData data = timing_data(test::simulated_beats(drawn.scenario, GetParam()));
  const double period_s = drawn.truth.at("T0");
  const FitSummary found = fit_clock(data, period_s, drawn.options);
  const FitSummary told = fit_clock(data, period_s, test::told_the_truth(drawn));
  // Either search stops where a step gains less than 1e-4; dynamics that differ by a fifth of a
  // sigma in some parameters may be chosen.
  EXPECT_GT(test::two_log_likelihood(found), test::two_log_likelihood(told) - 1.0);
  for (const auto& [name, value] : drawn.truth) {
    const FittedParameter& p = found[name];
    if (name == "lambda0" || !(p.sigma > 0.0)) continue; // known to first order; not stated
    EXPECT_NEAR(p.value, value, 5.0 * p.sigma) << name;
  }
}

// Each kind of change, T0 free: the logs in which a search from a grid went astray most often.
INSTANTIATE_TEST_SUITE_P(Prior, DrawnFromAPrior,
                         testing::Values(8001U, 8003U, 8009U, 8011U, 8017U, 8019U));

// By how much the nearest of the starts is off, in the logarithm of its worst parameter.
double nearest_start(std::uint64_t seed) {
  test::DrawnClock drawn = test::ClockPrior(seed).draw();
  drawn.options.fixed.clear();
  const TimingData data = timing_data(test::simulated_beats(drawn.scenario, seed));
  const auto parameters = timing_model::make_parameters(drawn.options, data, {});
  const std::vector<double> zeros(parameters.free_count, 0.0);
  double nearest = 1e9;
  for (const auto& point : timing_model::starts_by_change(parameters, data, zeros)) {
    double off = 0.0;
    for (const auto& slot : parameters.slots) {
      const auto truth = drawn.truth.find(parameters.name_of(slot));
      if (slot.free && truth != drawn.truth.end() && truth->first != "T0")
        off = std::max(off, std::abs(point[slot.index] - slot.coordinate_of(truth->second)));
    }
    nearest = std::min(nearest, off);
  }
  return nearest;
}

TEST(ChangeStartsTest, MostLogsHaveOneNearTheTruth) {
  int near = 0;
  constexpr int logs = 24;
  for (std::uint64_t seed = 9001; seed < 9001 + logs; ++seed)
    near += nearest_start(seed) < 0.5 ? 1 : 0; // the switching ratios are 0.4 apart
  EXPECT_GE(near, 2 * logs / 3); // the search does the rest; points drawn anywhere: none of 24
}

} // namespace
} // namespace goingrate
