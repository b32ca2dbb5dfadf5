// Rows of a least-squares problem, folded into a triangle as they come. Private to the fit room.
#pragma once

#include <Eigen/Dense>
#include <algorithm>

namespace goingrate::timing_model {

/// Takes rows (J, r) of n + 1 numbers and keeps R and Q'r of all of them: Householder steps on
/// blocks of rows under the triangle so far.
class RowStack {
public:
  explicit RowStack(Eigen::Index unknowns)
      : n_(unknowns), rows_(Eigen::MatrixXd::Zero(block + unknowns + 1, unknowns + 1)),
        used_(unknowns + 1) {}

  /// `derivative(k)` gives the k-th entry of J.
  template <class Derivative> void add(double value, Derivative&& derivative) {
    for (Eigen::Index k = 0; k < n_; ++k)
      rows_(used_, k) = derivative(k);
    rows_(used_, n_) = value;
    if (++used_ == rows_.rows()) fold();
  }
  /// R, n x n.
  [[nodiscard]] Eigen::MatrixXd triangle() {
    fold();
    return rows_.topLeftCorner(n_, n_);
  }
  /// Q'r, n.
  [[nodiscard]] Eigen::VectorXd projected() {
    fold();
    return rows_.col(n_).head(n_);
  }

private:
  static constexpr Eigen::Index block = 256; // in the first cache with twenty unknowns

  void fold() {
    if (used_ == n_ + 1) return;
    auto filled = rows_.topRows(used_);
    const Eigen::HouseholderQR<Eigen::Ref<Eigen::MatrixXd>> qr(filled);
    for (Eigen::Index k = 0; k <= n_; ++k) // what is below the diagonal are the reflectors
      rows_.col(k).tail(rows_.rows() - k - 1).setZero();
    used_ = n_ + 1;
  }

  Eigen::Index n_;
  Eigen::MatrixXd rows_; // the triangle first
  Eigen::Index used_;
};

} // namespace goingrate::timing_model
