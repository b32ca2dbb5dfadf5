// Finds the effect of each turn of the train's wheels on a log, which is subtracted before a fit.
#include "goingrate/fit/timing_data.hpp"

#include "base/scaled_time.hpp"
#include "fit/noise_guess.hpp"
#include "goingrate/spectra/lines.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace goingrate {

namespace {

// Part of a log on a grid of its usual spacing. Values between beats, and unknown values, are
// interpolated linearly between their known neighbours.
class EvenGrid {
public:
  EvenGrid(std::span<const double> cycle, double spacing) : cycle_(cycle), spacing_(spacing) {}

  /// EvenGrid steps from the first beat to beat i; not a whole number where the log leaves the grid.
  [[nodiscard]] double place(std::size_t i) const { return (cycle_[i] - cycle_[0]) / spacing_; }

  /// Empty if fewer than two values are known, or most of the grid lies in gaps.
  [[nodiscard]] std::vector<double> filled(std::span<const double> values) const {
    constexpr double most_steps_per_beat = 2.0;
    const double end = place(cycle_.size() - 1);
    if (!(end <= most_steps_per_beat * static_cast<double>(cycle_.size()))) return {};
    std::vector<std::size_t> known;
    for (std::size_t i = 0; i < values.size(); ++i)
      if (std::isfinite(values[i])) known.push_back(i);
    if (known.size() < 2) return {};
    std::vector<double> series(static_cast<std::size_t>(end) + 1);
    std::size_t next = 1;
    for (std::size_t g = 0; g < series.size(); ++g) {
      const auto at = static_cast<double>(g);
      while (next + 1 < known.size() && place(known[next]) < at)
        ++next;
      const std::size_t left = known[next - 1], right = known[next];
      const double share = (at - place(left)) / (place(right) - place(left));
      series[g] = std::lerp(values[left], values[right], std::clamp(share, 0.0, 1.0));
    }
    return series;
  }

private:
  std::span<const double> cycle_;
  double spacing_;
};

// A sinusoid size * sin(turn * place + phase), place in grid steps; `gain` of 2 log L.
struct Wave {
  double size, turn, phase, gain;
};

// The lines of a series. They are looked for in differences over `lag` steps, which suppress a
// course that drifts or settles.
std::vector<Wave> waves_of(std::span<const double> series, std::size_t lag, double slowest) {
  constexpr std::size_t fewest_values = 256; // enough for the density around a line
  if (series.size() < fewest_values + lag) return {};
  std::vector<double> differences(series.size() - lag);
  for (std::size_t i = 0; i < differences.size(); ++i)
    differences[i] = series[i + lag] - series[i];
  constexpr double false_alarm = 1e-6; // one log of a million without a wheel
  std::vector<Wave> waves;
  for (const SpectralLine& line :
       find_lines(differences, 1.0, {.false_alarm = false_alarm, .from_hz = slowest})) {
    // The difference of size sin(w g + phase) is 2 size sin(w lag/2) cos(w g + phase + w lag/2).
    const double turn = two_pi * line.frequency_hz;
    const double half = 0.5 * turn * static_cast<double>(lag);
    constexpr double least_response = 0.1; // below, differences hardly show such a wave
    if (std::abs(std::sin(half)) < least_response) continue;
    waves.push_back({line.amplitude / (2.0 * std::sin(half)), turn,
                     line.phase_rad - 0.5 * std::numbers::pi - half, 2.0 * line.ratio});
  }
  return waves;
}

} // namespace

void level_wheels(TimingData& data) {
  constexpr double longest_turn_s = 600.0;    // slower periods may come from weather or heating
  constexpr std::size_t block_beats = 131072; // their lines take seconds at most
  if (data.size() < 3) return;
  const double spacing = timing_model::usual_spacing(data);
  // With both directions, differences over a whole period are free of the beat error.
  const std::size_t lag = spacing < 1.0 ? static_cast<std::size_t>(std::lround(1.0 / spacing)) : 1;
  const double slowest = spacing * data.reference_period_s / longest_turn_s; // turns a grid step
  // Rounding alone makes the times oscillate by up to 2.2 times this least jitter.
  const double least_late_s = 3.0 * timing_model::least_jitter(data);
  for (std::size_t from = 0; from < data.size(); from += block_beats) {
    const std::size_t count = std::min(block_beats, data.size() - from);
    const EvenGrid grid(std::span(data.cycle).subspan(from, count), spacing);
    const auto level = [&](std::vector<double>& values, std::vector<double>& taken, double least,
                           double Wheel::*size) {
      const auto part = std::span(values).subspan(from, count);
      for (const Wave& wave : waves_of(grid.filled(part), lag, slowest)) {
        if (std::abs(wave.size) < least) continue;
        taken.resize(data.size());
        for (std::size_t i = 0; i < count; ++i) {
          const double swing = wave.size * std::sin(wave.turn * grid.place(i) + wave.phase);
          part[i] -= swing;
          taken[from + i] += swing;
        }
        Wheel wheel{two_pi / wave.turn * spacing * data.reference_period_s};
        wheel.*size = std::abs(wave.size);
        wheel.gain = wave.gain;
        data.wheels.push_back(wheel);
      }
    };
    level(data.lateness_s, data.wheel_late_s, least_late_s, &Wheel::late_s);
    if (data.has_amplitude())
      level(data.amplitude_rad, data.wheel_amplitude_rad, 0.0, &Wheel::amplitude_rad);
  }
}

} // namespace goingrate
