#include "dynamics/passage.hpp"

#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace goingrate {
namespace {

TEST(PassageTest, FreeSwingIsTheEllipticIntegral) {
  ClockParameters clock;
  clock.escapement = Escapement::none;
  for (const double amplitude : {0.02, 0.3, 1.5}) {
    const double k = std::sin(0.5 * amplitude);
    for (const double part : {-0.9, -0.2, 0.5, 0.8}) {
      const double angle = part * amplitude;
      const double exact = boost::math::ellint_1(k, std::asin(std::sin(0.5 * angle) / k));
      // 1e-12: close to the turning point the speed changes fast
      EXPECT_NEAR(time_from_vertical(clock, 2.0 * k, true, 1.0, angle), exact, 1e-12);
      EXPECT_NEAR(time_from_vertical(clock, 2.0 * k, false, 1.0, angle), -exact, 1e-12);
    }
  }
}

// The equation of motion in time, small steps, the crossing by a last interpolation in phi'.
double slow_time(const ClockParameters& clock, double speed, double torque, double angle) {
  using State = std::array<double, 2>;
  const auto motion = [&](const State& s, State& d, double) {
    d = {s[1], torque - std::sin(s[0]) - 2.0 * clock.epsilon * s[1] -
                   clock.quadratic_drag * std::abs(s[1]) * s[1] - clock.dry_friction};
  };
  boost::numeric::odeint::runge_kutta_fehlberg78<State> formula;
  State state{0.0, speed};
  const double h = std::copysign(1e-3, angle);
  double t = 0.0;
  while (std::abs(state[0] + h * state[1]) < std::abs(angle)) {
    formula.do_step(motion, state, t, h);
    t += h;
  }
  for (int i = 0; i < 5; ++i) {
    const double rest = (angle - state[0]) / state[1];
    formula.do_step(motion, state, t, rest);
    t += rest;
  }
  return t;
}

TEST(PassageTest, AgreesWithTheEquationOfMotion) {
  ClockParameters clock{2.0, 2.5e-4, 2e-5, 0.03};
  clock.quadratic_drag = 0.01;
  clock.dry_friction = 1e-6;
  for (const double angle : {-0.03, -0.012, 0.001, 0.02})
    EXPECT_NEAR(time_from_vertical(clock, 0.045, true, 1.3, angle),
                slow_time(clock, 0.045, 1.3 * 2e-5, angle), 1e-13)
        << angle;
  // Falling is rising seen in a mirror.
  EXPECT_NEAR(time_from_vertical(clock, 0.045, false, 1.3, 0.012),
              slow_time(clock, 0.045, 1.3 * 2e-5, -0.012), 1e-13);
}

TEST(PassageTest, BeyondTheSwitchTheTorqueHoldsBack) {
  const ClockParameters clock{2.0, 0.0, 1e-3, 0.03};
  const double beyond = time_from_vertical(clock, 0.1, true, 1.0, 0.04) -
                        time_from_vertical(clock, 0.1, true, 1.0, 0.03);
  // Work: mu phi0 up to the switch, from there mu (phi - phi0) back.
  const auto slowness = [](double phi) {
    return 1.0 / std::sqrt(0.01 - 2.0 * (1.0 - std::cos(phi)) + 2e-3 * (0.03 - (phi - 0.03)));
  };
  const double simpson = 0.01 / 6.0 * (slowness(0.03) + 4.0 * slowness(0.035) + slowness(0.04));
  EXPECT_NEAR(beyond, simpson, 1e-6); // the rule's own error; the torque's sign is 5e-4
}

TEST(PassageTest, AnAngleThatIsNotReachedHasNoTime) {
  const ClockParameters clock{2.0, 2.5e-4, 2e-5, 0.03};
  EXPECT_TRUE(std::isnan(time_from_vertical(clock, 0.045, true, 1.0, 0.05)));
  EXPECT_EQ(time_from_vertical(clock, 0.045, true, 1.0, 0.0), 0.0);
}

TEST(PassageTest, AnImpulseInTheWayShortensTheRest) {
  ClockParameters clock;
  clock.escapement = Escapement::single_impulse;
  clock.impulse = 1e-4;
  clock.impulse_angle = 0.01;
  ClockParameters none;
  none.escapement = Escapement::none;
  EXPECT_EQ(time_from_vertical(clock, 0.1, false, 1.0, 0.02),
            time_from_vertical(none, 0.1, false, 1.0, 0.02)); // falling, there is none
  EXPECT_LT(time_from_vertical(clock, 0.1, true, 1.0, 0.02),
            time_from_vertical(none, 0.1, true, 1.0, 0.02));
}

} // namespace
} // namespace goingrate
