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

/// The places of those that are free, in that order.
std::vector<std::size_t> free_terms(const Parameters& parameters);

/// The amplitudes between which the fit has the pendulum swing: turning angles, the last and the
/// first.
struct Span {
  double last = 0.0, first = 0.0;
  [[nodiscard]] double at(double part) const { return last * std::pow(first / last, part); }
};
Span amplitudes_of(const Fitted& fitted);

/// Puts in what the dynamics add at x; second order does not know friction that is not linear.
/// False where they do not run.
bool correct(FitProblem& problem, FitDynamics dynamics, std::span<const double> x);

/// The fit with all terms, each as a size from 0 on, brought to rest by its dynamics; nothing where
/// the model does not hold.
std::optional<Fitted> with_every_law(const Fitted& fitted, const FitOptions& options);

/// All coordinates as the likelihood curves about x, with friction on its side of 0; the top of the
/// parabola may lie on the other.
FrictionCone cone_about(const Fitted& all, const Eigen::VectorXd& x, const Evaluation& at);
/// The same about the fit, as wide as its sigmas are.
FrictionCone cone_of(const Fitted& all, const Evaluation& at);

/// Whether a step to the best place that the curvature promises would gain nothing that counts. By
/// times alone, at wide swings, amplitude and friction trade places along a ridge that bends, and a
/// search may stop on its way.
bool is_at_rest(const Fitted& all, const Evaluation& at);

} // namespace goingrate::timing_model
