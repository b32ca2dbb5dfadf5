// References: W. J. Riley and C. A. Greenhall, "Power law noise identification using the lag 1
// autocorrelation", EFTF 2004; W. J. Riley, NIST SP 1065 (2008).
#include "spectra/noise_type.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "goingrate/base/errors.hpp"
#include "noise_by_ratio.hpp"

namespace goingrate {
namespace {

std::vector<double> every_mth(std::span<const double> x, std::size_t m) {
  if (m == 1) return {x.begin(), x.end()};
  std::vector<double> taken((x.size() + m - 1) / m);
  for (std::size_t k = 0; k < taken.size(); ++k)
    taken[k] = x[k * m];
  return taken;
}

std::size_t count_finite(std::span<const double> z) {
  return static_cast<std::size_t>(
      std::count_if(z.begin(), z.end(), [](double v) { return std::isfinite(v); }));
}

// Sums of the K numbers that term(i) returns, i < n. Four sums of each, so that one addition need
// not wait for the one before.
template <std::size_t K, class Term>
std::array<double, K> sums_in_lanes(std::size_t n, const Term& term) {
  constexpr std::size_t lanes = 4;
  std::array<std::array<double, lanes>, K> lane_sums{};
  std::size_t i = 0;
  for (; i + lanes <= n; i += lanes)
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const std::array<double, K> values = term(i + lane);
      for (std::size_t k = 0; k < K; ++k)
        lane_sums[k][lane] += values[k];
    }
  std::array<double, K> sums{};
  for (; i < n; ++i)
    for (std::size_t k = 0; k < K; ++k)
      sums[k] += term(i)[k];
  for (std::size_t k = 0; k < K; ++k)
    for (double part : lane_sums[k])
      sums[k] += part;
  return sums;
}

// Solves the symmetric 3 by 3 system of the moments t^0 .. t^4 by elimination; an unknown whose
// pivot has vanished (fewer known points than coefficients) is left at zero.
std::array<double, 3> solve_parabola(const std::array<double, 5>& moment, std::array<double, 3> b) {
  std::array<std::array<double, 3>, 3> a{};
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c)
      a[r][c] = moment[r + c];
  const double least = 1e-13 * moment[0]; // a few roundings of the largest moment
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t r = k + 1; r < 3 && a[k][k] > least; ++r) {
      const double share = a[r][k] / a[k][k];
      for (std::size_t c = k; c < 3; ++c)
        a[r][c] -= share * a[k][c];
      b[r] -= share * b[k];
    }
  std::array<double, 3> solution{};
  for (std::size_t k = 3; k-- > 0;) {
    double rest = b[k];
    for (std::size_t c = k + 1; c < 3; ++c)
      rest -= a[k][c] * solution[c];
    solution[k] = a[k][k] > least ? rest / a[k][k] : 0.0;
  }
  return solution;
}

// Least-squares removal of 1, t, t^2 on the known points; t in [-1, 1] keeps the powers of similar
// size.
void remove_parabola(std::vector<double>& z, bool whole) {
  const std::size_t n = z.size();
  const double step = n > 1 ? 2.0 / static_cast<double>(n - 1) : 0.0;
  std::array<double, 5> moment{};
  std::array<double, 3> b{};
  if (whole) {
    b = sums_in_lanes<3>(n, [&](std::size_t i) {
      const double t = static_cast<double>(i) * step - 1.0;
      return std::array{z[i], z[i] * t, z[i] * t * t};
    });
    const double count = static_cast<double>(n), gaps = count - 1.0; // n is 30 or more here
    moment = {count, 0.0, count * (count + 1.0) / (3.0 * gaps), 0.0,
              count * (count + 1.0) * (3.0 * count * count - 7.0) / (15.0 * gaps * gaps * gaps)};
  }
  for (std::size_t i = 0; i < n && !whole; ++i) {
    if (!std::isfinite(z[i])) continue;
    const double t = static_cast<double>(i) * step - 1.0, square = t * t;
    moment[0] += 1.0, moment[1] += t, moment[2] += square;
    moment[3] += square * t, moment[4] += square * square;
    b[0] += z[i], b[1] += z[i] * t, b[2] += z[i] * square;
  }
  const std::array<double, 3> c = solve_parabola(moment, b);
  for (std::size_t i = 0; i < n; ++i) {
    const double t = static_cast<double>(i) * step - 1.0;
    z[i] -= c[0] + t * (c[1] + t * c[2]);
  }
}

