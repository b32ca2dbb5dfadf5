#include "goingrate/fit/impulse_cycle.hpp"

#include "base/robust.hpp"
#include "goingrate/fit/timing_data.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>
#include <utility>

namespace goingrate {

namespace {

using std::numbers::pi;

constexpr std::size_t longest_cycle = 60;        // periods between pushes
constexpr double least_gain = 18.0;              // 2 log L, after the price
constexpr std::size_t least_cycles = 8;          // enough to tell a scatter from
constexpr std::size_t searched_cycles = 200'000; // of a log at most: enough to see a push
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

// One value per cycle, NaN where there is none.
using Grid = std::vector<double>;

Grid on_cycles(const TimingData& data, const std::vector<double>& values, std::size_t most) {
  const auto length = std::min(most, static_cast<std::size_t>(std::llround(data.cycle.back())) + 1);
  Grid grid(length, unknown);
  for (std::size_t i = 0; i < data.size(); ++i) {
    const auto at = static_cast<std::size_t>(std::llround(data.cycle[i]));
    if (at < length) grid[at] = values[i];
  }
  return grid;
}

// Values less the mean of the `n` around each (of n + 1, the outer ones by half, if n is even):
// what wanders slowly goes, and what repeats every n stays whole, less its mean.
Grid less_moving_mean(const Grid& values, std::size_t n) {
  std::vector<double> sums{0.0};
  std::vector<std::size_t> holes{0};
  for (const double v : values) {
    sums.push_back(sums.back() + (std::isfinite(v) ? v : 0.0));
    holes.push_back(holes.back() + (std::isfinite(v) ? 0 : 1));
  }
  const std::size_t half = n / 2;
  const bool even = n % 2 == 0;
  Grid left(values.size(), unknown);
  for (std::size_t i = half; i + half < values.size(); ++i) {
    const std::size_t from = i - half, to = i + half + 1;
    if (holes[to] != holes[from]) continue;
    const double outer = even ? 0.5 * (values[from] + values[to - 1]) : 0.0;
    left[i] = values[i] - (sums[to] - sums[from] - outer) / static_cast<double>(n);
  }
  return left;
}

// u and U of the header, as functions of m from 1 to n.
double tooth(double m, double n) { return (0.5 * (n + 1.0) - m) / n; }
double hump(double m, double n) { return 0.5 * m * (n - m) / n - (n * n - 1.0) / (12.0 * n); }

double height_of_hump(double n) { return n / 8.0; } // above a push, at m = n/2

// The mean of each of the n values of a cycle.
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

// The crossing in the middle of a push that runs through the vertical, less its mean.
double middle(double m, double n) { return (m == n ? 1.0 : 0.0) - 1.0 / n; }

// The three shapes at one crossing, or how much there is of each.
using Shapes = Eigen::Vector3d;
enum Shape : std::size_t { tooth_shape, hump_shape, middle_shape };
Shapes shapes_of(double m, double n) { return {tooth(m, n), hump(m, n), middle(m, n)}; }

// Which of them are sought.
using Sought = std::span<const Shape>;
constexpr std::array<Shape, 3> in_order{tooth_shape, hump_shape, middle_shape};
constexpr std::array<Shape, 2> no_hump{tooth_shape, middle_shape}; // an amplitude has none
constexpr Sought tooth_alone = Sought(in_order).first(1),
                 tooth_and_hump = Sought(in_order).first(2), every_shape = in_order;
// Two swings can have only one pattern; in a few more, the three shapes are hardly distinct.
Sought few_shapes(std::size_t n) { return n == 2 ? tooth_alone : tooth_and_hump; }
Sought most_shapes(std::size_t n) {
  constexpr std::size_t least_swings = 6; // between pushes
  return n < least_swings ? few_shapes(n) : every_shape;
}
Sought in_amplitudes(Sought in_times) { return in_times.size() == 3 ? no_hump : tooth_alone; }

// Least squares of shapes.
struct LeastSquares {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Shapes right = Shapes::Zero();

