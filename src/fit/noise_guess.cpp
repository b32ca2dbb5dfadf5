#include "fit/noise_guess.hpp"

#include "base/time_grain.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace goingrate::timing_model {

namespace {

constexpr std::size_t most_differences = 20000; // known to a per cent

// Robust mean square of the third differences at a stride of usual spacings: of jitter j and a walk
// w a spacing it is 20 j^2 + 6 stride w^2, of anything smooth over three strides nearly nothing.
// `relative`: the noise of each value over that of all, or empty.
double third_differences(const TimingData& data, std::span<const double> series,
                         std::span<const double> relative, std::size_t stride) {
  const double spacing = usual_spacing(data);
  std::vector<double> size;
  for (std::size_t i = 0; i + 3 * stride < series.size() && size.size() < most_differences; ++i) {
    if (data.cycle[i + 3 * stride] - data.cycle[i] != 3.0 * spacing * static_cast<double>(stride))
      continue;
    double d = series[i + 3 * stride] - 3.0 * series[i + 2 * stride] + 3.0 * series[i + stride] -
               series[i];
    if (!relative.empty()) d /= 0.5 * (relative[i + stride] + relative[i + 2 * stride]);
    if (std::isfinite(d)) size.push_back(std::abs(d));
  }
  if (size.empty()) return 0.0;
  const auto middle = size.begin() + static_cast<std::ptrdiff_t>(size.size() / 2);
  std::nth_element(size.begin(), middle, size.end());
  constexpr double normal = 1.4826; // standard deviation over median of the size
  return std::pow(normal * *middle, 2);
}

// Relative standard deviation of a robust mean square of third differences. That from the median of
// m independent sizes is 2.3/sqrt m, and third differences are independent every three strides.
double scatter_at(std::size_t stride, std::size_t beats) {
  return 2.3 * std::sqrt(3.0 * static_cast<double>(stride) /
                         static_cast<double>(std::min(beats, most_differences)));
}
constexpr double beyond_chance = 4.0; // standard deviations

} // namespace

double usual_spacing(const TimingData& data) {
  constexpr std::size_t most_beats = 1001;
  std::vector<double> steps;
  for (std::size_t i = 1; i < std::min(most_beats, data.size()); ++i)
    steps.push_back(data.cycle[i] - data.cycle[i - 1]);
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

double least_jitter(const TimingData& data) {
  const double of_doubles = 1e-12 * data.reference_period_s + 4e-16 * data.elapsed_s.back();
  const double grain_s = time_grain(std::min(data.size(), times_for_grain), data.reference_period_s,
                                    [&](std::size_t i) { return data.elapsed_s[i]; });
  // Half the error that the steps of the times cause: a bound that the best value does not reach by
  // chance.
  return std::max(of_doubles, 0.5 * rounding_sigma(grain_s));
}

NoiseGuess guess_noise(const TimingData& data) {
  NoiseGuess guess;
  constexpr std::size_t stride = 8;
  const double near = third_differences(data, data.lateness_s, data.time_noise, 1);
  double far = third_differences(data, data.lateness_s, data.time_noise, stride);
  // Twice the stride doubles the contribution of a walk, but raises that of a smooth course 64
  // times.
  constexpr double smooth = 8.0;
  if (third_differences(data, data.lateness_s, data.time_noise, 2 * stride) > smooth * far)
    far = near;
  const double walk2 = std::clamp((far - near) / (6.0 * (stride - 1)), 0.0, near / 6.0);
  guess.walk_s = std::sqrt(walk2 / usual_spacing(data));
  guess.walks = far > near * (1.0 + beyond_chance * scatter_at(stride, data.size()));
  guess.jitter_s =
      std::max(std::sqrt(std::max(0.0, near - 6.0 * walk2) / 20.0), least_jitter(data));
  constexpr double finest_amplitude_rad = 1e-8; // rad
  if (data.has_amplitude())
    guess.amplitude_rad = std::max(
        std::sqrt(third_differences(data, data.amplitude_rad, data.amplitude_noise, 1) / 20.0),
        finest_amplitude_rad);
  return guess;
}

bool walks(const TimingData& data, std::span<const double> residual) {
  // What a walk adds doubles with the stride. What a smooth course adds rises 64 times, and at
  // least six times as long as the stride is shorter than the time in which it bends.
  constexpr double largest_rise = 4.0;
  const double near = third_differences(data, residual, data.time_noise, 1);
  for (std::size_t stride = 8; 24 * stride < data.size(); stride *= 2) {
    const double added = third_differences(data, residual, data.time_noise, stride) - near;
    if (added > beyond_chance * scatter_at(stride, data.size()) * near)
      return third_differences(data, residual, data.time_noise, 2 * stride) - near <
             largest_rise * added;
  }
  return false;
}

} // namespace goingrate::timing_model
