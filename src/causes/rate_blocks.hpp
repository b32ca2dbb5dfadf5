// Rate and amplitude in blocks of equal time, and their noise. Private to the causes room.
#pragma once

#include "goingrate/fit/timing_data.hpp"

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace goingrate::timing_model {

/// Means over blocks of equal time.
struct RateBlocks {
  double begin_s = 0.0;
  double length_s = 0.0;
  std::vector<double> rate;                ///< relative
  std::vector<std::vector<double>> values; ///< of each term of the data, its mean removed
  std::vector<std::vector<double>> known;  ///< share of the beats at which each term is known
  std::vector<double> amplitude_rad;       ///< empty if fewer than nine in ten are known
};
/// `count` blocks from `begin_s` on, `length_s` each.
RateBlocks rate_blocks(const TimingData& data, double begin_s, double length_s, std::size_t count);
/// The whole log in `count` blocks.
RateBlocks rate_blocks(const TimingData& data, std::size_t count);

/// Cosine transform: coefficients of cos(pi k (i + 1/2)/n), k = 0 .. n - 1, of a series without its
/// mean and, if asked, without its line. A Fourier series would treat the two ends as neighbours;
/// these coefficients are nearly independent for white noise, flicker and a random walk alike.
std::vector<double> cosines(std::span<const double> series, bool without_line);

/// The parts that the noise of a series may have besides white noise and noise that grows as f^2.
struct NoiseKinds {
  bool wanders = true; ///< flicker and random walk
  /// Corner of a clock's response to white drive, in 2 pi/blocks; 0: outside the log's range. Below
  /// it the density may be up to 30 times that above, since gains differ by at most five in real
  /// clocks.
  double corner = 0.0;
};

/// Noise of the rate, by Whittle's likelihood of the cosine coefficients from `first` on. Each
/// iteration multiplies the size of every part by the ratio of its observed to its expected power,
/// which never lowers the likelihood.
class RateNoise {
public:
  RateNoise(std::size_t first, const NoiseKinds& kinds) : first_(first), kinds_(kinds) {}
  /// `leverage`: the share of the variance of each coefficient, from `first` on, that a regression
  /// removed from the residual; empty to ignore this.
  void fit(std::span<const double> residual, const Eigen::ArrayXd& leverage = {});
  /// Expected power of coefficient k, at least `first`.
  [[nodiscard]] double level(std::size_t k) const {
    return level_[static_cast<Eigen::Index>(k - first_)];
  }
  /// The levels of all coefficients from the first on.
  [[nodiscard]] const Eigen::ArrayXd& levels() const { return level_; }
  /// -2 log L of the residual fitted last, up to a constant.
  [[nodiscard]] double deviance() const { return deviance_; }
  [[nodiscard]] bool is_fitted() const { return level_.size() > 0; }
  [[nodiscard]] std::size_t first() const { return first_; }

private:
  static constexpr Eigen::Index white = 1; // the column of white noise
  void put_shapes(std::size_t cosines);

  std::size_t first_;
  NoiseKinds kinds_;
  std::shared_ptr<const Eigen::MatrixXd> shapes_; // of kinds_, a column a part; copies share them
  Eigen::VectorXd sizes_;
  Eigen::ArrayXd level_;
  double deviance_ = 0.0;
};

/// Generalised least squares of a series on some causes, with the sizes of the noise fitted too.
struct RateRegression {
  std::vector<double> coefficients, sigmas;
  RateNoise noise{1, {}}; ///< of the residual
  double deviance = 0.0;  ///< to within 0.1
};
/// How the sizes of the noise are found. A choice between sets of causes needs the most likely
/// sizes. These are too small, and sigmas with them by up to a tenth, since causes that vary as
/// slowly as the noise absorb part of it. The restricted likelihood gives sizes without that bias.
enum class NoiseSize : std::uint8_t { likeliest, unbiased };
/// `noise` has the starting sizes: those fitted without the last cause, or none.
RateRegression regress(const std::vector<double>& rate_cosines,
                       const std::vector<std::vector<double>>& cause_cosines, RateNoise noise,
                       NoiseSize size = NoiseSize::likeliest);

} // namespace goingrate::timing_model
