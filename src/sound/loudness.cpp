#include "loudness.hpp"

#include "base/robust.hpp"

#include <algorithm>
#include <cmath>

namespace goingrate {

namespace {

constexpr float highest_excess = 4.0F,
                lowest_excess = -2.0F; // of `above`: a bang counts no more than a tick

// Mean power of each bin.
std::vector<float> powers(Whitening& sound, std::int64_t count, std::int64_t hop,
                          const std::function<void(double)>& progress) {
  constexpr std::int64_t bins_at_once = 1024;
  const std::int64_t bins = count / hop;
  std::vector<float> power; // grows as the file is read, because a head may state any length
  std::vector<float> x;
  for (std::int64_t from = 0; from < bins; from += bins_at_once) {
    const std::int64_t size = std::min(bins_at_once, bins - from);
    x.resize(static_cast<std::size_t>(size * hop));
    sound.read(from * hop, x);
    power.resize(static_cast<std::size_t>(from + size));
    for (std::int64_t b = 0; b < size; ++b) {
      float sum = 0.0F;
      for (std::int64_t i = b * hop; i < (b + 1) * hop; ++i)
        sum += x[static_cast<std::size_t>(i)] * x[static_cast<std::size_t>(i)];
      power[static_cast<std::size_t>(from + b)] = sum / static_cast<float>(hop);
    }
    if (progress) progress(static_cast<double>(from + size) / static_cast<double>(bins));
  }
  return power;
}

constexpr float silent_log_power =
    -60.0F; // ln(power) where there is no sound: a recorder left something out

// The median of the bins with sound; `silent` if there are too few.
float sound_median(std::span<const float> values) {
  std::vector<double> copy;
  for (const float value : values)
    if (value > silent_log_power) copy.push_back(static_cast<double>(value));
  constexpr std::size_t least_share = 4; // one part in it
  return least_share * copy.size() <= values.size() ? silent_log_power
                                                    : static_cast<float>(median(copy));
}

// Medians of blocks, and of five blocks in a row. In silence the median of the sound before it, or
// after it, is used, and `least` if there is no sound between the beats.
std::vector<float> background_of(std::span<const float> log_power, float least) {
  std::vector<float> medians, smooth;
  for (std::size_t from = 0; from < log_power.size(); from += Loudness::floor_bins)
    medians.push_back(sound_median(
        log_power.subspan(from, std::min(Loudness::floor_bins, log_power.size() - from))));
  constexpr std::size_t reach = 2;
  for (std::size_t i = 0; i < medians.size(); ++i) {
    const std::size_t from = i < reach ? 0 : i - reach;
    const std::size_t to = std::min(medians.size(), i + reach + 1);
    smooth.push_back(sound_median(std::span<const float>(medians).subspan(from, to - from)));
  }
  const auto first = std::find_if(smooth.begin(), smooth.end(),
                                  [](float value) { return value > silent_log_power; });
  float before = first == smooth.end() ? silent_log_power : *first;
  for (float& value : smooth)
    before = value = std::max(least, value > silent_log_power ? value : before);
  return smooth;
}

} // namespace

double Loudness::background(double at) const {
  const auto last = static_cast<double>(floor_log.size() - 1);
  const double block = std::clamp(at / static_cast<double>(hop * floor_bins), 0.0, last);
  // The median of chi-square over its mean, by Wilson and Hilferty.
  const double third = 2.0 / (9.0 * static_cast<double>(hop));
  return std::exp(static_cast<double>(floor_log[static_cast<std::size_t>(block)])) /
         std::pow(1.0 - third, 3);
}

Loudness measure_loudness(Whitening& sound, std::int64_t count, double rate_hz,
                          const std::function<void(double)>& progress) {
  Loudness loudness;
  loudness.hop = std::max<std::int64_t>(1, std::llround(1e-3 * rate_hz));
  loudness.above = powers(sound, count, loudness.hop, progress);
  auto& above = loudness.above;
  if (above.empty()) return loudness;
  double mean = 0.0;
  for (const float power : above)
    mean += static_cast<double>(power) / static_cast<double>(above.size());
  for (float& power : above)
    power = std::max(std::log(power), silent_log_power);
  constexpr double finest_share = 1e-7; // of the mean power: 70 dB below it nothing is background
  loudness.floor_log =
      background_of(above, static_cast<float>(std::log(std::max(finest_share * mean, 1e-25))));
  for (std::size_t i = 0; i < above.size(); ++i) {
    const float floor = loudness.floor_log[i / Loudness::floor_bins];
    above[i] = above[i] > silent_log_power
                   ? std::clamp(above[i] - floor, lowest_excess, highest_excess)
                   : 0.0F;
  }
  return loudness;
}

} // namespace goingrate
