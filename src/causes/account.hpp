// What explains the course of a clock's rate and amplitude, one cause after the other. Private to
// the causes room.
//
// In a rate r and an amplitude a, given in n blocks, each cause makes courses c_i(t), whose sizes
// are found by generalised least squares in noise that is sized along with them:
//   r = sum of b_i c_i + noise,   a = sum of e_i d_i + noise.
// The gain of a further cause is by how much it raises 2 log L of both series, less log n for each
// size and time constant (Schwarz) and 2 log n for each date, which n blocks tell n times as finely
// and not sqrt(n) times (Zhang and Siegmund 2007). That is one scale for all causes.
#pragma once

#include "rate_blocks.hpp"

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace goingrate::timing_model {

/// The gain from which on a cause is believed: odds of exp(3), about 20, to 1.
inline constexpr double convincing_gain = 6.0;

/// The courses of one cause, each with one value per block.
struct Courses {
  std::vector<std::vector<double>> rate, amplitude;
  int dates = 0, times = 0; ///< dates and time constants that were searched for
};

/// Where something begins, dies away, or drifts. Places are in blocks from the first one's
/// beginning; a block that something begins in holds its mean, part of it being as before.
class CourseMaker {
public:
  explicit CourseMaker(const RateBlocks& blocks)
      : count_(blocks.rate.size()), length_s_(blocks.length_s) {}
  [[nodiscard]] std::vector<double> step(double place) const;
  /// 1 at the place, and dies away from there with a time constant.
  [[nodiscard]] std::vector<double> dying(double place, double time_s) const;
  /// The step less what dies away: an approach to a new level.
  [[nodiscard]] std::vector<double> approach(double place, double time_s) const;
  /// Powers of the time from the middle, in days.
  [[nodiscard]] std::vector<double> power(int exponent) const;
  [[nodiscard]] std::vector<double> wave(double period_s, double phase) const;

private:
  std::size_t count_;
  double length_s_;
};

/// The sizes that belong to the courses of one cause.
struct Sizes {
  std::vector<double> rate, rate_sigma, amplitude, amplitude_sigma;
};

/// A series in units of the spread of each cosine, less what some courses explain of it.
class WhitenedSeries {
public:
  using Series = std::vector<std::vector<double>>;
  /// From the cosine transforms of the series and of the courses taken so far, and the fitted
  /// noise.
  WhitenedSeries(const std::vector<double>& series, const Series& taken, const RateNoise& noise);
  [[nodiscard]] const Eigen::VectorXd& rest() const { return rest_; }
  /// Further courses, one per column, likewise less what those taken explain of them.
  [[nodiscard]] Eigen::MatrixXd without_taken(const Series& courses) const;
  /// By how much further courses raise 2 log L.
  [[nodiscard]] double gain_of(const Series& courses) const;

private:
  [[nodiscard]] Eigen::VectorXd whitened(const std::vector<double>& cosines) const;

  Eigen::ArrayXd per_sigma_;
  Eigen::MatrixXd taken_; // an orthonormal basis
  Eigen::VectorXd rest_;
};

/// Gains in noise that stays as it is, by which places and times are compared.
struct FixedNoiseAccount {
  WhitenedSeries rate;
  std::optional<WhitenedSeries> amplitude;
  double price = 0.0;
  /// As Account::gain_of.
  [[nodiscard]] double gain_of(const Courses& courses) const;
};

/// What has been found so far, and by how much more would explain the log better.
class Account {
public:
  /// `rate_noise` is that of a healthy clock; the amplitude's may always wander, since a drive that
  /// is white makes it.
  Account(const RateBlocks& blocks, const NoiseKinds& rate_noise);

  /// 2 log L gained by the courses besides those taken, less their price.
  [[nodiscard]] double gain_of(const Courses& courses) const;
  /// What the courses of the amplitude alone gain; 0 without amplitudes.
  [[nodiscard]] double amplitude_gain_of(const Courses& courses) const;
  /// As gain_of, for noise of the rate of other kinds that bring `numbers` more sizes.
  [[nodiscard]] double gain_of(const NoiseKinds& kinds, int numbers) const;
  /// Sizes of the courses besides those taken.
  [[nodiscard]] Sizes sizes_of(const Courses& courses) const;
  void take(const Courses& courses);
  void take(const NoiseKinds& kinds);
  /// The account with its noise fixed as it is, or as it is with some courses taken.
  [[nodiscard]] FixedNoiseAccount in_noise_beside(const Courses& courses = {}) const;
  [[nodiscard]] bool sees_amplitude() const { return !amplitude_.empty(); }

private:
  using Series = std::vector<std::vector<double>>;
  [[nodiscard]] RateRegression of_rate(const Series& more) const;
  [[nodiscard]] RateRegression of_amplitude(const Series& more) const;

  std::vector<double> rate_, amplitude_; // cosines
  Series rate_taken_, amplitude_taken_;  // cosines of the courses
  RateNoise rate_noise_, amplitude_noise_;
  double price_ = 0.0;
};

} // namespace goingrate::timing_model
