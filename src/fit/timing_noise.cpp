#include "fit/timing_noise.hpp"

#include "goingrate/base/errors.hpp"

#include "goingrate/spectra/spectrum.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/tools/minima.hpp>
#include <cstdint>

namespace goingrate {

Whitening::Whitening(std::span<const double> cycle, const TimingNoise& noise) {
  if (!(noise.jitter_s > 0.0 || noise.walk_s > 0.0))
    throw ArgumentError("noise", noise.jitter_s, "above 0 in jitter or walk");
  const double j2 = noise.jitter_s * noise.jitter_s;
  const double w2 = noise.walk_s * noise.walk_s;
  for (std::size_t i = 1; i < cycle.size(); ++i) {
    const double variance = 2.0 * j2 + w2 * (cycle[i] - cycle[i - 1]);
    const double left = i == 1 ? 0.0 : -j2 / diagonal_.back();
    below_.push_back(left);
    diagonal_.push_back(std::sqrt(variance - left * left));
  }
}

double Whitening::log_determinant() const {
  double sum = 0.0;
  for (const double d : diagonal_)
    sum += std::log(d);
  return 2.0 * sum;
}

namespace {

double sum_of_squares(std::span<const double> values) {
  double sum = 0.0;
  for (const double v : values)
    sum += v * v;
  return sum;
}

// For a share s of walk, w^2 = s, j^2 = 1 - s: -2 log likelihood with the scale at its best.
struct Profile {
  double deviance;
  double scale2;
};

Profile profile_at(std::span<const double> cycle, std::span<const double> residual, double share) {
  const Whitening whitening(cycle, {std::sqrt(1.0 - share), std::sqrt(share)});
  std::vector<double> white(residual.size() - 1);
  whitening.apply<double>(residual, white);
  const auto n = static_cast<double>(white.size());
  const double scale2 = sum_of_squares(white) / n;
  return {n * std::log(scale2) + whitening.log_determinant(), scale2};
}

} // namespace

TimingNoise estimate_noise(std::span<const double> cycle, std::span<const double> residual) {
  if (sum_of_squares(residual) == 0.0) return {};
  // The share is searched for in log odds: a walk of a millionth of the jitter's variance still
  // dominates the residuals after a million beats.
  const auto share_at = [](double odds) { return 1.0 / (1.0 + std::exp(-odds)); };
  const auto deviance = [&](double odds) {
    return profile_at(cycle, residual, share_at(odds)).deviance;
  };
  double best = -30.0;
  for (double odds = -30.0; odds <= 12.0; odds += 3.0)
    if (deviance(odds) < deviance(best)) best = odds;
  std::uintmax_t most = 40;
  constexpr int bits = 12; // of the log odds: a thousandth, far below its uncertainty
  const double refined =
      boost::math::tools::brent_find_minima(deviance, best - 3.0, best + 3.0, bits, most).first;
  const Profile none = profile_at(cycle, residual, 0.0);
  const Profile walk = profile_at(cycle, residual, share_at(refined));
  const double demanded = std::log(static_cast<double>(residual.size()));
  if (none.deviance - walk.deviance < demanded) return {std::sqrt(none.scale2), 0.0};
  const double share = share_at(refined);
  return {std::sqrt(walk.scale2 * (1.0 - share)), std::sqrt(walk.scale2 * share)};
}

double rms(std::span<const double> values) {
  return values.empty() ? 0.0
                        : std::sqrt(sum_of_squares(values) / static_cast<double>(values.size()));
}

namespace {
// Third difference of four values in a row: 1, -3, 3, -1, so white noise is raised by 1+9+9+1.
constexpr double third_difference_gain = 20.0;
double third_difference(const double* x) { return x[3] - 3.0 * x[2] + 3.0 * x[1] - x[0]; }
} // namespace

double local_white_noise(std::span<const double> series) {
  double sum = 0.0;
  std::size_t n = 0;
  for (std::size_t i = 0; i + 3 < series.size(); ++i) {
    const double d = third_difference(&series[i]);
    if (std::isnan(d)) continue;
    sum += d * d;
    ++n;
  }
  return n == 0 ? 0.0 : std::sqrt(sum / (third_difference_gain * static_cast<double>(n)));
}

namespace {

double autocorrelation(std::span<const double> x, double mean, double variance, std::size_t lag) {
  double sum = 0.0;
  for (std::size_t i = lag; i < x.size(); ++i)
    sum += (x[i] - mean) * (x[i - lag] - mean);
  return sum / (static_cast<double>(x.size()) * variance);
}

struct Moments {
  double mean = 0.0;
  double variance = 0.0;
};

Moments moments(std::span<const double> x) {
  Moments m;
  for (const double v : x)
    m.mean += v;
  m.mean /= static_cast<double>(x.size());
  for (const double v : x)
    m.variance += (v - m.mean) * (v - m.mean);
  m.variance /= static_cast<double>(x.size());
  return m;
}

} // namespace

double whiteness_p(std::span<const double> white, std::size_t lags) {
  lags = std::min(lags, white.size() / 4);
  const Moments m = moments(white);
  if (lags == 0 || m.variance == 0.0) return 1.0;
  const auto n = static_cast<double>(white.size());
  double q = 0.0;
  for (std::size_t lag = 1; lag <= lags; ++lag) {
    const double r = autocorrelation(white, m.mean, m.variance, lag);
    q += r * r / (n - static_cast<double>(lag));
  }
  q *= n * (n + 2.0);
  const boost::math::chi_squared chi(static_cast<double>(lags));
  return boost::math::cdf(boost::math::complement(chi, q));
}

namespace {

// All lags at once, by the transform of the series and as many zeros (Wiener and Khinchin).
std::vector<double> autocorrelations(std::span<const double> x, const Moments& m) {
  std::vector<double> padded(2 * x.size(), 0.0);
  for (std::size_t i = 0; i < x.size(); ++i)
    padded[i] = x[i] - m.mean;
  auto transform = real_transform(padded);
  for (auto& value : transform)
    value = std::norm(value);
  std::vector<double> sums = inverse_real_transform(transform, padded.size());
  for (double& sum : sums)
    sum /= static_cast<double>(x.size()) * m.variance;
  return sums;
}

// Variance of the means of `count` batches, in units of what white noise would give.
double batch_time(std::span<const double> x, const Moments& m, std::size_t count) {
  const std::size_t size = x.size() / count;
  if (size < 2) return 1.0;
  double sum = 0.0;
  for (std::size_t b = 0; b < count; ++b) {
    double mean = 0.0;
    for (std::size_t i = b * size; i < (b + 1) * size; ++i)
      mean += x[i] / static_cast<double>(size);
    sum += (mean - m.mean) * (mean - m.mean);
  }
  // 8 or 16 means scatter by themselves: three standard deviations of that count as white.
  const double ratio =
      sum / static_cast<double>(count - 1) * static_cast<double>(size) / m.variance;
  return ratio > 1.0 + 3.0 * std::sqrt(2.0 / static_cast<double>(count - 1)) ? ratio : 1.0;
}

} // namespace

double correlation_time(std::span<const double> white) {
  const Moments m = moments(white);
  if (white.size() < 8 || m.variance == 0.0) return 1.0;
  double time = 1.0;
  constexpr std::size_t few_lags = 16; // one by one they take less time than the transform
  std::vector<double> all;
  for (std::size_t lag = 1; lag + 1 < white.size() / 4; lag += 2) {
    if (lag > few_lags && all.empty()) all = autocorrelations(white, m);
    const auto at = [&](std::size_t i) {
      return all.empty() ? autocorrelation(white, m.mean, m.variance, i) : all[i];
    };
    const double pair = at(lag) + at(lag + 1);
    if (pair <= 0.0) break;
    time += 2.0 * pair;
  }
  // A faint but long correlation is lost in the noise of single lags; means over an eighth and a
  // sixteenth of the series show it.
  for (const std::size_t count : {8U, 16U})
    time = std::max(time, batch_time(white, m, count));
  return std::max(1.0, time);
}

} // namespace goingrate
