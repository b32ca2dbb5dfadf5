// How well several sizes that cannot be negative are known together. Private to the fit room.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <vector>

namespace goingrate::timing_model {

/// Coordinates f of which the likelihood is a parabola: its fall of 2 log L at f is
/// (f - centre)' information (f - centre). Some of them cannot be below 0, and the top of the
/// parabola may lie where they are.
///
/// The interval of a sum h.f is the hull of two. One holds every value v at which that fall,
/// minimised over the allowed f with h.f = v, exceeds its minimum over all allowed f by less than
/// z^2: the likelihood-ratio interval (Rust and Burrus 1972), which covers as it says inside, and
/// less where the true f lie on bounds whose coordinates are strongly correlated. The other is that
/// of the parabola without bounds, h.centre +- z sigma, which covers as it says wherever they lie.
/// So the hull covers at z at least (RingDownTest.IntervalsOnTheBoundsCover).
class FrictionCone {
public:
  /// `bounded`: which coordinates cannot be below 0; at most three.
  FrictionCone(Eigen::VectorXd centre, Eigen::MatrixXd information, std::vector<bool> bounded);

  /// The likeliest of all allowed f.
  [[nodiscard]] const Eigen::VectorXd& likeliest() const { return likeliest_; }
  /// The likeliest with h.f = v.
  [[nodiscard]] Eigen::VectorXd likeliest_at(const Eigen::VectorXd& h, double v) const;
  /// Ends of the interval of h.f; infinite where nothing bounds it.
  [[nodiscard]] std::array<double, 2> interval(const Eigen::VectorXd& h, double z) const;

private:
  struct Place {
    Eigen::VectorXd f;
    double fall;
  };
  /// The lowest fall with h.f = v, or of all if there is no h; infinite where no f is allowed.
  [[nodiscard]] Place lowest(const Eigen::VectorXd* h, double v) const;

  Eigen::VectorXd centre_;
  Eigen::MatrixXd information_;
  std::vector<bool> bounded_;
  Eigen::VectorXd likeliest_;
  double least_ = 0.0; // the fall there
};

} // namespace goingrate::timing_model
