#include "goingrate/dynamics/map.hpp"

#include "base/scaled_time.hpp"
#include "dynamics/point_c.hpp"
#include "goingrate/base/random.hpp"
#include "goingrate/dynamics/stationary.hpp"
#include "support/noisy_oracle.hpp"

#include <gtest/gtest.h>

namespace goingrate {
namespace {

using test::clock_c, test::velocity_c, test::excess_c;
const FactorRange noisy{1.0 - 7 * 0.3, 1.0 + 7 * 0.3};

using test::error_of;

TEST(MapTest, CrossingTimesOfPointC) {
  for (const FactorRange& factors : {FactorRange{}, noisy}) {
    MapPendulum pendulum(clock_c, velocity_c, factors);
    TwoPart<double> excess;
    double worst_2000 = 0.0, worst = 0.0;
    for (int cycle = 1; cycle <= 100000; ++cycle) {
      excess += pendulum.advance().excess;
      worst = std::max(worst, error_of(excess, excess_c * cycle));
      if (cycle == 2000) worst_2000 = worst;
    }
    EXPECT_LT(worst_2000, 2e-14);
    EXPECT_LT(worst, 2e-13);
    EXPECT_EQ(pendulum.fallbacks(), 0);
  }
}

TEST(MapTest, InDigitsOfADouble) {
  for (const FactorRange& factors : {FactorRange{}, noisy}) {
    MapPendulum pendulum(clock_c, velocity_c, factors, MapDigits::of_a_double);
    TwoPart<double> excess;
    constexpr int cycles = 100000;
    for (int cycle = 1; cycle <= cycles; ++cycle)
      excess += pendulum.advance().excess;
    EXPECT_LT(error_of(excess, excess_c * cycles) / cycles, 2e-15); // some roundings of 2 pi - T
    EXPECT_EQ(pendulum.fallbacks(), 0);
  }
}

TEST(MapTest, CrossingTimesOfANoisyDrive) {
  // Between the nodes, against the integration that the nodes come from; 1e5 in tests/studies.
  MapPendulum pendulum(clock_c, velocity_c, noisy);
  EXPECT_LT(test::worst_noisy_error(std::move(pendulum), clock_c, 2000), 2e-14);
}

TEST(MapTest, HalvesAreThoseOfTheDirectIntegration) {
  MapPendulum map(clock_c, 0.05, noisy);
  DirectPendulum direct(clock_c, 0.05);
  for (const double factor : {1.0, 0.2, 2.4}) {
    const auto fast = map.advance(factor), slow = direct.advance(factor);
    EXPECT_NEAR(fast.half_excess, slow.half_excess, 1e-16); // what direct's steps cut off
    EXPECT_NEAR(fast.excess, slow.excess, 1e-16);           // likewise
  }
}

TEST(MapTest, LanesGiveTheBitsOfSinglePeriods) {
  ReturnMap map(clock_c, noisy);
  const MapPatch* patch = map.find(velocity_c * velocity_c);
  ASSERT_NE(patch, nullptr);
  std::array<double, MapPatch::lanes> x, factor, change, excess;
  for (std::size_t k = 0; k < MapPatch::lanes; ++k) {
    x[k] = velocity_c * velocity_c * (1.0 + 3e-3 * static_cast<double>(k));
    factor[k] = 0.1 + 0.3 * static_cast<double>(k);
  }
  patch->at(x, factor, change, excess);
  for (std::size_t k = 0; k < MapPatch::lanes; ++k) {
    EXPECT_EQ(change[k], patch->at(x[k], factor[k]).speed2_change);
    EXPECT_EQ(excess[k], patch->at(x[k], factor[k]).excess);
  }
}

TEST(MapTest, OutsideItsDomainTheDirectIntegratorTakesOverAndIsCounted) {
  MapPendulum map(clock_c, 0.05, {0.5, 1.5});
  DirectPendulum direct(clock_c, 0.05);
  (void)map.advance(3.0); // beyond the factors
  (void)direct.advance(3.0);
  EXPECT_EQ(map.fallbacks(), 1);
  EXPECT_EQ(map.velocity(), direct.velocity());

  // Just above the switching angle: T has a branch point at v = phi0 and no polynomial there.
  MapPendulum grazing(clock_c, 0.0302, {0.5, 1.5});
  EXPECT_EQ(grazing.advance().status, SwingStatus::crossed);
  EXPECT_EQ(grazing.fallbacks(), 1);
}

TEST(MapTest, NearTheSwitchingAngleItIsExactOrSteppedAside) {
  for (const double ratio : {1.001, 1.01, 1.03, 1.05, 1.1, 1.2, 1.5}) {
    MapPendulum map(clock_c, 0.03 * ratio, {-1.0, 3.0});
    DirectPendulum direct(clock_c, 0.03 * ratio);
    for (int i = 0; i < 20; ++i) {
      const double factor = 0.2 * i - 0.9;
      const auto fast = map.advance(factor), slow = direct.advance(factor);
      ASSERT_EQ(fast.status, slow.status);
      if (fast.status != SwingStatus::crossed) break;
      EXPECT_NEAR(fast.excess, slow.excess, 2.8e-16)
          << ratio; // ten steps, an eighth of a rounding each
    }
  }
}

TEST(MapTest, ServesEveryClockLaw) {
  ClockParameters impulse;
  impulse.epsilon = 1e-4;
  impulse.quadratic_drag = 1e-3;
  impulse.dry_friction = 1e-7;
  impulse.escapement = Escapement::single_impulse;
  impulse.impulse = 3e-6;
  impulse.impulse_angle = 0.01;
  const auto cycle = limit_cycle(impulse);
  ASSERT_TRUE(cycle);
  MapPendulum map(impulse, cycle->velocity, {0.5, 1.5});
  DirectPendulum direct(impulse, cycle->velocity);
  for (const double factor : {1.0, 0.6, 1.4, 1.1}) {
    EXPECT_NEAR(map.advance(factor).excess, direct.advance(factor).excess, 1e-16);
    EXPECT_NEAR(map.velocity(), direct.velocity(), 1e-16); // what direct's steps cut off
  }
  EXPECT_EQ(map.fallbacks(), 0);
}

TEST(MapTest, ARingDownGoesFromPatchToPatch) {
  ClockParameters free{two_pi, 2.5e-4, 0.0, 0.0, Escapement::none};
  MapPendulum map(free, 0.1, {});
  DirectPendulum direct(free, 0.1);
  TwoPart<double> fast, slow;
  for (int i = 0; i < 2000; ++i) {
    fast += map.advance().excess;
    slow += direct.advance().excess;
  }
  EXPECT_NEAR(fast.value(), slow.value(), 1e-14); // 2000 steps cut off 1e-16 each, up or down
  EXPECT_EQ(map.fallbacks(), 0);
}

} // namespace
} // namespace goingrate
