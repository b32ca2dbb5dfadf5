// The rate in blocks of equal time, and its noise. Private to the fit room.
#pragma once

#include "goingrate/fit/timing_data.hpp"

#include <array>
#include <span>
#include <vector>

namespace goingrate::timing_model {

/// Means over `count` blocks of equal time.
struct RateBlocks {
  double length_s = 0.0;
  std::vector<double> rate;                ///< relative
  std::vector<std::vector<double>> values; ///< of each of the data's terms, less its mean
};
RateBlocks rate_blocks(const TimingData& data, std::size_t count);

/// Coefficients of cos(pi k (i + 1/2)/n), k = 0 .. n - 1, of a series without its mean, and without
/// its line if asked. Unlike those of a Fourier series they do not take the ends for neighbours, so
/// that white noise, flicker and a random walk all have nearly independent ones.
std::vector<double> cosines(std::span<const double> series, bool without_line);

/// Noise of the rate: what grows as f^2, white, flicker and random walk, by Whittle's likelihood of
/// the cosines from `first` on. Each round multiplies the four sizes by how much more of them the
/// squares show than expected, which never lowers the likelihood.
class RateNoise {
public:
  explicit RateNoise(std::size_t first) : first_(first) {}
  /// `wanders`: with flicker and random walk.
  void fit(std::span<const double> residual, bool wanders = true);
  [[nodiscard]] double level(std::size_t k) const { return level_[k]; }
  /// -2 log L of the residual last fitted, but for a constant.
  [[nodiscard]] double deviance() const { return deviance_; }

private:
  static constexpr std::size_t parts = 4;
  std::size_t first_;
  std::array<double, parts> sizes_{};
  std::vector<double> level_;
  double deviance_ = 0.0;
};

/// Generalised least squares of the rate on some causes, in noise that is sized along with it.
struct RateRegression {
  std::vector<double> coefficients, sigmas;
  double deviance = 0.0;
};
RateRegression regress(const std::vector<double>& rate_cosines,
                       const std::vector<std::vector<double>>& cause_cosines, std::size_t first,
                       bool wanders = true);

} // namespace goingrate::timing_model
