#include "tick_times.hpp"

#include "beat_learning.hpp"

#include "base/robust.hpp"

#include <algorithm>

namespace goingrate {

namespace {

constexpr std::size_t most_learnt_from = 600;

BeatKind learnt(SnippetReader& snippets, const BeatGrid& grid, const TickTrack& track, bool tocks) {
  std::vector<double> bins;
  for (const RoughTick& tick : track.ticks)
    if (tick.is_tock == tocks && tick.stands_out) bins.push_back(tick.bin);
  const std::size_t count = std::min(most_learnt_from, bins.size());
  std::vector<BeatSnippet> read;
  for (std::size_t i = 0; i < count; ++i)
    read.push_back(snippets.read(bins[i * bins.size() / count]));
  return learn_kind(grid, std::move(read));
}

MeanBeat mean_beat(const BeatKind& kind, const BeatGrid& grid, double strength, double rate_hz) {
  MeanBeat beat;
  beat.step_s = static_cast<double>(grid.samples) / rate_hz;
  beat.rise_s = kind.rise * beat.step_s;
  beat.begin_s = -static_cast<double>(grid.lead) * beat.step_s;
  for (const double value : kind.shape)
    beat.power.push_back(1.0 + strength * value);
  return beat;
}

// If the phase steps, one beat may be found twice.
void drop_repeated(std::vector<Tick>& ticks, double period) {
  std::sort(ticks.begin(), ticks.end(), [](const Tick& a, const Tick& b) { return a.at < b.at; });
  std::vector<Tick> kept;
  constexpr double nearest_share = 0.15; // of a period: ticks and tocks are farther apart
  for (const Tick& tick : ticks) {
    if (kept.empty() || tick.at - kept.back().at > nearest_share * period)
      kept.push_back(tick);
    else if (tick.sigma < kept.back().sigma)
      kept.back() = tick;
  }
  ticks = std::move(kept);
}

// All beats of a log count as equally good, so those covered by other sounds are left out.
std::int64_t drop_covered(std::vector<Tick>& ticks) {
  if (ticks.empty()) return 0;
  std::vector<double> sigmas;
  for (const Tick& tick : ticks)
    sigmas.push_back(tick.sigma);
  constexpr double worst_ratio = 8.0; // such a beat tells a sixty-fourth of what the usual one does
  const double most = worst_ratio * median(sigmas);
  return static_cast<std::int64_t>(
      std::erase_if(ticks, [&](const Tick& tick) { return tick.sigma > most; }));
}

} // namespace

TickTrain time_ticks(Whitening& sound, const Loudness& loudness, const TickTrack& track,
                     double rate_hz, const std::function<void(double)>& progress) {
  BeatGrid grid(rate_hz);
  SnippetReader snippets(sound, loudness, grid);
  measure_background(snippets, track, grid);
  TickTrain train;
  train.period = track.pattern.period * static_cast<double>(loudness.hop);
  train.has_tocks = track.pattern.has_tocks;
  train.is_even = track.pattern.is_even;
  const BeatKind tick = learnt(snippets, grid, track, false);
  const BeatKind tock = train.has_tocks ? learnt(snippets, grid, track, true) : BeatKind{};
  BeatFit fit_tick(grid, tick), fit_tock(grid, tock);
  std::vector<double> strengths[2];
  std::size_t done = 0;
  for (const RoughTick& rough : track.ticks) {
    if (progress && ++done % 1024 == 0)
      progress(static_cast<double>(done) / static_cast<double>(track.ticks.size()));
    if (!rough.stands_out) {
      ++train.drowned;
      continue;
    }
    const BeatSnippet snippet = snippets.read(rough.bin, rough.is_tock ? tock.after : tick.after);
    const BeatPlace place = rough.is_tock ? fit_tock(snippet) : fit_tick(snippet);
    constexpr double worst_s = 2e-3; // of a place: it is then not found, but expected
    const bool known = place.sigma * static_cast<double>(grid.samples) <= worst_s * rate_hz;
    if (!place.inside || !known) {
      ++train.drowned;
      continue;
    }
    const auto samples = static_cast<double>(grid.samples);
    // A bin's power is that of its middle.
    train.ticks.push_back({static_cast<double>(snippet.first) + (place.bin + 0.5) * samples - 0.5,
                           place.sigma * samples, rough.is_tock});
    strengths[rough.is_tock ? 1 : 0].push_back(place.strength);
  }
  drop_repeated(train.ticks, train.period);
  train.drowned += drop_covered(train.ticks);
  if (!strengths[0].empty()) train.tick = mean_beat(tick, grid, median(strengths[0]), rate_hz);
  if (!strengths[1].empty()) train.tock = mean_beat(tock, grid, median(strengths[1]), rate_hz);
  return train;
}

} // namespace goingrate
