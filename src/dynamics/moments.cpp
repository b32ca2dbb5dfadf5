#include "goingrate/dynamics/moments.hpp"

#include <algorithm>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <boost/math/special_functions/bessel.hpp>
#include <cmath>
#include <numbers>

namespace goingrate {

using std::numbers::pi;

namespace {

// int (m0 + m1 phi) over a stretch of a quarter-to-quarter swing, psi from -pi/2 to pi/2.
struct StretchIntegrals {
  double cosine = 0.0, sine = 0.0;
};

StretchIntegrals integrals_of(const TorqueTable& table, double lambda) {
  StretchIntegrals sum;
  for (std::size_t i = 1; i < table.points.size(); ++i) {
    const auto& [x0, m0] = table.points[i - 1];
    const auto& [x1, m1] = table.points[i];
    const double slope = (m1 - m0) / (x1 - x0), constant = m0 - slope * x0;
    const double from = std::clamp(x0, -lambda, lambda), to = std::clamp(x1, -lambda, lambda);
    if (!(to > from)) continue;
    const auto cosine_primitive = [&](double phi) { return (constant + 0.5 * slope * phi) * phi; };
    const auto sine_primitive = [&](double phi) {
      const double s = phi / lambda, c = std::sqrt(std::max(0.0, 1.0 - s * s));
      return -constant * c + 0.5 * slope * lambda * (std::asin(s) - s * c);
    };
    sum.cosine += (cosine_primitive(to) - cosine_primitive(from)) / lambda;
    sum.sine += sine_primitive(to) - sine_primitive(from);
  }
  return sum;
}

} // namespace

DriveMoments drive_moments(const ClockParameters& clock, double lambda) {
  switch (clock.escapement) {
  case Escapement::constant_torque: {
    if (!(clock.phi0 < lambda)) return {};
    const double s = clock.phi0 / lambda;
    return {2.0 * clock.mu * s / pi, -2.0 * clock.mu * std::sqrt(1.0 - s * s) / pi};
  }
  case Escapement::single_impulse: {
    const double s = clock.impulse_angle / lambda;
    if (!(std::abs(s) < 1.0)) return {};
    const double a = clock.impulse / (2.0 * pi * lambda);
    return {a, a * s / std::sqrt(1.0 - s * s)};
  }
  case Escapement::profile: {
    // While phi falls psi runs on from pi/2: cos psi changes its sign, sin psi does not.
    const auto rise = integrals_of(clock.rising, lambda),
               fall = integrals_of(clock.falling, lambda);
    return {(rise.cosine - fall.cosine) / (2.0 * pi), (rise.sine + fall.sine) / (2.0 * pi)};
  }
  case Escapement::none:
    break;
  }
  return {};
}

double friction_moment(const ClockParameters& clock, double lambda) {
  return clock.epsilon * lambda + 4.0 / (3.0 * pi) * clock.quadratic_drag * lambda * lambda +
         2.0 / pi * clock.dry_friction;
}

double circular_error(double lambda) {
  if (std::abs(lambda) > 1.0) return boost::math::cyl_bessel_j(1, lambda) / lambda - 0.5;
  // J1(x)/x - 1/2 = sum over k >= 1 of (-x^2/4)^k / (2 k! (k+1)!): no cancellation at small x.
  const double q = -0.25 * lambda * lambda;
  double term = 0.5, sum = 0.0;
  for (int k = 1; std::abs(term) > 1e-17 * std::abs(sum); ++k) {
    term *= q / (k * (k + 1));
    sum += term;
  }
  return sum;
}

DriveMoments drive_moments(const ForceLaw& torque, double lambda,
                           const std::vector<double>& jumps) {
  std::vector<double> edges{-0.5 * pi, 0.5 * pi, 1.5 * pi};
  for (const double angle : jumps) {
    if (!(std::abs(angle) < lambda)) continue;
    const double psi = std::asin(angle / lambda);
    edges.insert(edges.end(), {psi, pi - psi});
  }
  std::sort(edges.begin(), edges.end());
  DriveMoments moments;
  using Quadrature = boost::math::quadrature::gauss_kronrod<double, 31>;
  const auto over = [&](double from, double to, auto weight) {
    const auto integrand = [&](double psi) {
      return torque(lambda * std::sin(psi), lambda * std::cos(psi)) * weight(psi);
    };
    return Quadrature::integrate(integrand, from, to, 10, 1e-13) / (2.0 * pi);
  };
  for (std::size_t i = 1; i < edges.size(); ++i) {
    if (edges[i] == edges[i - 1]) continue;
    moments.a += over(edges[i - 1], edges[i], [](double psi) { return std::cos(psi); });
    moments.b += over(edges[i - 1], edges[i], [](double psi) { return std::sin(psi); });
  }
  return moments;
}

} // namespace goingrate
