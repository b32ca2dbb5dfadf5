#include "search.hpp"

#include "valley.hpp"

#include "goingrate/base/pulse.hpp"

#include <algorithm>
#include <ceres/ceres.h>
#include <cmath>
#include <exception>

namespace goingrate::timing_model {

namespace {

class ScoredLikelihood : public ceres::CostFunction {
public:
  /// What is known already, so that it need not be computed twice.
  struct Remembered {
    std::vector<double> x;
    std::optional<Evaluation> evaluation;
  };

  ScoredLikelihood(const FitProblem& problem, const Valley& map, double offset, Remembered start)
      : problem_(problem), map_(map), offset_(offset), unknowns_(problem.parameters.free_count),
        remembered_(std::move(start)) {
    set_num_residuals(static_cast<int>(unknowns_) + 1);
    mutable_parameter_block_sizes()->push_back(static_cast<int>(unknowns_));
  }

  bool Evaluate(double const* const* at, double* residual, double** jacobian) const override {
    const std::span<const double> u(at[0], unknowns_);
    if (!std::equal(u.begin(), u.end(), last_u_.begin(), last_u_.end())) {
      last_u_.assign(u.begin(), u.end()); // Ceres asks for the value first, then for the slopes
      last_x_ = map_.x_of(u);
    }
    const std::vector<double>& x = last_x_;
    const auto n = static_cast<Eigen::Index>(unknowns_);
    Eigen::Map<Eigen::VectorXd> r(residual, n + 1);
    r.setZero();
    if (jacobian == nullptr || jacobian[0] == nullptr) {
      const auto value = minus_log_likelihood(problem_, x);
      if (!value || *value + offset_ < 0.0) return false;
      have_value_.push_back(x);
      r[n] = std::sqrt(2.0 * (*value + offset_));
      return true;
    }
    const auto evaluation =
        remembered_ && remembered_->x == x ? remembered_->evaluation : evaluate(problem_, x);
    if (!evaluation) return has_value(x) && stop_here(r, jacobian[0]);
    const double rest = 2.0 * (evaluation->value + offset_) - evaluation->projected.squaredNorm();
    r.head(n) = evaluation->projected;
    r[n] = std::sqrt(std::max(0.0, rest)); // below 0 only where the noise is far too small
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::Map<RowMajor> slopes(jacobian[0], n + 1, n);
    slopes.setZero();
    slopes.topRows(n) = evaluation->triangle * map_.slopes(u);
    // Ceres squares them, and would write to stderr if that overflows.
    if (!std::isfinite(slopes.squaredNorm())) return has_value(x) && stop_here(r, jacobian[0]);
    return true;
  }

  /// Whether the search came to a place where L has a value but no finite slope.
  [[nodiscard]] bool broke_off() const { return broke_off_; }

private:
  // A step is taken only where L was asked for its value alone; a look along the way is not.
  [[nodiscard]] bool has_value(const std::vector<double>& x) const {
    return std::find(have_value_.begin(), have_value_.end(), x) != have_value_.end();
  }
  // At a step that was taken a failure would make Ceres write to stderr; no slope ends it too.
  bool stop_here(Eigen::Map<Eigen::VectorXd>& residual, double* slopes) const {
    broke_off_ = true;
    residual.setZero();
    std::fill_n(slopes, unknowns_ * (unknowns_ + 1), 0.0);
    return true;
  }

