#include "goingrate/dynamics/half_swing.hpp"

#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <gtest/gtest.h>

namespace goingrate {
namespace {

using Quad = boost::multiprecision::cpp_bin_float_quad; // 113 bits
constexpr double pi = std::numbers::pi;

TEST(HalfSwingTest, PeriodOfTheFreePendulumIsTheEllipticIntegral) {
  // From small swings to 2.8 rad; the exact half period is 2 K(v/2).
  for (const double v : {1e-3, 0.05, 0.3, 1.0, 1.5, 1.8, 1.95, 1.97}) {
    const auto swing = half_swing(v, 0.0, 0.0, 10.0, true);
    ASSERT_EQ(swing.status, SwingStatus::crossed);
    EXPECT_NEAR(swing.duration.value() / (2.0 * boost::math::ellint_1(v / 2.0)), 1.0,
                2e-15 / (4 - v * v))
        << v; // a few roundings, and the sensitivity to v near the top
    EXPECT_NEAR(swing.apex, 2.0 * std::asin(v / 2.0), 1e-14 / (2 - v)) << v;
    EXPECT_EQ(swing.speed2_change, 0.0);
  }
}

TEST(HalfSwingTest, DampedSmallSwingsAreTheHarmonicOscillator) {
  const double eps = 0.1;
  const double v = 1e-6; // the circular error is 6e-14 here
  const auto swing = half_swing(v, eps, 0.0, 10.0, true);
  const double omega = std::sqrt(1.0 - eps * eps);
  EXPECT_NEAR(swing.duration.value(), pi / omega, 1e-12);
  EXPECT_NEAR(swing.speed / v, std::exp(-eps * pi / omega), 1e-12);
}

struct Case {
  double v, eps, mu, phi0;
  bool helping;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.v << ' ' << c.eps << ' ' << c.mu; }

class Against128Bits : public testing::TestWithParam<Case> {};

TEST_P(Against128Bits, DurationAndWorkAgreeToRounding) {
  const Case& c = GetParam();
  const auto fast = half_swing(c.v, c.eps, c.mu, c.phi0, c.helping);
  const auto exact = half_swing(Quad(c.v), Quad(c.eps), Quad(c.mu), Quad(c.phi0), c.helping);
  ASSERT_EQ(fast.status, exact.status);
  EXPECT_EQ(fast.switched, exact.switched);
  Quad exact_duration = exact.duration.hi + exact.duration.lo;
  // Four steps of rounding 1e-16 each, times how steeply the duration hangs on them.
  EXPECT_LT(abs(Quad(fast.duration.hi) + fast.duration.lo - exact_duration), Quad(3e-15));
  // Work and friction, each to four roundings.
  EXPECT_LT(abs(Quad(fast.speed2_change) - exact.speed2_change),
            Quad(9e-16) * Quad(4 * std::abs(c.mu) * c.phi0 + 2 * pi * c.eps * c.v * c.v));
  EXPECT_NEAR(fast.apex, static_cast<double>(exact.apex), 1e-14);
  // v'^2 by work and by the end of the motion are the same number.
  EXPECT_LT(abs(exact.speed * exact.speed - Quad(c.v) * Quad(c.v) - exact.speed2_change),
            Quad(1e-30));
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, Against128Bits,
    testing::Values(Case{0.0390886300401325, 2.5e-4, 2e-5, 0.03, true},        // A
                    Case{0.0552840336990741, 2.5e-4, 4e-5, 0.03, true},        // B
                    Case{0.0495414393471761, 1.167245e-4, 1.5e-5, 0.03, true}, // C
                    Case{0.0300001, 2.5e-4, 2e-5, 0.03, true},                 // grazing the switch
                    Case{0.02, 2.5e-4, 2e-5, 0.03, true},                      // not reaching it
                    Case{0.0390886300401325, 2.5e-4, 2e-5, 0.03, false}, // after a missed switch
                    Case{0.05, 2.5e-4, -2e-5, 0.03, true},               // torque reversed by noise
                    Case{0.3, 0.05, 2e-2, 0.2, true},                    // heavy friction
                    Case{1.5, 1e-3, 1e-3, 0.5, true}));                  // far from small

TEST(HalfSwingTest, ASwitchWithinOneUlpOfTheApexIsDecidedByTheApex) {
  const double eps = 1e-4, mu = 1e-5;
  const double apex = half_swing(0.05, eps, mu, 1.0, true).apex; // never switches
  EXPECT_FALSE(half_swing(0.05, eps, mu, apex * (1 + 4e-16), true).switched);
  const auto just = half_swing(0.05, eps, mu, apex * (1 - 1e-13), true);
  EXPECT_TRUE(just.switched);
  EXPECT_EQ(just.status, SwingStatus::crossed);
  EXPECT_TRUE(std::isfinite(just.duration.value()));
}

TEST(HalfSwingTest, AWeakSwingUnderAStrongTorqueStalls) {
  // The torque holds the pendulum at 0.01 rad, the swing is smaller than that.
  EXPECT_EQ(half_swing(1e-3, 1e-3, 0.01, 0.5, true).status, SwingStatus::stalled);
}

TEST(HalfSwingTest, TooMuchSpeedOverturns) {
  EXPECT_EQ(half_swing(2.1, 1e-3, 0.0, 0.5, true).status, SwingStatus::overturned);
}

TEST(HalfSwingTest, TimeReversalBringsTheUndampedPendulumBack) {
  // Without friction the swing under a constant torque +m to the right is the swing back run
  // backwards: out with speed v and in with speed v again.
  const auto out = half_swing(0.4, 0.0, 0.01, 10.0, true);
  EXPECT_NEAR(out.speed, 0.4, 1e-15);
}

} // namespace
} // namespace goingrate
