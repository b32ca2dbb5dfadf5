#include "fit_problem.hpp"

#include <ceres/ceres.h>
#include <glog/logging.h>

namespace goingrate::timing_model {

namespace {

// Rows of a whitened problem with T carrying derivatives; T = double or a Jet.
template <class T> struct Rows {
  std::vector<T> value;
  std::size_t times = 0;
};

template <class T> bool evaluate(const FitProblem& problem, std::span<const T> x, Rows<T>& rows) {
  const TimingData& data = problem.data;
  Prediction<T> prediction;
  if (!predict(problem.parameters, x, data, prediction)) return false;
  if (!problem.correction.residual_s.empty()) {
    for (std::size_t i = 0; i < data.size(); ++i) {
      prediction.residual_s[i] -= problem.correction.residual_s[i];
      prediction.amplitude[i] += problem.correction.amplitude[i];
    }
  }
  rows.times = data.size() - 1;
  rows.value.assign(rows.times, T(0.0));
  const Whitening whitening(data.cycle, problem.weights.timing);
  whitening.apply<T>(prediction.residual_s, rows.value);
  for (std::size_t i = 0; i < data.amplitude_rad.size(); ++i) {
    if (std::isnan(data.amplitude_rad[i])) continue;
    rows.value.push_back((prediction.amplitude[i] - data.amplitude_rad[i]) /
                         problem.weights.amplitude_rad);
  }
  for (const CoordinatePrior& prior : problem.priors)
    rows.value.push_back((x[prior.index] - prior.centre) / prior.sigma);
  return true;
}

template <int width>
std::optional<Linearisation> linearise_with(const FitProblem& problem, std::span<const double> x) {
  using Jet = ceres::Jet<double, width>;
  std::vector<Jet> jets;
  for (std::size_t k = 0; k < x.size(); ++k)
    jets.emplace_back(x[k], static_cast<int>(k));
  Rows<Jet> rows;
  if (!evaluate<Jet>(problem, jets, rows)) return {};
  Linearisation result;
  const auto count = static_cast<Eigen::Index>(rows.value.size());
  const auto columns = static_cast<Eigen::Index>(x.size());
  result.times = rows.times;
  result.amplitudes = rows.value.size() - rows.times - problem.priors.size();
  result.residual.resize(count);
  result.jacobian.resize(count, columns);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Jet& row = rows.value[static_cast<std::size_t>(i)];
    result.residual[i] = row.a;
    result.jacobian.row(i) = row.v.head(columns).transpose();
  }
  return result;
}

std::size_t row_count(const FitProblem& problem) {
  std::size_t rows = problem.data.size() - 1 + problem.priors.size();
  for (const double amplitude : problem.data.amplitude_rad)
    rows += std::isnan(amplitude) ? 0 : 1;
  return rows;
}

// Ceres tells of every failed trial on standard error, which belongs to the user; what matters is
// in its summary.
class QuietLogging {
public:
  QuietLogging() : before_(FLAGS_minloglevel) { FLAGS_minloglevel = google::GLOG_FATAL; }
  QuietLogging(const QuietLogging&) = delete;
  QuietLogging& operator=(const QuietLogging&) = delete;
  ~QuietLogging() { FLAGS_minloglevel = before_; }

private:
  int before_;
};

// The problem as Ceres sees it: one block of residuals over one block of parameters.
class Cost final : public ceres::CostFunction {
public:
  explicit Cost(const FitProblem& problem) : problem_(problem) {
    set_num_residuals(static_cast<int>(row_count(problem)));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(problem.parameters.free_count));
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const std::span<const double> x(parameters[0], problem_.parameters.free_count);
    if (jacobians == nullptr || jacobians[0] == nullptr) {
      Rows<double> rows;
      if (!evaluate<double>(problem_, x, rows)) return false;
      std::copy(rows.value.begin(), rows.value.end(), residuals);
      return true;
    }
    const auto linear = linearise(problem_, x);
    if (!linear || !linear->residual.allFinite() || !linear->jacobian.allFinite()) return false;
    Eigen::Map<Eigen::VectorXd>(residuals, linear->residual.size()) = linear->residual;
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::Map<RowMajor>(jacobians[0], linear->jacobian.rows(), linear->jacobian.cols()) =
        linear->jacobian;
    return true;
  }

private:
  const FitProblem& problem_;
};

} // namespace

std::optional<Linearisation> linearise(const FitProblem& problem, std::span<const double> x) {
  return x.size() <= 8 ? linearise_with<8>(problem, x)
                       : linearise_with<static_cast<int>(most_parameters)>(problem, x);
}

std::optional<Prediction<double>> predict_at(const FitProblem& problem, std::span<const double> x) {
  Prediction<double> prediction;
  if (!predict(problem.parameters, x, problem.data, prediction)) return {};
  double mean = 0.0;
  for (std::size_t i = 0; i < prediction.residual_s.size(); ++i) {
    if (!problem.correction.residual_s.empty()) {
      prediction.residual_s[i] -= problem.correction.residual_s[i];
      prediction.amplitude[i] += problem.correction.amplitude[i];
    }
    mean += prediction.residual_s[i];
  }
  mean /= static_cast<double>(prediction.residual_s.size());
  for (double& r : prediction.residual_s)
    r -= mean;
  return prediction;
}

Minimum minimise(const FitProblem& problem, std::vector<double> start, int iterations) {
  Minimum minimum;
  minimum.x = std::move(start);
  const auto at_start = linearise(problem, minimum.x); // with derivatives, which can overflow alone
  if (!at_start || !at_start->residual.allFinite() || !at_start->jacobian.allFinite()) {
    minimum.termination = "the start lies outside the domain of the model";
    return minimum;
  }
  if (problem.parameters.free_count == 0) {
    minimum.usable = minimum.converged = true;
    minimum.termination = "nothing free";
    minimum.cost = 0.5 * at_start->residual.squaredNorm();
    return minimum;
  }
  ceres::Problem ceres_problem;
  ceres_problem.AddResidualBlock(new Cost(problem), nullptr, minimum.x.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = iterations;
  options.logging_type = ceres::SILENT;
  // A step that changes the cost (half a chi-squared) by 1e-4 is a hundredth of a sigma.
  options.function_tolerance =
      1e-4 / std::max(0.5 * static_cast<double>(at_start->residual.size()), 1.0);
  options.gradient_tolerance = 1e-14;
  options.parameter_tolerance = 1e-13;
  ceres::Solver::Summary summary;
  const QuietLogging quiet;
  ceres::Solve(options, &ceres_problem, &summary);
  minimum.usable = summary.IsSolutionUsable();
  minimum.converged = summary.termination_type == ceres::CONVERGENCE;
  minimum.cost = summary.final_cost;
  minimum.termination = summary.message;
  return minimum;
}

} // namespace goingrate::timing_model
