#include "goingrate/dynamics/half_swing.hpp"

#include <boost/math/special_functions/ellint_1.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace goingrate {
namespace {

using Wide = long double;
static_assert(std::numeric_limits<Wide>::digits >= 64,
              "what double is compared with is 2000 times finer");
using std::numbers::pi;

TEST(HalfSwingTest, PeriodOfTheFreePendulumIsTheEllipticIntegral) {
  // From small swings to 2.8 rad; the exact half period is 2 K(v/2).
  for (const double v : {1e-3, 0.05, 0.3, 1.0, 1.5, 1.8, 1.95, 1.97}) {
    const auto swing = half_swing(v, 0.0, 0.0, 10.0, true);
    ASSERT_EQ(swing.status, SwingStatus::crossed);
    EXPECT_NEAR((pi + swing.excess) / (2.0 * boost::math::ellint_1(v / 2.0)), 1.0,
                2e-15 / (4 - v * v))
        << v; // a few roundings, and the sensitivity to v near the top
    EXPECT_EQ(swing.speed2_change, 0.0);
  }
}

TEST(HalfSwingTest, PeriodOfTheFreePendulumUpToThreeRadians) {
  const double v = 2 * std::sin(1.5); // turns round at 3 rad
  const auto swing = half_swing(v, FreePendulum<double>{}, 0.0, 10.0, true);
  EXPECT_NEAR(swing.apex, 3.0, 1e-13); // the top is 0.14 rad away: v counts ten times there
  // Likewise: three roundings of 7.3, tenfold.
  EXPECT_NEAR(pi + swing.excess, 2.0 * boost::math::ellint_1(v / 2.0), 3e-14);
}

TEST(HalfSwingTest, ExcessOfASmallFreeSwingKeepsItsOwnDigits) {
  // 2K - pi = pi (k^2/4 + 9 k^4/64 + ...), k = v/2: 2e-7 here. What the steps cut off is a
  // fraction of the rounding of the motion, 1e-16, where pi + 2e-7 itself is rounded to 4e-16.
  const double v = 1e-3, k2 = v * v / 4;
  const double exact = pi * k2 * (0.25 + k2 * (9.0 / 64 + k2 * 25.0 / 256));
  EXPECT_NEAR(half_swing(v, 0.0, 0.0, 10.0, true).excess, exact, 1e-21); // ten roundings of 8e-7
}

TEST(HalfSwingTest, DampedSmallSwingsAreTheHarmonicOscillator) {
  const double eps = 0.1;
  const double v = 1e-6; // the circular error is 6e-14 here
  const auto swing = half_swing(v, eps, 0.0, 10.0, true);
  const double omega = std::sqrt(1.0 - eps * eps);
  EXPECT_NEAR(pi + swing.excess, pi / omega, 3e-13); // pi times the circular error
  // Eps times that.
  EXPECT_NEAR(std::sqrt(1 + swing.speed2_change / (v * v)), std::exp(-eps * pi / omega), 3e-14);
}

struct Case {
  double v, eps, mu, phi0;
  bool helping;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.v << ' ' << c.eps << ' ' << c.mu; }

class AgainstLongDouble : public testing::TestWithParam<Case> {};

TEST_P(AgainstLongDouble, DurationAndWorkAgreeToRounding) {
  const Case& c = GetParam();
  const auto fast = half_swing(c.v, c.eps, c.mu, c.phi0, c.helping);
  const auto exact = half_swing(Wide(c.v), Wide(c.eps), Wide(c.mu), Wide(c.phi0), c.helping);
  ASSERT_EQ(fast.status, exact.status);
  EXPECT_EQ(fast.switched, exact.switched);
  // A few roundings of what the forces did, not of the motion: 1e-18 in a clock.
  const double forces =
      c.v * c.v / 8 + 2 * std::abs(c.mu) / c.v + 2 * c.eps; // excess, about, before any cancels
  // Each of some five steps may cut off an eighth of the rounding of the motion.
  EXPECT_LT(std::abs(fast.excess - exact.excess), Wide(4e-16 * forces + 1e-16));
  // Work and friction, each to some roundings; what gravity adds to them on the way to v^2/50.
  const double worked = 4 * std::abs(c.mu) * c.phi0 + 2 * pi * c.eps * c.v * c.v;
  const bool by_work = c.v * c.v > 600 * c.eps;
  const double moved = by_work ? worked : std::pow(c.v, 4) / 50;
  EXPECT_LT(std::abs(fast.speed2_change - exact.speed2_change),
            Wide(1.5e-15 * (worked + moved) + (by_work ? 0.0 : 1e-16 * c.v * c.v)));
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, AgainstLongDouble,
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
  const FreePendulum<double> friction{eps, 0, 0};
  const double apex = half_swing(0.05, friction, mu, 1.0, true).apex; // never switches
  EXPECT_FALSE(half_swing(0.05, eps, mu, apex * (1 + 1e-15), true).switched);
  const auto just = half_swing(0.05, eps, mu, apex * (1 - 1e-13), true);
  EXPECT_TRUE(just.switched);
  EXPECT_EQ(just.status, SwingStatus::crossed);
  EXPECT_TRUE(std::isfinite(just.excess));
}

TEST(HalfSwingTest, AWeakSwingUnderAStrongTorqueStalls) {
  // The torque holds the pendulum at 0.01 rad, the swing is smaller than that.
  EXPECT_EQ(half_swing(1e-3, 1e-3, 0.01, 0.5, true).status, SwingStatus::stalled);
}

TEST(HalfSwingTest, AWeakSwingThatDipsThroughTheVerticalHasCrossed) {
  // The torque holds the pendulum up on the wrong side; the swing takes it through the vertical for
  // less than a step. It is at rest at 0.005 rad and swings 0.0051 to either side.
  const double mu = 0.005, speed = std::sqrt(0.0051 * 0.0051 - mu * mu);
  const auto swing = half_swing(speed, 1e-9, mu, 0.5, true);
  EXPECT_EQ(swing.status, SwingStatus::crossed);
  // About the rest the motion is harmonic: 2 (pi - acos(0.005/0.0051)) between the passages.
  EXPECT_NEAR(std::numbers::pi + swing.excess, 2 * (std::numbers::pi - std::acos(mu / 0.0051)),
              2e-3); // the circular error, and friction
  const double less = std::sqrt(0.00501 * 0.00501 - mu * mu);
  EXPECT_EQ(half_swing(less, 1e-3, mu, 0.5, true).status, SwingStatus::stalled);
}

TEST(HalfSwingTest, TooMuchSpeedOverturns) {
  EXPECT_EQ(half_swing(2.1, 1e-3, 0.0, 0.5, true).status, SwingStatus::overturned);
}

TEST(HalfSwingTest, TimeReversalBringsTheUndampedPendulumBack) {
  // Without friction the swing under a constant torque +m to the right is the swing back run
  // backwards: out with speed v and in with speed v again.
  const auto out = half_swing(0.4, 0.0, 0.01, 10.0, true);
  EXPECT_NEAR(out.speed2_change, 0.0, 1e-17); // below a rounding of 0.16: the halves are alike
}

// ---- other laws -------------------------------------------------------------------------------

TEST(HalfSwingTest, QuadraticDragTakesItsWorkFromTheSwing) {
  // v v' = -sin phi - k v^2 while rising: v^2 is exact in closed form, and so is the fall. With
  // y = v^2: y' = -2 sin phi - 2 k y up, y' = ... + 2 k y down (y over phi).
  const double k = 0.05, v = 0.3;
  const auto swing = half_swing(v, FreePendulum<double>{0, k, 0}, 0.0, 10.0, true);
  const double a = swing.apex, d = 1 + 4 * k * k;
  const auto up = [&](double phi) { return (2 * std::cos(phi) - 4 * k * std::sin(phi)) / d; };
  const auto down = [&](double phi) { return (2 * std::cos(phi) + 4 * k * std::sin(phi)) / d; };
  EXPECT_NEAR(up(a) + (v * v - up(0)) * std::exp(-2 * k * a), 0.0, 1e-15); // it turns at the apex
  const double v2 = down(0) - down(a) * std::exp(-2 * k * a);
  // Two roundings of 2, of which v2 is a difference.
  EXPECT_NEAR(v * v + swing.speed2_change, v2, 1e-15);
}

TEST(HalfSwingTest, DryFrictionTakesTwiceItsForceTimesTheAngle) {
  const double c = 1e-3, v = 0.2;
  const auto swing = half_swing(v, FreePendulum<double>{0, 0, c}, 0.0, 10.0, true);
  EXPECT_NEAR(swing.speed2_change, -4 * c * swing.apex, 1e-18); // ten roundings of 8e-4
}

TEST(HalfSwingTest, DryFrictionHoldsASwingThatIsSmallerThanItself) {
  EXPECT_EQ(half_swing(1e-3, FreePendulum<double>{0, 0, 1e-2}, 0.0, 10.0, true).status,
            SwingStatus::stalled);
}

TEST(HalfSwingTest, AllFrictionLawsAgreeWithLongDouble) {
  const FreePendulum<double> friction{1e-3, 0.02, 1e-5};
  const FreePendulum<Wide> wide{Wide(1e-3), Wide(0.02), Wide(1e-5)};
  const auto fast = half_swing(0.07, friction, 2e-5, 0.03, true);
  const auto exact = half_swing(Wide(0.07), wide, Wide(2e-5), Wide(0.03), true);
  EXPECT_LT(std::abs(fast.excess - exact.excess), Wide(1e-16)); // what five steps may cut off
  EXPECT_LT(std::abs(fast.speed2_change - exact.speed2_change), Wide(1e-16 * 0.07 * 0.07));
}

TEST(HalfSwingTest, AProfileThatIsAConstantTorqueIsTheConstantTorque) {
  // +mu up to phi0 and -mu from there on, as a table with a steep fall of 1e-9 rad.
  const double mu = 2e-5, phi0 = 0.03;
  SwingProfile<double> profile;
  const double slope = -2 * mu / 1e-9;
  profile.rise = {
      {phi0 - 5e-10, mu, 0, 0}, {phi0 + 5e-10, -slope * phi0, slope, 0}, {1e9, -mu, 0, 0}};
  profile.fall = {{0.0, -mu, 0, 0}};
  const auto table = half_swing(0.05, FreePendulum<double>{2.5e-4, 0, 0}, profile, 1.0);
  const auto torque = half_swing(0.05, 2.5e-4, mu, phi0, true);
  EXPECT_NEAR(table.speed2_change, torque.speed2_change, 1e-15); // the fall is 1e-9 wide
  EXPECT_NEAR(table.excess, torque.excess, 1e-15);               // likewise
}

TEST(HalfSwingTest, AnImpulseAddsItsEnergyWhereItActs) {
  const double e = 1e-6;
  SwingProfile<double> rise, fall;
  rise.rise = {{0.02, 0, 0, e}, {1e9, 0, 0, 0}};
  rise.fall = {{0.0, 0, 0, 0}};
  fall.rise = {{1e9, 0, 0, 0}};
  fall.fall = {{0.02, 0, 0, e}, {0.0, 0, 0, 0}};
  const FreePendulum<double> none;
  const double free = half_swing(0.05, 0.0, 0.0, 10.0, true).excess;
  for (const auto* profile : {&rise, &fall}) {
    const auto swing = half_swing(0.05, none, *profile, 1.0);
    // Below a rounding of 2.5e-3: changes keep their digits.
    EXPECT_NEAR(swing.speed2_change, 2 * e, 1e-19);
    // A push along the motion before the apex lengthens the way, after it shortens the time:
    // -(e / lambda^2) tan psi1 of phase each (eq. blow5), signs as phi psi' - 1 has them.
    const double psi = std::asin(0.02 / 0.05);
    const double shift = e / (0.05 * 0.05) * std::tan(psi) * (profile == &rise ? 1 : -1);
    EXPECT_NEAR(swing.excess - free, shift, 0.02 * std::abs(shift)); // first order in e/lambda^2
  }
}

} // namespace
} // namespace goingrate
