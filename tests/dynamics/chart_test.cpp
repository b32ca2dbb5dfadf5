#include "goingrate/dynamics/chart.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace goingrate {
namespace {

const ChartRow* find(const std::vector<ChartRow>& rows, const std::string& scene,
                     const std::string& method, const std::string& setting = {}) {
  for (const ChartRow& row : rows)
    if (row.scenario == scene && row.method == method &&
        row.setting.find(setting) != std::string::npos)
      return &row;
  return nullptr;
}

TEST(ChartTest, ErrorsAreThoseOfTheReference) {
  // Errors only: speeds are for the chart to print, not for a test to judge.
  const auto rows = measure_chart(chart_scenes(400), chart_methods(), 1);
  EXPECT_EQ(rows.size(), 6 * chart_methods().size());
  for (const ChartRow& row : rows)
    EXPECT_EQ(row.status, SwingStatus::crossed) << row.scenario << ' ' << row.method;
  for (const char* scene : {"C steady", "C noisy", "jump", "ring-down", "near stall"}) {
    EXPECT_LT(find(rows, scene, "direct")->max_error, 3e-14) << scene;
    EXPECT_LT(find(rows, scene, "map")->max_error, 3e-15) << scene;
  }
  EXPECT_LT(find(rows, "large amplitude", "direct")->max_error, 5e-13); // forces of the size of 1
  // The rate error of each method at C (rk4.hpp, stationary.hpp) times 400 periods; that of rk4
  // comes with the amplitude, over a relaxation time of 700 periods.
  const double turns = 400 * 6.283185307;
  const double per_step = find(rows, "C steady", "rk4-per-step")->max_error / turns;
  EXPECT_GT(per_step, 2e-6);
  EXPECT_LT(per_step, 5.5e-6);
  const double first_order = find(rows, "C steady", "averaged1", "16")->max_error / turns;
  EXPECT_GT(first_order, 1.2e-8);
  EXPECT_LT(first_order, 2.4e-8);
  EXPECT_LT(find(rows, "C steady", "averaged2")->max_error, 5e-12 * turns);
}

TEST(ChartTest, TheFrontierHoldsWhatNothingBeats) {
  std::vector<ChartRow> rows;
  const auto add = [&](const char* name, double ns, double error) {
    rows.push_back({"s", name, "", SwingStatus::crossed, ns, 0.0, error});
  };
  add("slow and bad", 100, 1e-2);
  add("fast", 10, 1e-3);
  add("good", 50, 1e-9);
  add("beaten", 60, 1e-8);
  rows.push_back({"s", "stalled", "", SwingStatus::stalled, NAN, NAN, NAN});
  const auto frontier = chart_frontier(rows, "s");
  ASSERT_EQ(frontier.size(), 2u);
  EXPECT_EQ(frontier[0].method, "fast");
  EXPECT_EQ(frontier[1].method, "good");
}

TEST(ChartTest, EveryLimitEndsInANumberOrANamedStatus) {
  for (const LimitRow& row : measure_limits(5)) {
    for (const auto& error : row.errors) {
      const bool crossed =
          error.status == SwingStatus::crossed && row.exact == SwingStatus::crossed;
      EXPECT_EQ(std::isfinite(error.error), crossed)
          << error.method << ' ' << row.epsilon << ' ' << row.ratio << ' ' << row.amplitude;
      // The exact methods end alike everywhere, and their times agree.
      if (error.method != "map" && error.method != "direct") continue;
      EXPECT_EQ(error.status, row.exact);
      if (crossed) {
        EXPECT_LT(error.error, 1e-13) << row.epsilon << ' ' << row.ratio << ' ' << row.amplitude;
      }
    }
  }
}

} // namespace
} // namespace goingrate