struct Lag1 {
  double r1;
  std::size_t pairs;
};

// Autocorrelation at lag 1 about the mean. Without gaps n/(pairs + 1) is 1 and this is the textbook
// estimate; with gaps it scales the sum of products to the pairs that exist. One pass: the parabola
// is gone, so the mean is small and costs no digits when it is taken out of the sums afterwards.
Lag1 lag1_autocorrelation(std::span<const double> z, bool whole) {
  double sum = 0.0, squares = 0.0, products = 0.0, both = 0.0, before = 0.0;
  std::size_t n = 0, pairs = 0;
  bool has_before = false;
  if (whole) {
    n = z.size(), pairs = n - 1;
    const auto sums = sums_in_lanes<3>(pairs, [&](std::size_t i) {
      return std::array{z[i], z[i] * z[i], z[i] * z[i + 1]};
    });
    sum = sums[0] + z.back(), squares = sums[1] + z.back() * z.back(), products = sums[2];
    both = 2.0 * sum - z.front() - z.back();
    z = {};
  }
  for (double v : z) {
    const bool known = std::isfinite(v);
    if (known) {
      ++n;
      sum += v;
      squares += v * v;
    }
    if (known && has_before) {
      ++pairs;
      products += before * v;
      both += before + v;
    }
    before = v;
    has_before = known;
  }
  const double count = static_cast<double>(n), pair_count = static_cast<double>(pairs);
  const double mean = n > 0 ? sum / count : 0.0;
  const double scatter = squares - count * mean * mean;
  const double together = products - mean * both + pair_count * mean * mean;
  return {scatter > 0.0 ? count / (pair_count + 1.0) * together / scatter
                        : std::numeric_limits<double>::quiet_NaN(),
          pairs};
}

void difference(std::vector<double>& z) {
  for (std::size_t i = 0; i + 1 < z.size(); ++i)
    z[i] = z[i + 1] - z[i]; // NaN stays NaN
  z.pop_back();
}

// Variance and Allan variance of averaged frequencies (in units of 1/m), from phases one tau apart;
// an Allan difference needs two neighbours.
struct FrequencyScatter {
  double variance = 0.0, allan = 0.0;
  std::size_t n = 0, pairs = 0;
};

FrequencyScatter scatter_of_steps(std::span<const double> z) {
  FrequencyScatter scatter;
  double mean = 0.0;
  for (std::size_t i = 0; i + 1 < z.size(); ++i) {
    const double y = z[i + 1] - z[i];
    if (std::isnan(y)) continue;
    ++scatter.n;
    const double from_mean = y - mean;
    mean += from_mean / static_cast<double>(scatter.n);
    scatter.variance += from_mean * (y - mean);
    const double jump = i + 2 < z.size() ? (z[i + 2] - z[i + 1]) - y : y - y;
    if (i + 2 >= z.size() || std::isnan(jump)) continue;
    scatter.allan += jump * jump;
    ++scatter.pairs;
  }
  if (scatter.n > 1) scatter.variance /= static_cast<double>(scatter.n - 1);
  if (scatter.pairs > 0) scatter.allan /= 2.0 * static_cast<double>(scatter.pairs);
  return scatter;
}

// B1: what variance over Allan variance is expected to be for n frequencies of sigma^2 ~ tau^mu.
double expected_ratio(double n, int mu) {
  switch (mu) {
  case 2:
    return n * (n + 1.0) / 6.0;
  case 1:
    return 0.5 * n;
  case 0:
    return n * std::log(n) / (2.0 * (n - 1.0) * std::log(2.0));
  case -1:
    return 1.0;
  default:
    return (n * n - 1.0) / (1.5 * n * (n - 1.0));
  }
}

} // namespace

