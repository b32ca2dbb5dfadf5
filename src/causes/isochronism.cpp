#include "goingrate/causes/isochronism.hpp"

#include "rate_blocks.hpp"

#include "fit/timing_noise.hpp"
#include "goingrate/dynamics/stationary.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace goingrate {

namespace {

using namespace timing_model;

double mean_of(const std::vector<double>& x) {
  return std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
}

// The speed of a series of block means, from the neighbours on both sides.
std::vector<double> speed_of(const std::vector<double>& x, double block_s) {
  std::vector<double> speed;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const std::size_t from = i > 0 ? i - 1 : 0, to = std::min(i + 1, x.size() - 1);
    speed.push_back((x[to] - x[from]) / (block_s * static_cast<double>(to - from)));
  }
  return speed;
}

// Standard deviation of a block mean.
double sigma_of_means(const TimingData& data, std::size_t blocks) {
  std::vector<double> known;
  for (const double a : data.amplitude_rad)
    if (!std::isnan(a)) known.push_back(a);
  const double in_a_block = static_cast<double>(known.size()) / static_cast<double>(blocks);
  return local_white_noise(known) / std::sqrt(std::max(1.0, in_a_block));
}

/// The regression of the rate on the amplitude and its speed, whose errors have a known size.
class SlopeRegression {
public:
  SlopeRegression(const RateBlocks& blocks, double amplitude_sigma)
      : rate_(cosines(blocks.rate, true)), amplitude_(cosines(blocks.amplitude_rad, true)),
        speed_(cosines(speed_of(blocks.amplitude_rad, blocks.length_s), true)),
        error2_(amplitude_sigma * amplitude_sigma), block_s_(blocks.length_s) {
    constexpr int rounds = 6; // of coefficients and noise in turn, as in regress()
    noise_.fit(rate_);
    for (int round = 0; round < rounds; ++round) {
      solve();
      std::vector<double> rest = rate_;
      for (std::size_t k = 0; k < rest.size(); ++k)
        rest[k] -= found_[0] * amplitude_[k] + found_[1] * speed_[k];
      noise_.fit(rest);
    }
    solve();
  }

  [[nodiscard]] double slope() const { return found_[0]; }
  /// Includes the uncertainty of the amplitude noise and of the first-order relation.
  [[nodiscard]] double sigma() const {
    constexpr double relative_sigma_of_error_variance = 0.2;
    // The error of the first-order relation: assumed, not measured, and so the least that
    // sigma/slope can be. Over the longest logs of tests/studies/isochronism.txt its median is
    // 0.0064.
    constexpr double relative_model_error = 5e-3;
    return std::hypot(std::sqrt(covariance_(0, 0)),
                      relative_sigma_of_error_variance * share_ * found_[0],
                      relative_model_error * found_[0]);
  }
  /// Noise share of the weighted amplitude variance.
  [[nodiscard]] double share_of_errors() const { return share_; }

private:
  // Noise of the regressors adds to the matrix of their products and not to the right side; what it
  // is expected to add is taken off.
  void solve() {
    Eigen::Matrix2d seen = Eigen::Matrix2d::Zero(), error = Eigen::Matrix2d::Zero();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    for (std::size_t k = first; k < rate_.size(); ++k) {
      const double weight = 1.0 / noise_.level(k);
      const Eigen::Vector2d x(amplitude_[k], speed_[k]);
      seen += weight * x * x.transpose();
      right += weight * rate_[k] * x;
      const double turn =
          std::numbers::pi * static_cast<double>(k) / static_cast<double>(rate_.size());
      error(0, 0) += weight * error2_;
      error(1, 1) += weight * error2_ * std::pow(std::sin(turn) / block_s_, 2);
    }
    share_ = error(0, 0) / seen(0, 0);
    const Eigen::Matrix2d inverse = (seen - error).inverse();
    found_ = inverse * right;
    covariance_ = inverse * seen * inverse.transpose();
  }

  static constexpr std::size_t first = 2; // cosines below it, the mean and the trend, are left out
  std::vector<double> rate_, amplitude_, speed_;
  double error2_, block_s_, share_ = 0.0;
  RateNoise noise_{first, {}};
  Eigen::Vector2d found_ = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance_ = Eigen::Matrix2d::Zero();
};

// The clock with another drive, by a factor.
ClockParameters driven(ClockParameters clock, double factor) {
  clock.mu *= factor;
  clock.impulse *= factor;
  return clock;
}

// The factor of the drive at which the clock reaches this amplitude; nullopt if none does.
std::optional<double> drive_for(const ClockParameters& clock, double amplitude) {
  double low = 1e-3, high = 1e3;
  const auto swings_less = [&](double factor) {
    const auto reached = stationary_amplitude(driven(clock, factor));
    return !reached || *reached < amplitude; // a clock that stalls swings less
  };
  if (!swings_less(low) || swings_less(high)) return {};
  constexpr int halvings = 60; // of the logarithm: to rounding
  for (int i = 0; i < halvings; ++i) {
    const double middle = std::sqrt(low * high);
    (swings_less(middle) ? low : high) = middle;
  }
  return high;
}

std::optional<IsochronismCurve> curve_of(const ClockParameters& clock, double low, double high) {
  constexpr int steps = 40;
  IsochronismCurve curve;
  for (int i = 0; i <= steps; ++i) {
    const double amplitude = low + (high - low) * i / steps;
    const auto factor = drive_for(clock, amplitude);
    const auto rate = factor ? stationary_rate_first_order(driven(clock, *factor)) : std::nullopt;
    if (!rate) continue;
    const double circular = -clock.gravity_share * amplitude * amplitude / 16.0;
    curve.amplitude_rad.push_back(amplitude);
    curve.circular.push_back(circular);
    curve.escapement.push_back(*rate - circular);
    curve.sum.push_back(*rate);
  }
  if (curve.sum.size() < 3) return {};
  return curve;
}

double slope_at(const IsochronismCurve& curve, double amplitude) {
  const auto& x = curve.amplitude_rad;
  const auto after = std::upper_bound(x.begin() + 1, x.end() - 1, amplitude) - x.begin();
  const auto i = static_cast<std::size_t>(after);
  return (curve.sum[i] - curve.sum[i - 1]) / (x[i] - x[i - 1]);
}

} // namespace

std::optional<Isochronism> isochronism(const TimingData& data, const FitSummary& fit) {
  constexpr std::size_t least_beats = 256, most_blocks = 1024;
  if (!data.has_amplitude() || data.size() < least_beats) return {};
  if (fit.has_result() && fit.model.escapement == Escapement::none) return {};
  const std::size_t count = std::min(most_blocks, data.size() / 8);
  const RateBlocks blocks = rate_blocks(data, count);
  if (blocks.amplitude_rad.empty()) return {};
  const SlopeRegression found(blocks, sigma_of_means(data, count));
  constexpr double largest_share = 0.5;
  if (!(found.share_of_errors() < largest_share)) return {};
  Isochronism result;
  result.amplitude_rad = mean_of(blocks.amplitude_rad);
  result.slope = found.slope();
  result.sigma = found.sigma();
  const auto clock = fit.has_result() ? fitted_clock(fit) : std::nullopt;
  const auto [low, high] =
      std::minmax_element(blocks.amplitude_rad.begin(), blocks.amplitude_rad.end());
  if (clock) result.curve = curve_of(*clock, *low, *high);
  if (result.curve) result.fitted_slope = slope_at(*result.curve, result.amplitude_rad);
  return result;
}

} // namespace goingrate
