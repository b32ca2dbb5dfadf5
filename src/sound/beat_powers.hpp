// The power of single beats in short bins, and that of the background between them.
#pragma once

#include "loudness.hpp"
#include "tick_track.hpp"

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace goingrate {

/// Sizes of a beat's power in bins.
struct BeatGrid {
  explicit BeatGrid(double rate_hz);
  std::int64_t samples = 1; ///< a bin
  std::size_t lead = 0, size = 0;
  std::ptrdiff_t reach = 0;
  double degrees = 1.0;                 ///< of freedom of one power of the background
  std::vector<double> correlation{1.0}; ///< of its powers, by their distance in bins

  // Variance of the logarithm of a power that is background (1), a beat's sound and `added`: that
  // of noise in which a known sound stands.
  [[nodiscard]] double log_variance(double sound, double added = 0.0) const {
    const double all = 1.0 + sound + added;
    return 2.0 * (1.0 + 2.0 * sound) / (all * all) / degrees;
  }

  // How many neighbouring powers hold as much information as one independent power.
  [[nodiscard]] double alike() const {
    return 2.0 * std::accumulate(correlation.begin(), correlation.end(), 0.0) - 1.0;
  }
};

/// The power around a place where a beat may begin.
struct BeatSnippet {
  std::int64_t first = 0;    // sample
  double background = 1.0;   // power
  double expected = 0.0;     // where the beat begins, in bins
  std::vector<float> powers; // `reach` more than the grid on both sides
};

/// Reads snippets.
class SnippetReader {
public:
  SnippetReader(Whitening& sound, const Loudness& loudness, const BeatGrid& grid)
      : sound_(sound), loudness_(loudness), grid_(grid) {}

  // The snippet around a rough place; `after` is that of the kind.
  BeatSnippet read(double bin, double after = 0.0);

private:
  Whitening& sound_;
  const Loudness& loudness_;
  const BeatGrid& grid_;
  std::vector<float> samples_, bins_;
};

/// Measures the background halfway between beats: its power is chi-square with as many degrees of
/// freedom as its scatter tells, which in the band of the beats are fewer than there are samples.
void measure_background(SnippetReader& snippets, const TickTrack& track, BeatGrid& grid);

} // namespace goingrate
