// Coordinates that straighten the valley of the likelihood. Private to the fit room.
//
// Three things are known far better than any parameter, and bend the valley: the mean rate, how
// near the start was to rest, and the scatter of neighbouring periods. So searches and profiles
// move in u, where
//   x_l = u_l + (log lambda_rest - its value at the start)   starts as far from rest as before,
//   x_a = u_a + h(x of the others)                           holds the last beat as late as it was,
//   x_d = u_d - (log(T0 g) - its value at the start)         holds the scatter the drive causes.
// l is the logarithm of lambda0 and lambda_rest = sqrt(2 mu phi0/(pi eps)) the amplitude of rest
// before any change; a is the one of T0, phi0, mu, epsilon and their changes that moves the last
// beat most; d is the logarithm of the drive's rms, and g the fast gain. Everywhere else only x is
// seen.
#pragma once

#include "likelihood.hpp"

namespace goingrate::timing_model {

/// The map between u and x, about a point.
class Valley {
public:
  /// `except`: a coordinate that must not follow, because it is being held.
  Valley(const FitProblem& problem, std::span<const double> start,
         std::optional<std::size_t> except = {});

  /// Where h does not exist u itself is given, which the model then refuses or not.
  [[nodiscard]] std::vector<double> x_of(std::span<const double> u) const;
  [[nodiscard]] std::vector<double> u_of(std::span<const double> x) const;
  /// dx/du, n x n.
  [[nodiscard]] Eigen::MatrixXd slopes(std::span<const double> u) const;

private:
  // Which coordinate holds the rate.
  [[nodiscard]] std::optional<std::size_t> following(std::span<const double> start,
                                                     std::optional<std::size_t> except) const;
  // Sets lambda0 for where the other coordinates stand; `own` is u_l.
  void follow_start(std::vector<double>& x, double own) const;
  // The value of the following coordinate that holds the rate, given the others; lambda0 follows.
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
  double reference_ = 0.0;           // of a
  double late_ = 0.0;                // of the last beat at the start, s
  double slope_ = 0.0;               // of that along a
  double scatter_ = 0.0;             // log(T0 g) there
};

} // namespace goingrate::timing_model
