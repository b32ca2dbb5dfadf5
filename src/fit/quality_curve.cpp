#include "quality_curve.hpp"

#include "base/special_values.hpp"
#include "goingrate/dynamics/swing_loss.hpp"

#include <algorithm>
#include <cmath>

namespace goingrate::timing_model {

namespace {

// A sum of the coordinates, and its estimate from the log.
class KnownSum {
public:
  KnownSum(const Fitted& all, const FrictionCone& cone, Eigen::VectorXd weights)
      : all_(all), cone_(cone), h_(std::move(weights)) {
    const Eigen::VectorXd wide = all.known.factor.transpose() * h_;
    const Eigen::VectorXd narrow = all.known.unwidened.transpose() * h_;
    widening_ = wide.norm() / narrow.norm();
    sigma_ = wide.norm();
  }

  [[nodiscard]] double best() const { return h_.dot(cone_.likeliest()); }
  /// Ends at z sigma, by the parabola.
  [[nodiscard]] std::array<double, 2> interval(double z) const { return cone_.interval(h_, z); }
  /// Ends at z sigma by searches with the sum held, from the ends of the parabola.
  [[nodiscard]] std::array<double, 2> searched(double z) const {
    std::array<double, 2> ends = interval(z);
    const double reach = cone_.reach(h_, z);
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}})
      ends[side] = searched_end(reach, ends[side], side == 0 ? -1.0 : 1.0);
    return ends;
  }

  /// Whether L rises like the parabola if the correction by the dynamics is computed at its ends:
  /// along a bent ridge, first order may see a minimum where the full equation has none.
  [[nodiscard]] bool holds_by_dynamics() const {
    constexpr double least = 0.4, most = 2.0; // roots of 0.1 and 2 of ln L, for the parabola's 1/2
    for (const double v : interval(1.0)) {
      if (!std::isfinite(v)) continue;
      const auto root = root_at(v, Corrections::of_each_place);
      if (!(root && *root > least && *root < most)) return false;
    }
    return true;
  }

private:
  // The correction of first order by the dynamics: as at the best point, or computed at each point.
  enum class Corrections { of_the_best, of_each_place };

  [[nodiscard]] std::optional<FitProblem> problem_at(std::span<const double> x,
                                                     Corrections corrections) const {
    FitProblem problem = all_.problem;
    if (corrections == Corrections::of_each_place && !correct(problem, all_.dynamics, x)) return {};
    return problem;
  }

  // The root of the fall of 2 log L, in sigmas, with the sum held at v: each step goes to the
  // lowest place of the parabola about the last, or half as far where L does not fall. Nothing
  // where the model does not hold.
  [[nodiscard]] std::optional<double> root_at(double v, Corrections corrections) const {
    constexpr int most_steps = 12;
    constexpr double converged_gain = 5e-3; // of ln L, where half or two are looked for
    Eigen::VectorXd x = cone_.likeliest_at(h_, v);
    const auto place = [&](const Eigen::VectorXd& at) {
      return std::span(at.data(), all_.minimum.x.size());
    };
    const auto value_at = [&](const Eigen::VectorXd& at) -> std::optional<double> {
      const auto problem = problem_at(place(at), corrections);
      return problem ? minus_log_likelihood(*problem, place(at)) : std::nullopt;
    };
    auto value = value_at(x);
    for (int step = 0; value && step < most_steps; ++step) {
      const auto problem = problem_at(place(x), corrections);
      const auto here = problem ? evaluate(*problem, place(x)) : std::nullopt;
      if (!here) return {};
      const Eigen::VectorXd towards =
          x + with_short_noise_steps(cone_about(all_, x, *here).likeliest_at(h_, v) - x);
      double part = 1.0;
      Eigen::VectorXd there = towards;
      auto next = value_at(there);
      while (!(next && *next < *value) && part > 0.05) {
        part *= 0.5;
        there = x + part * (towards - x);
        next = value_at(there);
      }
      if (!(next && *next < *value)) break;
      const bool done = *value - *next < converged_gain;
      x = there;
      value = next;
      if (done) break;
    }
    if (!value) return {};
    return std::sqrt(2.0 * std::max(0.0, *value - all_.minimum.value)) / widening_;
  }

  // As long as the misfit is large, a step of scoring would take all of it for noise.
  [[nodiscard]] Eigen::VectorXd with_short_noise_steps(Eigen::VectorXd step) const {
    constexpr double longest = 0.2; // of the logarithm of a size
    for (const Slot& slot : all_.problem.parameters.slots)
      if (slot.free && is_noise(slot.quantity)) {
        double& moved = step[static_cast<Eigen::Index>(slot.index)];
        moved = std::clamp(moved, -longest, longest);
      }
    return step;
  }

  // The root rises nearly linearly from 0 at the best sum: false position from the parabola's end.
  [[nodiscard]] double searched_end(double z, double end, double side) const {
    constexpr double tolerance = 0.05, farthest = 4.0; // of z; of the parabola's distance
    const double from = best();
    double v = std::isfinite(end) ? end : from + side * z * sigma_;
    double inside = from, root_inside = 0.0;
    std::optional<double> outside, root_outside;
    for (int round = 0; round < 8; ++round) {
      const auto root = root_at(v, Corrections::of_the_best);
      if (root && std::abs(*root - z) < tolerance * z) return v;
      if (root && *root < z) {
        inside = v;
        root_inside = *root;
      } else {
        outside = v;
        root_outside = root;
      }
      double next = 0.5 * (inside + outside.value_or(inside));
      if (outside && root_outside)
        next = inside + (*outside - inside) * (z - root_inside) / (*root_outside - root_inside);
      else if (!outside)
        next = from + (inside - from) * std::min(2.0, z / std::max(0.3 * z, root_inside));
      if (std::abs(next - from) > farthest * z * sigma_) return side * infinite;
      v = next;
    }
    return outside && root_outside ? v : side * infinite;
  }

  const Fitted& all_;
  const FrictionCone& cone_;
  Eigen::VectorXd h_;
  double widening_ = 1.0, sigma_ = 0.0;
};

