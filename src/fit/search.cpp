#include "search.hpp"

#include "base/special_values.hpp"
#include "valley.hpp"

#include "goingrate/base/pulse.hpp"

#include <algorithm>
#include <array>
#include <ceres/ceres.h>
#include <cmath>
#include <exception>

namespace goingrate::timing_model {

namespace {

// What a change of a coordinate by one (a factor e for most) costs a step, as it seems to Ceres, as
// a share of the gain in L that scoring promises; and the least such gain that counts.
constexpr double flat_share = 1e-4, least_promise = 50.0;

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// The bounds of the coordinates.
class Bounds {
public:
  explicit Bounds(const FitProblem& problem) : bounds_(problem.bounds) {
    bounds_.resize(problem.parameters.free_count, {-infinite, infinite});
  }
  [[nodiscard]] std::vector<double> nearest(std::vector<double> x) const {
    for (std::size_t k = 0; k < x.size(); ++k)
      x[k] = std::clamp(x[k], bounds_[k][0], bounds_[k][1]);
    return x;
  }
  /// Clears dx/du of each coordinate x that u would put beyond its bounds, where it stays.
  void stay(std::span<const double> beyond, Eigen::MatrixXd& dx_du) const {
    for (std::size_t k = 0; k < beyond.size(); ++k)
      if (beyond[k] < bounds_[k][0] || beyond[k] > bounds_[k][1])
        dx_du.row(static_cast<Eigen::Index>(k)).setZero();
  }
  /// Clears the slopes of each coordinate that is at a bound beyond which the cost would fall.
  /// Otherwise Ceres would aim beyond the bound and cut the whole step short.
  void hold(std::span<const double> x, const Eigen::VectorXd& gradient,
            Eigen::Ref<RowMajor> slopes) const {
    for (std::size_t k = 0; k < x.size(); ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      if ((x[k] <= bounds_[k][0] && gradient[column] > 0.0) ||
          (x[k] >= bounds_[k][1] && gradient[column] < 0.0))
        slopes.col(column).setZero();
    }
  }
  void put_into(ceres::Problem& problem, double* x) const {
    for (std::size_t k = 0; k < bounds_.size(); ++k) {
      const auto [low, high] = bounds_[k];
      const auto place = static_cast<int>(k);
      if (std::isfinite(low)) problem.SetParameterLowerBound(x, place, low);
      if (std::isfinite(high)) problem.SetParameterUpperBound(x, place, high);
    }
  }

private:
  std::vector<std::array<double, 2>> bounds_;
};

class ScoredLikelihood : public ceres::CostFunction {
public:
  /// An evaluation that is kept, so that it need not be repeated.
  struct Remembered {
    std::vector<double> x;
    std::optional<Evaluation> evaluation;
  };

  ScoredLikelihood(const FitProblem& problem, const Valley& map, const Bounds& bounds,
                   double offset, Remembered start)
      : problem_(problem), map_(map), bounds_(bounds), offset_(offset),
        unknowns_(problem.parameters.free_count), last_(std::move(start)) {
    set_num_residuals(2 * static_cast<int>(unknowns_) + 1);
    mutable_parameter_block_sizes()->push_back(static_cast<int>(unknowns_));
  }

  bool Evaluate(double const* const* at, double* residual, double** jacobian) const override {
    const std::span<const double> u(at[0], unknowns_);
    if (!std::equal(u.begin(), u.end(), last_u_.begin(), last_u_.end())) {
      last_u_.assign(u.begin(), u.end()); // kept, since Ceres asks for the slopes after the value
      last_beyond_ = map_.x_of(u); // the bounds are those of x, which follows other coordinates too
      last_x_ = bounds_.nearest(last_beyond_);
    }
    const std::vector<double>& x = last_x_;
    const auto n = static_cast<Eigen::Index>(unknowns_);
    Eigen::Map<Eigen::VectorXd> r(residual, 2 * n + 1);
    r.setZero();
    if (jacobian == nullptr || jacobian[0] == nullptr) {
      const auto value = value_at(x);
      if (!value) return false;
      r[n] = std::sqrt(2.0 * (*value + offset_));
      return std::isfinite(r[n]); // if not, Ceres would write to stderr
    }
    if (last_.x != x) last_ = {x, evaluate(problem_, x)};
    const std::optional<Evaluation>& evaluation = last_.evaluation;
    if (!evaluation) return has_value(x) && stop_here(r, jacobian[0]);
    const double rest = 2.0 * (evaluation->value + offset_) - evaluation->projected.squaredNorm();
    r.head(n) = evaluation->projected;
    r[n] = std::sqrt(std::max(0.0, rest)); // rest < 0 only if the noise is far too small
    Eigen::Map<RowMajor> slopes(jacobian[0], 2 * n + 1, n);
    slopes.setZero();
    // Keeps steps from leaping far where the likelihood is flat.
    const double promise = std::max(least_promise, 0.5 * evaluation->projected.squaredNorm());
    slopes.bottomRows(n).diagonal().setConstant(std::sqrt(2.0 * flat_share * promise));
    Eigen::MatrixXd dx_du = map_.slopes(u);
    bounds_.stay(last_beyond_, dx_du);
    slopes.topRows(n) = evaluation->triangle * dx_du;
    bounds_.hold(u, slopes.transpose() * r, slopes);
    // Ceres squares the slopes, and would write to stderr if that overflowed.
    if (!std::isfinite(slopes.squaredNorm())) return has_value(x) && stop_here(r, jacobian[0]);
    return true;
  }

