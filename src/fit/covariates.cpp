#include "goingrate/fit/covariates.hpp"

#include "goingrate/base/scaled_time.hpp"
#include "goingrate/spectra/spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <numeric>

namespace goingrate {

namespace {

using Complex = std::complex<double>;

/// Means over blocks of equal time.
struct Blocks {
  double length_s = 0.0;
  std::vector<double> rate, value;
};

// y at t by straight lines between the beats; t must rise from call to call.
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

Blocks blocks_of(const TimingData& data, const RateTerm& term) {
  constexpr std::size_t most = 2048;
  const std::size_t count = std::min(most, data.size() / 8);
  Blocks blocks;
  blocks.length_s = data.elapsed_s.back() / static_cast<double>(count);
  Between late(data.elapsed_s, data.lateness_s), advance(data.elapsed_s, term.advance_s);
  double late_before = late.at(0.0), advance_before = advance.at(0.0);
  for (std::size_t b = 1; b <= count; ++b) {
    const double t = std::min(blocks.length_s * static_cast<double>(b), data.elapsed_s.back());
    const double late_now = late.at(t), advance_now = advance.at(t);
    blocks.rate.push_back(-(late_now - late_before) / blocks.length_s);
    blocks.value.push_back((advance_now - advance_before) / blocks.length_s);
    late_before = late_now;
    advance_before = advance_now;
  }
  return blocks;
}

double mean_of(std::span<const double> x) {
  return std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
}

std::vector<Complex> transform_without_line(std::span<const double> series) {
  const auto n = static_cast<double>(series.size());
  const double mean = mean_of(series), middle = 0.5 * (n - 1.0);
  double tilt = 0.0, spread = 0.0;
  for (std::size_t i = 0; i < series.size(); ++i) {
    const double t = static_cast<double>(i) - middle;
    tilt += t * (series[i] - mean);
    spread += t * t;
  }
  std::vector<double> x;
  for (std::size_t i = 0; i < series.size(); ++i)
    x.push_back(series[i] - mean - tilt / spread * (static_cast<double>(i) - middle));
  return real_transform(x);
}

// The mean of the periodogram over neighbours: a fifth of a frequency, four at least.
std::vector<double> smoothed(const std::vector<double>& power) {
  std::vector<double> smooth(power.size(), 0.0);
  for (std::size_t k = 1; k < power.size();) {
    const std::size_t to = std::min(power.size(), k + std::max<std::size_t>(4, k / 5));
    const double mean = mean_of(std::span(power).subspan(k, to - k));
    std::fill(smooth.begin() + static_cast<std::ptrdiff_t>(k),
              smooth.begin() + static_cast<std::ptrdiff_t>(to), mean);
    k = to;
  }
  return smooth;
}

/// The regression of a rate on a covariate through a lag.
class Regression {
public:
  Regression(std::span<const double> rate, std::span<const double> value, double block_s)
      : rate_(transform_without_line(rate)), value_(transform_without_line(value)),
        spacing_(1.0 / (static_cast<double>(rate.size()) * block_s)), level_(rate_.size(), 1.0) {
    constexpr int rounds = 6; // the weights settle
    for (int i = 0; i < rounds; ++i) {
      solve(0.0);
      weigh();
    }
    const double plain = misfit(0.0);
    double best = plain;
    constexpr double demanded = 8.0; // of 2 log L: for one more parameter, looked for on a grid
    const double longest = 0.05 / spacing_;
    for (double lag = 2.0 * block_s; lag < longest; lag *= 1.3) {
      const double here = misfit(lag);
      if (here < best && here < plain - demanded) {
        best = here;
        lag_s_ = lag;
      }
    }
    solve(lag_s_);
    weigh();
    solve(lag_s_);
  }

  [[nodiscard]] double coefficient() const { return coefficient_; }
  [[nodiscard]] double sigma() const { return sigma_; }
  [[nodiscard]] double lag_s() const { return lag_s_; }

private:
  [[nodiscard]] Complex regressor(std::size_t k, double lag_s) const {
    return value_[k] /
           Complex(1.0, 2.0 * std::numbers::pi * static_cast<double>(k) * spacing_ * lag_s);
  }
  void solve(double lag_s) {
    double xx = 0.0, xy = 0.0;
    for (std::size_t k = 1; k < rate_.size(); ++k) {
      const Complex x = regressor(k, lag_s);
      xx += std::norm(x) / level_[k];
      xy += (std::conj(x) * rate_[k]).real() / level_[k];
    }
    coefficient_ = xy / xx;
    sigma_ = std::sqrt(0.5 / xx); // each frequency has two degrees of freedom
    used_lag_ = lag_s;
  }
  void weigh() {
    std::vector<double> power(rate_.size(), 0.0);
    for (std::size_t k = 1; k < rate_.size(); ++k)
      power[k] = std::norm(rate_[k] - coefficient_ * regressor(k, used_lag_));
    level_ = smoothed(power);
  }
  [[nodiscard]] double misfit(double lag_s) const {
    double xx = 0.0, xy = 0.0, yy = 0.0;
    for (std::size_t k = 1; k < rate_.size(); ++k) {
      const Complex x = regressor(k, lag_s);
      xx += std::norm(x) / level_[k];
      xy += (std::conj(x) * rate_[k]).real() / level_[k];
      yy += std::norm(rate_[k]) / level_[k];
    }
    return 2.0 * (yy - xy * xy / xx);
  }

