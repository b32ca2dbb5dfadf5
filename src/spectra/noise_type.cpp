// References: W. J. Riley and C. A. Greenhall, "Power law noise identification using the lag 1
// autocorrelation", EFTF 2004; W. J. Riley, NIST SP 1065 (2008).
#include "spectra/noise_type.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "goingrate/base/errors.hpp"
#include "base/per_processor.hpp"
#include "goingrate/base/sums.hpp"

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

// Every m-th phase, k = 0 .. count - 1, at places t from -1 to 1, so that the powers of t are of
// similar size.
struct Series {
  std::span<const double> phase;
  std::size_t m;
  std::size_t count = (phase.size() + m - 1) / m;
  double step = count > 1 ? 2.0 / static_cast<double>(count - 1) : 0.0;

  [[nodiscard]] double value(std::size_t k) const { return phase[k * m]; }
  [[nodiscard]] double place(std::size_t k) const { return static_cast<double>(k) * step - 1.0; }
};

// The least-squares parabola through the known points, as coefficients of 1, t, t^2.
struct Parabola {
  std::array<double, 3> c{};
  std::size_t known = 0; // points

  [[nodiscard]] double at(double t) const { return c[0] + t * (c[1] + t * c[2]); }
};

Parabola parabola_through_all(const Series& series, const std::array<double, 3>& b) {
  const double count = static_cast<double>(series.count), gaps = count - 1.0; // at least 29
  const std::array<double, 5> moment{count, 0.0, count * (count + 1.0) / (3.0 * gaps), 0.0,
                                     count * (count + 1.0) * (3.0 * count * count - 7.0) /
                                         (15.0 * gaps * gaps * gaps)};
  return {solve_parabola(moment, b), series.count};
}

Parabola parabola_through_known(const Series& series) {
  std::array<double, 5> moment{};
  std::array<double, 3> b{};
  Parabola parabola;
  for (std::size_t k = 0; k < series.count; ++k) {
    const double z = series.value(k);
    if (!std::isfinite(z)) continue;
    const double t = series.place(k), square = t * t;
    ++parabola.known;
    moment[0] += 1.0, moment[1] += t, moment[2] += square;
    moment[3] += square * t, moment[4] += square * square;
    b[0] += z, b[1] += z * t, b[2] += z * square;
  }
  parabola.c = solve_parabola(moment, b);
  return parabola;
}

Parabola parabola_through(const Series& series) {
  const auto b = sums_in_lanes<3>(series.count, [&](std::size_t k) {
    const double z = series.value(k), t = series.place(k);
    return std::array{z, z * t, z * t * t};
  });
  return std::isfinite(b[0]) ? parabola_through_all(series, b) : parabola_through_known(series);
}

struct Lag1 {
  double r1;
  std::size_t pairs;
};

// Autocorrelation at lag 1 about the mean, of a series that comes in blocks. Without gaps n/(pairs
// + 1) is 1 and this is the textbook estimate; with gaps it scales the sum of products to the pairs
// that exist. The parabola is gone, so the mean is small and costs no digits when it is taken out
// of the sums afterwards.
class Autocorrelation {
public:
  void add(std::span<const double> z, bool whole) {
    if (whole)
      add_known(z);
    else
      for (const double v : z)
        add(v);
    last_ = z.empty() ? last_ : z.back();
  }

  [[nodiscard]] Lag1 result() const {
    const double count = static_cast<double>(n_), pair_count = static_cast<double>(pairs_);
    const double mean = n_ > 0 ? sum_ / count : 0.0;
    const double scatter = squares_ - count * mean * mean;
    const double together = products_ - mean * both_ + pair_count * mean * mean;
    return {scatter > 0.0 ? count / (pair_count + 1.0) * together / scatter : nan, pairs_};
  }
  // The last value that was added; NaN before the first.
  [[nodiscard]] double last() const { return last_; }

private:
  static constexpr double nan = std::numeric_limits<double>::quiet_NaN();

  void add(double v) {
    const bool known = std::isfinite(v);
    if (known) {
      ++n_;
      sum_ += v;
      squares_ += v * v;
    }
    if (known && std::isfinite(last_)) {
      ++pairs_;
      products_ += last_ * v;
      both_ += last_ + v;
    }
    last_ = v;
  }

  void add_known(std::span<const double> z) {
    if (z.empty()) return;
    add(z.front());
    const auto sums = sums_in_lanes<3>(z.size() - 1, [&](std::size_t i) {
      return std::array{z[i + 1], z[i + 1] * z[i + 1], z[i] * z[i + 1]};
    });
    n_ += z.size() - 1, pairs_ += z.size() - 1;
    sum_ += sums[0], squares_ += sums[1], products_ += sums[2];
    both_ += 2.0 * sums[0] + z.front() - z.back();
  }

  double sum_ = 0.0, squares_ = 0.0, products_ = 0.0, both_ = 0.0, last_ = nan;
  std::size_t n_ = 0, pairs_ = 0;
};

constexpr std::size_t most_orders = 4; // of differences: 0 to 3

