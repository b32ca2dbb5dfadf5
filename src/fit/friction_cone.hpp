// Intervals for sums of sizes that cannot be negative. Private to the fit room.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <vector>

namespace goingrate::timing_model {

/// Coordinates f in which the logarithm of the likelihood is a parabola: 2 log L falls by
/// (f - centre)' information (f - centre). Some of them cannot be below 0, but the top of the
/// parabola may be there.
///
/// The interval of a sum h.f holds every value v at which that fall, minimised over the allowed f
/// with h.f = v, exceeds its minimum over all allowed f by less than reach^2: the likelihood-ratio
/// interval (Rust and Burrus 1972). If the true f lie on bounds, the ratio does not have the
/// distribution for one degree of freedom: with strongly correlated sizes, reach = z covers 57 %
/// instead of 68 %. So reach is the value that the ratio exceeds by chance as often as z implies,
/// in draws about the likeliest f, or about one of the bounded coordinates alone if the log allows
/// that: the greatest of these (RingDownTest.IntervalsOnTheBoundsCover).
class FrictionCone {
public:
  /// `bounded`: which coordinates cannot be below 0; at most three.
  FrictionCone(Eigen::VectorXd centre, Eigen::MatrixXd information, std::vector<bool> bounded);

  /// The likeliest f of all that are allowed.
  [[nodiscard]] const Eigen::VectorXd& likeliest() const { return likeliest_; }
  /// The likeliest f with h.f = v.
  [[nodiscard]] Eigen::VectorXd likeliest_at(const Eigen::VectorXd& h, double v) const;
  /// The square root of the fall that the ratio exceeds by chance as often as z implies; at least
  /// z.
  [[nodiscard]] double reach(const Eigen::VectorXd& h, double z) const;
  /// Ends of the interval of h.f; infinite where nothing bounds it.
  [[nodiscard]] std::array<double, 2> interval(const Eigen::VectorXd& h, double z) const;

private:
  [[nodiscard]] FrictionCone of_bounded() const;
  /// The reach if f were the truth.
  [[nodiscard]] double reach_about(const Eigen::VectorXd& f, const Eigen::VectorXd& h,
                                   double z) const;
  struct Place {
    Eigen::VectorXd f;
    double fall;
  };
  /// The lowest fall with h.f = v, or without a condition if there is no h; infinite if no f is
  /// allowed.
  [[nodiscard]] Place lowest(const Eigen::VectorXd* h, double v) const;

  Eigen::VectorXd centre_;
  Eigen::MatrixXd information_;
  std::vector<bool> bounded_;
  Eigen::VectorXd likeliest_;
  double least_ = 0.0; // the fall there
};

} // namespace goingrate::timing_model
