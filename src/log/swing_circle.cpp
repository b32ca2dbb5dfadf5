#include "swing_circle.hpp"

#include <Eigen/Dense>
#include <cmath>

namespace goingrate {

namespace {

using Places = Eigen::ArrayXd;

// The circle of least algebraic distance, x^2 + y^2 = 2 a x + 2 b y + c: too small if the arc is
// short and noisy, but a good start.
Eigen::Vector3d first_circle(const Places& x, const Places& y) {
  Eigen::MatrixXd design(x.size(), 3);
  design << 2.0 * x.matrix(), 2.0 * y.matrix(), Eigen::VectorXd::Ones(x.size());
  const Eigen::Vector3d found =
      design.colPivHouseholderQr().solve((x.square() + y.square()).matrix());
  const double radius2 = found[2] + found[0] * found[0] + found[1] * found[1];
  return {found[0], found[1], std::sqrt(std::max(radius2, 0.0))};
}

} // namespace

double SwingCircle::angle_of(double place_x, double place_y) const {
  return std::atan2(place_x - x, hangs_below ? y - place_y : place_y - y);
}

std::optional<SwingCircle> circle_through(std::span<const double> x, std::span<const double> y) {
  constexpr std::size_t fewest_points = 10;
  if (x.size() < fewest_points) return {};
  const auto count = static_cast<Eigen::Index>(x.size());
  const Places given_x = Eigen::Map<const Places>(x.data(), count);
  const Places given_y = Eigen::Map<const Places>(y.data(), count);
  // About the middle and in units of the arc, so that the numbers are of the order of one.
  const double mean_x = given_x.mean(), mean_y = given_y.mean();
  const double scale =
      std::sqrt(((given_x - mean_x).square() + (given_y - mean_y).square()).mean());
  if (!(scale > 0.0)) return {};
  const Places px = (given_x - mean_x) / scale, py = (given_y - mean_y) / scale;
  Eigen::Vector3d circle = first_circle(px, py);
  Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();
  double variance = 0.0;
  constexpr int rounds = 50; // of Gauss and Newton; a few are enough
  for (int round = 0; round < rounds; ++round) {
    const Places dx = px - circle[0], dy = py - circle[1];
    const Places distance = (dx.square() + dy.square()).sqrt();
    Eigen::MatrixXd slope(count, 3);
    slope << (dx / distance).matrix(), (dy / distance).matrix(), Eigen::VectorXd::Ones(count);
    const Eigen::VectorXd off = (distance - circle[2]).matrix();
    inverse = (slope.transpose() * slope).inverse();
    const Eigen::Vector3d step = inverse * (slope.transpose() * off);
    variance = off.squaredNorm() / static_cast<double>(count - 3);
    if (!step.allFinite()) return {};
    circle += step;
    if (step.norm() < 1e-12 * circle.norm()) break; // rounding
  }
  SwingCircle found{mean_x + scale * circle[0], mean_y + scale * circle[1], scale * circle[2],
                    scale * std::sqrt(variance * inverse(2, 2))};
  found.hangs_below = found.y > mean_y;
  constexpr double radius_error = 0.2; // of the radius
  if (!(found.radius > 0.0) || !(found.radius_sigma < radius_error * found.radius)) return {};
  return found;
}

} // namespace goingrate
