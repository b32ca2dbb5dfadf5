#include "goingrate/clock/restoring.hpp"

#include "goingrate/base/errors.hpp"

#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/quadrature/trapezoidal.hpp>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <limits>
#include <numbers>

namespace goingrate {

using std::numbers::pi;

namespace {

// sin x / x.
double sinc(double x) { return std::abs(x) < 1e-8 ? 1.0 : std::sin(x) / x; }

} // namespace

double top_angle(double gravity_share) {
  constexpr double least_sinc = -0.21723362821122166; // sin x/x at its lowest,
  constexpr double lowest_at = 4.493409457909064;     // here: tan x = x
  constexpr double two_turns = 4.0 * pi;
  if (gravity_share == 1.0) return pi;
  const auto pull = [&](double x) { return 1.0 - gravity_share + gravity_share * sinc(x); };
  if (gravity_share < 1.0 && 1.0 - gravity_share + gravity_share * least_sinc > 0.0)
    return two_turns;
  std::uintmax_t rounds = 100;
  const auto [low, high] = boost::math::tools::bisect(
      pull, gravity_share > 1.0 ? 0.1 : pi, gravity_share > 1.0 ? pi : lowest_at,
      boost::math::tools::eps_tolerance<double>(50), rounds);
  return 0.5 * (low + high);
}

double velocity_of_turning_angle(double gravity_share, double angle) {
  const double sine = 2.0 * std::sin(0.5 * angle);
  return std::sqrt((1.0 - gravity_share) * angle * angle + gravity_share * sine * sine);
}

double turning_angle_of_velocity(double gravity_share, double velocity) {
  if (gravity_share == 1.0) return 2.0 * std::asin(0.5 * velocity);
  if (velocity == 0.0) return 0.0;
  if (!(velocity <= top_velocity(gravity_share))) return std::numeric_limits<double>::quiet_NaN();
  // Newton on v(A), kept between 0 and the top; v is concave or nearly straight, so it closes in at
  // once.
  double low = 0.0, high = top_angle(gravity_share), angle = std::fmin(velocity, 0.9 * high);
  for (int i = 0; i < 100; ++i) {
    const double reached = velocity_of_turning_angle(gravity_share, angle);
    (reached > velocity ? high : low) = angle;
    const double slope =
        ((1.0 - gravity_share) * angle + gravity_share * std::sin(angle)) / reached;
    const double next = angle - (reached - velocity) / slope;
    const double before = angle;
    angle = next > low && next < high ? next : 0.5 * (low + high);
    if (std::abs(angle - before) <= std::numeric_limits<double>::epsilon() * angle) break;
  }
  return angle;
}

double top_velocity(double gravity_share) {
  return velocity_of_turning_angle(gravity_share, top_angle(gravity_share));
}

void check_velocity(const ClockParameters& clock, double velocity, std::string_view name) {
  const double top = top_velocity(clock.gravity_share);
  if (velocity > 0.0 && velocity < top) return;
  if (clock.gravity_share == 1.0)
    throw ArgumentError(name, velocity, "above 0 and below 2 (at 2 the pendulum turns over)");
  throw ArgumentError(name, velocity,
                      fmt::format("above 0 and below {:.4g} (with that it {})", top,
                                  top_angle(clock.gravity_share) > 1.5 * pi
                                      ? "would swing out by two turns"
                                      : "reaches the angle at which nothing pulls it back"));
}

namespace {

// (speed at angle sin u)^2 / (angle cos u)^2 of the free pendulum that turns at `angle`: cos x -
// cos A = 2 sin((A + x)/2) sin((A - x)/2), so that no digits are lost where x is near A.
double stiffness_at(double gravity_share, double angle, double u) {
  const double x = angle * std::sin(u);
  return 1.0 - gravity_share + gravity_share * sinc(0.5 * (angle + x)) * sinc(0.5 * (angle - x));
}

} // namespace

double free_period_ratio(double gravity_share, double angle) {
  if (!(angle > 0.0 && angle < top_angle(gravity_share)))
    throw ArgumentError("amplitude", angle,
                        fmt::format("above 0 and below {:.4g} rad", top_angle(gravity_share)));
  // The integrand is periodic and analytic: the trapezoidal rule converges exponentially.
  const auto integrand = [&](double u) {
    return 1.0 / std::sqrt(stiffness_at(gravity_share, angle, u));
  };
  return boost::math::quadrature::trapezoidal(integrand, -0.5 * pi, 0.5 * pi, 1e-14, 20) / pi;
}

double free_passage_time(double gravity_share, double angle, double half) {
  if (!(angle < top_angle(gravity_share))) return std::numeric_limits<double>::quiet_NaN();
  const auto integrand = [&](double u) {
    return 1.0 / std::sqrt(stiffness_at(gravity_share, angle, u));
  };
  using Quadrature = boost::math::quadrature::gauss<double, 30>;
  return 2.0 * Quadrature::integrate(integrand, 0.0, std::asin(half / angle));
}

} // namespace goingrate
