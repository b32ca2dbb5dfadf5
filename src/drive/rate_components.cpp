#include "rate_components.hpp"

#include "base/scaled_time.hpp"
#include "base/special_values.hpp"
#include "goingrate/spectra/spectrum.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <boost/math/tools/roots.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace goingrate::timing_model {

namespace {

// sin^2(pi f T), on which both shapes depend.
double sine2(double hz, double period_s) {
  const double s = std::sin(std::numbers::pi * hz * period_s);
  return s * s;
}

double jitter_shape(double sine2, double period_s) { return 8.0 * sine2 / period_s; }

// The density of a slow drive divided by that of a white one of the same variance.
class MemoryShape {
public:
  MemoryShape(double period_s, double memory_s)
      : r_(std::exp(-period_s / memory_s)), left_(-std::expm1(-period_s / memory_s)) {}
  [[nodiscard]] double at(double sine2) const { // 1 - 2 r cos + r^2 without cancellation
    return left_ * (1.0 + r_) / (left_ * left_ + 4.0 * r_ * sine2);
  }

private:
  double r_, left_; // 1 - r
};

} // namespace

double RateComponents::fast_density(double hz, double period_s,
                                    const DriveResponse& response) const {
  return std::norm(response.at(hz)) * 2.0 * period_s * fast2;
}

double RateComponents::slow_density(double hz, double period_s,
                                    const DriveResponse& response) const {
  if (slow2 == 0.0) return 0.0;
  return std::norm(response.at(hz)) * 2.0 * period_s * slow2 *
         MemoryShape(period_s, memory_s).at(sine2(hz, period_s));
}

double RateComponents::jitter_density(double hz, double period_s) const {
  return jitter2 * jitter_shape(sine2(hz, period_s), period_s);
}

ComponentFit::ComponentFit(std::span<const double> rates, double period_s,
                           const DriveResponse& response)
    : period_s_(period_s), response_(response), size_(rates.size()) {
  gather(rates);
  double power = 0.0;
  std::array<double, 3> shape{};
  const auto shapes_of_bins = shapes(period_s_ * std::sqrt(static_cast<double>(size_)));
  for (std::size_t b = 0; b < bins_.size(); ++b) {
    power += bins_[b].count * bins_[b].power;
    for (std::size_t i = 0; i < 3; ++i)
      shape[i] += bins_[b].count * shapes_of_bins[b][i];
  }
  for (std::size_t i = 0; i < 3; ++i)
    all_[i] = power / shape[i];
  constexpr int rounds = 3; // the smearing, a small correction, depends on the fit
  for (int round = 0; round < rounds; ++round) {
    const Place place = lowest_over_memory({});
    best_ = place.at;
    best_value_ = place.value;
    if (round + 1 < rounds) smear();
  }
  const Place without = lowest(best_.memory_s, {1, 0.0});
  without_slow_ = without.value;
  if (without_slow_ < best_value_) { // only by rounding
    best_ = without.at;
    best_value_ = without_slow_;
  }
}

void ComponentFit::gather(std::span<const double> rates) {
  const double mean =
      std::accumulate(rates.begin(), rates.end(), 0.0) / static_cast<double>(rates.size());
  std::vector<double> x(rates.begin(), rates.end());
  for (double& v : x)
    v -= mean;
  const std::vector<double> square = squared_transform(x, x.size());
  const double scale = 2.0 * period_s_ / static_cast<double>(size_);
  const double spacing = 1.0 / (static_cast<double>(size_) * period_s_);
  constexpr double width = 0.04;           // of the frequency: S changes little over it
  const std::size_t end = (size_ + 1) / 2; // without Nyquist's: half the degrees of freedom
  for (std::size_t k = 1; k < end;) {
    const std::size_t to = std::min(
        end,
        k + std::max<std::size_t>(1, static_cast<std::size_t>(width * static_cast<double>(k))));
    Bin bin{0.0, static_cast<double>(to - k), 0.0, 0.0, 1.0, 0.0};
    bin.frequency_hz = 0.5 * static_cast<double>(k + to - 1) * spacing;
    bin.sine2 = sine2(bin.frequency_hz, period_s_);
    for (std::size_t i = k; i < to; ++i)
      bin.power += square[i] * scale / bin.count;
    bin.response2 = std::norm(response_.at(bin.frequency_hz));
    bins_.push_back(bin);
    k = to;
  }
}

