#include "rate_blocks.hpp"

#include "goingrate/spectra/spectrum.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
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
  std::vector<double> x(2 * n); // the series and its mirror
  for (std::size_t i = 0; i < n; ++i)
    x[i] = x[2 * n - 1 - i] = series[i] - mean - slope * (static_cast<double>(i) - middle);
  const auto transform = real_transform(x);
  std::vector<double> result(n);
  const double scale = 1.0 / std::sqrt(2.0 * static_cast<double>(n));
  for (std::size_t k = 0; k < n; ++k) {
    const double turn = -0.5 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n);
    result[k] = scale * (transform[k] * std::polar(1.0, turn)).real();
  }
  return result;
}

// Spectral densities at the frequencies of the cosine transform from first_ on, one column for each
// part of the noise.
void RateNoise::put_shapes(std::size_t cosines) {
  const auto rows = static_cast<Eigen::Index>(cosines - first_);
  if (shapes_ && shapes_->rows() == rows) return;
  Shapes shapes(rows, parts);
  for (Eigen::Index row = 0; row < rows; ++row) {
    const double k = static_cast<double>(row) + static_cast<double>(first_);
    const double s = 2.0 * std::sin(0.5 * std::numbers::pi * k / static_cast<double>(cosines));
    const double wander = kinds_.wanders ? 1.0 / s : 0.0;
    const double bend = kinds_.corner > 0.0 ? 1.0 / (1.0 + std::pow(s / kinds_.corner, 2)) : 0.0;
    shapes.row(row) << s * s, 1.0, wander, wander * wander, bend;
  }
  shapes_ = std::make_shared<const Shapes>(std::move(shapes));
}

void RateNoise::fit(std::span<const double> residual) {
  put_shapes(residual.size());
  const Shapes& shapes = *shapes_;
  const Eigen::ArrayXd squares =
      Eigen::Map<const Eigen::ArrayXd>(residual.data(), static_cast<Eigen::Index>(residual.size()))
          .tail(shapes.rows())
          .square();
  // Sizes change by factors, so one that an earlier fit brought to almost nothing could not grow
  // again; each starts from at least this share.
  const double least_share = is_fitted() ? 1e-3 : 1.0;
  for (Eigen::Index i = 0; i < parts; ++i)
    if (const double shape = shapes.col(i).sum(); shape > 0.0)
      sizes_[i] = std::max(sizes_[i], least_share * squares.sum() / (parts * shape));
  constexpr int rounds = 60;            // the log likelihood then changes by less than 0.1
  constexpr double largest_move = 1e-3; // of each size, relative
  constexpr double most_bent = 30.0;
  double moved = 1.0;
  for (int round = 0; round < rounds && moved > largest_move; ++round) {
    const Eigen::ArrayXd weight = (shapes.matrix() * sizes_.matrix()).array().inverse();
    const Sizes seen = shapes.matrix().transpose() * (squares * weight.square()).matrix();
    const Sizes expected = shapes.matrix().transpose() * weight.matrix();
    moved = 0.0;
    for (Eigen::Index i = 0; i < parts; ++i) {
      if (!(expected[i] > 0.0)) continue;
      const double factor = seen[i] / expected[i];
      // A size that tends to zero never settles; it counts only while it matters beside the others.
      if (sizes_[i] * expected[i] > largest_move) moved = std::max(moved, std::abs(factor - 1.0));
      sizes_[i] *= factor;
    }
    sizes_[4] = std::min(sizes_[4], most_bent * sizes_[1]);
  }
  level_ = (shapes.matrix() * sizes_.matrix()).array();
  deviance_ = (level_.log() + squares / level_).sum();
}

RateRegression regress(const std::vector<double>& rate,
                       const std::vector<std::vector<double>>& causes, RateNoise noise) {
  const auto unknowns = static_cast<Eigen::Index>(causes.size());
  const std::size_t first = noise.first();
  if (!noise.is_fitted() || causes.empty()) noise.fit(rate);
  RateRegression result;
  result.deviance = noise.deviance();
  constexpr int most_rounds = 6; // of coefficients and noise in turn
  constexpr double largest_move = 0.05;
  double moved = causes.empty() ? 0.0 : 1.0;
  for (int round = 0; round < most_rounds && moved > largest_move; ++round) {
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(unknowns, unknowns);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
    for (std::size_t k = first; k < rate.size(); ++k) {
      const double weight = 1.0 / noise.level(k);
      for (Eigen::Index i = 0; i < unknowns; ++i) {
        const double x = causes[static_cast<std::size_t>(i)][k];
        right[i] += weight * x * rate[k];
        for (Eigen::Index j = 0; j <= i; ++j)
          normal(i, j) += weight * x * causes[static_cast<std::size_t>(j)][k];
      }
    }
    const Eigen::MatrixXd full = normal.selfadjointView<Eigen::Lower>();
    const Eigen::MatrixXd covariance =
        full.ldlt().solve(Eigen::MatrixXd::Identity(unknowns, unknowns));
    const Eigen::VectorXd b = full.ldlt().solve(right);
    result.coefficients.assign(b.begin(), b.end());
    result.sigmas.clear();
    for (Eigen::Index i = 0; i < unknowns; ++i)
      result.sigmas.push_back(std::sqrt(std::max(0.0, covariance(i, i))));
    std::vector<double> rest = rate;
    for (std::size_t k = 0; k < rest.size(); ++k)
      for (Eigen::Index i = 0; i < unknowns; ++i)
        rest[k] -= b[i] * causes[static_cast<std::size_t>(i)][k];
    noise.fit(rest);
    moved = std::abs(noise.deviance() - result.deviance);
    result.deviance = noise.deviance();
  }
  result.noise = std::move(noise);
  return result;
}

} // namespace goingrate::timing_model
