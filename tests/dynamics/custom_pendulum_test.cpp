#include "goingrate/dynamics/custom_pendulum.hpp"

#include "goingrate/dynamics/direct.hpp"

#include <boost/math/special_functions/ellint_1.hpp>
#include <gtest/gtest.h>

namespace goingrate {
namespace {

TEST(CustomPendulumTest, AgreesWithDirectIntegration) {
  // A smooth-edged profile with all three frictions, written down once as data and once as code.
  ClockParameters clock;
  clock.epsilon = 2e-4;
  clock.quadratic_drag = 1e-3;
  clock.dry_friction = 1e-6;
  clock.escapement = Escapement::profile;
  clock.rising.points = {{-0.02, 0.0}, {0.0, 4e-5}, {0.02, 0.0}};
  clock.falling.points = {{-0.02, 0.0}, {0.0, -4e-5}, {0.02, 0.0}};
  CustomLaws laws;
  laws.torque = [](double phi, double w) {
    return (w > 0 ? 1 : -1) * std::max(0.0, 4e-5 * (1 - std::abs(phi) / 0.02));
  };
  laws.friction = [](double, double w) {
    return 4e-4 * w + 1e-3 * std::abs(w) * w + (w > 0 ? 1e-6 : -1e-6);
  };
  laws.jumps = {-0.02, 0.02}; // the slope jumps there
  laws.jumps_with_direction = true;
  DirectPendulum direct(clock, 0.05);
  CustomPendulum custom(laws, 0.05);
  for (int i = 0; i < 5; ++i) {
    const auto exact = direct.advance(), written = custom.advance();
    ASSERT_EQ(written.status, SwingStatus::crossed);
    // At phi = 0 itself the slope jumps too: a step runs over it there, an error of h^3 slope/12.
    EXPECT_NEAR(written.excess, exact.excess, 1e-12);
    EXPECT_NEAR(custom.velocity(), direct.velocity(), 1e-13);
  }
}

// The paper's escapement, whose torque jumps: the direction of the motion stands for its memory.
TEST(CustomPendulumTest, JumpsAreSteppedToNotOver) {
  for (const double phi0 : {0.03, 0.3}) {
    ClockParameters clock;
    clock.epsilon = 2.5e-3;
    clock.mu = 4e-4;
    clock.phi0 = phi0;
    CustomLaws laws;
    laws.torque = [&](double phi, double w) {
      const bool helps_right = w > 0.0 ? phi < phi0 : phi < -phi0;
      return helps_right ? clock.mu : -clock.mu;
    };
    laws.friction = [&](double, double w) { return 2.0 * clock.epsilon * w; };
    laws.jumps = {-phi0, phi0};
    laws.jumps_with_direction = true;
    const double velocity = 1.2 * phi0;
    DirectPendulum direct(clock, velocity);
    CustomPendulum custom(laws, velocity);
    for (int i = 0; i < 10; ++i) {
      const auto exact = direct.advance(), written = custom.advance();
      ASSERT_EQ(written.status, SwingStatus::crossed);
      EXPECT_NEAR(written.excess, exact.excess, 1e-12); // some hundred steps' rounding
      EXPECT_NEAR(custom.velocity(), direct.velocity(), 1e-14 * i + 1e-14); // likewise, adding up
    }
  }
}

TEST(CustomPendulumTest, WithoutForcesItIsTheFreePendulum) {
  const ForceLaw nothing = [](double, double) { return 0.0; };
  CustomPendulum custom({nothing, nothing}, 1.0);
  EXPECT_NEAR(custom.advance().excess + 2 * std::numbers::pi, 4 * boost::math::ellint_1(0.5),
              1e-13);
}

TEST(CustomPendulumTest, StallAndOverturningAreTold) {
  const ForceLaw nothing = [](double, double) { return 0.0; };
  const ForceLaw strong = [](double, double) { return 0.3; };
  EXPECT_EQ(CustomPendulum({strong, [](double, double w) { return w; }}, 0.1).advance().status,
            SwingStatus::stalled);
  EXPECT_EQ(CustomPendulum({strong, nothing}, 1.9).advance().status, SwingStatus::overturned);
}

} // namespace
} // namespace goingrate
