// A log under jitter alone, by a few beats that say as much. Private to the fit room.
//
// Between events the model's lateness m is a smooth function of the beat's number: over a block of
// beats it is the polynomial through its values at a few of them, the nodes. With P (beats by
// nodes) holding Lagrange's polynomials and P = Q R,
//   sum over beats (d - m)^2 = |d - P d^|^2 + sum over blocks |R (d^ - m at the nodes)|^2,
// where d^ = R^-1 Q' d. The first term does not depend on the model. Nothing is lost but what the
// polynomial misses: blocks of 0.7 relaxation times and twelve Chebyshev nodes leave 1e-10 of the
// transient. `model_fit` compares with all beats before it believes it.
#pragma once

#include "parameters.hpp"

#include "goingrate/fit/timing_data.hpp"

#include <Eigen/Dense>
#include <memory>
#include <span>
#include <vector>

namespace goingrate::timing_model {

inline constexpr int nodes_a_block = 12; ///< of a condensed log

class CondensedLog {
public:
  /// `relaxation_cycles`: in which the squared amplitude comes nearer to rest by a factor e.
  /// Nothing if the log is too short for it to pay, or too full of gaps.
  static std::shared_ptr<const CondensedLog>
  of(const TimingData& data, const std::vector<double>& event_cycles, double relaxation_cycles);

  /// The nodes, with d^ as their lateness.
  [[nodiscard]] const TimingData& nodes() const { return nodes_; }
  [[nodiscard]] double beats() const { return static_cast<double>(beats_); }
  /// |d - P d^|^2, s^2.
  [[nodiscard]] double rest_s2() const { return rest_s2_; }

  /// R times each column, less the mean over all beats: its squared norm is that of the column
  /// spread over all beats, about its mean. `at_nodes`: nodes by columns.
  [[nodiscard]] Eigen::MatrixXd weighted(const Eigen::MatrixXd& at_nodes) const;
  /// P times values at the nodes: one for each beat.
  [[nodiscard]] std::vector<double> spread(const std::vector<double>& at_nodes) const;

private:
  using Triangle = Eigen::Matrix<double, nodes_a_block, nodes_a_block>;
  // Lagrange's polynomials on the beats of a block; blocks without gaps and of one length share it.
  struct Pattern {
    std::vector<double> cycle;                // of the beats, less the first
    std::vector<std::size_t> nodes;           // places of the nodes among them
    Triangle triangle = Triangle::Zero();     // R
    bool swings = false;                      // so much that the nodes are of no use
    Eigen::HouseholderQR<Eigen::MatrixXd> qr; // of P; of the last few only, for it is long
  };
  struct Block {
    std::size_t first, beats;
    std::size_t pattern;
  };

  // Takes the beats [first, end) as one block; false if the polynomials would swing.
  bool add_block(const TimingData& data, std::size_t first, std::size_t end);
  // The place of the pattern of these beats in patterns_, where it may be new.
  std::size_t pattern_of(std::span<const double> cycle);
  [[nodiscard]] Eigen::MatrixXd weighted_plainly(const Eigen::MatrixXd& at_nodes) const;

  TimingData nodes_;
  std::size_t beats_ = 0;
  std::vector<Pattern> patterns_;
  std::vector<Block> blocks_;
  Eigen::VectorXd constant_; // weighted ones
  double rest_s2_ = 0.0;
};

} // namespace goingrate::timing_model
