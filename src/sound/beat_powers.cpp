#include "beat_powers.hpp"

#include "base/robust.hpp"

#include <algorithm>
#include <cmath>

namespace goingrate {

namespace {

constexpr double lead_s = 8e-3, tail_s = 24e-3, // of a beat, from where it begins
    bin_s = 62.5e-6,                            // of its power
    reach_s = 4e-3;                             // a rough place is right to three milliseconds

} // namespace

BeatGrid::BeatGrid(double rate_hz)
    : samples(std::max<std::int64_t>(1, std::llround(bin_s * rate_hz))) {
  const double step = static_cast<double>(samples) / rate_hz;
  lead = static_cast<std::size_t>(std::lround(lead_s / step));
  size = lead + static_cast<std::size_t>(std::lround(tail_s / step));
  reach = static_cast<std::ptrdiff_t>(std::lround(reach_s / step));
  degrees = static_cast<double>(samples);
}

BeatSnippet SnippetReader::read(double bin, double after) {
  const double at =
      (bin + 0.5) * static_cast<double>(loudness_.hop) + after * static_cast<double>(grid_.samples);
  const auto before = static_cast<std::ptrdiff_t>(grid_.lead) + grid_.reach;
  const std::size_t size = grid_.size + 2 * static_cast<std::size_t>(grid_.reach);
  BeatSnippet snippet;
  snippet.first = std::llround(at) - before * grid_.samples;
  snippet.expected = static_cast<double>(before);
  snippet.background = loudness_.background(at);
  samples_.resize((size + 2) * static_cast<std::size_t>(grid_.samples));
  sound_.read(snippet.first - grid_.samples, samples_);
  bins_.assign(size + 2, 0.0F);
  for (std::size_t i = 0; i < samples_.size(); ++i)
    bins_[i / static_cast<std::size_t>(grid_.samples)] += samples_[i] * samples_[i];
  const float quarter = 0.25F / static_cast<float>(grid_.samples);
  snippet.powers.resize(size);
  for (std::size_t i = 0; i < size; ++i)
    snippet.powers[i] = quarter * (bins_[i] + 2.0F * bins_[i + 1] + bins_[i + 2]) +
                        1e-9F * static_cast<float>(snippet.background);
  return snippet;
}

void measure_background(SnippetReader& snippets, const TickTrack& track, BeatGrid& grid) {
  constexpr std::size_t most_beats = 300, lags = 24;
  std::vector<double> products(lags, 0.0), sizes(lags, 1e-12), squares;
  const std::size_t every = track.ticks.size() / most_beats + 1;
  for (std::size_t i = 0; i + 1 < track.ticks.size(); i += every) {
    const BeatSnippet snippet = snippets.read(0.5 * (track.ticks[i].bin + track.ticks[i + 1].bin));
    std::vector<double> powers(snippet.powers.begin(), snippet.powers.end());
    const double mean = trimmed_mean(powers);
    std::vector<double> off;
    constexpr double largest_power = 4.0; // anything louder is not background
    for (const float power : snippet.powers)
      off.push_back(std::min(static_cast<double>(power) / mean - 1.0, largest_power));
    for (std::size_t lag = 0; lag < lags; ++lag)
      for (std::size_t k = lag; k < off.size(); ++k)
        products[lag] += off[k] * off[k - lag], sizes[lag] += 1.0;
  }
  const double variance = products[0] / sizes[0];
  if (!(variance > 0.0)) return;
  grid.degrees = 2.0 / variance;
  grid.correlation.clear();
  for (std::size_t lag = 0; lag < lags; ++lag) { // Bartlett's weights leave no negative variance
    const double weight = 1.0 - static_cast<double>(lag) / lags;
    grid.correlation.push_back(weight * products[lag] / sizes[lag] / variance);
  }
}

} // namespace goingrate
