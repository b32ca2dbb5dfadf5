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
/// The interval of a sum h.f holds every value v at which that fall, minimised over the allowed f
/// with h.f = v, exceeds its minimum over all allowed f by less than reach^2: the likelihood-ratio
/// interval (Rust and Burrus 1972). Where the true f lie on bounds the ratio is not that of one
/// degree of freedom: with sizes that are strongly correlated reach = z covers 57 % for 68 %. So
/// reach is what the ratio reaches by chance as often as z says, in draws about the likeliest f, or
/// about one of the bounded coordinates alone if the log allows that: the greatest of these
/// (RingDownTest.IntervalsOnTheBoundsCover).
class FrictionCone {
public:
  /// `bounded`: which coordinates cannot be below 0; at most three.
  FrictionCone(Eigen::VectorXd centre, Eigen::MatrixXd information, std::vector<bool> bounded);

  /// The likeliest of all allowed f.
  [[nodiscard]] const Eigen::VectorXd& likeliest() const { return likeliest_; }
  /// The likeliest with h.f = v.
  [[nodiscard]] Eigen::VectorXd likeliest_at(const Eigen::VectorXd& h, double v) const;
  /// The root of the ratio's fall that is not exceeded by chance as often as z says; z at least.
  [[nodiscard]] double reach(const Eigen::VectorXd& h, double z) const;
  /// Ends of the interval of h.f; infinite where nothing bounds it.
  [[nodiscard]] std::array<double, 2> interval(const Eigen::VectorXd& h, double z) const;

private:
  [[nodiscard]] FrictionCone of_bounded() const;
  /// The same if f were the truth.
  [[nodiscard]] double reach_about(const Eigen::VectorXd& f, const Eigen::VectorXd& h,
                                   double z) const;
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
