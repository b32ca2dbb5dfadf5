#include "tick_band.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace goingrate {

namespace {

constexpr std::size_t reach = 24;       // samples either side
constexpr std::size_t frequencies = 96; // from 0 to half the sampling rate

// Mean autocorrelations of pieces read at some places, each divided by the power of its background.
class Correlation {
public:
  Correlation(Whitening& sound, const Loudness& loudness) : sound_(sound), loudness_(loudness) {}

  void add(std::int64_t first) {
    samples_.resize(static_cast<std::size_t>(8 * loudness_.hop)); // as long as most of a beat
    sound_.read(first, samples_);
    const double background = loudness_.background(static_cast<double>(first));
    for (std::size_t lag = 0; lag <= reach; ++lag) {
      double sum = 0.0;
      for (std::size_t i = lag; i < samples_.size(); ++i)
        sum += static_cast<double>(samples_[i]) * static_cast<double>(samples_[i - lag]);
      sums_[lag] += sum / background;
    }
    ++count_;
  }

  // Power at a frequency in units of half the sampling rate; never negative, by Bartlett's weights.
  [[nodiscard]] double spectrum(double frequency) const {
    double sum = sums_[0];
    for (std::size_t lag = 1; lag <= reach; ++lag)
      sum += 2.0 * (1.0 - static_cast<double>(lag) / (reach + 1)) * sums_[lag] *
             std::cos(std::numbers::pi * frequency * static_cast<double>(lag));
    return sum / (count_ > 0.0 ? count_ : 1.0);
  }

private:
  Whitening& sound_;
  const Loudness& loudness_;
  std::vector<float> samples_;
  std::vector<double> sums_ = std::vector<double>(reach + 1, 0.0);
  double count_ = 0.0;
};

// The filter of this response, by inverse cosine transform with Hann's taper; its power is 1.
std::vector<float> filter_with(const std::function<double(double)>& response) {
  std::vector<double> half(reach + 1, 0.0);
  for (std::size_t i = 0; i < frequencies; ++i) {
    const double frequency = (static_cast<double>(i) + 0.5) / frequencies;
    const double value = response(frequency);
    for (std::size_t lag = 0; lag <= reach; ++lag)
      half[lag] += value * std::cos(std::numbers::pi * frequency * static_cast<double>(lag));
  }
  double power = 0.0;
  for (std::size_t lag = 0; lag <= reach; ++lag) {
    half[lag] *= 0.5 + 0.5 * std::cos(std::numbers::pi * static_cast<double>(lag) / (reach + 1));
    power += (lag == 0 ? 1.0 : 2.0) * half[lag] * half[lag];
  }
  std::vector<float> filter(2 * reach + 1);
  for (std::size_t k = 0; k < filter.size(); ++k) {
    const std::size_t lag = k < reach ? reach - k : k - reach;
    filter[k] = static_cast<float>(half[lag] / std::sqrt(power > 0.0 ? power : 1.0));
  }
  return filter;
}

} // namespace

std::vector<float> band_of_ticks(Whitening& sound, const Loudness& loudness,
                                 const TickTrack& track) {
  constexpr std::size_t most_windows = 600;
  Correlation beats(sound, loudness), between(sound, loudness);
  const std::size_t every = track.ticks.size() / most_windows + 1;
  for (std::size_t i = 0; i + 1 < track.ticks.size(); i += every) {
    const RoughTick& tick = track.ticks[i];
    if (!tick.clock_goes) continue;
    const auto middle = static_cast<std::int64_t>(0.5 * (tick.bin + track.ticks[i + 1].bin));
    beats.add(static_cast<std::int64_t>(tick.bin) * loudness.hop);
    between.add(middle * loudness.hop);
  }
  return filter_with([&](double frequency) {
    const double noise = std::max(between.spectrum(frequency), 1e-9);
    const double sound_power = std::max(beats.spectrum(frequency) - noise, 0.0);
    return std::sqrt(sound_power / (noise * (noise + sound_power)));
  });
}

std::vector<float> band_around(double frequency_hz, double rate_hz) {
  return filter_with([&](double frequency) {
    const double octaves = std::log2(0.5 * frequency * rate_hz / frequency_hz);
    return std::abs(octaves) < 1.0 ? 1.0 : 0.0;
  });
}

} // namespace goingrate
