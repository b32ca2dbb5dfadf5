#include "account.hpp"

#include "base/scaled_time.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace goingrate::timing_model {

namespace {

constexpr std::size_t first_cosine = 1; // the mean is not looked at

std::vector<std::vector<double>> joined(std::vector<std::vector<double>> taken,
                                        const std::vector<std::vector<double>>& more) {
  for (const auto& course : more)
    taken.push_back(cosines(course, false));
  return taken;
}

} // namespace

std::vector<double> CourseMaker::step(double place) const {
  std::vector<double> s(count_);
  for (std::size_t i = 0; i < count_; ++i)
    s[i] = std::clamp(static_cast<double>(i) + 1.0 - place, 0.0, 1.0);
  return s;
}

// The mean of exp(-t/T) over a block of length l from t1 to t2 is T/l (exp(-t1/T) - exp(-t2/T)).
// From one whole block to the next it falls by the same factor.
std::vector<double> CourseMaker::dying(double place, double time_s) const {
  std::vector<double> s(count_, 0.0);
  const double ratio = length_s_ / time_s;
  auto block = static_cast<std::size_t>(std::max(0.0, std::floor(place)));
  if (block >= count_) return s;
  const double first = ratio * std::min(1.0, static_cast<double>(block) + 1.0 - place);
  s[block] = -std::expm1(-first) / ratio;
  const double kept = std::exp(-ratio);
  for (double mean = std::exp(-first) * -std::expm1(-ratio) / ratio; ++block < count_; mean *= kept)
    s[block] = mean;
  return s;
}

std::vector<double> CourseMaker::approach(double place, double time_s) const {
  std::vector<double> s = step(place);
  const std::vector<double> gone = dying(place, time_s);
  for (std::size_t i = 0; i < count_; ++i)
    s[i] -= gone[i];
  return s;
}

std::vector<double> CourseMaker::power(int exponent) const {
  std::vector<double> s(count_);
  for (std::size_t i = 0; i < count_; ++i)
    s[i] = std::pow((static_cast<double>(i) - 0.5 * static_cast<double>(count_ - 1)) * length_s_ /
                        seconds_per_day,
                    exponent);
  return s;
}

std::vector<double> CourseMaker::ramp(double place) const {
  std::vector<double> s(count_);
  for (std::size_t i = 0; i < count_; ++i) { // the mean over each block
    const double since = std::max(0.0, static_cast<double>(i + 1) - place);
    s[i] = (since < 1.0 ? 0.5 * since * since : since - 0.5) * length_s_ / seconds_per_day;
  }
  return s;
}

std::vector<double> CourseMaker::wave(double period_s, double phase) const {
  std::vector<double> s(count_);
  for (std::size_t i = 0; i < count_; ++i)
    s[i] = std::cos(two_pi * (static_cast<double>(i) + 0.5) * length_s_ / period_s - phase);
  return s;
}

WhitenedSeries::WhitenedSeries(const std::vector<double>& series, const Series& taken,
                               const RateNoise& noise)
    : per_sigma_(noise.levels().rsqrt()), rest_(whitened(series)) {
  if (taken.empty()) {
    taken_.resize(rest_.size(), 0);
    return;
  }
  Eigen::MatrixXd known(rest_.size(), static_cast<Eigen::Index>(taken.size()));
  for (std::size_t i = 0; i < taken.size(); ++i)
    known.col(static_cast<Eigen::Index>(i)) = whitened(taken[i]);
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factors(known);
  taken_ = factors.householderQ() * Eigen::MatrixXd::Identity(known.rows(), factors.rank());
  rest_ -= taken_ * (taken_.transpose() * rest_);
}

Eigen::VectorXd WhitenedSeries::whitened(const std::vector<double>& cosines) const {
  const Eigen::Map<const Eigen::ArrayXd> all(cosines.data(),
                                             static_cast<Eigen::Index>(cosines.size()));
  return all.tail(per_sigma_.size()) * per_sigma_;
}

Eigen::VectorXd WhitenedSeries::without_taken(const std::vector<double>& cosines) const {
  Eigen::VectorXd rest = whitened(cosines);
  rest -= taken_ * (taken_.transpose() * rest);
  return rest;
}

Eigen::MatrixXd WhitenedSeries::without_taken(const Series& courses) const {
  Eigen::MatrixXd result(rest_.size(), static_cast<Eigen::Index>(courses.size()));
  for (std::size_t i = 0; i < courses.size(); ++i)
    result.col(static_cast<Eigen::Index>(i)) = without_taken(cosines(courses[i], false));
  return result;
}

void GrowingGain::add(const std::vector<double>& cosines) {
  Eigen::VectorXd direction = series_.without_taken(cosines);
  const double whole = direction.squaredNorm();
  for (const Eigen::VectorXd& before : directions_)
    direction -= before.dot(direction) * before;
  constexpr double rounding = 1e-20; // of the whole's square
  const double left = direction.squaredNorm();
  direction *= left > rounding * whole ? 1.0 / std::sqrt(left) : 0.0;
  value_ += std::pow(direction.dot(series_.rest()), 2);
  directions_.push_back(std::move(direction));
}

