#include "mean_amplitude.hpp"

#include <algorithm>
#include <cmath>

namespace goingrate {

MeanAmplitude amplitude_at(const std::vector<Beat>& beats, bool end) {
  constexpr std::size_t most = 20;
  double sum = 0.0, sum2 = 0.0;
  MeanAmplitude mean;
  for (std::size_t i = 0; i < std::min(most, beats.size()); ++i) {
    const double amplitude = beats[end ? beats.size() - 1 - i : i].amplitude_rad;
    if (!std::isfinite(amplitude)) continue;
    sum += amplitude;
    sum2 += amplitude * amplitude;
    ++mean.beats;
  }
  if (mean.beats == 0) return mean;
  const double count = mean.beats;
  mean.rad = sum / count;
  if (mean.beats < 2) return mean;
  const double variance = std::max(0.0, sum2 - count * mean.rad * mean.rad) / (count - 1.0);
  mean.sigma_rad = std::sqrt(variance / count);
  return mean;
}

} // namespace goingrate
