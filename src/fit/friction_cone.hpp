// How well several sizes that cannot be negative are known together. Private to the fit room.
#pragma once

#include <Eigen/Dense>
#include <array>

namespace goingrate::timing_model {

/// Sizes f >= 0 of which the likelihood is a parabola: its fall of 2 log L at f is
/// (f - centre)' information (f - centre), whose top may lie outside.
///
/// The interval of a sum h.f, with no entry of h below 0, holds every value v at which that fall,
/// minimised over f >= 0 with h.f = v, exceeds its minimum over f >= 0 by less than z^2: the
/// likelihood-ratio interval. It covers at z whether the true f lie on the bounds or inside (Rust
/// and Burrus 1972; RingDownTest.IntervalsOnTheBoundsCover).
class FrictionCone {
public:
  FrictionCone(Eigen::VectorXd centre, Eigen::MatrixXd information);

  /// The likeliest f >= 0.
  [[nodiscard]] const Eigen::VectorXd& likeliest() const { return likeliest_; }
  /// Ends of the interval of h.f; the high end is infinite where nothing bounds it.
  [[nodiscard]] std::array<double, 2> interval(const Eigen::VectorXd& h, double z) const;

private:
  /// The fall at h.f = v.
  [[nodiscard]] double fall(const Eigen::VectorXd& h, double v) const;

  Eigen::VectorXd centre_;
  Eigen::MatrixXd information_;
  Eigen::VectorXd likeliest_;
  double least_ = 0.0; // the fall there
};

} // namespace goingrate::timing_model
