#include "push_friction.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <numbers>

namespace goingrate::push_shapes {

namespace {

using std::numbers::pi;

// How much the amplitude grows from one push to the next, by the first and the last interval.
double growth_between(const Grid& amplitude, const std::vector<double>& pushes) {
  const auto length = static_cast<double>(amplitude.size());
  const auto first = std::lower_bound(pushes.begin(), pushes.end(), 0.0);
  const auto last = std::upper_bound(first, pushes.end(), length - 1.0) - 1;
  const auto from_to = [&](double from, double to) { // crossings after one push up to another
    return mean_of_known(std::span(amplitude).subspan(static_cast<std::size_t>(from) + 1,
                                                      static_cast<std::size_t>(to - from)));
  };
  if (last - first < 2) return 0.0;
  const double growth = (from_to(*(last - 1), *last) - from_to(*first, *(first + 1))) /
                        static_cast<double>(last - first - 1);
  return std::isfinite(growth) ? growth : 0.0;
}

// Checks that friction is the same in every part of the log: pushes that are regular only for a
// while leave a tooth that comes and goes, whose mean says nothing.
bool is_same_in_every_part(const Grid& straight, const Coefficients& swing, double periods,
                           double loss, const ImpulseCycle::Estimate& epsilon) {
  constexpr std::size_t most_parts = 8, least_cycles_a_part = 8;
  const std::size_t count = swing.teeth.size();
  const std::size_t parts = std::min(most_parts, count / least_cycles_a_part);
  if (parts < 2) return true;
  const auto n = static_cast<std::size_t>(std::lround(periods));
  const auto level = [&](std::size_t interval) {
    return mean_of_known(std::span(straight).subspan(swing.begins[interval], n));
  };
  double squares = 0.0;
  for (std::size_t k = 0; k < parts; ++k) {
    const std::size_t from = k * count / parts, to = (k + 1) * count / parts;
    const ImpulseCycle::Estimate step =
        mean_of({swing.teeth.begin() + static_cast<std::ptrdiff_t>(from),
                 swing.teeth.begin() + static_cast<std::ptrdiff_t>(to)});
    const double growth = (level(to - 1) - level(from)) / static_cast<double>(to - from - 1);
    const double sigma = std::max(step.sigma / loss, epsilon.sigma); // at least that of all
    squares += std::pow(((step.value - growth) / loss - epsilon.value) / sigma, 2);
  }
  const double freedom = static_cast<double>(parts - 1);
  constexpr double beyond_chance = 1e-3;
  return boost::math::cdf(complement(boost::math::chi_squared(freedom), squares)) > beyond_chance;
}

// How much more than 2 pi epsilon the logarithm of the amplitude A loses in a period: the action
// A^2/2 (1 - 5 A^2/96) falls as exp(-2 epsilon t), and a period is 1 + A^2/16 times T0.
double faster_at(double amplitude) { return 1.0 + 11.0 / 96.0 * amplitude * amplitude; }

} // namespace

double mean_of_known(std::span<const double> values) {
  double sum = 0.0, known = 0.0;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    sum += value;
    ++known;
  }
  return known > 0.0 ? sum / known : not_known;
}

Grid straightened(const Grid& amplitude) {
  const double mean = mean_of_known(amplitude);
  Grid straight(amplitude.size(), not_known);
  for (std::size_t i = 0; i < amplitude.size(); ++i)
    if (amplitude[i] > 0.0) straight[i] = mean * (1.0 + std::log(amplitude[i] / mean));
  return straight;
}

std::optional<ImpulseCycle::Estimate> friction_of_teeth(const Grid& amplitude,
                                                        const std::vector<double>& pushes,
                                                        double periods, const Coefficients& swing) {
  const auto& step = swing[tooth_shape];
  const Grid straight = straightened(amplitude);
  const double mean = mean_of_known(amplitude), growth = growth_between(straight, pushes);
  const double loss = 2.0 * pi * periods * mean * faster_at(mean);
  const ImpulseCycle::Estimate epsilon{(step.value - growth) / loss, step.sigma / loss};
  if (!is_same_in_every_part(straight, swing, periods, loss, epsilon)) return {};
  return epsilon;
}

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

} // namespace goingrate::push_shapes
