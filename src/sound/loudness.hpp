// The loudness of a recording relative to its background, in bins of about a millisecond.
#pragma once

#include "whitening.hpp"

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace goingrate {

/// Powers of a whitened recording over those of its background.
struct Loudness {
  std::int64_t hop = 0;         ///< samples per bin
  std::vector<float> above;     ///< ln(power/background) in each bin, within bounds; 0: like it
  std::vector<float> floor_log; ///< ln of the background's median power, one for each `floor_bins`

  static constexpr std::size_t floor_bins = 256;
  /// The background's mean power a sample around a place (in samples).
  [[nodiscard]] double background(double at) const;
};

/// Measures the loudness. The background is the median over 1.3 s: ticks are shorter than the
/// silence between them.
Loudness measure_loudness(Whitening& sound, std::int64_t count, double rate_hz,
                          const std::function<void(double)>& progress);

} // namespace goingrate
