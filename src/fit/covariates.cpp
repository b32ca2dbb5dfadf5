#include "goingrate/fit/covariates.hpp"

#include "goingrate/base/scaled_time.hpp"
#include "goingrate/spectra/spectrum.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <fmt/format.h>
#include <numbers>
#include <numeric>

namespace goingrate {

namespace {

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

// Coefficients of cos(pi k (i + 1/2)/n), k = 0 .. n - 1, of a series without its mean and line.
// Unlike those of a Fourier series they do not take the ends for neighbours, so that white noise,
// flicker and a random walk all have nearly independent ones. From a transform of the series and
// its mirror.
std::vector<double> cosines_without_line(std::span<const double> series) {
  const std::size_t n = series.size();
  const double mean = mean_of(series), middle = 0.5 * (static_cast<double>(n) - 1.0);
  double tilt = 0.0, spread = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = static_cast<double>(i) - middle;
    tilt += t * (series[i] - mean);
    spread += t * t;
  }
  std::vector<double> x(2 * n);
  for (std::size_t i = 0; i < n; ++i)
    x[i] = x[2 * n - 1 - i] = series[i] - mean - tilt / spread * (static_cast<double>(i) - middle);
  const auto transform = real_transform(x);
  std::vector<double> cosines(n);
  const double scale = 1.0 / std::sqrt(2.0 * static_cast<double>(n));
  for (std::size_t k = 0; k < n; ++k) {
    const double turn = -0.5 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n);
    cosines[k] = scale * (transform[k] * std::polar(1.0, turn)).real();
  }
  return cosines;
}

std::vector<double> lagged(std::span<const double> value, double block_s, double lag_s) {
  if (lag_s == 0.0) return {value.begin(), value.end()};
  std::vector<double> result;
  double state = value.front();
  const double share = -std::expm1(-block_s / lag_s);
  for (const double v : value)
    result.push_back(state += share * (v - state));
  return result;
}

/// Noise of the rate: white, flicker and random walk, by Whittle's likelihood. Each round
/// multiplies the three sizes by how much more the squares show of them than expected, which never
/// lowers it.
class RateNoise {
public:
  void fit(std::span<const double> residual) {
    const std::size_t n = residual.size();
    if (level_.empty()) {
      double all = 0.0;
      for (std::size_t k = 2; k < n; ++k)
        all += residual[k] * residual[k];
      sizes_.fill(all / (3.0 * static_cast<double>(n)));
      level_.assign(n, 0.0);
    }
    constexpr int rounds = 60;
    for (int round = 0; round < rounds; ++round) {
      std::array<double, 3> seen{}, expected{};
      for (std::size_t k = 2; k < n; ++k) {
        const auto shape = shapes(k, n);
        const double level = std::inner_product(shape.begin(), shape.end(), sizes_.begin(), 0.0);
        for (std::size_t i = 0; i < 3; ++i) {
          seen[i] += shape[i] * residual[k] * residual[k] / (level * level);
          expected[i] += shape[i] / level;
        }
      }
      for (std::size_t i = 0; i < 3; ++i)
        sizes_[i] *= seen[i] / expected[i];
    }
    for (std::size_t k = 1; k < n; ++k) {
      const auto shape = shapes(k, n);
      level_[k] = std::inner_product(shape.begin(), shape.end(), sizes_.begin(), 0.0);
    }
  }
  [[nodiscard]] double level(std::size_t k) const { return level_[k]; }

private:
  static std::array<double, 3> shapes(std::size_t k, std::size_t n) {
    const double s =
        2.0 * std::sin(0.5 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n));
    return {1.0, 1.0 / s, 1.0 / (s * s)};
  }
  std::array<double, 3> sizes_{};
  std::vector<double> level_;
};

/// The regression of a rate on a covariate through a lag. The first cosine is left out: taking off
/// the line has emptied it.
class Regression {
public:
  Regression(std::span<const double> rate, std::span<const double> value, double block_s)
      : rate_(cosines_without_line(rate)), value_(value), block_s_(block_s) {
    noise_.fit(rate_);
    settle(0.0);
    const double plain = misfit(0.0);
    double best = plain, lag_found = 0.0;
    constexpr double demanded = 8.0; // of 2 log L: for one more parameter, looked for on a grid
    const double longest = 0.1 * block_s * static_cast<double>(rate.size());
    for (double lag = block_s; lag < longest; lag *= 1.3) {
      const double here = misfit(lag);
      if (here >= best || here >= plain - demanded) continue;
      best = here;
      lag_found = lag;
    }
    settle(lag_found);
  }

  [[nodiscard]] double coefficient() const { return coefficient_; }
  [[nodiscard]] double sigma() const { return sigma_; }
  [[nodiscard]] double lag_s() const { return lag_s_; }

private:
  struct Sums {
    double xx = 0.0, xy = 0.0, yy = 0.0;
  };
  [[nodiscard]] Sums sums(std::span<const double> x) const {
    Sums s;
    for (std::size_t k = 2; k < rate_.size(); ++k) {
      const double weight = 1.0 / noise_.level(k);
      s.xx += weight * x[k] * x[k];
      s.xy += weight * x[k] * rate_[k];
      s.yy += weight * rate_[k] * rate_[k];
    }
    return s;
  }
  // Coefficient and noise settle together.
  void settle(double lag_s) {
    lag_s_ = lag_s;
    const auto x = cosines_without_line(lagged(value_, block_s_, lag_s));
    constexpr int rounds = 4;
    for (int round = 0; round < rounds; ++round) {
      const Sums s = sums(x);
      coefficient_ = s.xy / s.xx;
      sigma_ = 1.0 / std::sqrt(s.xx);
      std::vector<double> rest = rate_;
      for (std::size_t k = 0; k < rest.size(); ++k)
        rest[k] -= coefficient_ * x[k];
      noise_.fit(rest);
    }
  }
  [[nodiscard]] double misfit(double lag_s) const {
    const Sums s = sums(cosines_without_line(lagged(value_, block_s_, lag_s)));
    return s.yy - s.xy * s.xy / s.xx;
  }

  std::vector<double> rate_;
  std::span<const double> value_;
  double block_s_;
  RateNoise noise_;
  double coefficient_ = 0.0, sigma_ = 0.0, lag_s_ = 0.0;
};

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