// The autocorrelations of the series without the parabola, and of its differences up to an order,
// in one pass.
GOINGRATE_PER_PROCESSOR("avx2")
std::array<Autocorrelation, most_orders>
autocorrelations(const Series& series, const Parabola& parabola, std::size_t highest_order) {
  constexpr std::size_t block = 1024; // two of them stay in the first-level cache
  const bool whole = parabola.known == series.count;
  std::array<Autocorrelation, most_orders> found;
  std::array<std::array<double, block + 1>, 2> buffers; // [0] of each is the one before the block
  double *values = buffers[0].data(), *differences = buffers[1].data();
  for (std::size_t begin = 0; begin < series.count; begin += block) {
    const std::size_t count = std::min(block, series.count - begin);
    for (std::size_t i = 0; i < count; ++i)
      values[i + 1] = series.value(begin + i) - parabola.at(series.place(begin + i));
    std::size_t first = 1; // of the whole series there are fewer differences than values
    for (std::size_t d = 0; d <= highest_order; ++d) {
      values[0] = found[d].last();
      found[d].add({values + first, count + 1 - first}, whole);
      if (begin == 0) ++first;
      for (std::size_t i = 1; i <= count; ++i)
        differences[i] = values[i] - values[i - 1];
      std::swap(values, differences);
    }
  }
  return found;
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
  if (most_differences >= most_orders)
    throw ArgumentError("most_differences", static_cast<double>(most_differences), "at most 3");
  const Series series{phase, m};
  const Parabola parabola = parabola_through(series);
  NoiseType noise;
  noise.points = parabola.known;
  if (noise.points < least_points_for_noise_type) return noise;
  const auto found = autocorrelations(series, parabola, most_differences);
  for (std::size_t d = 0;; ++d) {
    const Lag1 lag1 = found[d].result();
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
  }
}

namespace {

// Means over windows of a long series, from its sums up to every `cell`-th phase.
class CoarseSums {
public:
  CoarseSums(std::span<const double> phase, std::size_t cell) : phase_(phase), cell_(cell) {
    sums_.reserve(phase.size() / cell + 1);
    sums_.emplace_back();
    for (std::size_t i = cell; i <= phase.size(); i += cell)
      sums_.push_back(plus(sums_.back(), i - cell, i));
  }

  // Of the m phases from number i on; NaN if fewer than half of them are known.
  [[nodiscard]] double mean(std::size_t i, std::size_t m) const {
    const Sum begin = before(i), end = before(i + m);
    const std::size_t known = end.known - begin.known;
    if (2 * known < m) return std::numeric_limits<double>::quiet_NaN();
    return ((end.value.hi - begin.value.hi) + (end.value.lo - begin.value.lo)) /
           static_cast<double>(known);
  }

private:
  struct Sum { // of those that are known
    TwoPart<double> value{};
    std::size_t known = 0;
  };
  [[nodiscard]] Sum before(std::size_t i) const { return plus(sums_[i / cell_], i - i % cell_, i); }
  [[nodiscard]] Sum plus(Sum sum, std::size_t from, std::size_t to) const {
    double part = 0.0;
    for (std::size_t i = from; i < to; ++i) {
      const bool known = !std::isnan(phase_[i]);
      part += known ? phase_[i] : 0.0;
      sum.known += known ? 1 : 0;
    }
    sum.value += part;
    return sum;
  }

  std::span<const double> phase_;
  std::size_t cell_;
  std::vector<Sum> sums_;
};

// 2 or 1: which phase noise MVAR/AVAR speaks for.
int alpha_of_phase_noise(std::span<const double> phase, std::size_t m) {
  if (m == 1) return 2;
  // Differences that start a 16th of m apart hold as much information as all.
  const std::size_t step = std::max<std::size_t>(1, m / 16);
  const CoarseSums sums(phase, std::max<std::size_t>(1, step / 4));
  double modified = 0.0, plain = 0.0;
  std::size_t modified_count = 0, plain_count = 0;
  for (std::size_t i = 0; i + 2 * m < phase.size(); i += step) {
    const double bend = (phase[i + 2 * m] - phase[i + m]) - (phase[i + m] - phase[i]);
    if (!std::isnan(bend)) plain += bend * bend, ++plain_count;
    if (i + 3 * m > phase.size()) continue;
    const double middle = sums.mean(i + m, m);
    const double of_means = (sums.mean(i + 2 * m, m) - middle) - (middle - sums.mean(i, m));
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

} // namespace

NoiseType identify_noise_by_ratio(std::span<const double> phase, std::size_t m) {
  if (m == 0) throw ArgumentError("m", 0.0, "1 or more");
  const std::vector<double> thinned = m == 1 ? std::vector<double>{} : every_mth(phase, m);
  const std::span<const double> z = m == 1 ? phase : std::span<const double>(thinned);
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
  if (noise.alpha == 1) noise.alpha = alpha_of_phase_noise(phase, m);
  noise.exponent = noise.alpha;
  noise.identified = true;
  return noise;
}

} // namespace goingrate
