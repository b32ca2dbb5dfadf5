// Parameters that fits call determined, against the truth in many logs.
#include "goingrate/fit/clock_fit.hpp"

#include "support/fit_scenes.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace goingrate {
namespace {

// The short form of tests/studies/coverage: what is called determined must be right. Truth lies
// within four sigma always (a hundred comparisons or so a scene), and the scatter of the normalised
// errors is 1 within four standard errors of that scatter.
struct HonestScene {
  test::FitScene scene;
  std::vector<std::string> determined; // must be, in every log
};

class HonestSigma : public testing::TestWithParam<int> {
protected:
  static HonestScene scene() {
    const std::vector<std::string> clock{"epsilon", "mu", "phi0", "lambda0"};
    test::FitScene still{"stationary with amplitudes", test::at_point_a(2000), {}, {}};
    still.scenario.sensor.jitter_rms_s = still.scenario.sensor.amplitude_rms.emplace(1e-5);
    still.truth = {{"lambda0", test::velocity_at_a}};
    const std::vector<HonestScene> scenes{
        {test::jump_scene("jump", 2000, 1e-4, false), {"T0", "epsilon", "mu", "mu@1"}},
        {test::jump_scene("jump", 2000, 1e-6, true), clock},
        {test::ring_down_scene(2000, 1e-4), {"T0", "epsilon", "lambda0"}},
        {test::start_up_scene(3000, 1e-6), clock},
        {test::noisy_jump_scene(3000), clock},
        {test::amplitude_scene(1000), clock},
        {still, {"lambda0"}},
        {test::noisy_scene(50000, false), {}},
    };
    return scenes[static_cast<std::size_t>(GetParam())];
  }
};

TEST_P(HonestSigma, WhatIsCalledDeterminedIsRight) {
  const HonestScene honest = scene();
  constexpr int logs = 8;
  double sum2 = 0.0, count = 0.0;
  for (std::uint64_t seed = 1; seed <= logs; ++seed) {
    const FitSummary fit = test::fit_scene(honest.scene, seed);
    ASSERT_EQ(fit.status, FitStatus::converged);
    for (const std::string& name : honest.determined)
      EXPECT_TRUE(std::isfinite(fit[name].sigma)) << seed << ": " << name;
    for (const FittedParameter& p : fit.parameters) {
      const auto truth = honest.scene.truth.find(p.name);
      if (truth == honest.scene.truth.end() || !std::isfinite(p.sigma)) continue;
      const double z = (p.value - truth->second) / p.sigma;
      EXPECT_LT(std::abs(z), 4.0) << seed << ": " << p.name << " = " << p.value << " +- "
                                  << p.sigma;
      EXPECT_LE(p.low95, p.low68);
      EXPECT_GE(p.high95, p.high68);
      sum2 += z * z;
      ++count;
    }
  }
  // The parameters of one log hang together: its logs count, not their number.
  if (count > 0.0) {
    EXPECT_NEAR(sum2 / count, 1.0, 4.0 * std::sqrt(2.0 / logs));
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, HonestSigma, testing::Range(0, 8));

} // namespace
} // namespace goingrate