  void add(const Shapes& shapes, double value) {
    normal += shapes * shapes.transpose();
    right += value * shapes;
  }
  // Shapes that are not sought have their places in the equations, and nothing to do there.
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

// What the shapes, begun at place `first` of the cycle, explain of folded means: the sum of
// squares.
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
    const double angle = 2.0 * pi * static_cast<double>(k) / n;
    cosine += means[k] * std::cos(angle);
    sine += means[k] * std::sin(angle);
  }
  return (cosine * cosine + sine * sine) * (means.size() == 2 ? 1.0 : 2.0) / n;
}

// Where pushes come: regular or one by one.
std::vector<double> regular_pushes(std::size_t first, std::size_t n, double last) {
  std::vector<double> at;
  for (auto c = static_cast<double>(first) - static_cast<double>(n);
       c <= last + static_cast<double>(n); c += static_cast<double>(n))
    at.push_back(c);
  return at;
}

// The shapes at one crossing. Before the first push and after the last the interval counts as
// usual.
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

// A mean and its standard deviation. Neighbouring cycles share the values that their slow part was
// taken from, and what wanders moves both.
ImpulseCycle::Estimate mean_of(const std::vector<double>& each) {
  const auto count = static_cast<double>(each.size());
  const double mean = std::accumulate(each.begin(), each.end(), 0.0) / count;
  double squares = 0.0, neighbours = 0.0;
  for (std::size_t i = 0; i < each.size(); ++i) {
    squares += std::pow(each[i] - mean, 2);
    if (i > 0) neighbours += (each[i] - mean) * (each[i - 1] - mean);
  }
  const double all = std::max(squares + 2.0 * neighbours, 0.25 * squares);
  return {mean, std::sqrt(all / (count - 1.0) / count)};
}

// Whether values keep their sign from one eighth of the log to the next. Pushes that come at any
// other interval slip, and their saw-tooth comes and goes: a slip by a fifth of the interval leaves
// nothing of it. Pushes that grow or weaken on the way are still pushes.
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

// Coefficients of the shapes with standard deviations from their scatter from cycle to cycle, which
// contains whatever noise there is.
struct Coefficients {
  std::array<ImpulseCycle::Estimate, 3> of{{{0.0, 0.0}, {0.0, 0.0}, {0.0, 0.0}}};
  std::vector<double> teeth{};       // of each interval that is whole
  std::vector<std::size_t> begins{}; // the crossing after the push with which that interval begins
  double cycles = 0.0;
  bool steady = true;
  [[nodiscard]] const ImpulseCycle::Estimate& operator[](Shape shape) const { return of[shape]; }
  // In 2 log L, with the scatter from the same cycles: if they are few, they may agree by chance.
  [[nodiscard]] double gain(Shape shape) const {
    const auto& [value, sigma] = of[shape];
    if (!(sigma > 0.0)) return 0.0;
    return cycles * std::log1p(std::pow(value / sigma, 2) / (cycles - 1.0));
  }
  [[nodiscard]] double gain() const {
    return gain(tooth_shape) + gain(hump_shape) + gain(middle_shape);
  }
};

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

// For pushes once in n periods: their shapes have no slow part.
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
                                                   const std::vector<double>& pushes, std::size_t n,
                                                   Sought sought) {
  std::array<Grid, 3> less_slow;
  for (std::size_t k = 0; k < 3; ++k) {
    Grid shape(values.size());
    for (std::size_t i = 0; i < values.size(); ++i)
      shape[i] = shapes_at(pushes, static_cast<double>(n),
                           static_cast<double>(i))(static_cast<Eigen::Index>(k));
    less_slow[k] = less_moving_mean(shape, n);
  }
  return coefficients(less_moving_mean(values, n), pushes, sought,
                      [&](std::size_t i, std::size_t) -> Shapes {
                        return {less_slow[0][i], less_slow[1][i], less_slow[2][i]};
                      });
}

// The data as far as they are known, cycle by cycle.
struct Sight {
  Grid late, amplitude;                           // the second empty where the log has none
  double late_noise = 0.0, amplitude_noise = 0.0; // of one value
};

// The noise of a single value, from second differences.
double noise_of(const Grid& values) {
  std::vector<double> bends;
  for (std::size_t i = 2; i < values.size(); ++i)
    if (const double bend = values[i] - 2.0 * values[i - 1] + values[i - 2]; std::isfinite(bend))
      bends.push_back(bend);
  if (bends.empty()) return 0.0;
  const double rms = std::sqrt(std::inner_product(bends.begin(), bends.end(), bends.begin(), 0.0) /
                               static_cast<double>(bends.size()));
  const double robust = robust_sigma(bends); // 0 where most values are alike, as rounded ones are
  return (robust > 0.0 ? robust : rms) / std::sqrt(6.0);
}

