// From a minimum to what it means. Private to the fit room.
#pragma once

#include "fit_problem.hpp"

namespace goingrate::timing_model {

/// What the data say of the search coordinates, weak priors included (so it always exists).
///
/// With weighted Jacobian J the covariance is the sandwich H^-1 (J' W J) H^-1, H = J'J, where W widens
/// the rows of times and of amplitudes by the correlation left in them. Kept as a factor F with
/// covariance F F', so that small variances are not differences of large ones.
struct Certainty {
  Eigen::MatrixXd factor;
  Eigen::MatrixXd unwidened;    ///< the same with W = 1: what the cost function curves like
  std::vector<bool> distrusted; ///< by distrust_ripples
  [[nodiscard]] double sigma(Eigen::Index i) const { return factor.row(i).norm(); }
  [[nodiscard]] Eigen::MatrixXd covariance() const { return factor * factor.transpose(); }
};

/// A parameter whose sigma is above 3 % of what would make it undetermined is held three sigma away on
/// either side while the rest is fitted again: the cost has to rise by a third at least of what the
/// curvature promises. Where it does not, the curvature was that of a ripple on a flat valley: the coordinate is
/// marked as distrusted.
void distrust_ripples(const FitProblem& problem, std::span<const double> x, Certainty& known);

Certainty certainty(const FitProblem& problem, std::span<const double> x);

/// Parameters, correlations, combinations and derived quantities into `summary`.
void state_results(const FitProblem& problem, std::span<const double> x,
                   const Certainty& certainty, const FitOptions& options,
                   double nominal_period_s, FitSummary& summary);

/// Shift of the coordinates that `correction` would cause, to first order.
Eigen::VectorXd shift_by(const FitProblem& problem, std::span<const double> x,
                         const Correction& correction);

} // namespace goingrate::timing_model
