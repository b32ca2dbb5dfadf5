#include "whitening.hpp"

#include <algorithm>
#include <array>

namespace goingrate {

namespace {

constexpr std::size_t order = 24; // half a millisecond at 48 kHz
constexpr std::size_t taps = order + 3;
constexpr std::int64_t block = 4096; // samples
constexpr std::int64_t most_blocks = 256;

// Second differences: mains hum and wind, which the prediction is too short to resolve, are far
// below the band of ticks in them.
constexpr std::array<double, 3> differences{1.0, -2.0, 1.0};

std::vector<double> mean_autocorrelation(const SoundSamples& samples) {
  std::vector<double> sum(order + 1, 0.0);
  std::vector<float> x(block);
  const std::int64_t whole = std::max<std::int64_t>(1, samples.count / block);
  const std::int64_t blocks = std::min(most_blocks, whole);
  for (std::int64_t b = 0; b < blocks; ++b) {
    samples.read(b * whole / blocks * block, x);
    for (std::size_t i = x.size(); i-- > 2;)
      x[i] += x[i - 2] - 2.0F * x[i - 1];
    x[0] = x[1] = 0.0F;
    std::vector<double> own(order + 1, 0.0);
    for (std::size_t lag = 0; lag <= order; ++lag)
      for (std::size_t i = lag; i < x.size(); ++i)
        own[lag] += static_cast<double>(x[i]) * static_cast<double>(x[i - lag]);
    if (!(own[0] > 0.0)) continue;
    for (std::size_t lag = 0; lag <= order; ++lag)
      sum[lag] += own[lag] / own[0];
  }
  return sum;
}

} // namespace

Whitening::Whitening(const SoundSamples& samples) : samples_(samples) {
  std::vector<double> r = mean_autocorrelation(samples);
  // Frequencies 30 dB below the rest are not raised, because codecs leave bands empty and hum is a
  // line.
  constexpr double least_power = 1e-3;
  double error = r[0] *= 1.0 + least_power;
  std::vector<double> a(order + 1, 0.0);
  a[0] = 1.0;
  for (std::size_t k = 1; k <= order && error > 0.0; ++k) {
    double reflection = 0.0;
    for (std::size_t i = 0; i < k; ++i)
      reflection -= a[i] * r[k - i];
    reflection /= error;
    const std::vector<double> before = a;
    for (std::size_t i = 1; i <= k; ++i)
      a[i] = before[i] + reflection * before[k - i];
    error *= 1.0 - reflection * reflection;
  }
  prediction_.assign(taps, 0.0F);
  for (std::size_t k = 0; k <= order; ++k)
    for (std::size_t d = 0; d < differences.size(); ++d)
      prediction_[k + d] += static_cast<float>(a[k] * differences[d]);
  filter_ = prediction_;
}

void Whitening::follow_by(std::span<const float> symmetric) {
  ahead_ = symmetric.size() / 2;
  filter_.assign(prediction_.size() + symmetric.size() - 1, 0.0F);
  for (std::size_t k = 0; k < prediction_.size(); ++k)
    for (std::size_t d = 0; d < symmetric.size(); ++d)
      filter_[k + d] += prediction_[k] * symmetric[d];
}

void Whitening::read(std::int64_t first, std::span<float> to) {
  const std::size_t before = filter_.size() - 1;
  raw_.resize(to.size() + before);
  samples_.read(first + static_cast<std::int64_t>(ahead_) - static_cast<std::int64_t>(before),
                raw_);
  std::fill(to.begin(), to.end(), 0.0F);
  // Tap by tap over many samples: that is what compilers vectorise.
  constexpr std::size_t block_samples = 1024;
  for (std::size_t begin = 0; begin < to.size(); begin += block_samples) {
    const std::size_t size = std::min(block_samples, to.size() - begin);
    for (std::size_t k = 0; k < filter_.size(); ++k) {
      const float weight = filter_[k];
      const float* from = raw_.data() + begin + before - k;
      float* result = to.data() + begin;
      for (std::size_t i = 0; i < size; ++i)
        result[i] += weight * from[i];
    }
  }
}

} // namespace goingrate
