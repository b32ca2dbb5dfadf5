#include "goingrate/dynamics/rk4.hpp"

#include "base/scaled_time.hpp"
#include "dynamics/point_c.hpp"
#include "goingrate/base/errors.hpp"
#include "goingrate/dynamics/stationary.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace goingrate {
namespace {

using test::velocity_c;

// Point C of the paper; the rate of its limit cycle in 128-bit arithmetic.
constexpr double eps_c = 1.167245e-4, mu_c = 1.5e-5, phi0_c = 0.03;
constexpr double rate_c = 1.844068077230375e-08;

// Rate excess of a period given by what it has over 2 pi.
double rate_for(double excess) { return -excess / (two_pi + excess); }

// Mean rate by linear regression of crossing times on their number. Interpolation puts each time
// off by up to 0.016 dt^3; over n crossings that leaves 0.01 dt^3 / n^1.5 in the rate, 1e-12 at
// 0.03.
double mean_rate(Rk4Pendulum& pendulum, double eps, double mu, double phi0, int n) {
  double excess = 0.0, sum = 0.0, weight = 0.0;
  for (int i = 0; i <= n; ++i) {
    const double x = i - 0.5 * n;
    sum += x * excess;
    weight += x * x;
    excess += pendulum.advance(eps, mu, phi0).full - two_pi;
  }
  return rate_for(sum / weight);
}

// After `warm` periods from the exact limit cycle: towards the integrator's own, which differs by
// O(dt), the pendulum relaxes within 680 periods at C.
double rate_at_c(TorqueTiming timing, double dt, int warm, int n) {
  Rk4Pendulum pendulum(velocity_c, dt, timing);
  for (int i = 0; i < warm; ++i)
    pendulum.advance(eps_c, mu_c, phi0_c);
  return mean_rate(pendulum, eps_c, mu_c, phi0_c, n);
}

struct Scene {
  const char* name;
  TorqueTiming timing;
  double dt, error, tolerance;
};
class Rk4RateTest : public testing::TestWithParam<Scene> {};

TEST_P(Rk4RateTest, RateErrorAtPointC) {
  const Scene& s = GetParam();
  EXPECT_NEAR(rate_at_c(s.timing, s.dt, 8000, 4000) - rate_c, s.error, s.tolerance);
}

// Tolerances: half a unit of the digits the header gives, but for the torque chosen per stage at
// 0.03, whose rate wanders by 2e-11 from one 4000 periods to the next.
INSTANTIATE_TEST_SUITE_P(
    Variants, Rk4RateTest,
    testing::Values(Scene{"PerStepCoarse", TorqueTiming::per_step, 0.03, -5.44e-6, 5e-9},
                    Scene{"PerStepFine", TorqueTiming::per_step, 0.01, -1.807e-6, 5e-10},
                    Scene{"PerStageCoarse", TorqueTiming::per_stage, 0.03, -7.09e-9, 4e-11},
                    Scene{"PerStageFine", TorqueTiming::per_stage, 0.01, 9.754e-10, 2e-12},
                    Scene{"AtSwitchesCoarse", TorqueTiming::at_switches, 0.03, -6.446e-9, 2e-12},
                    Scene{"AtSwitchesFine", TorqueTiming::at_switches, 0.01, -8.215e-11, 5e-14}),
    [](const auto& scene) { return scene.param.name; });

double order_of(TorqueTiming timing, double coarse, double fine) {
  const double first = std::abs(rate_at_c(timing, coarse, 4000, 4000) - rate_c);
  const double second = std::abs(rate_at_c(timing, fine, 4000, 4000) - rate_c);
  return std::log(first / second) / std::log(coarse / fine);
}

TEST(Rk4OrderTest, OncePerStepIsOfFirstOrder) {
  EXPECT_NEAR(order_of(TorqueTiming::per_step, 0.06, 0.015), 1.0, 0.02); // dt^2 / dt
}

TEST(Rk4OrderTest, FourthOrderIsKeptByCuttingAtTheSwitches) {
  EXPECT_NEAR(order_of(TorqueTiming::at_switches, 0.04, 0.02), 4.0, 0.08); // dt^5 / dt^4
}

TEST(Rk4OrderTest, ASingleSwitchPerStageIsOfFirstOrder) {
  // The end of the first period against that with cut steps; rms over places of the switch in its
  // step. A strong torque, so that the switch counts for more than the interpolation.
  constexpr double strong = 1e-3;
  const auto error = [](double around) {
    double sum = 0.0;
    constexpr int places = 400;
    for (int i = 0; i < places; ++i) {
      const double dt = around * (0.9 + 0.2 * i / places);
      Rk4Pendulum stage(velocity_c, dt, TorqueTiming::per_stage);
      Rk4Pendulum cut(velocity_c, dt, TorqueTiming::at_switches);
      const double difference =
          stage.advance(eps_c, strong, phi0_c).full - cut.advance(eps_c, strong, phi0_c).full;
      sum += difference * difference;
    }
    return std::sqrt(sum / places);
  };
  EXPECT_NEAR(std::log(error(0.04) / error(0.01)) / std::log(4.0), 1.0, 0.05); // scatter of places
}

TEST(Rk4OrderTest, PerStageTheClockLocksToTheGrid) {
  const double locked = 135.0 / 848.23 * two_pi - 1.0;
  for (const double dt : {0.02, 0.01, 0.005}) {
    EXPECT_NEAR(rate_at_c(TorqueTiming::per_stage, dt, 8000, 4000), locked,
                2e-12); // has locked to this by then
    EXPECT_GT(std::abs(rate_at_c(TorqueTiming::at_switches, dt, 4000, 4000) - locked), 9e-10);
  }
}

TEST(Rk4FreeTest, VelocityIsLostAtFifthOrder) {
  // Means of 2000 crossings, because that of one is off by up to dt^2/8.
  const auto loss_per_period = [](double dt) {
    Rk4Pendulum pendulum(0.1, dt, TorqueTiming::per_step);
    const auto mean_log = [&] {
      double sum = 0.0;
      for (int i = 0; i < 2000; ++i) {
        pendulum.advance(0.0, 0.0, 0.03);
        sum += std::log(pendulum.velocity());
      }
      return sum / 2000;
    };
    const double before = mean_log();
    for (int i = 0; i < 16000; ++i)
      pendulum.advance(0.0, 0.0, 0.03);
    return (before - mean_log()) / 18000;
  };
  const double coarse = loss_per_period(0.2), fine = loss_per_period(0.1);
  EXPECT_NEAR(std::log2(coarse / fine), 5.0, 0.06);                  // dt^7 / dt^5
  EXPECT_NEAR(fine, two_pi * std::pow(0.1, 5) / 144.0, 0.01 * fine); // dt^2, phi'^2
}

TEST(Rk4FreeTest, SwingsToTheLeftAreThoseToTheRight) {
  // Reversed in time, a free swing is itself. On the grid each half is off by its interpolation,
  // up to 0.016 dt^3; the mean of 2000 is left with 1/45 of that.
  for (const auto timing :
       {TorqueTiming::per_step, TorqueTiming::per_stage, TorqueTiming::at_switches}) {
    Rk4Pendulum pendulum(0.5, 0.05, timing);
    double sum = 0.0;
    for (int i = 0; i < 2000; ++i) {
      const auto step = pendulum.advance(0.0, 0.0, 0.1);
      sum += step.down - 0.5 * step.full;
    }
    EXPECT_NEAR(sum / 2000, 0.0, 0.016 * 1.25e-4 / 45);
  }
}

TEST(Rk4FreeTest, ATorqueChangedAtACrossingActsInThePeriodThatFollows) {
  // Jump from A to B: 3.2201382327e-4 where it is made exactly at the crossing. Here it comes up
  // to dt late, which is dt / 2 pi of the change of rate.
  Rk4Pendulum pendulum(0.0390886300401325117257, 0.0005, TorqueTiming::at_switches);
  const double before = rate_for(pendulum.advance(2.5e-4, 2e-5, 0.03).full - two_pi);
  const double after = rate_for(pendulum.advance(2.5e-4, 4e-5, 0.03).full - two_pi);
  EXPECT_NEAR(before, 1.133264e-4, 1e-10); // interpolation: 0.016 dt^3
  EXPECT_NEAR(after, 3.2201382e-4, 2.1e-4 * 0.0005 / two_pi);
}

TEST(Rk4FreeTest, ASwitchNextToTheVerticalIsNotMissed) {
  // phi0 far below the way of one step: crossing and switch fall into the same step.
  ClockParameters clock;
  clock.epsilon = 1e-4;
  clock.mu = 4e-3;
  clock.phi0 = 1e-4;
  const auto cycle = limit_cycle(clock);
  ASSERT_TRUE(cycle);
  Rk4Pendulum pendulum(cycle->velocity, 0.03, TorqueTiming::at_switches);
  const double rate = mean_rate(pendulum, clock.epsilon, clock.mu, clock.phi0, 2000);
  EXPECT_NEAR(rate, cycle->rate_excess, 5e-8); // some dt^4/120
}

TEST(Rk4FreeTest, InterpolationErrorOfACrossing) {
  // theta (1 - theta) (2 theta - 1) dt^3 / 6 for a crossing at the part theta of its step, at most
  // 0.016 dt^3; in a period the difference of two.
  constexpr double dt = 0.03;
  Rk4Pendulum pendulum(velocity_c, dt, TorqueTiming::per_step);
  const double exact = 4.0 * std::comp_ellint_1(0.5 * velocity_c);
  const double period = exact * (1.0 + std::pow(dt, 4) / 120.0); // that of RK4
  double largest = 0.0;
  for (int i = 0; i < 1000; ++i)
    largest = std::max(largest, std::abs(pendulum.advance(0.0, 0.0, phi0_c).full - period));
  const double bound = 2 * 0.0161 * dt * dt * dt;
  EXPECT_LT(largest, bound);
  EXPECT_GT(largest, 0.9 * bound); // among 1000 one comes near it
}

TEST(Rk4StatusTest, BelowPhi0TheClockStalls) {
  Rk4Pendulum pendulum(0.2, 0.03, TorqueTiming::at_switches);
  auto step = pendulum.advance(0.1, 0.01, 0.5);
  EXPECT_EQ(step.status, SwingStatus::crossed); // still wider than the torque holds it up
  for (int i = 0; i < 100 && step.status == SwingStatus::crossed; ++i)
    step = pendulum.advance(0.1, 0.01, 0.5);
  EXPECT_EQ(step.status, SwingStatus::stalled);
  EXPECT_EQ(step.full, 0.0);
  EXPECT_EQ(pendulum.advance(0.1, 0.01, 0.1).status, SwingStatus::stalled); // and stays so
}

TEST(Rk4StatusTest, WithoutMemoryTheClockStartsItself) {
  for (const auto timing : {TorqueTiming::per_step, TorqueTiming::per_stage}) {
    Rk4Pendulum pendulum(0.001, 0.03, timing); // far below phi0
    for (int i = 0; i < 10000; ++i)
      ASSERT_EQ(pendulum.advance(eps_c, mu_c, phi0_c).status, SwingStatus::crossed);
    EXPECT_NEAR(pendulum.velocity(), velocity_c, 0.02 * velocity_c); // late switches: + dt/2
  }
}

TEST(Rk4StatusTest, ATorqueThatLiftsItOverTheTopIsTold) {
  for (const auto timing :
       {TorqueTiming::per_step, TorqueTiming::per_stage, TorqueTiming::at_switches}) {
    Rk4Pendulum pendulum(1.9, 0.03, timing);
    EXPECT_EQ(pendulum.advance(0.0, 0.5, 3.0).status, SwingStatus::overturned);
  }
}

TEST(Rk4StatusTest, NumbersThatAreNoneEndInAStatus) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  for (const auto timing :
       {TorqueTiming::per_step, TorqueTiming::per_stage, TorqueTiming::at_switches}) {
    for (const double bad : {inf, -inf, nan}) {
      EXPECT_EQ(Rk4Pendulum(0.05, 0.03, timing).advance(bad, mu_c, phi0_c).status,
                SwingStatus::not_finite);
      const auto torque = Rk4Pendulum(0.05, 0.03, timing).advance(eps_c, bad, phi0_c);
      EXPECT_EQ(torque.status, SwingStatus::not_finite);
      EXPECT_EQ(torque.down, 0.0);
      Rk4Pendulum pendulum(0.05, 0.03, timing);
      (void)pendulum.advance(eps_c, mu_c, bad); // any status, but it returns
      EXPECT_TRUE(std::isfinite(pendulum.velocity()));
    }
  }
}

TEST(Rk4StatusTest, APendulumThatComesToRestIsStalled) {
  Rk4Pendulum pendulum(1.0, 1.0, TorqueTiming::at_switches);
  auto step = pendulum.advance(0.9, 0.0, 0.1);
  for (int i = 0; i < 1000 && step.status == SwingStatus::crossed; ++i)
    step = pendulum.advance(0.9, 0.0, 0.1);
  EXPECT_EQ(step.status, SwingStatus::stalled); // the angle has underflowed to 0
}

TEST(Rk4StatusTest, RefusesWhatItCannotDoAndNamesIt) {
  const auto message = [](double velocity, double dt) -> std::string {
    try {
      const Rk4Pendulum pendulum(velocity, dt, TorqueTiming::per_step);
    } catch (const ArgumentError& e) {
      return e.what();
    }
    return {};
  };
  for (const double velocity : {0.0, -0.1, 2.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_EQ(message(velocity, 0.03).substr(0, 10), "velocity =");
  for (const double dt : {0.0, -0.03, 1.01, 1e-7, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_EQ(message(0.05, dt).substr(0, 4), "dt =");
  EXPECT_EQ(message(1.99, 1.0), "");
}

} // namespace
} // namespace goingrate
