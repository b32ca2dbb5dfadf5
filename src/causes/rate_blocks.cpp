#include "rate_blocks.hpp"

#include "goingrate/spectra/spectrum.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace goingrate::timing_model {

namespace {

// Linear interpolation of y between the beats. Successive calls must have rising t.
class Between {
public:
  Between(const std::vector<double>& t, const std::vector<double>& y) : t_(t), y_(y) {}
  double at(double t) {
    while (i_ + 2 < t_.size() && t_[i_ + 1] < t)
      ++i_;
    const double share = (t - t_[i_]) / (t_[i_ + 1] - t_[i_]);
    return y_[i_] + share * (y_[i_ + 1] - y_[i_]);
  }

private:
  const std::vector<double>&t_, &y_;
  std::size_t i_ = 0;
};

std::vector<double> differences(const TimingData& data, const std::vector<double>& integral,
                                double begin_s, double length_s, std::size_t count) {
  Between between(data.elapsed_s, integral);
  std::vector<double> means;
  double before = between.at(begin_s);
  for (std::size_t b = 1; b <= count; ++b) {
    const double now =
        between.at(std::min(begin_s + length_s * static_cast<double>(b), data.elapsed_s.back()));
    means.push_back((now - before) / length_s);
    before = now;
  }
  return means;
}

// The share of the beats of each block at which the term is known; empty if known at all of them.
std::vector<double> known_shares(const TimingData& data, const RateTerm& term, double begin_s,
                                 double length_s, std::size_t count) {
  if (term.is_known.empty()) return {};
  std::vector<double> known(count, 0.0), all(count, 0.0);
  for (std::size_t i = 0; i < data.size(); ++i) {
    const double place = std::floor((data.elapsed_s[i] - begin_s) / length_s);
    if (place < 0.0 || place >= static_cast<double>(count)) continue;
    const auto block = static_cast<std::size_t>(place);
    ++all[block];
    known[block] += static_cast<double>(term.is_known[i]);
  }
  for (std::size_t b = 0; b < count; ++b)
    known[b] = all[b] > 0.0 ? known[b] / all[b] : 0.0;
  return known;
}

// Mean amplitude of each block; a block without amplitudes repeats the value before it.
std::vector<double> amplitude_means(const TimingData& data, double begin_s, double length_s,
                                    std::size_t count) {
  std::vector<double> sum(count, 0.0), seen(count, 0.0);
  std::size_t known = 0;
  for (std::size_t i = 0; i < data.amplitude_rad.size(); ++i) {
    const double place = std::floor((data.elapsed_s[i] - begin_s) / length_s);
    if (std::isnan(data.amplitude_rad[i])) continue;
    ++known;
    if (place < 0.0 || place >= static_cast<double>(count)) continue;
    sum[static_cast<std::size_t>(place)] += data.amplitude_rad[i];
    seen[static_cast<std::size_t>(place)] += 1.0;
  }
  if (10 * known < 9 * data.size()) return {};
  const auto first = std::find_if(seen.begin(), seen.end(), [](double n) { return n > 0.0; });
  if (first == seen.end()) return {};
  const auto at = static_cast<std::size_t>(first - seen.begin());
  double last = sum[at] / seen[at];
  for (std::size_t b = 0; b < count; ++b) {
    if (seen[b] > 0.0) last = sum[b] / seen[b];
    sum[b] = last;
  }
  return sum;
}

} // namespace

RateBlocks rate_blocks(const TimingData& data, double begin_s, double length_s, std::size_t count) {
  RateBlocks blocks;
  blocks.begin_s = begin_s;
  blocks.length_s = length_s;
  blocks.rate = differences(data, data.lateness_s, begin_s, length_s, count);
  for (double& rate : blocks.rate)
    rate = -rate;
  for (const RateTerm& term : data.terms) {
    blocks.values.push_back(differences(data, term.advance_s, begin_s, length_s, count));
    blocks.known.push_back(known_shares(data, term, begin_s, length_s, count));
  }
  if (data.has_amplitude()) blocks.amplitude_rad = amplitude_means(data, begin_s, length_s, count);
  return blocks;
}

RateBlocks rate_blocks(const TimingData& data, std::size_t count) {
  return rate_blocks(data, 0.0, data.elapsed_s.back() / static_cast<double>(count), count);
}

std::vector<double> cosines(std::span<const double> series, bool without_line) {
  const std::size_t n = series.size();
  const double mean = std::accumulate(series.begin(), series.end(), 0.0) / static_cast<double>(n);
  const double middle = 0.5 * (static_cast<double>(n) - 1.0);
  double tilt = 0.0, spread = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = static_cast<double>(i) - middle;
    tilt += t * (series[i] - mean);
    spread += t * t;
  }
  const double slope = without_line ? tilt / spread : 0.0;
  std::vector<double> x(n);
  for (std::size_t i = 0; i < n; ++i)
    x[i] = series[i] - mean - slope * (static_cast<double>(i) - middle);
  return cosine_transform(x);
}

