// Folds the rows of a least-squares problem into a triangle as they come. Private to the fit room.
#pragma once

#include <Eigen/Core>

namespace goingrate::timing_model {

/// Takes rows (J, r) of n + 1 numbers and keeps R and Q'r of all of them: Householder steps on
/// blocks of rows under the triangle so far (RowStackTest.EqualsTheFactorOfAllRowsAtOnce).
class RowStack {
public:
  explicit RowStack(Eigen::Index unknowns)
      : n_(unknowns), triangle_(Eigen::MatrixXd::Zero(unknowns + 1, unknowns + 1)),
        rows_(Eigen::MatrixXd::Zero(block, unknowns + 1)) {}

  /// `derivative(k)` gives the k-th entry of J.
  template <class Derivative> void add(double value, Derivative&& derivative) {
    for (Eigen::Index k = 0; k < n_; ++k)
      rows_(used_, k) = derivative(k);
    rows_(used_, n_) = value;
    if (++used_ == block) fold();
  }
  /// Adds all rows of another stack.
  void add(RowStack& other);
  /// R, n x n.
  [[nodiscard]] Eigen::MatrixXd triangle() {
    fold();
    return triangle_.topLeftCorner(n_, n_);
  }
  /// Q'r, n.
  [[nodiscard]] Eigen::VectorXd projected() {
    fold();
    return triangle_.col(n_).head(n_);
  }

private:
  static constexpr Eigen::Index block = 256; // in the first cache with twenty unknowns

  void fold();

  Eigen::Index n_;
  Eigen::MatrixXd triangle_; // upper
  Eigen::MatrixXd rows_;     // those not folded in yet; zero beyond
  Eigen::Index used_ = 0;
};

} // namespace goingrate::timing_model