// The expected periodogram of N values: the autocovariance c(n), weighted by 1 - n/N, transformed.
void ComponentFit::smear() {
  const std::size_t n = size_, grid = 2 * n;
  const double spacing = 1.0 / (static_cast<double>(grid) * period_s_);
  std::vector<std::complex<double>> density(grid / 2 + 1);
  for (std::size_t k = 0; k < density.size(); ++k) {
    const double hz = static_cast<double>(k) * spacing;
    density[k] =
        (best_.fast_density(hz, period_s_, response_) +
         best_.slow_density(hz, period_s_, response_) + best_.jitter_density(hz, period_s_)) /
        (2.0 * period_s_);
  }
  std::vector<double> covariance = inverse_real_transform(density, grid);
  covariance.resize(n);
  for (std::size_t i = 0; i < n; ++i)
    covariance[i] *= 1.0 - static_cast<double>(i) / static_cast<double>(n);
  const auto half = real_transform(covariance);
  const auto expected = [&](std::size_t k) {
    return 2.0 * period_s_ * (2.0 * half[k].real() - covariance[0]);
  };
  std::size_t k = 1;
  for (Bin& bin : bins_) {
    double smeared = 0.0, plain = 0.0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(bin.count); ++i, ++k) {
      smeared += expected(k);
      plain += 2.0 * period_s_ * density[2 * k].real();
    }
    bin.smearing = plain > 0.0 && smeared > 0.0 ? smeared / plain : 1.0;
  }
}

std::vector<ComponentFit::Shapes> ComponentFit::shapes(double memory_s) const {
  const MemoryShape memory(period_s_, memory_s);
  std::vector<Shapes> all;
  all.reserve(bins_.size());
  for (const Bin& bin : bins_) {
    const double drive = bin.response2 * 2.0 * period_s_ * bin.smearing;
    all.push_back(
        {drive, drive * memory.at(bin.sine2), jitter_shape(bin.sine2, period_s_) * bin.smearing});
  }
  return all;
}

double ComponentFit::value_at(const RateComponents& at, const std::vector<Shapes>& shapes) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < bins_.size(); ++i) {
    const Shapes& shape = shapes[i];
    const double expected = at.fast2 * shape[0] + at.slow2 * shape[1] + at.jitter2 * shape[2];
    if (!(expected > 0.0)) return std::numeric_limits<double>::infinity();
    sum += bins_[i].count * (std::log(expected) + bins_[i].power / expected);
  }
  return sum;
}

namespace {

// Minimises sum w (p - A v)^2 over those v >= 0 that are free: the best of all subsets whose values
// are all positive.
Eigen::Vector3d nonnegative(const Eigen::Matrix3d& normal, const Eigen::Vector3d& right,
                            const Eigen::Vector3d& given, unsigned free) {
  Eigen::Vector3d best = given;
  double lowest = std::numeric_limits<double>::infinity();
  for (unsigned subset = 0; subset < 8; ++subset) {
    if ((subset & ~free) != 0) continue;
    Eigen::Vector3d v = given;
    std::vector<Eigen::Index> used;
    for (Eigen::Index i = 0; i < 3; ++i) {
      if ((free >> i & 1U) != 0) v[i] = 0.0;
      if ((subset >> i & 1U) != 0) used.push_back(i);
    }
    if (!used.empty()) {
      const Eigen::VectorXd rest = (right - normal * v)(used);
      const Eigen::VectorXd found = normal(used, used).ldlt().solve(rest);
      if (!found.allFinite() || (found.array() <= 0.0).any()) continue;
      v(used) = found;
    }
    const double cost = v.dot(normal * v) - 2.0 * right.dot(v);
    if (cost < lowest) {
      lowest = cost;
      best = v;
    }
  }
  return best;
}

} // namespace

// Fisher scoring: least squares with the weights of the previous round, until L no longer rises.
ComponentFit::Place ComponentFit::lowest(double memory_s, const Held& held) const {
  const std::vector<Shapes> shape = shapes(memory_s);
  Eigen::Vector3d scale = Eigen::Vector3d::Zero(); // of each variance, to keep v near 1
  double power = 0.0;
  for (std::size_t b = 0; b < bins_.size(); ++b) {
    scale += bins_[b].count * Eigen::Map<const Eigen::Vector3d>(shape[b].data());
    power += bins_[b].count * bins_[b].power;
  }
  for (int i = 0; i < 3; ++i)
    scale[i] = power / scale[i];
  Eigen::Vector3d v = Eigen::Vector3d::Constant(1.0 / 3.0);
  unsigned free = 7;
  if (held.which >= 0) {
    v[held.which] = held.variance / scale[held.which];
    free &= ~(1U << held.which);
  }
  for (int i = 0; i < 3; ++i)
    if ((held.absent >> i & 1U) != 0) v[i] = 0.0;
  free &= ~held.absent;
  const auto at = [&](const Eigen::Vector3d& u) {
    return RateComponents{u[0] * scale[0], u[1] * scale[1], u[2] * scale[2], memory_s};
  };
  double value = value_at(at(v), shape);
  constexpr int most_rounds = 60;
  for (int round = 0; round < most_rounds; ++round) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (std::size_t b = 0; b < bins_.size(); ++b) {
      const Eigen::Vector3d a =
          Eigen::Map<const Eigen::Vector3d>(shape[b].data()).cwiseProduct(scale);
      const double expected = a.dot(v);
      const double weight = bins_[b].count / (expected * expected);
      normal += weight * a * a.transpose();
      right += weight * bins_[b].power * a;
    }
    Eigen::Vector3d target = nonnegative(normal, right, v, free);
    double step = 1.0, next = value_at(at(target), shape);
    while (!(next <= value) && step > 1e-4) { // a full step may overshoot where v is far off
      step *= 0.5;
      target = v + step * (target - v);
      next = value_at(at(target), shape);
    }
    if (!(next < value)) break;
    const double gained = value - next;
    v = target;
    value = next;
    if (gained < 1e-7) break;
  }
  return {value, at(v)};
}