NoiseType identify_noise(std::span<const double> phase, std::size_t m,
                         std::size_t most_differences) {
  if (m == 0) throw ArgumentError("m", 0.0, "1 or more");
  std::vector<double> z = every_mth(phase, m);
  NoiseType noise;
  noise.points = count_finite(z);
  if (noise.points < least_points_for_noise_type) return noise;
  const bool whole = noise.points == z.size();
  remove_parabola(z, whole);
  for (std::size_t d = 0;; ++d) {
    const Lag1 lag1 = lag1_autocorrelation(z, whole);
    const bool enough = lag1.pairs + d + 1 >= least_points_for_noise_type;
    if (!enough || std::isnan(lag1.r1)) return noise;
    // r1 near -1 (alternating phase) would send rho to minus infinity; -0.9 is already far past
    // white phase noise, whose alpha of 2 is the limit below.
    const double r1 = std::max(lag1.r1, -0.9);
    const double rho = r1 / (1.0 + r1);
    if (rho < 0.25 || d == most_differences) {
      noise.exponent = 2.0 - 2.0 * (rho + static_cast<double>(d));
      noise.alpha = std::min(2, static_cast<int>(std::lround(noise.exponent)));
      noise.identified = true;
      return noise;
    }
    difference(z);
  }
}

const WindowMeans& NoiseByRatio::means() const {
  std::call_once(formed_, [this] { means_.emplace(phase_); });
  return *means_;
}

int NoiseByRatio::alpha_of_phase_noise(std::size_t m) const {
  if (m == 1) return 2;
  // Differences that start a 16th of m apart hold as much information as all.
  const std::size_t step = std::max<std::size_t>(1, m / 16);
  const WindowMeans& window = means();
  double modified = 0.0, plain = 0.0;
  std::size_t modified_count = 0, plain_count = 0;
  for (std::size_t i = 0; i + 2 * m < phase_.size(); i += step) {
    const double bend = (phase_[i + 2 * m] - phase_[i + m]) - (phase_[i + m] - phase_[i]);
    if (!std::isnan(bend)) plain += bend * bend, ++plain_count;
    if (i + 3 * m > phase_.size()) continue;
    const double middle = window.mean(i + m, m);
    const double of_means = (window.mean(i + 2 * m, m) - middle) - (middle - window.mean(i, m));
    if (!std::isnan(of_means)) modified += of_means * of_means, ++modified_count;
  }
  if (modified_count == 0 || !(plain > 0.0)) return 2;
  const double ratio =
      modified / static_cast<double>(modified_count) / (plain / static_cast<double>(plain_count));
  const double factor = static_cast<double>(m), pi = std::acos(-1.0);
  const double white = 1.0 / factor;
  const double flicker = 1.5 * std::log(256.0 / 27.0) / (1.038 + 3.0 * std::log(pi * factor));
  return ratio < std::sqrt(white * flicker) ? 2 : 1;
}

NoiseType NoiseByRatio::at(std::size_t m) const {
  if (m == 0) throw ArgumentError("m", 0.0, "1 or more");
  const std::vector<double> thinned = m == 1 ? std::vector<double>{} : every_mth(phase_, m);
  const std::span<const double> z = m == 1 ? phase_ : std::span<const double>(thinned);
  const FrequencyScatter scatter = scatter_of_steps(z);
  NoiseType noise;
  noise.points = count_finite(z);
  if (scatter.n < least_frequencies_for_ratio || !(scatter.allan > 0.0)) return noise;
  const double n = static_cast<double>(scatter.n);
  const double ratio = scatter.variance / scatter.allan;
  const auto border = [n](int mu) {
    return std::sqrt(expected_ratio(n, mu) * expected_ratio(n, mu - 1));
  };
  noise.alpha = -2;
  for (int mu = 1; noise.alpha < 1 && ratio <= border(mu); --mu)
    ++noise.alpha;
  if (noise.alpha == 1) noise.alpha = alpha_of_phase_noise(m);
  noise.exponent = noise.alpha;
  noise.identified = true;
  return noise;
}

NoiseType identify_noise_by_ratio(std::span<const double> phase, std::size_t m) {
  return NoiseByRatio(phase).at(m);
}

} // namespace goingrate
