// A log under jitter alone, by a few beats that say as much. Private to the fit room.
//
// Between events the model's lateness m is a smooth function of the beat's number: over a block of
// beats it is the polynomial through its values at a few of them, the nodes. With P (beats by
// nodes) holding Lagrange's polynomials and P = Q R,
//   sum over beats (d - m)^2 = |d - P d^|^2 + sum over blocks |R (d^ - m at the nodes)|^2,
// where d^ = R^-1 Q' d. The first term does not depend on the model. Nothing is lost but what the
// polynomial misses: blocks of half a relaxation time and twelve Chebyshev nodes leave 1e-12 of the
// transient. `model_fit` compares with all beats before it believes it.
#pragma once

#include "parameters.hpp"

#include "goingrate/fit/timing_data.hpp"

#include <Eigen/Dense>
#include <memory>

namespace goingrate::timing_model {

class CondensedLog {
public:
  /// `relaxation_cycles`: in which the squared amplitude comes nearer to rest by a factor e.
  /// Nothing if the log is too short beside it to gain, or too full of gaps.
  static std::shared_ptr<const CondensedLog>
  of(const TimingData& data, const std::vector<double>& event_cycles, double relaxation_cycles);

  /// The nodes, with d^ as their lateness.
  [[nodiscard]] const TimingData& nodes() const { return nodes_; }
  [[nodiscard]] double beats() const { return static_cast<double>(beat_cycle_.size()); }
  /// |d - P d^|^2, s^2.
  [[nodiscard]] double rest_s2() const { return rest_s2_; }

  /// R times each column, less the mean over all beats: its squared norm is that of the column
  /// spread over all beats, about its mean. `at_nodes`: nodes by columns.
  [[nodiscard]] Eigen::MatrixXd weighted(const Eigen::MatrixXd& at_nodes) const;
  /// P times values at the nodes: one for each beat.
  [[nodiscard]] std::vector<double> spread(const std::vector<double>& at_nodes) const;

private:
  struct Block {
    std::size_t first, beats;
    Eigen::MatrixXd triangle; // R
  };

  // Takes the beats [first, end) as one block; false if the polynomials would swing.
  bool add_block(const TimingData& data, std::size_t first, std::size_t end);
  [[nodiscard]] Eigen::MatrixXd lagrange(const Block& block, std::size_t first_node) const;
  [[nodiscard]] Eigen::MatrixXd weighted_plainly(const Eigen::MatrixXd& at_nodes) const;

  TimingData nodes_;
  std::vector<double> beat_cycle_;
  std::vector<Block> blocks_;
  Eigen::VectorXd constant_; // weighted ones
  double rest_s2_ = 0.0;
};

} // namespace goingrate::timing_model
