// The statistics of a minimum of the search: sigmas, rivals, intervals. Private to the fit room.
#pragma once

#include "fit_setup.hpp"
#include "search.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace goingrate::timing_model {

/// Half the width of a normal distribution's 95 % interval, in standard deviations.
inline constexpr double z95 = 1.959964;

/// The factors by which sigmas are widened for correlation left in the innovations of times and of
/// amplitudes.
struct Widening {
  double time = 1.0;
  double amplitude = 1.0;
  [[nodiscard]] double largest() const { return std::max(time, amplitude); }
};

/// If sigmas are widened by more than this, the model does not hold.
inline constexpr double largest_widening = 2.0;

/// What the data say about the search coordinates, priors included (so it always exists).
///
/// With the triangle R of all rows the covariance is the sandwich R^-1 M R^-T, where M is the
/// identity except for the rows that are widened. It is kept as a factor F with covariance F F', so
/// that small variances are not differences of large ones.
struct Certainty {
  Eigen::MatrixXd factor;
  Eigen::MatrixXd unwidened; ///< R^-1, from the curvature of the likelihood
  std::vector<bool> distrusted;
  std::vector<double> reach{}; ///< factor by which a coordinate may go farther than the curvature
                               ///< says, see reach_along_the_ridge(); empty: 1
  [[nodiscard]] double sigma(std::size_t i) const {
    return factor.row(static_cast<Eigen::Index>(i)).norm() * (reach.empty() ? 1.0 : reach[i]);
  }
  [[nodiscard]] double curvature_sigma(std::size_t i) const {
    return unwidened.row(static_cast<Eigen::Index>(i)).norm();
  }
  [[nodiscard]] Eigen::MatrixXd covariance() const { return factor * factor.transpose(); }
  /// Whether two points differ by more than a sigma in some coordinate; a search that ended early
  /// may be off by that much.
  [[nodiscard]] bool tells_apart(std::span<const double> a, std::span<const double> b) const {
    for (std::size_t k = 0; k < a.size(); ++k)
      if (std::abs(a[k] - b[k]) > sigma(k)) return true;
    return false;
  }
};

/// The certainty of the parameters at the minimum x.
Certainty certainty(const FitProblem& problem, std::span<const double> x,
                    const Evaluation& at_minimum, const Widening& widening);

/// Another point at which the search ended, no worse than three sigma from the best.
struct Rival {
  std::vector<double> x;
  double behind = 0.0; ///< its L minus that of the best

  /// Its probability, if one of the two is right.
  [[nodiscard]] double share() const { return 1.0 / (1.0 + std::exp(std::max(0.0, behind))); }
};
using Rivals = std::vector<Rival>;

/// Widens each sigma to the root mean square distance of the truth, which may lie about a rival as
/// well as about the best. If a rival is more than 3.5 sigma away in a coordinate, the coordinate
/// is marked instead, together with all that are correlated with it (above 0.99 in size); but if
/// that distance is less than a thousandth, the sigma is widened to it. A rival that a sigma covers
/// as it is does not widen it.
void distrust_by_rivals(const Rivals& rivals, std::span<const double> x, Certainty& known);

/// The largest relative sigma with which a value is determined: its three-sigma interval then
/// excludes zero.
inline constexpr double largest_relative_sigma = 1.0 / 3.0;
/// Sigmas from the best: the likelihood would not allow a rival so far away, at three sigma, if it
/// were a parabola.
inline constexpr double rivals_apart = 3.5;

/// Whether the parameter may be small or zero, and then has an upper limit rather than no value.
bool may_vanish(const Slot& slot);

/// The sigma above which this parameter is undetermined, in units of its coordinate.
double tolerable_sigma(const FitProblem& problem, const Slot& slot, std::span<const double> x);

/// The distance of the minimum x from the minimum with another `correction`, to first order: the
/// error of x if the other correction is right.
Eigen::VectorXd shift_by(const FitProblem& problem, std::span<const double> x,
                         const Correction& correction);

/// Ends of a parameter's intervals, as coordinates.
struct Interval {
  double low68, high68, low95, high95;
  /// sqrt(2 rise of L)/|z| at points z on one side, the first at 0; 1 for a parabola. z is the
  /// distance from the minimum in sigmas of the curvature. Two points define a straight line.
  struct Root {
    std::vector<double> z{0.0, 1.0}, over_z{1.0, 1.0};
  };
  Root low{}, high{};
};

/// States a free parameter as one that the log does not determine.
void leave_undetermined(FittedParameter& parameter);

/// Puts parameters, correlations, combinations and derived quantities into `summary`.
void state_results(const FitProblem& problem, std::span<const double> x, const Certainty& known,
                   const std::vector<Interval>& intervals, const Rivals& rivals,
                   const FitOptions& options, double nominal_period_s, FitSummary& summary);

} // namespace goingrate::timing_model
