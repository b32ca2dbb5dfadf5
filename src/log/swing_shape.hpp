// The shape of a swing about its passage through the middle, which is fitted to samples of an
// angle.
#pragma once

#include "log/angle_samples.hpp"

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

namespace goingrate {

/// The part of a pendulum's swing of turning angle A that a sine leaves out,
///   phi = 8 sum_n q^(n + 1/2) / ((2 n + 1) (1 + q^(2 n + 1))) sin((2 n + 1) theta),
/// q the nome of the modulus sin(A/2) (NIST DLMF 22.11 with phi = 2 asin(k sn)).
class Overtones {
public:
  explicit Overtones(double amplitude) {
    if (!(amplitude > 0.0 && amplitude < std::numbers::pi)) return; // no swing
    const double root = std::sqrt(std::cos(0.5 * amplitude));       // of the complementary modulus
    const double e = 0.5 * (1.0 - root) / (1.0 + root);
    const double nome = e + 2.0 * std::pow(e, 5) + 15.0 * std::pow(e, 9);
    double power = std::sqrt(nome);
    for (std::size_t n = 0; n < size_.size(); ++n, power *= nome) {
      const double order = 2.0 * static_cast<double>(n) + 1.0;
      size_[n] = 8.0 * power / (order * (1.0 + std::pow(nome, order)));
    }
    size_[0] -= amplitude;
  }
  [[nodiscard]] double at(double theta) const {
    double sum = 0.0;
    for (std::size_t n = 0; n < size_.size(); ++n)
      sum += size_[n] * std::sin((2.0 * static_cast<double>(n) + 1.0) * theta);
    return sum;
  }

private:
  std::array<double, 4> size_{}; // what is left out is 1e-8 rad at 1 rad, 1e-5 at 2
};

/// What friction in proportion to the square of the speed takes from a sine at a phase u after its
/// zero, beyond what linear friction takes that makes it decay as fast; in units of the decay over
/// a radian. Before and after the zero x'' + x = -k x'^2 with x = A sin u has the part
///   k A^2 (cos 2u/6 + cos u/3 - 1/2),   decay 4 k A/(3 pi),
/// where x'' + x = -2 eps x' has -eps A u sin u, decay eps.
inline double square_law_beyond_linear(double u) {
  const double square = std::cos(2.0 * u) / 6.0 + std::cos(u) / 3.0 - 0.5;
  return u * std::sin(u) + 0.75 * std::numbers::pi * square;
}

/// A swing about its passage through the middle, size * sine + middle, with a given shape.
struct SwingShape {
  double w = 0.0, decay = 0.0; // rad/s; of its size, 1/s
  double side = 1.0;           // 1 where it rises, or -1
  double quickening = 0.0;     // of w, rad/s^2: a smaller swing is faster
  double square_share = 0.0;   // of the decay, by friction that grows as the square of the speed
  double amplitude = 0.0;      // where that is known
  Overtones overtones{0.0};
  double root_s = 0.0; // where they are zero

  [[nodiscard]] double size(double t) const { return std::exp(-decay * t); }
  [[nodiscard]] double phase(double t) const { return (w + 0.5 * quickening * t) * t; }
  [[nodiscard]] Eigen::Vector3d row(double t) const {
    return {size(t) * std::cos(phase(t)), size(t) * std::sin(phase(t)), 1.0};
  }
  [[nodiscard]] double beside_the_sine(double t) const {
    const double u = w * (t - root_s);
    // The largest overtone goes with the third power of the size.
    return side * (std::pow(size(t), 3) * overtones.at(u) +
                   square_share * amplitude * decay / w * square_law_beyond_linear(u));
  }
  // Where the swing is at 0: near the zero of its sine, unless its middle is far from there.
  [[nodiscard]] double zero_of(const Eigen::Vector3d& terms, double from) const {
    const double slope = side * std::hypot(terms[0], terms[1]) * w;
    constexpr int steps = 8; // each takes the error down by middle/amplitude or better
    for (int step = 0; step < steps; ++step)
      from -= (terms.dot(row(from)) + beside_the_sine(from)) / slope;
    return from;
  }
};

/// The sums of a least-squares fit of a shape to samples, with times from `centre` and angles from
/// `zero`.
struct SwingSums {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  double sum2 = 0.0; // of the values

  SwingSums(std::span<const AngleSample> samples, const SwingShape& shape, const Instant& centre,
            double zero) {
    for (const AngleSample& sample : samples) {
      const double t = sample.time - centre;
      const Eigen::Vector3d row = shape.row(t);
      const double value = sample.angle - zero - shape.beside_the_sine(t);
      normal += row * row.transpose();
      moment += row * value;
      sum2 += value * value;
    }
  }

  // The covariance for errors of size 1, if only the first terms are free.
  [[nodiscard]] Eigen::Matrix3d inverse(Eigen::Index terms) const {
    Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();
    inverse.topLeftCorner(terms, terms) = normal.topLeftCorner(terms, terms).inverse();
    return inverse;
  }
};

} // namespace goingrate
