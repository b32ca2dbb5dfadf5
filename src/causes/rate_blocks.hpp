// Rate and amplitude in blocks of equal time, and their noise. Private to the causes room.
#pragma once

#include "goingrate/fit/timing_data.hpp"

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

namespace goingrate::timing_model {

/// Means over blocks of equal time.
struct RateBlocks {
  double begin_s = 0.0;
  double length_s = 0.0;
  std::vector<double> rate;                ///< relative
  std::vector<std::vector<double>> values; ///< of each of the data's terms, less its mean
  std::vector<double> amplitude_rad;       ///< empty if fewer than nine in ten are known
};
/// `count` blocks from `begin_s` on, `length_s` each.
RateBlocks rate_blocks(const TimingData& data, double begin_s, double length_s, std::size_t count);
/// The whole log in `count` blocks.
RateBlocks rate_blocks(const TimingData& data, std::size_t count);

/// Coefficients of cos(pi k (i + 1/2)/n), k = 0 .. n - 1, of a series without its mean, and without
/// its line if asked. Unlike those of a Fourier series they do not take the ends for neighbours, so
/// that white noise, flicker and a random walk all have nearly independent ones.
std::vector<double> cosines(std::span<const double> series, bool without_line);

/// What the noise of a series may be made of, beside what grows as f^2 and what is white.
struct NoiseKinds {
  bool wanders = true; ///< flicker and random walk
  /// Where a clock's answer to white drive bends, in 1/blocks times 2 pi; 0: nowhere seen. Below it
  /// the density may be up to 30 times that above: gains differ by five at most in pendulum clocks.
  double corner = 0.0;
};

/// Noise of the rate by Whittle's likelihood of the cosines from `first` on. Each round multiplies
/// the sizes of its parts by how much more of them the squares show than expected, which never
/// lowers the likelihood.
class RateNoise {
public:
  RateNoise(std::size_t first, const NoiseKinds& kinds) : first_(first), kinds_(kinds) {}
  void fit(std::span<const double> residual);
  /// Of cosine k, which is not before the first.
  [[nodiscard]] double level(std::size_t k) const {
    return level_[static_cast<Eigen::Index>(k - first_)];
  }
  /// -2 log L of the residual last fitted, but for a constant.
  [[nodiscard]] double deviance() const { return deviance_; }
  [[nodiscard]] bool is_fitted() const { return level_.size() > 0; }
  [[nodiscard]] std::size_t first() const { return first_; }

private:
  static constexpr Eigen::Index parts = 5;
  using Shapes = Eigen::Array<double, Eigen::Dynamic, parts>;
  using Sizes = Eigen::Array<double, parts, 1>;
  void put_shapes(std::size_t cosines);

  std::size_t first_;
  NoiseKinds kinds_;
  std::shared_ptr<const Shapes> shapes_; // of kinds_: copies share them
  Sizes sizes_ = Sizes::Zero();
  Eigen::ArrayXd level_;
  double deviance_ = 0.0;
};

/// Generalised least squares of a series on some causes, in noise that is sized along with it.
struct RateRegression {
  std::vector<double> coefficients, sigmas;
  RateNoise noise{1, {}}; ///< of what is left
  double deviance = 0.0;  ///< good to a tenth
};
/// `noise` is where the sizes begin: as they were without the last of the causes, or not fitted
/// yet.
RateRegression regress(const std::vector<double>& rate_cosines,
                       const std::vector<std::vector<double>>& cause_cosines, RateNoise noise);

} // namespace goingrate::timing_model
