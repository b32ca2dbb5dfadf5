#include "push_shapes.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

namespace goingrate::push_shapes {

namespace {

// u and U of impulse_cycle.hpp, as functions of m from 1 to n.
double tooth(double m, double n) { return (0.5 * (n + 1.0) - m) / n; }
double hump(double m, double n) { return 0.5 * m * (n - m) / n - (n * n - 1.0) / (12.0 * n); }

// The shape of the crossing in the middle of a push that runs through the vertical, minus its mean.
double middle(double m, double n) { return (m == n ? 1.0 : 0.0) - 1.0 / n; }

constexpr std::array<Shape, 2> no_hump{tooth_shape, middle_shape};
constexpr Sought tooth_alone = Sought(every_shape).first(1),
                 tooth_and_hump = Sought(every_shape).first(2);

// Least squares of shapes.
struct LeastSquares {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Shapes right = Shapes::Zero();

  void add(const Shapes& shapes, double value) {
    normal += shapes * shapes.transpose();
    right += value * shapes;
  }
  // Shapes that are not looked for keep their places in the equations, with a result of 0.
  [[nodiscard]] Shapes solved(Sought sought) const {
    Eigen::Matrix3d left = Eigen::Matrix3d::Identity();
    Shapes known = Shapes::Zero();
    for (const auto k : sought) {
      const auto row = static_cast<Eigen::Index>(k);
      known(row) = right(row);
      for (const auto l : sought)
        left(row, static_cast<Eigen::Index>(l)) = normal(row, static_cast<Eigen::Index>(l));
    }
    return left.ldlt().solve(known);
  }
};

} // namespace

namespace {

// Values with short gaps bridged by straight lines.
Grid bridged(Grid values) {
  constexpr std::size_t longest_gap = 3; // cycles: short beside what bends the course
  std::size_t last = 0;                  // known
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) continue;
    const std::size_t gap = i - last - 1;
    for (std::size_t k = 1; k <= gap && gap <= longest_gap; ++k)
      values[last + k] =
          std::lerp(values[last], values[i], static_cast<double>(k) / static_cast<double>(gap + 1));
    last = i;
  }
  return values;
}

// The values minus the mean of the n around each, where all of these are known.
Grid less_mean_around(const Grid& values, std::size_t n) {
  std::vector<double> sums{0.0};
  std::vector<std::size_t> holes{0};
  for (const double v : values) {
    sums.push_back(sums.back() + (std::isfinite(v) ? v : 0.0));
    holes.push_back(holes.back() + (std::isfinite(v) ? 0 : 1));
  }
  const std::size_t half = n / 2;
  const bool even = n % 2 == 0;
  Grid left(values.size(), not_known);
  for (std::size_t i = half; i + half < values.size(); ++i) {
    const std::size_t from = i - half, to = i + half + 1;
    if (holes[to] != holes[from]) continue;
    const double outer = even ? 0.5 * (values[from] + values[to - 1]) : 0.0;
    left[i] = values[i] - (sums[to] - sums[from] - outer) / static_cast<double>(n);
  }
  return left;
}

} // namespace

// What the first mean leaves of a bent course drifts, and would fold into a tooth; the second takes
// that away.
Grid less_moving_mean(const Grid& values, std::size_t n) {
  Grid left = less_mean_around(less_mean_around(bridged(values), n), n);
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i])) left[i] = not_known;
  return left;
}

Shapes shapes_of(double m, double n) { return {tooth(m, n), hump(m, n), middle(m, n)}; }

Shapes shapes_at(const std::vector<double>& pushes, double periods, double cycle) {
  const auto next = std::lower_bound(pushes.begin(), pushes.end(), cycle);
  double n = periods, m = 0.0;
  if (next == pushes.begin())
    m = std::max(1.0, cycle - (pushes.front() - n));
  else if (next == pushes.end())
    m = std::min(n, cycle - pushes.back());
  else {
    n = *next - *(next - 1);
    m = cycle - *(next - 1);
  }
  return shapes_of(m, n);
}