  const FitProblem& problem_;
  const Valley& map_;
  double offset_;
  std::size_t unknowns_;
  std::optional<Remembered> remembered_;
  mutable std::vector<double> last_u_, last_x_;
  mutable std::vector<std::vector<double>> have_value_;
  mutable bool broke_off_ = false;
};

// Ceres' own tests are relative to the cost, whose zero means nothing here.
class EnoughGained : public ceres::IterationCallback {
public:
  explicit EnoughGained(double least) : least_(least) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    // A step that was refused for less than counts is the end too: what is left is rounding.
    const bool settled = summary.iteration > 0 && std::abs(summary.cost_change) < least_;
    return settled ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

private:
  double least_;
};

// Nothing may be thrown through Ceres: it is told to stop, and what was thrown goes on behind it.
class WayOut : public ceres::IterationCallback {
public:
  ceres::CallbackReturnType operator()(const ceres::IterationSummary&) override {
    try {
      pulse();
    } catch (...) {
      thrown_ = std::current_exception();
      return ceres::SOLVER_ABORT;
    }
    return ceres::SOLVER_CONTINUE;
  }
  void rethrow() const {
    if (thrown_) std::rethrow_exception(thrown_);
  }

private:
  std::exception_ptr thrown_;
};

std::string words_for(const ceres::Solver::Summary& summary) {
  switch (summary.termination_type) {
  case ceres::USER_SUCCESS:
    return "converged: the last step gained nothing that counts";
  case ceres::CONVERGENCE:
    return "converged: gradient or step at rounding";
  case ceres::NO_CONVERGENCE:
    return "stopped at the limit of iterations";
  default:
    return "failed: " + summary.message;
  }
}

} // namespace

Minimum minimise(const FitProblem& problem, std::vector<double> start, const SearchLimits& limits) {
  Minimum minimum;
  minimum.x = std::move(start);
  for (std::size_t k = 0; k < problem.bounds.size(); ++k)
    minimum.x[k] = std::clamp(minimum.x[k], problem.bounds[k][0], problem.bounds[k][1]);
  const auto slopes = minimum.x.empty() ? std::nullopt : evaluate(problem, minimum.x);
  const auto first =
      slopes ? std::optional(slopes->value) : minus_log_likelihood(problem, minimum.x);
  if (!first) return minimum;
  minimum.value = *first;
  if (minimum.x.empty()) {
    minimum.usable = minimum.converged = true;
    minimum.termination = "nothing to search for";
    return minimum;
  }
  // Half of |Q'r|^2 is what a scoring step hopes to gain, which of a noise far too small is more
  // than L itself; and L may fall by half the logarithm of every variance.
  if (!slopes) return minimum;
  const double offset = 20.0 * static_cast<double>(problem.data->size()) + std::abs(*first) +
                        slopes->projected.squaredNorm();
  const Valley map(problem, minimum.x);
  std::vector<double> u = map.u_of(minimum.x);
  ScoredLikelihood likelihood(problem, map, offset, {map.x_of(u), slopes});
  ceres::Problem::Options owned_here;
  owned_here.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem ceres_problem(owned_here);
  ceres_problem.AddResidualBlock(&likelihood, nullptr, u.data());
  for (std::size_t k = 0; k < problem.bounds.size(); ++k) {
    const auto [low, high] = problem.bounds[k];
    const auto place = static_cast<int>(k);
    if (std::isfinite(low)) ceres_problem.SetParameterLowerBound(u.data(), place, low);
    if (std::isfinite(high)) ceres_problem.SetParameterUpperBound(u.data(), place, high);
  }
  EnoughGained enough(limits.least_gain);
  ceres::Solver::Options options;
  options.initial_trust_region_radius = limits.first_radius;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = limits.iterations;
  options.function_tolerance = 1e-16; // left to the callback
  options.gradient_tolerance = 1e-12;
  options.parameter_tolerance = 1e-14;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  // Under bounds Ceres looks along each step first; a cubic would ask for derivatives every time.
  options.line_search_interpolation_type = ceres::QUADRATIC;
  WayOut way_out;
  options.callbacks = {&way_out, &enough};
  ceres::Solver::Summary summary;
  ceres::Solve(options, &ceres_problem, &summary);
  way_out.rethrow();
  minimum.termination = words_for(summary);
  minimum.converged = summary.termination_type == ceres::CONVERGENCE ||
                      summary.termination_type == ceres::USER_SUCCESS;
  if (summary.termination_type == ceres::FAILURE || likelihood.broke_off()) return minimum;
  minimum.x = map.x_of(u);
  const auto last =
      minus_log_likelihood(problem, minimum.x); // final_cost less offset has no digits
  minimum.usable = last.has_value();
  if (last) minimum.value = *last;
  return minimum;
}

} // namespace goingrate::timing_model