GrowingGains::GrowingGains(const FixedNoiseAccount& account)
    : price_(account.price), rate_(account.rate) {
  if (account.amplitude) amplitude_.emplace(*account.amplitude);
}

void GrowingGains::add(const std::vector<std::vector<double>>& courses, GrowingGain& gain) {
  for (std::size_t i = gain.courses(); i < courses.size(); ++i) {
    if (courses[i] != last_) {
      last_ = courses[i];
      cosines_of_last_ = cosines(last_, false);
    }
    gain.add(cosines_of_last_);
  }
}

double GrowingGains::gain_of(const Courses& courses) {
  add(courses.rate, rate_);
  double gain = rate_.value() - price_ * static_cast<double>(2 * courses.dates + courses.times) -
                price_ * static_cast<double>(courses.rate.size());
  if (amplitude_) {
    add(courses.amplitude, *amplitude_);
    gain += amplitude_->value() - price_ * static_cast<double>(courses.amplitude.size());
  }
  return gain;
}

double FixedNoiseAccount::gain_of(const Courses& courses) const {
  return GrowingGains(*this).gain_of(courses);
}

// The noise of a single time at either end has no partner to cancel it at low frequencies: the
// first and the last block are left out.
Account::Account(const RateBlocks& blocks, const NoiseKinds& rate_noise)
    : rate_(cosines(blocks.rate, false)), rate_noise_(first_cosine, rate_noise),
      amplitude_noise_(first_cosine, {}),
      price_(std::log(static_cast<double>(blocks.rate.size()))) {
  const std::size_t last = blocks.rate.size() - 1;
  for (const std::size_t block : {std::size_t{0}, last}) {
    std::vector<double> alone(blocks.rate.size(), 0.0);
    alone[block] = 1.0;
    rate_taken_.push_back(cosines(alone, false));
  }
  rate_noise_ = of_rate({}).noise;
  if (blocks.amplitude_rad.empty()) return;
  amplitude_ = cosines(blocks.amplitude_rad, false);
  amplitude_noise_ = of_amplitude({}).noise;
}

RateRegression Account::of_rate(const Series& more, NoiseSize size) const {
  return regress(rate_, joined(rate_taken_, more), rate_noise_, size);
}

RateRegression Account::of_amplitude(const Series& more, NoiseSize size) const {
  return regress(amplitude_, joined(amplitude_taken_, more), amplitude_noise_, size);
}

double Account::gain_of(const Courses& courses) const {
  double gain = -price_ * (2 * courses.dates + courses.times);
  if (!courses.rate.empty())
    gain += rate_noise_.deviance() - of_rate(courses.rate).deviance -
            price_ * static_cast<double>(courses.rate.size());
  return gain + amplitude_gain_of(courses);
}

double Account::amplitude_gain_of(const Courses& courses) const {
  if (!sees_amplitude() || courses.amplitude.empty()) return 0.0;
  return amplitude_noise_.deviance() - of_amplitude(courses.amplitude).deviance -
         price_ * static_cast<double>(courses.amplitude.size());
}

double Account::gain_of(const NoiseKinds& kinds, int numbers) const {
  const RateRegression other = regress(rate_, rate_taken_, RateNoise(first_cosine, kinds));
  return rate_noise_.deviance() - other.deviance - price_ * numbers;
}

FixedNoiseAccount Account::in_noise_beside(const Courses& courses) const {
  const auto& rate_noise = courses.rate.empty() ? rate_noise_ : of_rate(courses.rate).noise;
  FixedNoiseAccount account{WhitenedSeries(rate_, rate_taken_, rate_noise), {}, price_};
  if (!sees_amplitude()) return account;
  const auto& noise =
      courses.amplitude.empty() ? amplitude_noise_ : of_amplitude(courses.amplitude).noise;
  account.amplitude.emplace(amplitude_, amplitude_taken_, noise);
  return account;
}

Sizes Account::sizes_of(const Courses& courses) const {
  const auto last = [](const std::vector<double>& all, std::size_t count) {
    return std::vector<double>(all.end() - static_cast<std::ptrdiff_t>(count), all.end());
  };
  Sizes sizes;
  if (!courses.rate.empty()) {
    const RateRegression found = of_rate(courses.rate, NoiseSize::unbiased);
    sizes.rate = last(found.coefficients, courses.rate.size());
    sizes.rate_sigma = last(found.sigmas, courses.rate.size());
  }
  if (sees_amplitude() && !courses.amplitude.empty()) {
    const RateRegression found = of_amplitude(courses.amplitude, NoiseSize::unbiased);
    sizes.amplitude = last(found.coefficients, courses.amplitude.size());
    sizes.amplitude_sigma = last(found.sigmas, courses.amplitude.size());
  }
  return sizes;
}

void Account::take(const Courses& courses) {
  rate_taken_ = joined(std::move(rate_taken_), courses.rate);
  rate_noise_ = of_rate({}).noise;
  if (!sees_amplitude()) return;
  amplitude_taken_ = joined(std::move(amplitude_taken_), courses.amplitude);
  amplitude_noise_ = of_amplitude({}).noise;
}

void Account::take(const NoiseKinds& kinds) {
  rate_noise_ = regress(rate_, rate_taken_, RateNoise(first_cosine, kinds)).noise;
}

} // namespace goingrate::timing_model
