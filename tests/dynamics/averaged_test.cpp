#include "goingrate/dynamics/averaged.hpp"

#include "base/scaled_time.hpp"
#include "goingrate/dynamics/clock_run.hpp"
#include "goingrate/dynamics/stationary.hpp"

#include <gtest/gtest.h>

namespace goingrate {
namespace {

// A slow but simple oracle: classical Runge-Kutta on Hoyng's eqs. dotl4 and dotpsi4.
struct Plain {
  double x, phase;
};

Plain integrate(double eps, double mu, double phi0, double x0, double t, int steps) {
  using std::numbers::pi;
  const auto dx = [&](double x) { return -2 * eps * x + 4 * mu * phi0 / pi; };
  const auto rate = [&](double x) {
    return -x / 16 + 2 * mu / (pi * std::sqrt(x)) * std::sqrt(1 - phi0 * phi0 / x);
  };
  Plain state{x0, 0.0};
  const double h = t / steps;
  for (int i = 0; i < steps; ++i) {
    const double k1 = dx(state.x), k2 = dx(state.x + h / 2 * k1), k3 = dx(state.x + h / 2 * k2),
                 k4 = dx(state.x + h * k3);
    const double r1 = rate(state.x), r2 = rate(state.x + h / 2 * k1),
                 r3 = rate(state.x + h / 2 * k2), r4 = rate(state.x + h * k3);
    state.x += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    state.phase += h / 6 * (r1 + 2 * r2 + 2 * r3 + r4);
  }
  return state;
}

struct Scene {
  const char* name;
  double eps, mu, phi0, lambda0;
};

class AveragedTest : public testing::TestWithParam<Scene> {};

TEST_P(AveragedTest, ClosedFormMatchesIntegration) {
  const Scene& s = GetParam();
  const AveragedMotion<double> motion(s.eps, s.mu, s.phi0, s.lambda0 * s.lambda0);
  const double t = 1.0 / s.eps;
  ASSERT_TRUE(motion.in_domain(t));
  const Plain slow = integrate(s.eps, s.mu, s.phi0, s.lambda0 * s.lambda0, t, 20000);
  const auto fast = motion.at(t);
  EXPECT_NEAR(fast.amplitude2, slow.x, 1e-14 * slow.x + 1e-17);
  EXPECT_NEAR(fast.phase_excess, slow.phase, 2e-13); // 20,000 steps of rounding in the oracle
}

TEST_P(AveragedTest, RateIsTheDerivativeOfThePhase) {
  const Scene& s = GetParam();
  const AveragedMotion<double> motion(s.eps, s.mu, s.phi0, s.lambda0 * s.lambda0);
  const double t = 0.3 / s.eps, h = 1e-3 / s.eps;
  const double slope = (motion.at(t + h).phase_excess - motion.at(t - h).phase_excess) / (2 * h);
  EXPECT_NEAR(slope, motion.at(t).rate_excess,
              2e-6 * std::abs(motion.at(t).rate_excess) + 1e-12); // h^2 of a central difference
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, AveragedTest,
    testing::Values(Scene{"StationaryAtA", 2.5e-4, 2e-5, 0.03, 0.0390882},
                    Scene{"AfterTheJump", 2.5e-4, 4e-5, 0.03, 0.0390882},
                    Scene{"FromAbove", 1e-4, 1.5e-5, 0.03, 0.2},
                    Scene{"BelowStall", 1e-4, 2e-6, 0.01, 0.2},    // b < 0: the arc tangent branch
                    Scene{"BarelyDriven", 1e-4, 1e-10, 0.01, 0.2}, // the midpoint branch
                    Scene{"DriveOff", 1e-4, 0.0, 0.01, 0.2},
                    Scene{"DriveReversed", 1e-4, -1e-6, 0.01, 0.2},
                    Scene{"AtTheStallLine", 1e-4, 1e-4 * 0.03 * 1.5707963267948966, 0.03, 0.05}),
    [](const auto& scene) { return scene.param.name; });

TEST(AveragedModelTest, StationaryRateIsThatOfTheFormula) {
  const ClockParameters clock{two_pi, 2.5e-4, 2e-5, 0.03};
  const double lambda = *stationary_amplitude(clock);
  const AveragedMotion<double> motion(clock.epsilon, clock.mu, clock.phi0, lambda * lambda);
  // A few roundings of 1.1e-4.
  EXPECT_NEAR(motion.at(0.0).rate_excess, *stationary_rate_first_order(clock), 1e-19);
  // Ten roundings of 11.
  EXPECT_NEAR(motion.at(1e5).phase_excess, 1e5 * *stationary_rate_first_order(clock), 2e-14);
}

TEST(AveragedModelTest, JumpShiftsThePhaseByThePapersAmount) {
  // Delta psi of the jump from A to B by the averaged equations: 0.2945374 (the paper prints
  // 0.295).
  const ClockParameters b{two_pi, 2.5e-4, 4e-5, 0.03};
  ClockParameters a = b;
  a.mu = 2e-5;
  const double lambda = *stationary_amplitude(a);
  const AveragedMotion<double> motion(b.epsilon, b.mu, b.phi0, lambda * lambda);
  const double t = 20000 * two_pi;
  EXPECT_NEAR(motion.at(t).phase_excess - t * *stationary_rate_first_order(b), 0.2945374,
              5e-8); // half a digit
}

TEST(AveragedModelTest, LeavesItsDomainWhereTheEscapementIsNotReached) {
  const AveragedMotion<double> motion(1e-3, 0.0, 0.03, 0.05 * 0.05);
  EXPECT_TRUE(motion.in_domain(100.0));
  EXPECT_FALSE(motion.in_domain(1000.0)); // lambda has fallen below phi0
}

TEST(AveragedModelTest, ErrorAgainstTheFullPendulumShrinksAsTheSquareOfAllSmallTerms) {
  // eps, mu/lambda and lambda^2 shrink together by s; the first-order rate is off at order s^2.
  double last = 0.0;
  for (const double s : {1.0, 0.25, 0.0625}) {
    const ClockParameters clock{two_pi, 2e-3 * s, 4e-4 * s * std::sqrt(s), 0.08 * std::sqrt(s)};
    const double error =
        std::abs(limit_cycle(clock)->rate_excess - *stationary_rate_first_order(clock));
    if (last > 0.0) {
      EXPECT_NEAR(std::log(last / error) / std::log(4.0), 2.0, 0.1); // the order, and higher terms
    }
    last = error;
  }
}

TEST(AveragedModelTest, TurningAngle) {
  // Cycle average of sqrt(phi^2 + phi'^2) of a free pendulum of apex 0.1 rad, by quadrature in
  // time.
  const double apex = 0.1;
  double phi = apex, w = 0.0, sum = 0.0;
  const int steps = 20000;
  const double h = 2 * std::numbers::pi * (1 + apex * apex / 16) / steps;
  for (int i = 0; i < steps; ++i) {
    sum += std::sqrt(phi * phi + w * w) / steps;
    w -= h / 2 * std::sin(phi);
    phi += h * w;
    w -= h / 2 * std::sin(phi);
  }
  EXPECT_NEAR(turning_angle(sum), apex, 3e-8); // O(lambda^4): 1e-7 of the angle, and the quadrature
}

} // namespace
} // namespace goingrate
