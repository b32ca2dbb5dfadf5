#include "goingrate/drive/drive_history.hpp"

#include "base/special_values.hpp"
#include "fit/noise_guess.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <numbers>

namespace goingrate {

namespace {

// The observations in one block.
struct Block {
  double at_s = 0.0, cycles = 0.0;
  double x = not_known, x_sigma = 0.0; // from its amplitudes
  double rate = not_known, rate_sigma = 0.0;
};

class Blocks {
public:
  Blocks(const TimingData& data, const DriveModel& model, double block_s)
      : data_(data), model_(model), noise_(timing_model::guess_noise(data)) {
    std::size_t from = 0;
    for (std::size_t i = 1; i < data.size(); ++i) {
      if (data.elapsed_s[i] - data.elapsed_s[from] < block_s) continue;
      add(from, i);
      from = i;
    }
  }
  [[nodiscard]] const std::vector<Block>& list() const { return list_; }

private:
  void add(std::size_t from, std::size_t to) {
    Block block;
    block.at_s = 0.5 * (data_.elapsed_s[from] + data_.elapsed_s[to]);
    block.cycles = data_.cycle[to] - data_.cycle[from];
    const double length = data_.elapsed_s[to] - data_.elapsed_s[from];
    if (model_.fast_gain && model_.slow_gain) {
      block.rate = -(data_.lateness_s[to] - data_.lateness_s[from]) / length;
      block.rate_sigma =
          std::hypot(std::sqrt(2.0) * noise_.jitter_s, noise_.walk_s * std::sqrt(block.cycles)) /
          length;
    }
    if (data_.has_amplitude()) add_amplitude(from, to, block);
    list_.push_back(block);
  }

  void add_amplitude(std::size_t from, std::size_t to, Block& block) const {
    double sum = 0.0, seen = 0.0;
    for (std::size_t i = from; i < to; ++i) {
      if (std::isnan(data_.amplitude_rad[i])) continue;
      sum += data_.amplitude_rad[i];
      ++seen;
    }
    if (seen == 0.0) return;
    const double relative = sum / seen / model_.amplitude_rad;
    block.x = relative * relative - 1.0;
    block.x_sigma = 2.0 * noise_.amplitude_rad / std::sqrt(seen) / model_.amplitude_rad;
  }

  const TimingData& data_;
  const DriveModel& model_;
  timing_model::NoiseGuess noise_;
  std::vector<Block> list_;
};

// Filter and smoother over the blocks; the state is (x, d, r0).
class Smoother {
public:
  Smoother(const std::vector<Block>& blocks, const DriveModel& model)
      : blocks_(blocks), model_(model) {}

  // -2 log likelihood of the step rms q.
  double deviance(double q) {
    run(q, false);
    return deviance_;
  }
  std::vector<DrivePoint> smoothed(double q) {
    run(q, true);
    std::vector<DrivePoint> points(blocks_.size());
    Vector state = filtered_.back().state;
    Matrix covariance = filtered_.back().covariance;
    for (std::size_t k = blocks_.size(); k-- > 0;) {
      if (k + 1 < blocks_.size()) {
        const Kept &here = filtered_[k], &next = filtered_[k + 1];
        const Matrix gain =
            here.covariance * next.transition.transpose() * next.predicted_covariance.inverse();
        state = here.state + gain * (state - next.predicted);
        covariance =
            here.covariance + gain * (covariance - next.predicted_covariance) * gain.transpose();
      }
      points[k] = {blocks_[k].at_s, 1.0 + state[1], std::sqrt(std::max(0.0, covariance(1, 1)))};
    }
    return points;
  }

private:
  using Vector = Eigen::Vector3d;
  using Matrix = Eigen::Matrix3d;
  struct Kept {
    Matrix transition;
    Vector predicted, state;
    Matrix predicted_covariance, covariance;
  };

  void see(const Vector& row, double value, double sigma) {
    const double innovation = value - row.dot(state_);
    const Vector shared = covariance_ * row;
    const double variance = row.dot(shared) + sigma * sigma;
    state_ += shared * (innovation / variance);
    covariance_ -= shared * shared.transpose() / variance;
    deviance_ += std::log(variance) + innovation * innovation / variance;
  }

