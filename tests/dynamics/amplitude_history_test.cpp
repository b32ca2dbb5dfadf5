#include "dynamics/amplitude_history.hpp"

#include "goingrate/dynamics/averaged.hpp"

#include <gtest/gtest.h>

namespace goingrate {
namespace {

constexpr double eps = 2.5e-4, phi0 = 0.03;

TEST(AmplitudeHistoryTest, AnyHistoryContainsTheJump) {
  const auto mu = [](double t) { return t < 0 ? 2e-5 : 4e-5; };
  for (const double t : {-100.0, 0.0, 10.0, 1000.0, 20000.0}) {
    const double exact = amplitude2_after_jump(t, 2e-5, 4e-5, eps, phi0);
    // The quadrature's tolerance.
    EXPECT_NEAR(amplitude2_at(t, mu, eps, phi0, {0.0}) / exact, 1.0, 1e-13);
  }
}

TEST(AmplitudeHistoryTest, ASlowSineIsFollowedWithTheLagOfOneRelaxation) {
  const double w = 2 * eps; // at the corner: half the power, an eighth of a turn late
  const auto mu = [&](double t) { return 2e-5 * (1 + 0.1 * std::sin(w * t)); };
  const double mean = amplitude2_after_jump(-1, 2e-5, 0, eps, phi0);
  const double swing = 0.1 / std::sqrt(2.0);
  const double quarter = std::numbers::pi / 4;
  for (const double phase : {0.3, 1.0, 4.0})
    EXPECT_NEAR(amplitude2_at(phase / w, mu, eps, phi0) / mean,
                1 + swing * std::sin(phase - quarter), 1e-13); // the quadrature's tolerance
}

TEST(AmplitudeHistoryTest, TheJumpIsTheAveragedMotion) {
  const AveragedMotion<double> motion(eps, 4e-5, phi0,
                                      amplitude2_after_jump(-1, 2e-5, 4e-5, eps, phi0));
  EXPECT_NEAR(motion.at(700.0).amplitude2 / amplitude2_after_jump(700.0, 2e-5, 4e-5, eps, phi0), 1,
              2e-15); // some ten roundings
}

} // namespace
} // namespace goingrate
