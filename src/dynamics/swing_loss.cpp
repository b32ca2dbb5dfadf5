#include "goingrate/dynamics/swing_loss.hpp"

#include "goingrate/base/errors.hpp"

#include <boost/math/special_functions/bessel.hpp>
#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/math/special_functions/ellint_d.hpp>
#include <cmath>
#include <numbers>

namespace goingrate {

namespace {

using std::numbers::pi;

double modulus_of(double amplitude_rad) {
  if (!(amplitude_rad > 0.0 && amplitude_rad < pi))
    throw ArgumentError("amplitude", amplitude_rad, "above 0 and below pi rad");
  return std::sin(0.5 * amplitude_rad);
}

} // namespace

std::array<double, 3> inverse_q_per_friction(double amplitude_rad) {
  const double k = modulus_of(amplitude_rad), k2 = k * k;
  // Without loss of digits at small swings: E - (1 - k^2) K = k^2 (K - D), D = (K - E)/k^2, and
  // sin A - A cos A = A^2 j1(A).
  const double linear = boost::math::ellint_1(k) - boost::math::ellint_d(k);
  const double quadratic =
      amplitude_rad * amplitude_rad * boost::math::sph_bessel(1, amplitude_rad);
  return {8.0 / pi * linear, 2.0 / pi * quadratic / k2, amplitude_rad / (pi * k2)};
}

double quality_factor(const Friction& friction, double amplitude_rad) {
  const auto [linear, quadratic, dry] = inverse_q_per_friction(amplitude_rad);
  return 1.0 / (linear * friction.epsilon + quadratic * friction.quadratic + dry * friction.dry);
}

double decay_periods_per_q(double amplitude_rad) {
  const double k = modulus_of(amplitude_rad);
  return amplitude_rad * std::sin(amplitude_rad) * boost::math::ellint_1(k) /
         (2.0 * pi * pi * k * k);
}

double circular_period_ratio(double amplitude_rad) {
  return boost::math::ellint_1(modulus_of(amplitude_rad)) / (0.5 * pi);
}

} // namespace goingrate