double mean_of_known(std::span<const double> values) {
  double sum = 0.0, known = 0.0;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    sum += value;
    ++known;
  }
  return known > 0.0 ? sum / known : unknown;
}

// The amplitude between the first push that was seen and the last.
struct PushedSwing {
  double mean = unknown;
  double growth = 0.0; ///< from one push to the next, by the first and the last interval
};
PushedSwing swing_between(const Grid& amplitude, const std::vector<double>& pushes) {
  const auto length = static_cast<double>(amplitude.size());
  const auto first = std::lower_bound(pushes.begin(), pushes.end(), 0.0);
  const auto last = std::upper_bound(first, pushes.end(), length - 1.0) - 1;
  const auto from_to = [&](double from, double to) { // crossings after one push up to another
    return mean_of_known(std::span(amplitude).subspan(static_cast<std::size_t>(from) + 1,
                                                      static_cast<std::size_t>(to - from)));
  };
  if (last - first < 2) return {};
  const double growth = (from_to(*(last - 1), *last) - from_to(*first, *(first + 1))) /
                        static_cast<double>(last - first - 1);
  return {from_to(*first, *last), std::isfinite(growth) ? growth : 0.0};
}

// The first `most` cycles.
Sight seen(const TimingData& data, std::size_t most) {
  Sight sight{on_cycles(data, data.lateness_s, most), {}};
  if (data.has_amplitude()) {
    sight.amplitude = on_cycles(data, data.amplitude_rad, most);
    if (!std::isfinite(mean_of_known(sight.amplitude))) sight.amplitude.clear();
  }
  sight.late_noise = noise_of(sight.late);
  sight.amplitude_noise = noise_of(sight.amplitude);
  return sight;
}

// Friction is the same in every part of the log. Pushes that are regular only for a while leave a
// tooth that comes and goes, and whose mean tells nothing.
bool is_same_in_every_part(const Grid& amplitude, const Coefficients& swing, double periods,
                           const ImpulseCycle::Estimate& epsilon) {
  constexpr std::size_t most_parts = 8, least_cycles_a_part = 8;
  const std::size_t count = swing.teeth.size();
  const std::size_t parts = std::min(most_parts, count / least_cycles_a_part);
  if (parts < 2) return true;
  const auto n = static_cast<std::size_t>(std::lround(periods));
  const auto level = [&](std::size_t interval) {
    return mean_of_known(std::span(amplitude).subspan(swing.begins[interval], n));
  };
  double squares = 0.0;
  for (std::size_t k = 0; k < parts; ++k) {
    const std::size_t from = k * count / parts, to = (k + 1) * count / parts;
    const ImpulseCycle::Estimate step =
        mean_of({swing.teeth.begin() + static_cast<std::ptrdiff_t>(from),
                 swing.teeth.begin() + static_cast<std::ptrdiff_t>(to)});
    const double first = level(from), last = level(to - 1);
    const double growth = (last - first) / static_cast<double>(to - from - 1);
    const double scale = 2.0 * pi * periods * 0.5 * (first + last);
    const double sigma = std::max(step.sigma / scale, epsilon.sigma); // at least that of all
    squares += std::pow(((step.value - growth) / scale - epsilon.value) / sigma, 2);
  }
  const double freedom = static_cast<double>(parts - 1);
  constexpr double beyond_chance = 1e-3;
  return boost::math::cdf(complement(boost::math::chi_squared(freedom), squares)) > beyond_chance;
}

// Pushes that may be, and how much of the squares of times and amplitudes they explain, in units of
// their noise, in the mean of a cycle: what decides between one number of swings and another.
struct Candidate {
  ImpulseCycle pushes;
  double squares = 0.0;
};

