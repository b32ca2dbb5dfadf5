#include "push_candidate.hpp"

#include "push_friction.hpp"

#include "base/robust.hpp"
#include "goingrate/fit/timing_data.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace goingrate::push_shapes {

namespace {

Grid on_cycles(const TimingData& data, const std::vector<double>& values, std::size_t most) {
  const auto length = std::min(most, static_cast<std::size_t>(std::llround(data.cycle.back())) + 1);
  Grid grid(length, not_known);
  for (std::size_t i = 0; i < data.size(); ++i) {
    const auto at = static_cast<std::size_t>(std::llround(data.cycle[i]));
    if (at < length) grid[at] = values[i];
  }
  return grid;
}

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

double squares_of(const Coefficients& found, double noise, const std::vector<Shapes>& shapes) {
  if (!(noise > 0.0)) return 0.0;
  const Shapes all{found.of[0].value, found.of[1].value, found.of[2].value};
  double sum = 0.0;
  for (const Shapes& at : shapes)
    sum += std::pow(all.dot(at) / noise, 2);
  return sum / static_cast<double>(shapes.size());
}

} // namespace

double Sight::in_noise(double late_squares, double swing_squares) const {
  const auto over = [](double squares, double noise) {
    return noise > 0.0 ? squares / (noise * noise) : 0.0;
  };
  return over(late_squares, late_noise) + over(swing_squares, amplitude_noise);
}

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

std::optional<Candidate> irregular_candidate(const Sight& sight, std::vector<double> pushes,
                                             double periods, double price) {
  const Sought sought = most_shapes(static_cast<std::size_t>(std::lround(periods)));
  const auto times = irregular_coefficients(sight.late, pushes, periods, sought);
  const auto swings = sight.has_swing()
                          ? irregular_coefficients(straightened(sight.amplitude), pushes, periods,
                                                   in_amplitudes(sought))
                          : std::nullopt;
  if (!times || (sight.has_swing() && !swings)) return {};
  const std::vector<Shapes> shapes = irregular_shapes(pushes, periods, sight.late.size());
  Candidate found{described(pushes, periods, *times, swings, price),
                  squares_of(*times, sight.late_noise, shapes)};
  if (swings) found.squares += squares_of(*swings, sight.amplitude_noise, shapes);
  found.pushes.is_regular = false;
  found.pushes.cycles = std::move(pushes);
  return found;
}

} // namespace goingrate::push_shapes
