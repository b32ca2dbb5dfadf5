#include "goingrate/dynamics/moments.hpp"

#include <boost/math/special_functions/bessel.hpp>
#include <gtest/gtest.h>
#include <numbers>

namespace goingrate {
namespace {

using std::numbers::pi;

TEST(MomentsTest, ClosedFormsAgreeWithQuadrature) {
  const double lambda = 0.05;
  const ClockParameters torque{2.0, 2.5e-4, 2e-5, 0.03};
  const auto by_form = drive_moments(torque, lambda);
  const ForceLaw law = [](double phi, double w) {
    return (w > 0 ? phi < 0.03 : phi < -0.03) ? 2e-5 : -2e-5;
  };
  const auto by_sum = drive_moments(law, lambda, {0.03, -0.03});
  EXPECT_NEAR(by_form.a, by_sum.a, 1e-17); // 1e-12 of mu
  EXPECT_NEAR(by_form.b, by_sum.b, 1e-17); // likewise

  ClockParameters profile;
  profile.escapement = Escapement::profile;
  profile.rising.points = {{-0.02, 0.0}, {0.01, 3e-5}, {0.04, 1e-5}, {0.2, -2e-5}};
  profile.falling.points = {{-0.08, -1e-5}, {0.03, -4e-5}};
  const auto between = [](const TorqueTable& table, double phi) {
    for (std::size_t i = 1; i < table.points.size(); ++i) {
      const auto &p = table.points[i - 1], &q = table.points[i];
      if (phi >= p.angle && phi <= q.angle)
        return p.torque + (q.torque - p.torque) * (phi - p.angle) / (q.angle - p.angle);
    }
    return 0.0;
  };
  const ForceLaw tables = [&](double phi, double w) {
    return between(w > 0 ? profile.rising : profile.falling, phi);
  };
  const auto exact = drive_moments(profile, lambda);
  const auto sum = drive_moments(tables, lambda, {-0.02, 0.01, 0.03, 0.04});
  EXPECT_NEAR(exact.a, sum.a, 1e-17); // likewise
  EXPECT_NEAR(exact.b, sum.b, 1e-17); // likewise
}

TEST(MomentsTest, ASingleImpulseIsTheLimitOfANarrowTorque) {
  ClockParameters impulse;
  impulse.escapement = Escapement::single_impulse;
  impulse.impulse = 1e-6;
  impulse.impulse_angle = -0.02;
  ClockParameters narrow;
  narrow.escapement = Escapement::profile;
  const double width = 1e-5;
  narrow.rising.points = {{-0.02 - width, 0.0}, {-0.02, 1e-6 / width}, {-0.02 + width, 0.0}};
  const auto sharp = drive_moments(impulse, 0.05), blunt = drive_moments(narrow, 0.05);
  EXPECT_NEAR(blunt.a / sharp.a, 1.0, 1e-7); // the width over the amplitude, squared
  EXPECT_NEAR(blunt.b / sharp.b, 1.0, 1e-7); // likewise, 4e-8
}

TEST(MomentsTest, FrictionIsThePeriodAverageOfItsForce) {
  ClockParameters clock;
  clock.epsilon = 1e-3;
  clock.quadratic_drag = 0.02;
  clock.dry_friction = 1e-5;
  const double lambda = 0.07;
  const ForceLaw opposing = [&](double, double w) {
    return -(2 * clock.epsilon * w + clock.quadratic_drag * std::abs(w) * w +
             clock.dry_friction * (w > 0 ? 1 : -1));
  };
  const auto moments = drive_moments(opposing, lambda);
  // The quadrature: 1e-12 of the force, 1.4e-4.
  EXPECT_NEAR(-moments.a, friction_moment(clock, lambda), 1e-16);
  EXPECT_NEAR(moments.b, 0.0, 1e-16); // no first-order shift of the phase
}

TEST(MomentsTest, CircularErrorInFull) {
  for (const double x : {1e-3, 0.05, 0.5, 0.999, 1.001, 2.0, 3.0}) {
    const double bessel = boost::math::cyl_bessel_j(1, x) / x - 0.5;
    EXPECT_NEAR(circular_error(x), bessel, 3e-16) << x; // cancellation of the formula as written
  }
  const double small = 1e-3; // eq. ce3: -lambda^2/16 + lambda^4/384
  EXPECT_NEAR(circular_error(small) / (-small * small / 16 + std::pow(small, 4) / 384), 1.0, 1e-13);
}

} // namespace
} // namespace goingrate
