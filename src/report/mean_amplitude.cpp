#include "mean_amplitude.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace goingrate {

MeanAmplitude amplitude_at(const std::vector<Beat>& beats, bool end) {
  constexpr std::size_t fewest_beats = 2, most_beats = 20;
  const std::size_t taken = std::clamp(beats.size() / 4, fewest_beats, most_beats);
  std::vector<double> amplitudes;
  for (std::size_t i = 0; i < std::min(taken, beats.size()); ++i) {
    const double amplitude = beats[end ? beats.size() - 1 - i : i].amplitude_rad;
    if (std::isfinite(amplitude)) amplitudes.push_back(amplitude);
  }
  MeanAmplitude mean;
  mean.beats = static_cast<int>(amplitudes.size());
  if (amplitudes.empty()) return mean;
  const auto count = static_cast<double>(amplitudes.size());
  mean.rad = std::accumulate(amplitudes.begin(), amplitudes.end(), 0.0) / count;
  if (amplitudes.size() < 2) return mean;
  double squares = 0.0;
  for (const double amplitude : amplitudes)
    squares += (amplitude - mean.rad) * (amplitude - mean.rad);
  mean.sigma_rad = std::sqrt(squares / (count - 1.0) / count);
  return mean;
}

} // namespace goingrate
