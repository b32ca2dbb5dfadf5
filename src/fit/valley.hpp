// Search coordinates that straighten the valley of the likelihood. Private to the fit room.
//
// A log determines a few quantities far better than any parameter, which makes the likelihood a
// narrow, curved valley: the mean rate in each stretch between changes, how near to rest the clock
// starts, and the scatter of neighbouring periods. Searches and profiles therefore move in
// coordinates u, where
//   x_l = u_l + (log lambda_rest - its value at the start)   keeps the distance from rest,
//   x_a = u_a + h(x of the others)                           keeps the lateness at each stretch's
//   end, x_d = u_d - (log(T0 g) - its value at the start)         keeps the scatter due to the
//   drive.
// l is the logarithm of lambda0, and lambda_rest = sqrt(2 mu phi0/(pi eps)) the amplitude at rest
// before any change; a are as many of T0, phi0, mu, epsilon and their changes as there are
// stretches, those that move the ends most, with preference for phi0; d is the logarithm of the
// drive's rms, and g the fast gain. All other code sees only x.
#pragma once

#include "likelihood.hpp"

namespace goingrate::timing_model {

/// The map between u and x about a point.
class Valley {
public:
  /// `except`: a coordinate that must not follow the others, because it is held fixed.
  Valley(const FitProblem& problem, std::span<const double> start,
         std::optional<std::size_t> except = {});

  /// If h does not exist, x_a = u_a, and it is left to the model to reject that point.
  [[nodiscard]] std::vector<double> x_of(std::span<const double> u) const;
  [[nodiscard]] std::vector<double> u_of(std::span<const double> x) const;
  /// dx/du, n x n.
  [[nodiscard]] Eigen::MatrixXd slopes(std::span<const double> u) const;

private:
  // Chooses the coordinates a and the ends that they keep. `slopes` as from slopes_of_late().
  void choose_following(std::span<const double> start, std::optional<std::size_t> except,
                        const Eigen::MatrixXd& slopes);
  // Sets lambda0 to suit the other coordinates; `own` is u_l.
  void follow_start(std::vector<double>& x, double own) const;
  // The lateness at the end of each stretch; lambda0 follows. Empty if the model does not hold.
  [[nodiscard]] std::optional<Eigen::VectorXd> late(std::vector<double>& x, double own) const;
  // The change of the x_a, from their values at the start, that keeps the lateness, given the other
  // coordinates; lambda0 follows.
  [[nodiscard]] std::optional<Eigen::VectorXd> solved(std::vector<double> x, double own) const;
  // d late/d x, stretches by coordinates, with lambda0 following; 0 for noise, and where the model
  // does not hold.
  [[nodiscard]] Eigen::MatrixXd slopes_of_late(std::vector<double> x, double own) const;
  [[nodiscard]] double log_rest(std::span<const double> x) const;
  [[nodiscard]] double log_scatter(std::span<const double> x) const;
  template <class Function>
  [[nodiscard]] Eigen::RowVectorXd gradient(std::vector<double>& x, Function&& function) const;

  const Parameters& parameters_;
  TimingData ends_;                     // the first beat, and the last of each stretch
  std::optional<std::size_t> start_;    // l
  std::vector<Eigen::Index> stretches_; // whose lateness is kept
  std::vector<Eigen::Index> rates_;     // a, one for each of them
  std::optional<std::size_t> drive_;    // d
  double rest_ = 0.0;                   // log lambda_rest at the start
  Eigen::VectorXd reference_;           // x_a at the start
  Eigen::VectorXd late_;                // lateness at the start, s
  Eigen::MatrixXd way_;                 // d x_a/d late at the start, 1/s
  double scatter_ = 0.0;                // log(T0 g) at the start
};

} // namespace goingrate::timing_model
