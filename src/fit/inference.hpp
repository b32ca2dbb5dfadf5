// From a minimum to what it means. Private to the fit room.
#pragma once

#include "fit_problem.hpp"

namespace goingrate::timing_model {

/// What the data say of the search coordinates, weak priors included (so it always exists).
///
/// With weighted Jacobian J the covariance is the sandwich H^-1 (J' W J) H^-1, H = J'J, where W
/// widens the rows of times and of amplitudes by the correlation left in them. Kept as a factor F
/// with covariance F F', so that small variances are not differences of large ones.
struct Certainty {
  Eigen::MatrixXd factor;
  Eigen::MatrixXd unwidened;    ///< the same with W = 1: what the cost function curves like
  std::vector<bool> distrusted; ///< by distrust_ripples
  [[nodiscard]] double sigma(Eigen::Index i) const { return factor.row(i).norm(); }
  [[nodiscard]] Eigen::MatrixXd covariance() const { return factor * factor.transpose(); }
};

/// Other places the search came to rest at, no worse than three sigma from the best. Where the
/// likelihood is what its curvature says they lie within three sigma of each other.
struct Rivals {
  std::vector<std::vector<double>> points;
  std::vector<double> best;
  Certainty known; ///< of the problem they were searched in
};

/// Adds to each sigma how far the farthest rival lies (nothing where all came to one minimum).
/// Marks the coordinates in which that is more than 3.5 sigma, and all that hang together with one
/// so marked (correlation above 0.99 in size).
void distrust_by_rivals(const Rivals& rivals, Certainty& known);

/// A parameter whose sigma is above 3 % of what would make it undetermined is held three sigma away
/// on either side while the rest is fitted again: the cost has to rise by a third at least of what
/// the curvature promises. Where it does not, the curvature was that of a ripple on a flat valley:
/// the coordinate is marked as distrusted.
void distrust_ripples(const FitProblem& problem, std::span<const double> x, Certainty& known);

Certainty certainty(const FitProblem& problem, std::span<const double> x);

/// Shift of the coordinates that `correction` would cause, to first order.
Eigen::VectorXd shift_by(const FitProblem& problem, std::span<const double> x,
                         const Correction& correction);

/// Parameters, correlations, combinations and derived quantities into `summary`.
void state_results(const FitProblem& problem, std::span<const double> x, const Certainty& certainty,
                   const Rivals& rivals, const FitOptions& options, double nominal_period_s,
                   FitSummary& summary);

} // namespace goingrate::timing_model