namespace {

// The mean height, within interval j, of stairs that rise by 1 at each push and fall by 1 in
// `periods` crossings.
double level_of(const std::vector<double>& pushes, double periods, std::size_t j) {
  return static_cast<double>(j) - 0.5 * (pushes[j - 1] + pushes[j] + 1.0) / periods;
}

// The level of these stairs, which wanders as the pushes do: a line through means over many
// intervals.
class Level {
public:
  Level(const std::vector<double>& pushes, double periods) : pushes_(pushes) {
    constexpr std::size_t reach = 4; // intervals either way, over which two lengths even out
    for (std::size_t j = 1; j < pushes.size(); ++j) {
      const std::size_t from = j > reach ? j - reach : 1,
                        to = std::min(pushes.size() - 1, j + reach);
      double sum = 0.0;
      for (std::size_t k = from; k <= to; ++k)
        sum += level_of(pushes, periods, k);
      means_.push_back(sum / static_cast<double>(to - from + 1));
    }
  }
  [[nodiscard]] double at(double cycle, std::size_t j) const {
    if (means_.empty()) return 0.0;
    const std::size_t own = std::clamp<std::size_t>(j, 1, means_.size()) - 1;
    const double middle = 0.5 * (pushes_[own] + pushes_[own + 1] + 1.0);
    const std::size_t next =
        cycle < middle ? (own > 0 ? own - 1 : own) : std::min(own + 1, means_.size() - 1);
    if (next == own) return means_[own];
    const double other = 0.5 * (pushes_[next] + pushes_[next + 1] + 1.0);
    return std::lerp(means_[own], means_[next],
                     std::clamp((cycle - middle) / (other - middle), 0.0, 1.0));
  }

private:
  const std::vector<double>& pushes_;
  std::vector<double> means_; // about each interval
};

} // namespace

std::vector<Shapes> irregular_shapes(const std::vector<double>& pushes, double periods,
                                     std::size_t length) {
  const Level level(pushes, periods);
  std::vector<Shapes> shapes(length);
  std::size_t next = 0; // the push at a crossing or after it
  for (std::size_t i = 0; i < length; ++i) {
    const auto cycle = static_cast<double>(i);
    while (next < pushes.size() && pushes[next] < cycle)
      ++next;
    shapes[i] = shapes_at(pushes, periods, cycle);
    shapes[i](tooth_shape) = static_cast<double>(next) - cycle / periods - level.at(cycle, next);
  }
  return shapes;
}

Sought few_shapes(std::size_t n) { return n == 2 ? tooth_alone : tooth_and_hump; }
Sought most_shapes(std::size_t n) {
  constexpr std::size_t least_swings = 6; // between pushes
  return n < least_swings ? few_shapes(n) : every_shape;
}
Sought in_amplitudes(Sought in_times) { return in_times.size() == 3 ? no_hump : tooth_alone; }

std::vector<double> folded_means(const Grid& values, std::size_t n) {
  std::vector<double> sums(n, 0.0), counts(n, 0.0);
  for (std::size_t i = 0; i < values.size(); ++i)
    if (std::isfinite(values[i])) {
      sums[i % n] += values[i];
      counts[i % n] += 1.0;
    }
  for (std::size_t k = 0; k < n; ++k)
    sums[k] /= std::max(counts[k], 1.0);
  return sums;
}

double explained(const std::vector<double>& means, std::size_t first, Sought sought) {
  const std::size_t n = means.size();
  LeastSquares sums;
  for (std::size_t m = 1; m <= n; ++m)
    sums.add(shapes_of(static_cast<double>(m), static_cast<double>(n)), means[(first + m) % n]);
  return sums.solved(sought).dot(sums.right);
}

double explained_by_sine(const std::vector<double>& means) {
  const auto n = static_cast<double>(means.size());
  double cosine = 0.0, sine = 0.0;
  for (std::size_t k = 0; k < means.size(); ++k) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(k) / n;
    cosine += means[k] * std::cos(angle);
    sine += means[k] * std::sin(angle);
  }
  return (cosine * cosine + sine * sine) * (means.size() == 2 ? 1.0 : 2.0) / n;
}

std::vector<double> regular_pushes(std::size_t first, std::size_t n, double last) {
  std::vector<double> at;
  for (auto c = static_cast<double>(first) - static_cast<double>(n);
       c <= last + static_cast<double>(n); c += static_cast<double>(n))
    at.push_back(c);
  return at;
}