double squares_of(const Coefficients& found, double noise, const std::vector<double>& pushes,
                  double periods, std::size_t length) {
  if (!(noise > 0.0)) return 0.0;
  const Shapes all{found.of[0].value, found.of[1].value, found.of[2].value};
  double sum = 0.0;
  for (std::size_t i = 0; i < length; ++i) {
    const Shapes at = shapes_at(pushes, periods, static_cast<double>(i));
    sum += std::pow(all.dot(at) / noise, 2);
  }
  return sum / static_cast<double>(length);
}

// How much more than 2 pi epsilon the logarithm of the amplitude A loses in a period: the action
// A^2/2 (1 - 5 A^2/96) falls as exp(-2 epsilon t), and a period takes 1 + A^2/16 of T0.
double faster_at(double amplitude) { return 1.0 + 11.0 / 96.0 * amplitude * amplitude; }

// What is lost between two pushes is in proportion to the amplitude, whatever a push gives.
std::optional<ImpulseCycle::Estimate> friction_of_teeth(const Grid& amplitude,
                                                        const std::vector<double>& pushes,
                                                        double periods, const Coefficients& swing) {
  const auto& step = swing[tooth_shape];
  const PushedSwing seen = swing_between(amplitude, pushes);
  const double loss = 2.0 * pi * periods * seen.mean * faster_at(seen.mean);
  const ImpulseCycle::Estimate epsilon{(step.value - seen.growth) / loss, step.sigma / loss};
  if (!is_same_in_every_part(amplitude, swing, periods, epsilon)) return {};
  return epsilon;
}

// Between pushes that are each seen the swing is free: the slope of the logarithm of its amplitude.
std::optional<ImpulseCycle::Estimate> friction_between(const Grid& amplitude,
                                                       const std::vector<double>& pushes) {
  std::vector<double> each;
  for (std::size_t j = 1; j < pushes.size(); ++j) {
    const auto from = static_cast<std::size_t>(std::max(0.0, pushes[j - 1] + 1.0));
    const auto to = std::min(amplitude.size(), static_cast<std::size_t>(std::max(0.0, pushes[j])));
    if (to < from + 2) continue;
    const double middle = 0.5 * static_cast<double>(from + to - 1);
    double up = 0.0, squares = 0.0;
    for (std::size_t i = from; i < to; ++i) {
      const double away = static_cast<double>(i) - middle;
      up += away * std::log(amplitude[i]);
      squares += away * away;
    }
    if (std::isfinite(up))
      each.push_back(-up / squares / (2.0 * pi * faster_at(amplitude[(from + to) / 2])));
  }
  if (each.size() < least_cycles) return {};
  const ImpulseCycle::Estimate mean = mean_of(each);
  if (!(mean.sigma > 0.0)) return {}; // equal to the last digit: rounded values
  return mean;
}

ImpulseCycle described(const std::vector<double>& pushes, double periods, const Coefficients& late,
                       const std::optional<Coefficients>& swing, double price) {
  ImpulseCycle found{periods, true, 0.0, *std::lower_bound(pushes.begin(), pushes.end(), 0.0)};
  const auto& hump = late[hump_shape];
  found.lateness = {hump.value * height_of_hump(periods), hump.sigma * height_of_hump(periods)};
  found.kick = late[tooth_shape];
  found.middle = late[middle_shape];
  found.gain = late.gain() - price;
  if (!swing) return found;
  const auto& step = (*swing)[tooth_shape];
  found.gain += swing->gain();
  found.amplitude_step = step;
  found.amplitude_middle = (*swing)[middle_shape].value;
  return found;
}

// Pushes once in n periods, wherever they begin.
class RegularSearch {
public:
  RegularSearch(const Sight& sight, std::size_t n, double price)
      : sight_(sight), n_(n), price_(price), times_(less_moving_mean(sight.late, n)),
        amplitudes_(less_moving_mean(sight.amplitude, n)), late_(folded_means(times_, n)),
        swing_(folded_means(amplitudes_, n)) {}

