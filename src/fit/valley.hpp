// Search coordinates that straighten the valley of the likelihood. Private to the fit room.
//
// A log determines three quantities far better than any parameter, which makes the likelihood a
// narrow, curved valley: the mean rate, how near to rest the clock starts, and the scatter of
// neighbouring periods. Searches and profiles therefore move in coordinates u, where
//   x_l = u_l + (log lambda_rest - its value at the start)   keeps the distance from rest,
//   x_a = u_a + h(x of the others)                           keeps the lateness of the last beat,
//   x_d = u_d - (log(T0 g) - its value at the start)         keeps the scatter due to the drive.
// l is the logarithm of lambda0, and lambda_rest = sqrt(2 mu phi0/(pi eps)) the amplitude at rest
// before any change; a is the one of T0, phi0, mu, epsilon and their changes that moves the last
// beat most, with preference for phi0; d is the logarithm of the drive's rms, and g the fast gain.
// All other code sees only x.
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
  // The coordinate a, which keeps the rate; empty if there is none.
  [[nodiscard]] std::optional<std::size_t> following(std::span<const double> start,
                                                     std::optional<std::size_t> except) const;
  // Sets lambda0 to suit the other coordinates; `own` is u_l.
  void follow_start(std::vector<double>& x, double own) const;
  // The value of x_a that keeps the rate, given the other coordinates; lambda0 follows.
  [[nodiscard]] std::optional<double> solved(std::vector<double> x, double own) const;
  // d late/d x_k, with lambda0 following.
  [[nodiscard]] std::optional<double> slope_of_late(std::vector<double>& x, std::size_t k,
                                                    double own) const;
  [[nodiscard]] double log_rest(std::span<const double> x) const;
  [[nodiscard]] double log_scatter(std::span<const double> x) const;
  template <class Function>
  [[nodiscard]] Eigen::RowVectorXd gradient(std::vector<double>& x, Function&& function) const;

  const Parameters& parameters_;
  TimingData ends_;
  std::optional<std::size_t> start_; // l
  std::optional<std::size_t> rate_;  // a
  std::optional<std::size_t> drive_; // d
  double rest_ = 0.0;                // log lambda_rest at the start
  double reference_ = 0.0;           // x_a at the start
  double late_ = 0.0;                // lateness of the last beat at the start, s
  double slope_ = 0.0;               // d late/dx_a at the start
  double scatter_ = 0.0;             // log(T0 g) at the start
};

} // namespace goingrate::timing_model
