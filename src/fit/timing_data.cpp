#include "goingrate/fit/timing_data.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <cmath>

namespace goingrate {

TimingData timing_data(std::span<const Beat> beats) {
  if (beats.size() < 3)
    throw ArgumentError("beats", static_cast<double>(beats.size()), "at least 3");
  TimingData data;
  const Beat& first = beats.front();
  data.reference_period_s =
      (beats.back().time - first.time) / static_cast<double>(beats.back().cycle - first.cycle);
  const bool amplitudes = std::any_of(
      beats.begin(), beats.end(), [](const Beat& beat) { return !std::isnan(beat.amplitude_rad); });
  for (const Beat& beat : beats) {
    const std::int64_t n = beat.cycle - first.cycle;
    data.cycle.push_back(static_cast<double>(n));
    data.elapsed_s.push_back(beat.time - first.time);
    data.lateness_s.push_back(
        residual_from_grid(beat.time, first.time, n, data.reference_period_s));
    if (amplitudes) data.amplitude_rad.push_back(beat.amplitude_rad);
  }
  return data;
}

TimingData subset(const TimingData& data, std::span<const std::size_t> chosen) {
  TimingData part;
  part.reference_period_s = data.reference_period_s;
  for (const std::size_t i : chosen) {
    part.cycle.push_back(data.cycle[i]);
    part.elapsed_s.push_back(data.elapsed_s[i]);
    part.lateness_s.push_back(data.lateness_s[i]);
    if (data.has_amplitude()) part.amplitude_rad.push_back(data.amplitude_rad[i]);
  }
  return part;
}

} // namespace goingrate
