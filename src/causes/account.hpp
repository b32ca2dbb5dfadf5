// Explains a clock's rate and amplitude by adding up causes. Private to the causes room.
//
// The rate r and the amplitude a are given in n blocks. A cause has courses (functions of time) c_i
// and d_i, whose sizes b_i and e_i are found by generalised least squares, together with the sizes
// of the noise:
//   r = sum of b_i c_i + noise,   a = sum of e_i d_i + noise.
// The gain of a further cause is the increase of 2 log L of both series less its price: log n for
// each size and time constant (Schwarz) and 2 log n for each date, which is determined to 1/n and
// not to 1/sqrt(n) of the log (Zhang and Siegmund 2007). Gains of all causes are thus comparable.
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

/// Makes courses: steps, decays, drifts, waves. `place` is a time in blocks from the beginning of
/// the log. A value is the mean over its block, also where a change falls within the block.
class CourseMaker {
public:
  explicit CourseMaker(const RateBlocks& blocks)
      : count_(blocks.rate.size()), length_s_(blocks.length_s) {}
  [[nodiscard]] std::vector<double> step(double place) const;
  /// 0 before the place, 1 at it, and an exponential decay after it.
  [[nodiscard]] std::vector<double> dying(double place, double time_s) const;
  /// The step less the decay: an exponential approach to a new level.
  [[nodiscard]] std::vector<double> approach(double place, double time_s) const;
  /// Powers of the time from the middle, in days.
  [[nodiscard]] std::vector<double> power(int exponent) const;
  /// The time since the place, in days; 0 before it.
  [[nodiscard]] std::vector<double> ramp(double place) const;
  [[nodiscard]] std::vector<double> wave(double period_s, double phase) const;

private:
  std::size_t count_;
  double length_s_;
};

/// The sizes that belong to the courses of one cause.
struct Sizes {
  std::vector<double> rate, rate_sigma, amplitude, amplitude_sigma;
};

/// The cosine coefficients of a series, each divided by its standard deviation in the noise, less
/// the part that some courses explain.
class WhitenedSeries {
public:
  using Series = std::vector<std::vector<double>>;
  /// `series` and `taken`: cosine transforms of the series and of the courses to subtract.
  WhitenedSeries(const std::vector<double>& series, const Series& taken, const RateNoise& noise);
  [[nodiscard]] const Eigen::VectorXd& rest() const { return rest_; }
  /// Further courses, one per column, less the part that those in `taken` explain.
  [[nodiscard]] Eigen::MatrixXd without_taken(const Series& courses) const;
  /// The same for one, given its cosine transform.
  [[nodiscard]] Eigen::VectorXd without_taken(const std::vector<double>& cosines) const;

private:
  [[nodiscard]] Eigen::VectorXd whitened(const std::vector<double>& cosines) const;

  Eigen::ArrayXd per_sigma_;
  Eigen::MatrixXd taken_; // an orthonormal basis
  Eigen::VectorXd rest_;
};

/// The increase of 2 log L by courses that are added one after the other to a series: each adds
/// what it explains beyond those before it.
class GrowingGain {
public:
  explicit GrowingGain(const WhitenedSeries& series) : series_(series) {}
  /// A further course, by its cosine transform.
  void add(const std::vector<double>& cosines);
  [[nodiscard]] std::size_t courses() const { return directions_.size(); }
  [[nodiscard]] double value() const { return value_; }

private:
  const WhitenedSeries& series_;
  std::vector<Eigen::VectorXd> directions_; // orthonormal, or 0 for a course that shows nothing new
  double value_ = 0.0;
};

/// Gains with the noise held fixed, which is fast enough to compare many dates and time constants.
struct FixedNoiseAccount {
  WhitenedSeries rate;
  std::optional<WhitenedSeries> amplitude;
  double price = 0.0;
  /// As Account::gain_of.
  [[nodiscard]] double gain_of(const Courses& courses) const;
};

/// Gains in fixed noise of lists of courses of which each begins with the one before.
class GrowingGains {
public:
  explicit GrowingGains(const FixedNoiseAccount& account);
  /// As Account::gain_of. `courses`: those of the last call and further ones.
  double gain_of(const Courses& courses);

private:
  void add(const std::vector<std::vector<double>>& courses, GrowingGain& gain);

  double price_;
  GrowingGain rate_;
  std::optional<GrowingGain> amplitude_;
  std::vector<double> last_, cosines_of_last_; // rate and amplitude often have the same course
};

/// The causes found so far (the courses "taken"), and the gain of further ones.
class Account {
public:
  /// `rate_noise` is that of a healthy clock. The noise of the amplitude may always wander: a white
  /// drive already causes that.
  Account(const RateBlocks& blocks, const NoiseKinds& rate_noise);

  /// The gain of courses in addition to those taken: the increase of 2 log L less the price.
  [[nodiscard]] double gain_of(const Courses& courses) const;
  /// The gain by the courses of the amplitude alone; 0 without amplitudes.
  [[nodiscard]] double amplitude_gain_of(const Courses& courses) const;
  /// The gain of other kinds of noise of the rate, which have `numbers` more sizes.
  [[nodiscard]] double gain_of(const NoiseKinds& kinds, int numbers) const;
  /// Sizes of courses in addition to those taken, with the noise of the restricted likelihood: with
  /// the likeliest, a drift that follows the lowest coefficients leaves no noise there, and its own
  /// sigma with them. A drift's errors are 1.4 times its sigma, since the noise is known from a few
  /// coefficients only (AccountTest.ADriftLeavesTheNoiseThatItStandsIn).
  [[nodiscard]] Sizes sizes_of(const Courses& courses) const;
  void take(const Courses& courses);
  void take(const NoiseKinds& kinds);
  /// The account with its noise held fixed, as fitted with `courses` in addition to those taken.
  [[nodiscard]] FixedNoiseAccount in_noise_beside(const Courses& courses = {}) const;
  [[nodiscard]] bool sees_amplitude() const { return !amplitude_.empty(); }

private:
  using Series = std::vector<std::vector<double>>;
  [[nodiscard]] RateRegression of_rate(const Series& more, NoiseSize size = {}) const;
  [[nodiscard]] RateRegression of_amplitude(const Series& more, NoiseSize size = {}) const;

  std::vector<double> rate_, amplitude_; // cosines
  Series rate_taken_, amplitude_taken_;  // cosines of the courses
  RateNoise rate_noise_, amplitude_noise_;
  double price_ = 0.0;
};

} // namespace goingrate::timing_model
