// Condenses a log with no noise but jitter to a few beats that hold the same information. Private
// to the fit room.
//
// Between events the model's lateness m is a smooth function of the beat's number: over a block of
// beats it is the polynomial through its values at a few of them, the nodes. With P (beats by
// nodes) holding Lagrange's polynomials and P = Q R,
//   sum over beats (d - m)^2 = |d - P d^|^2 + sum over blocks |R (d^ - m at the nodes)|^2,
// where d^ = R^-1 Q' d. The first term does not depend on the model. The only loss is the error of
// the polynomial: with blocks of 0.7 relaxation times and twelve Chebyshev nodes, 1e-10 of the
// transient. `model_fit` compares the result with all beats before it accepts it.
#pragma once

#include "parameters.hpp"

#include "goingrate/fit/timing_data.hpp"

#include <Eigen/Dense>
#include <memory>
#include <span>
#include <vector>

namespace goingrate::timing_model {

inline constexpr int nodes_a_block = 12; ///< nodes per block of a condensed log

class CondensedLog {
public:
  /// `relaxation_cycles`: the time in which the squared amplitude approaches its rest value by a
  /// factor e. Null if the log is too short for condensing to pay, or has too many gaps.
  static std::shared_ptr<const CondensedLog>
  of(const TimingData& data, const std::vector<double>& event_cycles, double relaxation_cycles);

  /// The nodes, with d^ as their lateness.
  [[nodiscard]] const TimingData& nodes() const { return nodes_; }
  [[nodiscard]] double beats() const { return static_cast<double>(beats_); }
  /// |d - P d^|^2, s^2.
  [[nodiscard]] double rest_s2() const { return rest_s2_; }

  /// R times each column, minus the mean over all beats. Its squared norm is that of the column,
  /// interpolated to all beats, about its mean. `at_nodes`: nodes by columns.
  [[nodiscard]] Eigen::MatrixXd weighted(const Eigen::MatrixXd& at_nodes) const;
  /// P times values at the nodes: one for each beat.
  [[nodiscard]] std::vector<double> spread(const std::vector<double>& at_nodes) const;

private:
  using Triangle = Eigen::Matrix<double, nodes_a_block, nodes_a_block>;
  // Lagrange's polynomials on the beats of a block; blocks without gaps and of one length share it.
  struct Pattern {
    std::vector<double> cycle;                // of the beats, minus the first
    std::vector<std::size_t> nodes;           // places of the nodes among them
    Triangle triangle = Triangle::Zero();     // R
    bool swings = false;                      // the polynomials swing too much to be of use
    Eigen::HouseholderQR<Eigen::MatrixXd> qr; // of P; kept for the last few only, as it is large
  };
  struct Block {
    std::size_t first, beats;
    std::size_t pattern;
  };

  // Takes the beats [first, end) as one block; false if the polynomials would swing too much.
  bool add_block(const TimingData& data, std::size_t first, std::size_t end);
  // The index in patterns_ of the pattern of these beats, which is added if it is new.
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