// Spectral densities at the frequencies of the cosine transform from first_ on, one column for each
// part of the noise.
void RateNoise::put_shapes(std::size_t cosines) {
  const auto rows = static_cast<Eigen::Index>(cosines - first_);
  if (shapes_ && shapes_->rows() == rows) return;
  const bool bends = kinds_.corner > 0.0;
  Eigen::MatrixXd shapes(rows, 2 + (kinds_.wanders ? 2 : 0) + (bends ? 1 : 0));
  for (Eigen::Index row = 0; row < rows; ++row) {
    const double k = static_cast<double>(row) + static_cast<double>(first_);
    const double s = 2.0 * std::sin(0.5 * std::numbers::pi * k / static_cast<double>(cosines));
    shapes(row, 0) = s * s;
    shapes(row, white) = 1.0;
    if (kinds_.wanders) {
      shapes(row, 2) = 1.0 / s;
      shapes(row, 3) = 1.0 / (s * s);
    }
    if (bends) shapes(row, shapes.cols() - 1) = 1.0 / (1.0 + std::pow(s / kinds_.corner, 2));
  }
  if (sizes_.size() == 0) sizes_ = Eigen::VectorXd::Zero(shapes.cols());
  shapes_ = std::make_shared<const Eigen::MatrixXd>(std::move(shapes));
}

void RateNoise::fit(std::span<const double> residual, const Eigen::ArrayXd& leverage) {
  put_shapes(residual.size());
  const Eigen::MatrixXd& shapes = *shapes_;
  const Eigen::ArrayXd squares =
      Eigen::Map<const Eigen::ArrayXd>(residual.data(), static_cast<Eigen::Index>(residual.size()))
          .tail(shapes.rows())
          .square();
  // Sizes change by factors, so one that an earlier fit brought to almost nothing could not grow
  // again; each starts from at least this share.
  const double least_share = is_fitted() ? 1e-3 : 1.0;
  const double mean_share = least_share * squares.sum() / static_cast<double>(sizes_.size());
  sizes_ = sizes_.cwiseMax((mean_share / shapes.colwise().sum().array()).matrix().transpose());
  constexpr double least_power = 1e-32; // rates of 1e-16: rounding, and all there is of exact beats
  constexpr int rounds = 60;            // after which log L changes by less than 0.1
  constexpr double largest_move = 1e-3; // of each size, relative
  constexpr double most_bent = 30.0;
  double moved = 1.0;
  Eigen::ArrayXd weight;
  Eigen::VectorXd seen, expected;
  for (int round = 0; round < rounds && moved > largest_move; ++round) {
    level_.matrix().noalias() = shapes * sizes_;
    level_ = level_.max(least_power);
    weight = level_.inverse();
    expected.noalias() = shapes.transpose() * weight.matrix();
    if (leverage.size() > 0)
      expected.noalias() -= shapes.transpose() * (weight * leverage).matrix();
    weight *= squares * weight;
    seen.noalias() = shapes.transpose() * weight.matrix();
    moved = 0.0;
    for (Eigen::Index i = 0; i < sizes_.size(); ++i) {
      const double factor = seen[i] / expected[i];
      // A size that tends to zero never settles; it counts only while it matters among the others.
      if (sizes_[i] * expected[i] > largest_move) moved = std::max(moved, std::abs(factor - 1.0));
      sizes_[i] *= factor;
    }
    double& bend = sizes_[sizes_.size() - 1];
    if (kinds_.corner > 0.0) bend = std::min(bend, most_bent * sizes_[white]);
  }
  level_ = (shapes * sizes_).array().max(least_power);
  deviance_ = (level_.log() + squares / level_).sum();
}

RateRegression regress(const std::vector<double>& rate,
                       const std::vector<std::vector<double>>& causes, RateNoise noise,
                       NoiseSize size) {
  const auto unknowns = static_cast<Eigen::Index>(causes.size());
  const auto first = static_cast<Eigen::Index>(noise.first());
  const auto column = [&](const std::vector<double>& series) {
    const Eigen::Map<const Eigen::VectorXd> all(series.data(),
                                                static_cast<Eigen::Index>(series.size()));
    return all.tail(all.size() - first);
  };
  Eigen::MatrixXd courses(static_cast<Eigen::Index>(rate.size()) - first, unknowns);
  for (Eigen::Index i = 0; i < unknowns; ++i)
    courses.col(i) = column(causes[static_cast<std::size_t>(i)]);
  if (!noise.is_fitted() || causes.empty()) noise.fit(rate);
  RateRegression result;
  result.deviance = noise.deviance();
  constexpr int most_rounds = 6; // of coefficients and noise in turn
  constexpr double largest_move = 0.05;
  double moved = causes.empty() ? 0.0 : 1.0;
  for (int round = 0; round < most_rounds && moved > largest_move; ++round) {
    const Eigen::MatrixXd weighted = courses.array().colwise() / noise.levels();
    const Eigen::LDLT<Eigen::MatrixXd> normal(weighted.transpose() * courses);
    const Eigen::MatrixXd covariance = normal.solve(Eigen::MatrixXd::Identity(unknowns, unknowns));
    const Eigen::VectorXd b = normal.solve(weighted.transpose() * column(rate));
    result.coefficients.assign(b.begin(), b.end());
    result.sigmas.clear();
    for (Eigen::Index i = 0; i < unknowns; ++i)
      result.sigmas.push_back(std::sqrt(std::max(0.0, covariance(i, i))));
    std::vector<double> rest = rate;
    Eigen::Map<Eigen::VectorXd>(rest.data(), static_cast<Eigen::Index>(rest.size()))
        .tail(courses.rows()) -= courses * b;
    Eigen::ArrayXd leverage;
    constexpr double most_leverage = 0.9; // above it, a coefficient hardly depends on the noise
    if (size == NoiseSize::unbiased)
      leverage = (weighted.array() * (courses * covariance).array())
                     .rowwise()
                     .sum()
                     .max(0.0)
                     .min(most_leverage);
    noise.fit(rest, leverage);
    moved = std::abs(noise.deviance() - result.deviance);
    result.deviance = noise.deviance();
  }
  result.noise = std::move(noise);
  return result;
}

} // namespace goingrate::timing_model