// The best memory: a grid, as -log L may have several minima, then Brent. A memory longer than half
// the log cannot be distinguished from drift.
ComponentFit::Place ComponentFit::lowest_over_memory(const Held& held) const {
  const double shortest = std::log(2.0 * period_s_);
  const double longest = std::log(0.5 * static_cast<double>(size_) * period_s_);
  constexpr int steps = 16;
  const auto at = [&](int i) { return shortest + (longest - shortest) * i / (steps - 1.0); };
  int best = 0;
  Place lowest_place{std::numeric_limits<double>::infinity(), {}};
  for (int i = 0; i < steps; ++i) {
    const Place place = lowest(std::exp(at(i)), held);
    if (place.value < lowest_place.value) {
      lowest_place = place;
      best = i;
    }
  }
  const bool no_memory = (held.which == 1 && held.variance == 0.0) || (held.absent >> 1 & 1U) != 0;
  if (no_memory) return lowest_place;
  constexpr int bits = 12; // of log tau
  const auto found = boost::math::tools::brent_find_minima(
      [&](double log_memory) { return lowest(std::exp(log_memory), held).value; },
      at(std::max(0, best - 1)), at(std::min(steps - 1, best + 1)), bits);
  const Place place = lowest(std::exp(found.first), held);
  return place.value < lowest_place.value ? place : lowest_place;
}

double variance_of(const RateComponents& components, Component which) {
  return which == Component::fast   ? components.fast2
         : which == Component::slow ? components.slow2
                                    : components.jitter2;
}

RateComponents ComponentFit::best_for(Component which) const {
  // If z is normal about any z0 >= 0 with unit sigma, replacing it by 0 below 1.18 biases its mean
  // by at most 0.2 in either direction; replacing it by 0 only below 0 biases it by up to 0.4. The
  // threshold is half of 1.18 squared.
  constexpr double evidence_of_jitter = 0.7;
  unsigned absent = 0;
  const auto leave_out = [&](Component part, double least) {
    const unsigned fewer = absent | 1U << static_cast<int>(part);
    if (part != which && lowest_over_memory({.absent = fewer}).value - best_value_ < least)
      absent = fewer;
  };
  leave_out(Component::jitter, evidence_of_jitter);
  leave_out(Component::slow, least_evidence);
  return lowest_over_memory({.absent = absent}).at;
}

std::array<RateComponents, 2> ComponentFit::interval68(Component which) const {
  const int index = static_cast<int>(which);
  const double here = variance_of(best_, which);
  constexpr double interval_rise = 0.5;
  const auto above = [&](double variance) {
    return lowest_over_memory({index, variance}).value - best_value_ - interval_rise;
  };
  const auto crossing = [&](double from, double to) {
    std::uintmax_t most = 30;
    const auto ends = boost::math::tools::toms748_solve(
        above, from, to, boost::math::tools::eps_tolerance<double>(10), // a thousandth
        most);
    return lowest_over_memory({index, 0.5 * (ends.first + ends.second)}).at;
  };
  const bool open_below = here == 0.0 || above(0.0) <= 0.0;
  std::array<RateComponents, 2> ends;
  ends[0] = open_below ? lowest_over_memory({index, 0.0}).at : crossing(0.0, here);
  double inside = here;
  double high = std::max(2.0 * here, 1e-6 * all_[static_cast<std::size_t>(index)]);
  constexpr int doublings = 60;
  for (int i = 0; i < doublings; ++i, inside = high, high *= 2.0)
    if (above(high) > 0.0) {
      ends[1] = crossing(inside, high);
      return ends;
    }
  ends[1] = best_;
  (which == Component::fast   ? ends[1].fast2
   : which == Component::slow ? ends[1].slow2
                              : ends[1].jitter2) = infinite;
  return ends;
}

} // namespace goingrate::timing_model