  std::vector<Complex> rate_, value_;
  double spacing_;
  std::vector<double> level_;
  double coefficient_ = 0.0, sigma_ = 0.0, lag_s_ = 0.0, used_lag_ = 0.0;
};

std::vector<double> lagged(std::span<const double> value, double block_s, double lag_s) {
  if (lag_s == 0.0) return {value.begin(), value.end()};
  std::vector<double> result;
  double state = value.front();
  const double share = -std::expm1(-block_s / lag_s);
  for (const double v : value)
    result.push_back(state += share * (v - state));
  return result;
}

// Sums of squares of the time error that a half leaves, by what the other half says.
struct HeldOut {
  double without2 = 0.0, with2 = 0.0;
};

HeldOut judged(const Blocks& blocks, std::size_t split, bool learn_first) {
  const std::size_t n = blocks.rate.size();
  const auto part = [&](const std::vector<double>& x, bool first) {
    return first ? std::span(x).first(split) : std::span(x).last(n - split);
  };
  const Regression known(part(blocks.rate, learn_first), part(blocks.value, learn_first),
                         blocks.length_s);
  const auto value = lagged(blocks.value, blocks.length_s, known.lag_s());
  const double rate = mean_of(part(blocks.rate, learn_first));
  const double mean = mean_of(part(value, learn_first));
  HeldOut result;
  double without = 0.0, with = 0.0;
  const auto seen = part(blocks.rate, !learn_first);
  const auto cause = part(value, !learn_first);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    without += (seen[i] - rate) * blocks.length_s;
    with += (seen[i] - rate - known.coefficient() * (cause[i] - mean)) * blocks.length_s;
    result.without2 += without * without / static_cast<double>(seen.size());
    result.with2 += with * with / static_cast<double>(seen.size());
  }
  return result;
}

bool varies(const RateTerm& term) {
  return std::any_of(term.advance_s.begin(), term.advance_s.end(),
                     [](double v) { return std::abs(v) > 1e-9; });
}

} // namespace

std::vector<CovariateEffect> covariate_effects(const TimingData& data) {
  std::vector<CovariateEffect> effects;
  constexpr std::size_t least = 256; // beats: 32 blocks, 16 in a half
  if (data.size() < least) return effects;
  for (const RateTerm& term : data.terms) {
    if (term.name == "drift" || !varies(term)) continue;
    const Blocks blocks = blocks_of(data, term);
    const Regression all(blocks.rate, blocks.value, blocks.length_s);
    const std::size_t half = blocks.rate.size() / 2;
    const HeldOut second = judged(blocks, half, true), first = judged(blocks, half, false);
    CovariateEffect effect{term.name, term.unit, all.coefficient(), all.sigma(), all.lag_s()};
    effect.without_s = std::sqrt(0.5 * (first.without2 + second.without2));
    effect.with_s = std::sqrt(0.5 * (first.with2 + second.with2));
    effects.push_back(std::move(effect));
  }
  return effects;
}

std::string covariate_text(const CovariateEffect& effect) {
  const double daily = seconds_per_day;
  const std::string per = effect.unit.starts_with("1/") ? effect.unit.substr(2) : effect.unit;
  std::string text =
      fmt::format("{}: the rate answers by {:.3g} +- {:.2g} s/day per {}", effect.name,
                  daily * effect.coefficient, daily * effect.sigma, per);
  if (effect.lag_s > 0.0) text += fmt::format(", with a lag of {:.3g} s", effect.lag_s);
  if (!effect.significant()) return text + ": nothing that stands out of the noise";
  return text +
         fmt::format("; over the half of the log it was not found in, compensating for it {} the "
                     "time error from {:.3g} s to {:.3g} s (rms)",
                     effect.helps() ? "lowers" : "raises", effect.without_s, effect.with_s);
}

} // namespace goingrate