namespace {

// Whether values keep their sign from one eighth of the log to the next. Pushes with a different
// interval slip, and their saw-tooth comes and goes: a slip by a fifth of the interval cancels it.
// Pushes that become stronger or weaker are still pushes.
bool is_steady(const std::vector<double>& each, double mean) {
  constexpr std::size_t parts = 8, least = 4; // cycles in a part
  constexpr double weakest = 1.0 / 3.0;       // of the mean
  constexpr double chance = 4.0;              // sigma: once in 30,000
  if (each.size() < parts * least) return true;
  for (std::size_t k = 0; k < parts; ++k) {
    const std::vector<double> part(
        each.begin() + static_cast<std::ptrdiff_t>(k * each.size() / parts),
        each.begin() + static_cast<std::ptrdiff_t>((k + 1) * each.size() / parts));
    const ImpulseCycle::Estimate own = mean_of(part);
    if (std::copysign(own.value, own.value * mean) + chance * own.sigma < weakest * std::abs(mean))
      return false;
  }
  return true;
}

// `values` without their slow part; `shape_at(i, j)` gives the shapes at crossing i after push j.
template <class ShapeAt>
std::optional<Coefficients> coefficients(const Grid& values, const std::vector<double>& pushes,
                                         Sought sought, ShapeAt shape_at) {
  std::array<std::vector<double>, 3> each;
  std::vector<std::size_t> begins;
  for (std::size_t j = 1; j < pushes.size(); ++j) {
    if (pushes[j - 1] < -0.5 || pushes[j] > static_cast<double>(values.size()) - 1.0) continue;
    LeastSquares sums;
    const auto from = static_cast<std::size_t>(pushes[j - 1]) + 1,
               to = static_cast<std::size_t>(pushes[j]);
    for (std::size_t i = from; i <= to; ++i)
      sums.add(shape_at(i, j - 1), values[i]);
    if (!std::isfinite(sums.right(0)) || !(sums.normal(0, 0) > 0.0)) continue; // a beat is missing
    const Shapes found = sums.solved(sought);
    if (!found.allFinite()) continue;
    for (const auto k : sought)
      each[k].push_back(found(static_cast<Eigen::Index>(k)));
    begins.push_back(from);
  }
  if (each.front().size() < least_cycles) return {};
  Coefficients result;
  result.teeth = each[tooth_shape];
  result.begins = std::move(begins);
  result.cycles = static_cast<double>(each.front().size());
  for (const auto k : sought) {
    result.of[k] = mean_of(each[k]);
    result.steady = result.steady && is_steady(each[k], result.of[k].value);
  }
  return result;
}

} // namespace

ImpulseCycle::Estimate mean_of(const std::vector<double>& each) {
  const auto count = static_cast<double>(each.size());
  const double mean = std::accumulate(each.begin(), each.end(), 0.0) / count;
  double squares = 0.0, neighbours = 0.0;
  for (std::size_t i = 0; i < each.size(); ++i) {
    squares += std::pow(each[i] - mean, 2);
    if (i > 0) neighbours += (each[i] - mean) * (each[i - 1] - mean);
  }
  const double all = std::max(squares, squares + 2.0 * neighbours);
  return {mean, std::sqrt(all / (count - 1.0) / count)};
}

// Their shapes have no slow part.
std::optional<Coefficients> regular_coefficients(const Grid& values,
                                                 const std::vector<double>& pushes, std::size_t n,
                                                 Sought sought) {
  std::vector<Shapes> shapes;
  for (std::size_t m = 1; m <= n; ++m)
    shapes.push_back(shapes_of(static_cast<double>(m), static_cast<double>(n)));
  return coefficients(values, pushes, sought, [&](std::size_t i, std::size_t j) {
    return shapes[i - static_cast<std::size_t>(pushes[j]) - 1];
  });
}

std::optional<Coefficients> irregular_coefficients(const Grid& values,
                                                   const std::vector<double>& pushes,
                                                   double periods, Sought sought) {
  const std::vector<Shapes> shapes = irregular_shapes(pushes, periods, values.size());
  const auto n = static_cast<std::size_t>(std::lround(periods));
  std::array<Grid, 3> less_slow;
  for (std::size_t k = 0; k < 3; ++k) {
    Grid shape(values.size());
    for (std::size_t i = 0; i < values.size(); ++i)
      shape[i] = shapes[i](static_cast<Eigen::Index>(k));
    less_slow[k] = less_moving_mean(shape, n);
  }
  return coefficients(less_moving_mean(values, n), pushes, sought,
                      [&](std::size_t i, std::size_t) -> Shapes {
                        return {less_slow[0][i], less_slow[1][i], less_slow[2][i]};
                      });
}

ImpulseCycle::Estimate kick_alone(const ImpulseCycle& pushes) {
  const double tooth = pushes.kick.value;
  const double hump = std::max(0.0, pushes.lateness.value / height_of_hump(pushes.periods));
  // Share of a period from the vertical to the push: 0.6 rad of phase, within which clocks are
  // pushed. If the middle crossing alone is off, the period of the push remains open.
  const double share = pushes.middle.value != 0.0 ? 1.0 : 0.1;
  return {tooth - std::clamp(tooth, -hump, 0.0), std::hypot(pushes.kick.sigma, share * hump)};
}

} // namespace goingrate::push_shapes
