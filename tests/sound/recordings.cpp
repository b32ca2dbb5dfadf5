#include "recordings.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <sndfile.h>
#include <stdexcept>

namespace goingrate::test {

namespace {

constexpr double turn = 2.0 * std::numbers::pi;
using Random = std::mt19937_64;

double normal(Random& random) { return std::normal_distribution<double>()(random); }
double uniform(Random& random, double from, double to) {
  return std::uniform_real_distribution<double>(from, to)(random);
}

struct Click {
  double after_s = 0.0, level = 1.0, tone_hz = 3000.0, decay_s = 1.5e-3;
};

std::vector<Click> clicks_of(const ClockSound& clock, bool tock) {
  const double pitch =
      (tock && !clock.tocks_are_ticks ? 0.8 : 1.0) * std::min(1.0, clock.rate_hz / 22e3);
  const double level = tock && !clock.tocks_are_ticks ? 0.7 : 1.0;
  if (!clock.triple)
    return {{0.0, level, 3100.0 * pitch, 2e-3}, {0.0, 0.4 * level, 5700.0 * pitch, 1e-3}};
  return {{0.0, 0.35 * level, 4200.0 * pitch, 0.8e-3},
          {3.1e-3, 0.6 * level, 3300.0 * pitch, 1e-3},
          {tock ? 8.3e-3 : 7.4e-3, level, 2900.0 * pitch, 1.5e-3}};
}

void add_click(std::vector<float>& to, double rate, double begin, const Click& click,
               double phase) {
  constexpr double attack_s = 5e-5;
  const auto first = static_cast<std::ptrdiff_t>(std::ceil(begin));
  const auto last = static_cast<std::ptrdiff_t>(begin + 12.0 * click.decay_s * rate);
  for (std::ptrdiff_t i = std::max<std::ptrdiff_t>(0, first);
       i < std::min(last, static_cast<std::ptrdiff_t>(to.size())); ++i) {
    const double t = (static_cast<double>(i) - begin) / rate;
    to[static_cast<std::size_t>(i)] += static_cast<float>(
        click.level * (1.0 - std::exp(-t / attack_s)) * std::exp(-t / click.decay_s) *
        std::sin(turn * click.tone_hz * t + phase));
  }
}

void scale_to(std::vector<float>& noise, double rms) {
  double sum = 0.0;
  for (const float value : noise)
    sum += static_cast<double>(value) * static_cast<double>(value);
  const double factor = rms / std::sqrt(std::max(1e-30, sum / static_cast<double>(noise.size())));
  for (float& value : noise)
    value *= static_cast<float>(factor);
}

void add_white(std::vector<float>& to, double rms, Random& random) {
  for (float& value : to)
    value += static_cast<float>(rms * normal(random));
}

std::vector<float> hum(std::size_t size, double rate) {
  std::vector<float> x(size);
  for (std::size_t i = 0; i < size; ++i)
    for (int k = 1; k <= 9; k += 2)
      x[i] += static_cast<float>(std::sin(turn * 50.0 * k * static_cast<double>(i) / rate + k) / k);
  return x;
}

// Syllables of some 150 ms, voiced by harmonics or hissing, with pauses.
std::vector<float> speech(std::size_t size, double rate, Random& random) {
  std::vector<float> x(size);
  for (double at = 0.0; at < static_cast<double>(size);) {
    const double length = uniform(random, 0.06, 0.3) * rate;
    const double pitch = uniform(random, 90.0, 220.0), level = std::exp(0.7 * normal(random));
    const bool hisses = uniform(random, 0.0, 1.0) < 0.3;
    double before = 0.0;
    for (double k = 0.0; k < length && at + k < static_cast<double>(size); k += 1.0) {
      double value = 0.0;
      if (hisses) {
        const double now = normal(random);
        value = 0.3 * (now - before);
        before = now;
      } else {
        for (int h = 1; h <= 12; ++h)
          value += std::sin(turn * pitch * h * k / rate + h * h) / h;
      }
      x[static_cast<std::size_t>(at + k)] +=
          static_cast<float>(level * std::sin(std::numbers::pi * k / length) * value);
    }
    at += length + uniform(random, 0.0, 1.0) * uniform(random, 0.0, 1.0) * rate;
  }
  return x;
}

// Plucked tones, two to five a second.
std::vector<float> music(std::size_t size, double rate, Random& random) {
  std::vector<float> x(size);
  for (double at = 0.0; at < static_cast<double>(size);) {
    const double tone = 220.0 * std::exp2(std::floor(uniform(random, 0.0, 24.0)) / 12.0);
    const double level = std::exp(0.4 * normal(random));
    const double length = std::min(1.2 * rate, static_cast<double>(size) - at - 1.0);
    for (double k = 0.0; k < length; k += 1.0) {
      double value = 0.0;
      for (int h = 1; h <= 8 && h * tone < 0.45 * rate; ++h)
        value += std::sin(turn * tone * h * k / rate) * std::exp(-3.0 * h * k / rate) / h;
      x[static_cast<std::size_t>(at + k)] +=
          static_cast<float>(level * (1.0 - std::exp(-k / (2e-3 * rate))) * value);
    }
    at += uniform(random, 0.2, 0.5) * rate;
  }
  return x;
}

// Low rumble in gusts.
std::vector<float> wind(std::size_t size, double rate, Random& random) {
  std::vector<float> x(size);
  double low = 0.0, gust = 0.0, slow = 0.0;
  const double cut = turn * 60.0 / rate, change = turn * 0.3 / rate;
  for (float& value : x) {
    low += cut * (normal(random) - low);
    slow += change * (normal(random) / std::sqrt(change) - slow);
    gust = std::exp(slow);
    value = static_cast<float>(gust * low);
  }
  return x;
}

std::vector<float> noise_of(const ClockSound& clock, std::size_t size, Random& random) {
  switch (clock.noise) {
  case Noise::hum:
    return hum(size, clock.rate_hz);
  case Noise::speech:
    return speech(size, clock.rate_hz, random);
  case Noise::music:
    return music(size, clock.rate_hz, random);
  case Noise::wind:
    return wind(size, clock.rate_hz, random);
  case Noise::white:
    break;
  }
  std::vector<float> white(size);
  add_white(white, 1.0, random);
  return white;
}

} // namespace

std::vector<float> pulses(double rate_hz, double fast, double seconds,
                          const std::vector<int>& missing) {
  Random random(14);
  std::vector<float> samples;
  double high_pass = 0.0, before = 0.0;
  for (std::int64_t i = 0; i < static_cast<std::int64_t>(seconds * rate_hz); ++i) {
    const double t = static_cast<double>(i) / (rate_hz * (1.0 + fast)) - 0.4;
    const auto second = static_cast<int>(std::floor(t));
    const bool sent = std::find(missing.begin(), missing.end(), second) == missing.end();
    const double now = t > 0.0 && t - second < 0.1 && sent ? 0.5 : 0.0;
    high_pass = 0.999 * (high_pass + now - before);
    before = now;
    samples.push_back(static_cast<float>(high_pass + 1e-3 * normal(random)));
  }
  return samples;
}

void write_sound(const std::string& path, const std::vector<std::vector<float>>& channels,
                 double rate_hz) {
  SF_INFO info{};
  info.samplerate = static_cast<int>(rate_hz);
  info.channels = static_cast<int>(channels.size());
  info.format = path.ends_with(".ogg")    ? SF_FORMAT_OGG | SF_FORMAT_VORBIS
                : path.ends_with(".flac") ? SF_FORMAT_FLAC | SF_FORMAT_PCM_16
                                          : SF_FORMAT_WAV | SF_FORMAT_PCM_16;
  SNDFILE* file = sf_open(path.c_str(), SFM_WRITE, &info);
  if (file == nullptr) throw std::runtime_error(path + " cannot be written");
  std::vector<float> frame(channels.size());
  for (std::size_t i = 0; i < channels.front().size(); ++i) {
    for (std::size_t c = 0; c < channels.size(); ++c)
      frame[c] = 0.4F * channels[c][i];
    sf_writef_float(file, frame.data(), 1);
  }
  sf_close(file);
}

SoundSamples Recorded::sound(double rate_hz) const {
  SoundSamples sound;
  sound.rate_hz = rate_hz;
  sound.count = static_cast<std::int64_t>(samples.size());
  sound.read = [this](std::int64_t first, std::span<float> to) {
    for (std::size_t i = 0; i < to.size(); ++i) {
      const std::int64_t at = first + static_cast<std::int64_t>(i);
      to[i] = at < 0 || at >= static_cast<std::int64_t>(samples.size())
                  ? 0.0F
                  : samples[static_cast<std::size_t>(at)];
    }
  };
  return sound;
}

Recorded record(const ClockSound& clock) {
  Random random(clock.seed);
  Recorded recorded;
  const auto size = static_cast<std::size_t>(clock.seconds * clock.rate_hz);
  const double noise_rms = std::pow(10.0, -clock.loudness_db / 20.0) / std::sqrt(2.0);
  recorded.samples = noise_of(clock, size, random);
  scale_to(recorded.samples, noise_rms);
  if (clock.noise != Noise::white) // the room and the microphone
    add_white(recorded.samples, std::min(0.1 * noise_rms, 1e-2), random);
  const double begin_s = uniform(random, 0.05, 0.2);
  const double half_s = 0.5 * (clock.period_s + clock.tick_minus_tock_s);
  for (std::int64_t n = 0;; ++n) {
    const bool tock = n % 2 != 0;
    const double at_s = begin_s + static_cast<double>(n / 2) * clock.period_s +
                        (tock ? half_s : 0.0) + clock.jitter_s * normal(random);
    if (at_s > std::min(clock.seconds - 0.05, clock.stops_at_s)) break;
    if (clock.is_silent || (tock && clock.silent_tocks)) continue;
    const double at = at_s * clock.rate_hz, level = std::exp(0.1 * normal(random));
    for (Click click : clicks_of(clock, tock)) {
      click.level *= level * std::exp(0.05 * normal(random));
      add_click(recorded.samples, clock.rate_hz, at + click.after_s * clock.rate_hz, click,
                0.02 * normal(random));
    }
    recorded.truth.push_back({at, 0.0, tock});
  }
  if (clock.clip_at > 0.0)
    for (float& value : recorded.samples)
      value =
          std::clamp(value, static_cast<float>(-clock.clip_at), static_cast<float>(clock.clip_at));
  if (clock.gap_s > 0.0) {
    const auto middle = static_cast<std::ptrdiff_t>(size / 2);
    const auto length = static_cast<std::ptrdiff_t>(clock.gap_s * clock.rate_hz);
    std::fill_n(recorded.samples.begin() + middle, length, 0.0F);
    std::erase_if(recorded.truth, [&](const Tick& tick) {
      return tick.at > static_cast<double>(middle) - 0.02 * clock.rate_hz &&
             tick.at < static_cast<double>(middle + length);
    });
  }
  return recorded;
}

} // namespace goingrate::test