  // The best place. A tooth begun one swing early or late and a crossing that is off between make
  // the same pattern: the third shape is asked for only where the pattern is more than a tooth and
  // a hump, the crossing being that before the push or that after it, or where these show nothing.
  [[nodiscard]] std::optional<Candidate> best() const {
    const Sought all = most_shapes(n_), few = few_shapes(n_);
    const std::size_t place = best_place(few), next = (place + 1) % n_;
    auto plain = candidate(place, few);
    if (all.size() == few.size()) return plain;
    const bool shows = plain && plain->pushes.gain > least_gain;
    const std::size_t whole_at = !shows                                 ? best_place(all)
                                 : score(next, all) > score(place, all) ? next
                                                                        : place;
    const double more = (score(whole_at, all) - score(place, few)) *
                        static_cast<double>(sight_.late.size()); // of chi^2
    if (!(more > least_gain)) return plain;
    auto whole = candidate(whole_at, all);
    if (!whole) return plain;
    whole->pushes.gain += shows ? plain->pushes.gain : -price_;
    return whole;
  }

  // What a sine of n periods explains.
  [[nodiscard]] double sine() const {
    constexpr std::size_t shapeless = 3; // periods: any pattern of so few is a sine
    if (n_ <= shapeless) return 0.0;
    return in_noise(explained_by_sine(late_), has_swing() ? explained_by_sine(swing_) : 0.0);
  }

private:
  [[nodiscard]] bool has_swing() const { return !sight_.amplitude.empty(); }
  [[nodiscard]] double in_noise(double late, double swing) const {
    const auto over = [](double squares, double noise) {
      return noise > 0.0 ? squares / (noise * noise) : 0.0;
    };
    return (over(late, sight_.late_noise) + over(swing, sight_.amplitude_noise)) /
           static_cast<double>(n_);
  }
  [[nodiscard]] double score(std::size_t first, Sought sought) const {
    return in_noise(explained(late_, first, sought),
                    has_swing() ? explained(swing_, first, in_amplitudes(sought)) : 0.0);
  }
  [[nodiscard]] std::size_t best_place(Sought sought) const {
    std::size_t best = 0;
    for (std::size_t first = 1; first < n_; ++first)
      if (score(first, sought) > score(best, sought)) best = first;
    return best;
  }

  // A candidate with three shapes needs the third to show.
  [[nodiscard]] std::optional<Candidate> candidate(std::size_t first, Sought sought) const {
    const bool is_whole = sought.size() == every_shape.size();
    const auto pushes = regular_pushes(first, n_, static_cast<double>(sight_.late.size()));
    const auto late = regular_coefficients(times_, pushes, n_, sought);
    const auto swing = has_swing()
                           ? regular_coefficients(amplitudes_, pushes, n_, in_amplitudes(sought))
                           : std::nullopt;
    if (!late || !late->steady) return {};
    if (has_swing() && (!swing || !swing->steady)) return {};
    const double middle = late->gain(middle_shape) + (swing ? swing->gain(middle_shape) : 0.0);
    if (is_whole && !(middle > least_gain)) return {};
    // A push raises the swing, or comes through the vertical and makes that crossing early; a weak
    // tooth of a wheel does neither.
    const bool early = is_whole && (*late)[middle_shape].value < 0.0;
    const double raised = has_swing()         ? (*swing)[tooth_shape].value
                          : sought.size() > 1 ? (*late)[hump_shape].value
                                              : std::abs((*late)[tooth_shape].value);
    if (!(raised > 0.0) && (has_swing() || !early)) return {};
    Candidate found{described(pushes, static_cast<double>(n_), *late, swing, price_),
                    score(first, sought)};
    if (has_swing() && swing->gain(tooth_shape) > least_gain)
      found.pushes.epsilon =
          friction_of_teeth(sight_.amplitude, pushes, static_cast<double>(n_), *swing);
    if (is_whole) found.pushes.gain = middle; // the others share in it
    return found;
  }

  const Sight& sight_;
  std::size_t n_;
  double price_;
  Grid times_, amplitudes_;          // less what wanders
  std::vector<double> late_, swing_; // the same, folded
};