  void run(double q, bool keep) {
    constexpr double prior_sigma = 3.0; // of the relative drive and of x: wider than any real value
    deviance_ = 0.0;
    filtered_.clear();
    state_.setZero();
    covariance_ = Vector(prior_sigma * prior_sigma, prior_sigma * prior_sigma, 1e-4).asDiagonal();
    for (std::size_t k = 0; k < blocks_.size(); ++k) {
      const Block& block = blocks_[k];
      Matrix transition = Matrix::Identity();
      const double gone =
          k == 0 ? 0.0
                 : -std::expm1(-2.0 * std::numbers::pi * model_.epsilon *
                               (block.cycles + blocks_[k - 1].cycles)); // middle to middle
      transition(0, 0) = 1.0 - gone;
      transition(0, 1) = gone;
      state_ = transition * state_;
      covariance_ = (transition * covariance_ * transition.transpose()).eval();
      if (k > 0) { // the step may come at any time between, so half of it acts on the amplitude
        const Vector step(0.5 * gone, 1.0, 0.0);
        covariance_ += q * q * step * step.transpose();
      }
      Kept kept{transition, state_, {}, covariance_, {}};
      if (std::isfinite(block.x)) see({1.0, 0.0, 0.0}, block.x, block.x_sigma);
      if (std::isfinite(block.rate))
        see({*model_.slow_gain - *model_.fast_gain, *model_.fast_gain, 1.0}, block.rate,
            block.rate_sigma);
      kept.state = state_;
      kept.covariance = covariance_;
      if (keep) filtered_.push_back(kept);
    }
  }

  const std::vector<Block>& blocks_;
  const DriveModel& model_;
  Vector state_;
  Matrix covariance_;
  double deviance_ = 0.0;
  std::vector<Kept> filtered_;
};

} // namespace

std::optional<DriveHistory> drive_history(const TimingData& data, const DriveModel& model,
                                          double block_s) {
  DriveHistory history;
  history.from_amplitude = data.has_amplitude();
  history.from_rate = model.fast_gain && model.slow_gain;
  if (!history.from_amplitude && !history.from_rate) return {};
  const double relaxation = model.T0_s / (4.0 * std::numbers::pi * model.epsilon);
  history.block_s = block_s > 0.0 ? block_s : std::max(4.0 * model.T0_s, 0.01 * relaxation);
  const Blocks blocks(data, model, history.block_s);
  constexpr std::size_t fewest_blocks = 10;
  if (blocks.list().size() < fewest_blocks) return {};
  Smoother smoother(blocks.list(), model);
  // A grid first, as the deviance is flat where the steps are too small or too large to matter.
  double best = -14.0;
  for (double log_q = -14.0; log_q <= 1.0; log_q += 1.0)
    if (smoother.deviance(std::exp(log_q)) < smoother.deviance(std::exp(best))) best = log_q;
  constexpr int bits = 10; // of log q, to a thousandth
  const double found = boost::math::tools::brent_find_minima(
                           [&](double log_q) { return smoother.deviance(std::exp(log_q)); },
                           best - 1.0, best + 1.0, bits)
                           .first;
  history.step_rms = std::exp(found);
  history.points = smoother.smoothed(history.step_rms);
  return history;
}

std::optional<DriveModel> drive_model(const FitSummary& fit, const TimingData& data) {
  if (fit.model.escapement == Escapement::none) return {};
  DriveModel model;
  model.T0_s = data.reference_period_s; // T0 to a part in a thousand is enough
  if (const FittedParameter* epsilon = fit.find("epsilon"))
    model.epsilon = epsilon->value; // NaN if undetermined
  if (!(model.epsilon > 0.0)) return {};
  const DerivedQuantity* fast = fit.combination("fast gain");
  const DerivedQuantity* slow = fit.combination("slow gain");
  if (fast && slow) {
    model.fast_gain = fast->value;
    model.slow_gain = slow->value;
  }
  model.amplitude_rad = fit.stationary_amplitude.value;
  // Without a fitted stationary amplitude the mean of the log takes its place.
  if (data.has_amplitude() && !(model.amplitude_rad > 0.0)) {
    double sum = 0.0, seen = 0.0;
    for (const double a : data.amplitude_rad) {
      sum += std::isnan(a) ? 0.0 : a;
      seen += std::isnan(a) ? 0.0 : 1.0;
    }
    model.amplitude_rad = sum / seen;
  }
  const bool has_signal = data.has_amplitude() || model.fast_gain;
  return has_signal ? std::optional(model) : std::nullopt;
}

} // namespace goingrate