// Turns 1/Q and its intervals into `factor` Q.
DecayEstimate estimate(double inverse, const std::array<double, 2>& in68,
                       const std::array<double, 2>& in95, double factor) {
  const auto of = [&](double end) { return end > 0.0 ? factor / end : infinite; };
  DecayEstimate q{of(inverse), 0.0, of(in68[1]), of(in68[0]), of(in95[1]), of(in95[0])};
  q.sigma = 0.5 * (q.high68 - q.low68);
  return q.sigma <= largest_relative_sigma * q.value ? q : nothing_known();
}

bool is_straight(const std::array<double, 2>& in68, double best) {
  constexpr double straight_relative_sigma = 0.02; // no bend of the ridge shows
  return in68[1] - in68[0] < 2.0 * straight_relative_sigma * best;
}

// How the logarithm of the amplitude at one end changes with the coordinates; nullopt where the
// model does not hold beside the fit.
std::optional<Eigen::VectorXd> slopes_of_swing(const Fitted& all, double Span::*end) {
  constexpr double step = 1e-4; // of coordinates that are logarithms or of order one
  std::vector<double> x = all.minimum.x;
  const auto log_at = [&]() -> std::optional<double> {
    const auto seen = residuals(all.problem, x);
    if (!seen) return {};
    return std::log(amplitudes_of(all.problem.parameters, x, *seen).*end);
  };
  const auto here = log_at();
  if (!here) return {};
  Eigen::VectorXd slopes(static_cast<Eigen::Index>(x.size()));
  for (std::size_t k = 0; k < x.size(); ++k) {
    x[k] += step; // upwards: friction cannot be below 0
    const auto there = log_at();
    x[k] = all.minimum.x[k];
    if (!there) return {};
    slopes[static_cast<Eigen::Index>(k)] = (*there - *here) / step;
  }
  return slopes;
}

} // namespace

DecayEstimate nothing_known() {
  return {not_known, not_known, not_known, not_known, not_known, not_known};
}

QualityCurve::Loss QualityCurve::loss_at(double amplitude) const {
  const auto share = inverse_q_per_friction(amplitude);
  Loss loss{Eigen::VectorXd::Zero(cone_.likeliest().size())};
  for (std::size_t term = 0; term < friction_terms.size(); ++term) {
    const Slot* slot = all_.problem.parameters.find(friction_terms[term]);
    if (slot->free)
      loss.weights[static_cast<Eigen::Index>(slot->index)] = share[term] * slot->scale;
    else
      loss.held += share[term] * slot->fixed_value;
  }
  return loss;
}

bool QualityCurve::holds_by_dynamics(double amplitude) const {
  if (all_.dynamics == FitDynamics::averaged1) return true;
  return KnownSum(all_, cone_, loss_at(amplitude).weights).holds_by_dynamics();
}

DecayEstimate QualityCurve::at(double amplitude, double factor) const {
  const auto [h, held] = loss_at(amplitude);
  const KnownSum sum(all_, cone_, h);
  auto in68 = sum.interval(1.0), in95 = sum.interval(z95);
  if (!is_straight(in68, sum.best())) {
    in68 = sum.searched(1.0);
    in95 = sum.searched(z95);
  }
  for (double* end : {&in68[0], &in68[1], &in95[0], &in95[1]})
    *end += held;
  return estimate(sum.best() + held, in68, in95, factor);
}

TurningAngle QualityCurve::swing(double Span::*end) const {
  const double rad = amplitudes_of(all_).*end;
  const auto slopes = slopes_of_swing(all_, end);
  if (!slopes) return {};
  if (!(slopes->norm() > 0.0)) return {rad, 0.0}; // held
  const KnownSum log_of_swing(all_, cone_, *slopes);
  auto in68 = log_of_swing.interval(1.0);
  if (!is_straight(in68, 1.0)) in68 = log_of_swing.searched(1.0);
  const double sigma =
      0.5 * rad *
      (std::exp(in68[1] - log_of_swing.best()) - std::exp(in68[0] - log_of_swing.best()));
  return sigma <= largest_relative_sigma * rad ? TurningAngle{rad, sigma} : TurningAngle{};
}

} // namespace goingrate::timing_model