// Pushes that each stand out of the amplitudes.
std::optional<Candidate> visible_pushes(const Sight& sight, double price) {
  constexpr double least_height = 12.0; // sigma of a difference
  const Grid& a = sight.amplitude;
  std::vector<double> steps, known;
  for (std::size_t i = 1; i < a.size(); ++i) {
    steps.push_back(a[i] - a[i - 1]);
    if (std::isfinite(steps.back())) known.push_back(steps.back());
  }
  if (known.size() < longest_cycle) return {};
  const double middle = median(known), sigma = robust_sigma(known); // which changes `known`
  std::vector<double> heights;
  for (const double step : steps)
    if (step - middle > least_height * sigma) heights.push_back(step - middle);
  if (heights.size() < least_cycles) return {};
  const double threshold = 0.5 * median(heights);
  std::vector<double> pushes;
  std::size_t falls = 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (steps[i] - middle > threshold) pushes.push_back(static_cast<double>(i));
    falls += middle - steps[i] > threshold ? 1 : 0;
  }
  if (20 * falls > pushes.size()) return {}; // pushes do not go both up and down
  std::vector<double> intervals;
  for (std::size_t j = 1; j < pushes.size(); ++j)
    intervals.push_back(pushes[j] - pushes[j - 1]);
  const double usual = std::round(median(intervals));
  const bool is_regular = std::all_of(intervals.begin(), intervals.end(), [&](double interval) {
    return std::fmod(interval, usual) == 0.0; // some may not have been seen
  });
  if (is_regular && usual <= static_cast<double>(longest_cycle)) return {}; // sought as such
  const double mean = (pushes.back() - pushes.front()) / static_cast<double>(intervals.size());
  const double periods = is_regular ? usual : mean;
  constexpr double least_steady = 0.5; // intervals that vary more are knocks or a hand
  if (periods < 2.0 || robust_sigma(intervals) > least_steady * periods) return {};
  const auto n = static_cast<std::size_t>(std::lround(periods));
  const auto times = irregular_coefficients(sight.late, pushes, n, most_shapes(n));
  const auto swings =
      irregular_coefficients(sight.amplitude, pushes, n, in_amplitudes(most_shapes(n)));
  if (!times || !swings) return {};
  Candidate found{
      described(pushes, periods, *times, swings, price),
      squares_of(*times, sight.late_noise, pushes, periods, sight.late.size()) +
          squares_of(*swings, sight.amplitude_noise, pushes, periods, sight.amplitude.size())};
  found.pushes.epsilon = friction_between(sight.amplitude, pushes);
  found.pushes.is_regular = is_regular;
  found.pushes.cycles = std::move(pushes);
  return found;
}

std::vector<double> pushes_of(const ImpulseCycle& found, double last) {
  if (!found.is_regular) return found.cycles;
  return regular_pushes(static_cast<std::size_t>(found.first),
                        static_cast<std::size_t>(found.periods), last);
}

} // namespace

std::optional<ImpulseCycle> find_impulse_cycle(const TimingData& data) {
  const Sight sight = seen(data, searched_cycles);
  if (sight.late.size() < least_cycles * 4) return {};
  const double places = 0.5 * static_cast<double>(longest_cycle * (longest_cycle + 1)) - 1.0;
  const double price = 2.0 * std::log(places);
  std::optional<Candidate> best;
  double sine = 0.0;
  const auto take = [&](std::optional<Candidate> candidate) {
    if (candidate && candidate->pushes.gain > least_gain &&
        (!best || candidate->squares > best->squares))
      best = std::move(candidate);
  };
  for (std::size_t n = 2; n <= longest_cycle && n * least_cycles <= sight.late.size(); ++n) {
    const RegularSearch search(sight, n, price);
    sine = std::max(sine, search.sine()); // more than any pushes: something goes round
    take(search.best());
  }
  if (!sight.amplitude.empty()) take(visible_pushes(sight, price));
  if (!best || best->squares < sine) return {};
  if (!best->pushes.cycles.empty() && sight.late.size() == searched_cycles) // each one, to the end
    best = visible_pushes(seen(data, std::numeric_limits<std::size_t>::max()), price);
  if (!best) return {};
  return std::move(best->pushes);
}

void level_impulses(const ImpulseCycle& found, TimingData& data) {
  const auto pushes = pushes_of(found, data.cycle.back());
  const double hump = found.lateness.value / height_of_hump(found.periods);
  for (std::size_t i = 0; i < data.size(); ++i) {
    const Shapes at = shapes_at(pushes, found.periods, data.cycle[i]);
    data.lateness_s[i] -= Shapes(found.kick.value, hump, found.middle.value).dot(at);
    if (found.amplitude_step)
      data.amplitude_rad[i] -=
          Shapes(found.amplitude_step->value, 0.0, found.amplitude_middle).dot(at);
  }
}

} // namespace goingrate
