// A free pendulum with every term of friction at once: linear, quadratic and dry. Private to the
// fit room.
#pragma once

#include "fitted.hpp"
#include "friction_cone.hpp"

#include <array>
#include <cmath>
#include <optional>

namespace goingrate::timing_model {

/// The terms of friction, in the order of swing_loss.hpp.
inline constexpr std::array friction_terms{Quantity::epsilon, Quantity::quadratic_drag,
                                           Quantity::dry_friction};

/// The indices of the free terms, in the same order.
std::vector<std::size_t> free_terms(const Parameters& parameters);

/// The turning angles at the end and at the beginning of the fitted swing.
struct Span {
  double last = 0.0, first = 0.0;
  [[nodiscard]] double at(double part) const { return last * std::pow(first / last, part); }
};
Span amplitudes_of(const Fitted& fitted);
/// The same for the swing that the model has at x, of which `seen` are the residuals.
Span amplitudes_of(const Parameters& parameters, std::span<const double> x, const Residuals& seen);

/// Adds the correction of the fit's dynamics at x; second order supports linear friction only.
/// False if the dynamics cannot be run.
bool correct(FitProblem& problem, FitDynamics dynamics, std::span<const double> x);

/// The fit with all terms, each as a size from 0 on, searched to its minimum with its own dynamics;
/// nullopt if the model does not hold.
std::optional<Fitted> with_every_law(const Fitted& fitted, const FitOptions& options);

/// The likelihood about x as a parabola in all coordinates, with friction not below 0; the top of
/// the parabola may lie below 0.
FrictionCone cone_about(const Fitted& all, const Eigen::VectorXd& x, const Evaluation& at);
/// The same about the fit, widened as its sigmas are.
FrictionCone cone_of(const Fitted& all, const Evaluation& at);

/// Whether a step to the best point that the curvature promises would gain nothing that counts.
/// With times alone and wide swings, amplitude and friction can make up for each other along a bent
/// ridge, and a search may stop on its way.
bool is_at_rest(const Fitted& all, const Evaluation& at);

} // namespace goingrate::timing_model
