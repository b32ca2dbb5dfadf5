#include "thinning.hpp"

#include "fit_setup.hpp"

#include "base/scaled_time.hpp"
#include "fit/noise_guess.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

namespace goingrate::timing_model {

namespace {

using std::numbers::pi;

double response2(const NoiseShape& shape, double f) {
  const double u = f / shape.corner;
  return (shape.ratio * shape.ratio + u * u) / (1.0 + u * u);
}

// Density of the increments over `stride` cycles at F in 1/increment, 0 < F <= 1/2: every alias of
// the clock's part, summed over the increment, and the jitter of both ends.
double aliased(const NoiseShape& shape, double frequency, std::size_t stride) {
  const double k = static_cast<double>(stride), top = std::pow(std::sin(pi * frequency), 2);
  double sum = 0.0;
  for (std::size_t m = 0; m < stride; ++m) {
    const double f = (frequency + static_cast<double>(m)) / k;
    const double folded = std::min(f, 1.0 - f);
    sum += response2(shape, folded) / std::pow(std::sin(pi * f), 2);
  }
  return shape.level * sum * top / k + 4.0 * shape.jitter2 * top;
}

NoiseShape moved(const NoiseShape& shape, int which, double step) {
  NoiseShape other = shape;
  if (which == 0) other.corner *= std::exp(step);
  if (which == 1) other.ratio += step;
  if (which == 2) other.level *= std::exp(step);
  if (which == 3) other.jitter2 *= std::exp(step);
  return other;
}

// Per original cycle: 1/2 int (d log S)(d log S)' dF / stride, over the logarithm of F.
Eigen::Matrix4d information(const NoiseShape& shape, std::size_t stride) {
  constexpr int points = 160;
  constexpr double lowest = 1e-7; // below the corner of any clock
  constexpr double step = 1e-4;
  Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
  const double span = std::log(0.5 / lowest);
  for (int i = 0; i < points; ++i) {
    const double frequency = lowest * std::exp(span * (i + 0.5) / points);
    Eigen::Vector4d slope;
    for (int p = 0; p < 4; ++p)
      slope[p] = (std::log(aliased(moved(shape, p, step), frequency, stride)) -
                  std::log(aliased(moved(shape, p, -step), frequency, stride))) /
                 (2.0 * step);
    sum += slope * slope.transpose() * (frequency * span / points);
  }
  return sum / static_cast<double>(stride);
}

Eigen::Vector4d variances(const NoiseShape& shape, std::size_t stride) {
  // A jitter too small to see must not make the matrix singular.
  const Eigen::Matrix4d total = information(shape, stride) + 1e-12 * Eigen::Matrix4d::Identity();
  return total.inverse().diagonal();
}

} // namespace

double information_lost(const NoiseShape& shape, std::size_t stride) {
  const Eigen::Vector4d all = variances(shape, 1), thinned = variances(shape, stride);
  double lost = 0.0;
  for (int p = 0; p < 2; ++p)
    lost = std::max(lost, 1.0 - all[p] / thinned[p]);
  return lost;
}

std::size_t longest_stride(const NoiseShape& shape, double allowed) {
  std::size_t stride = 1;
  while (stride < 64 && information_lost(shape, 2 * stride) < allowed)
    stride *= 2;
  return stride;
}

std::vector<std::size_t> kept_beats(const TimingData& data, const std::vector<double>& event_cycles,
                                    std::size_t stride, std::size_t dense) {
  std::vector<std::size_t> kept;
  std::size_t event = 0, since = 0;
  for (std::size_t i = 0; i < data.size(); ++i, ++since) {
    while (event < event_cycles.size() && data.cycle[i] >= event_cycles[event]) {
      ++event;
      since = 0;
    }
    const std::size_t spacing = since < dense ? 1 : std::bit_floor(2 * since / dense);
    const bool on_grid = static_cast<std::size_t>(data.cycle[i]) % std::min(spacing, stride) == 0;
    if (on_grid || i + 1 == data.size()) kept.push_back(i);
  }
  return kept;
}

namespace {

// The mean of the known amplitudes from `first` to `last`, and its noise relative to a single
// one's.
struct MeanAmplitude {
  double amplitude_rad = std::numeric_limits<double>::quiet_NaN(), noise = 1.0;
};
MeanAmplitude mean_amplitude(const TimingData& data, std::size_t first, std::size_t last) {
  double sum = 0.0, variance = 0.0, seen = 0.0;
  for (std::size_t i = first; i <= last; ++i) {
    if (std::isnan(data.amplitude_rad[i])) continue;
    sum += data.amplitude_rad[i];
    variance += data.amplitude_noise.empty() ? 1.0 : std::pow(data.amplitude_noise[i], 2);
    ++seen;
  }
  return seen > 0.0 ? MeanAmplitude{sum / seen, std::sqrt(variance) / seen} : MeanAmplitude{};
}

} // namespace

TimingData thinned_to(const TimingData& data, std::span<const std::size_t> kept) {
  TimingData thin = subset(data, kept);
  if (!data.has_amplitude()) return thin;
  thin.amplitude_noise.resize(kept.size(), 1.0);
  for (std::size_t k = 1; k + 1 < kept.size(); ++k) {
    const std::size_t reach = (std::min(kept[k] - kept[k - 1], kept[k + 1] - kept[k]) - 1) / 2;
    const MeanAmplitude mean = mean_amplitude(data, kept[k] - reach, kept[k] + reach);
    thin.amplitude_rad[k] = mean.amplitude_rad;
    thin.amplitude_noise[k] = mean.noise;
  }
  return thin;
}

namespace {

// Replaces the middle one of beats [first, first + together) by their mean.
void add_mean(const TimingData& data, std::size_t first, std::size_t together, TimingData& means) {
  const auto mean = [&](const std::vector<double>& values) {
    double sum = 0.0, seen = 0.0;
    for (std::size_t i = first; i < first + together; ++i) {
      if (std::isnan(values[i])) continue;
      sum += values[i];
      ++seen;
    }
    return seen > 0.0 ? sum / seen : std::numeric_limits<double>::quiet_NaN();
  };
  means.cycle.push_back(data.cycle[first + together / 2]);
  means.lateness_s.push_back(mean(data.lateness_s));
  means.elapsed_s.push_back(means.cycle.back() * data.reference_period_s + means.lateness_s.back());
  if (data.has_amplitude()) means.amplitude_rad.push_back(mean(data.amplitude_rad));
  if (!data.time_noise.empty()) means.time_noise.push_back(mean(data.time_noise));
  if (!data.amplitude_noise.empty()) means.amplitude_noise.push_back(mean(data.amplitude_noise));
  for (std::size_t k = 0; k < data.terms.size(); ++k)
    means.terms[k].advance_s.push_back(mean(data.terms[k].advance_s));
}

TimingData block_means(const TimingData& data, const std::vector<double>& event_cycles,
                       std::size_t together) {
  const std::array<std::size_t, 1> beginning{0}; // all cycles count from it
  TimingData means = subset(data, beginning);
  const double step = data.cycle[2] - data.cycle[1];
  for (std::size_t first = 1; first + together <= data.size();) {
    const double from = data.cycle[first], to = data.cycle[first + together - 1];
    const auto event = std::lower_bound(event_cycles.begin(), event_cycles.end(), from);
    const bool is_whole = to - from == step * static_cast<double>(together - 1) &&
                          (event == event_cycles.end() || *event >= to);
    if (is_whole) add_mean(data, first, together, means);
    first += is_whole ? together : 1;
  }
  return means;
}

} // namespace

FewBeats few_beats(const TimingData& data, const std::vector<double>& event_cycles,
                   std::size_t count) {
  const std::size_t together = (data.size() / count - 1) | 1U; // odd: the middle is a beat
  if (data.size() < 3 * count) return {at_one_stride(data, count), 1.0};
  if (!walks(data, data.lateness_s)) {
    TimingData means = block_means(data, event_cycles, together);
    constexpr double least_filled_share = 0.5; // of the blocks that could be
    if (static_cast<double>(means.size() * together) >
        least_filled_share * static_cast<double>(data.size()))
      return {std::move(means), static_cast<double>(together)};
  }
  return {at_one_stride(data, count), 1.0};
}

} // namespace goingrate::timing_model