  /// Whether the search reached a point where L has a value but no finite slope.
  [[nodiscard]] bool broke_off() const { return broke_off_; }

  /// L at x, which is kept: under bounds Ceres asks once for its search along a step and once more
  /// to judge the step.
  std::optional<double> value_at(const std::vector<double>& x) const {
    if (const Value* known = found(x)) return known->value;
    const auto value = minus_log_likelihood(problem_, x);
    if (value) values_.push_back({x, *value});
    return value;
  }

private:
  struct Value {
    std::vector<double> x;
    double value;
  };
  [[nodiscard]] const Value* found(const std::vector<double>& x) const {
    const auto at = std::find_if(values_.rbegin(), values_.rend(),
                                 [&](const Value& known) { return known.x == x; });
    return at == values_.rend() ? nullptr : &*at;
  }
  // Ceres takes a step only to a point where it has asked for the value alone; a point that it only
  // tries in a line search is not such a step.
  [[nodiscard]] bool has_value(const std::vector<double>& x) const { return found(x) != nullptr; }
  // If evaluation failed at a step already taken, Ceres would write to stderr; zero slopes end the
  // search as well.
  bool stop_here(Eigen::Map<Eigen::VectorXd>& residual, double* slopes) const {
    broke_off_ = true;
    residual.setZero();
    std::fill_n(slopes, unknowns_ * (2 * unknowns_ + 1), 0.0);
    return true;
  }

  const FitProblem& problem_;
  const Valley& map_;
  const Bounds& bounds_;
  double offset_;
  std::size_t unknowns_;
  mutable Remembered last_;
  mutable std::vector<double> last_u_, last_beyond_, last_x_;
  mutable std::vector<Value> values_;
  mutable bool broke_off_ = false;
};

// Ends a search by its gain: Ceres' own test is relative to the cost, whose zero is arbitrary here.
class Progress : public ceres::IterationCallback {
public:
  explicit Progress(double least_gain) : least_gain_(least_gain) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (summary.iteration == 0) return ceres::SOLVER_CONTINUE;
    // A rejected step with such a small change ends the search too: the rest is rounding.
    return std::abs(summary.cost_change) < least_gain_ ? ceres::SOLVER_TERMINATE_SUCCESSFULLY
                                                       : ceres::SOLVER_CONTINUE;
  }

private:
  double least_gain_;
};

// Exceptions must not pass through Ceres: it is told to abort, and they are rethrown afterwards.
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

ceres::Solver::Options solver_options(const SearchLimits& limits) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = limits.iterations;
  options.initial_trust_region_radius = limits.first_radius;
  options.function_tolerance = 1e-16; // in effect off: the callback ends the search
  options.gradient_tolerance = 1e-12;
  options.parameter_tolerance = 1e-14;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  // Under bounds Ceres would search along each step, and shorten it until it gains. In a curved
  // valley it is better to reject the step, which shrinks the trust region.
  options.max_num_line_search_step_size_iterations = 0;
  return options;
}

} // namespace

Minimum minimise(const FitProblem& problem, std::vector<double> start, const SearchLimits& limits) {
  Minimum minimum;
  const Bounds bounds(problem);
  minimum.x = bounds.nearest(std::move(start));
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
  if (!slopes) return minimum;
  // Keeps L + C positive. A scoring step promises to gain half of |Q'r|^2, which is more than L
  // itself if the noise is far too small, and L may fall by half the logarithm of every variance.
  const double offset = 20.0 * static_cast<double>(problem.data->size()) + std::abs(*first) +
                        slopes->projected.squaredNorm();
  const Valley map(problem, minimum.x);
  std::vector<double> u = map.u_of(minimum.x);
  ScoredLikelihood likelihood(problem, map, bounds, offset, {bounds.nearest(map.x_of(u)), slopes});
  ceres::Problem::Options owned_here;
  owned_here.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem ceres_problem(owned_here);
  ceres_problem.AddResidualBlock(&likelihood, nullptr, u.data());
  bounds.put_into(ceres_problem, u.data());
  Progress progress(limits.least_gain);
  WayOut way_out;
  ceres::Solver::Options options = solver_options(limits);
  options.callbacks = {&way_out, &progress};
  ceres::Solver::Summary summary;
  ceres::Solve(options, &ceres_problem, &summary);
  way_out.rethrow();
  minimum.termination = words_for(summary);
  minimum.converged = summary.termination_type == ceres::CONVERGENCE ||
                      summary.termination_type == ceres::USER_SUCCESS;
  if (summary.termination_type == ceres::FAILURE || likelihood.broke_off()) return minimum;
  minimum.x = bounds.nearest(map.x_of(u));
  // Not from final_cost: too few digits are left in it less the offset.
  const auto last = likelihood.value_at(minimum.x);
  minimum.usable = last.has_value();
  if (last) minimum.value = *last;
  return minimum;
}

} // namespace goingrate::timing_model
