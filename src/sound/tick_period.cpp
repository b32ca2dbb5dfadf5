#include "tick_period.hpp"

#include "base/robust.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <vector>

namespace goingrate {

namespace {

constexpr double shortest_s = 0.07, // between two sounds: 43,200 beats an hour are 0.083 s apart
    longest_s = 3.7,                // of a period
    farthest_s = 22.0,              // lag looked at: six of the longest periods
    window_s = 60.0;
constexpr std::size_t most_windows = 20, coarse = 2; // bins
constexpr double nominal_is_right_to = 0.03;         // half an hour a day

// Sums of the values before each.
std::vector<double> sums_of(std::span<const float> values) {
  std::vector<double> sums{0.0};
  for (const float value : values)
    sums.push_back(sums.back() + static_cast<double>(value));
  return sums;
}

double mean_around(std::span<const double> sums, std::size_t i, std::size_t reach) {
  const std::size_t from = i < reach ? 0 : i - reach;
  const std::size_t to = std::min(sums.size() - 1, i + reach + 1);
  return (sums[to] - sums[from]) / static_cast<double>(to - from);
}

// Selects sounds as long as a beat: means over 5 bins minus means over 61, every second bin.
std::vector<float> beat_like(std::span<const float> above) {
  constexpr std::size_t beat = 2, syllable = 30;
  const std::vector<double> sums = sums_of(above);
  std::vector<float> result;
  constexpr double most_weight = 2.0; // a single sound must not count more than several beats
  for (std::size_t i = 0; i < above.size(); i += coarse)
    result.push_back(static_cast<float>(std::clamp(
        mean_around(sums, i, beat) - mean_around(sums, i, syllable), -most_weight, most_weight)));
  return result;
}

struct Windows {
  std::size_t size = 0;
  std::vector<std::size_t> begins;
};

Windows spread_windows(std::size_t bins, double bins_a_second) {
  Windows windows;
  windows.size = std::min(bins, static_cast<std::size_t>(window_s * bins_a_second));
  const std::size_t fit =
      windows.size == 0 ? 0 : (bins + windows.size - 1) / windows.size; // the last two overlap
  const std::size_t count = std::min(most_windows, fit);
  for (std::size_t i = 0; i < count; ++i)
    windows.begins.push_back(count < 2 ? 0 : i * (bins - windows.size) / (count - 1));
  return windows;
}

// Correlation of the loudness with itself `lag` coarse bins later, a mean over the windows.
std::vector<double> autocorrelation(const Loudness& loudness, const Windows& windows,
                                    std::size_t lags) {
  std::vector<double> result(lags, 0.0);
  for (const std::size_t begin : windows.begins) {
    const auto z = beat_like(std::span(loudness.above).subspan(begin, windows.size));
    std::vector<float> sum(lags, 0.0F);
    for (std::size_t i = 0; i < z.size(); ++i) {
      const std::size_t reach = std::min(lags, z.size() - i);
      const float* later = z.data() + i;
      for (std::size_t lag = 0; lag < reach; ++lag)
        sum[lag] += z[i] * later[lag];
    }
    if (!(sum[0] > 0.0F)) continue;
    // Over the number of terms, so that far lags are not taken for weaker ones.
    for (std::size_t lag = 0; lag < std::min(lags, z.size()); ++lag)
      result[lag] += static_cast<double>(sum[lag] / sum[0]) * static_cast<double>(z.size()) /
                     static_cast<double>(z.size() - lag);
  }
  return result;
}

double at(std::span<const double> values, double place) {
  const auto i = static_cast<std::size_t>(std::max(0.0, place));
  if (i + 1 >= values.size()) return 0.0;
  const double part = place - static_cast<double>(i);
  return (1.0 - part) * values[i] + part * values[i + 1];
}

// Subtracts sounds that repeat in the rhythm of the mains, 100 or 120 times per second: these also
// repeat one such interval earlier and later, which beats do not.
std::vector<double> without_hum(const std::vector<double>& correlation, double coarse_a_second) {
  std::vector<double> result = correlation;
  for (std::size_t lag = 0; lag < result.size(); ++lag)
    for (const double times_a_second : {100.0, 120.0}) {
      const double off = coarse_a_second / times_a_second, place = static_cast<double>(lag);
      const double hum = 0.5 * (at(correlation, place - off) + at(correlation, place + off));
      result[lag] = std::min(result[lag], correlation[lag] - hum);
    }
  return result;
}

// How well the loudness repeats after one, two, ... times the lag, as many as are known: their sum
// over the root of their number. Noise then has the same size at all lags. The period itself scores
// better than its multiples, which repeat as well but less often, and than its parts, which repeat
// only every second or third time.
double repeats(std::span<const double> correlation, double lag) {
  const double count = std::floor((static_cast<double>(correlation.size()) - 2.0) / lag);
  double sum = 0.0;
  for (double k = 1.0; k <= count; k += 1.0)
    sum += at(correlation, k * lag);
  return count < 1.0 ? 0.0 : sum / std::sqrt(count);
}

// The value of repeats() by chance.
double chance(std::span<const double> correlation, double from) {
  std::vector<double> values;
  for (double lag = from; 2.0 * lag < static_cast<double>(correlation.size()); lag += 1.0)
    values.push_back(repeats(correlation, lag));
  return values.empty() ? 0.0 : robust_sigma(values);
}

// The best lag in [from, to]. Its last repeat is looked for at every half bin.
double best_lag(std::span<const double> correlation, double from, double to) {
  double best = from, value = -1.0;
  const double growth = 1.0 + 0.5 / static_cast<double>(correlation.size());
  for (double lag = from; lag <= to; lag *= growth) {
    const double now = repeats(correlation, lag);
    if (now > value) value = now, best = lag;
  }
  return best;
}

// The place of the second sound in a period, from the loudest; nullopt if there is only one.
std::optional<double> second_sound(const Loudness& loudness, const Windows& windows,
                                   double period) {
  const auto size = static_cast<std::size_t>(std::ceil(period));
  std::vector<double> mean(size, 0.0);
  constexpr std::size_t width = 8; // bins a sound lasts, about
  for (const std::size_t begin : windows.begins) {
    std::vector<double> folded(size, 0.0), counts(size, 1e-9);
    for (std::size_t i = 0; i < windows.size; ++i) {
      const auto phase = static_cast<std::size_t>(std::fmod(static_cast<double>(i), period));
      folded[phase] += static_cast<double>(loudness.above[begin + i]);
      counts[phase] += 1.0;
    }
    std::vector<double> smooth(size, 0.0);
    for (std::size_t i = 0; i < size; ++i)
      for (std::size_t k = 0; k < width; ++k)
        smooth[i] += folded[(i + k) % size] / counts[(i + k) % size];
    const auto first =
        static_cast<std::size_t>(std::max_element(smooth.begin(), smooth.end()) - smooth.begin());
    for (std::size_t i = 0; i < size; ++i)
      mean[i] += smooth[(first + i) % size];
  }
  const std::size_t quarter = size / 4;
  const auto best = std::max_element(mean.begin() + static_cast<std::ptrdiff_t>(quarter),
                                     mean.end() - static_cast<std::ptrdiff_t>(quarter));
  // The lower half of the values shows what is between the sounds.
  std::vector<double> work = mean;
  std::sort(work.begin(), work.end());
  const double middle = work[size / 2];
  constexpr double quantile_below = 0.16; // of normal values, one standard deviation
  const double scatter =
      middle - work[static_cast<std::size_t>(quantile_below * static_cast<double>(size))];
  constexpr double scatter_factor = 6.0, least_share = 0.15; // of the louder one
  if (*best - middle < scatter_factor * scatter ||
      *best - middle < least_share * (mean[0] - middle))
    return {};
  return static_cast<double>(best - mean.begin());
}

} // namespace

std::optional<TickPattern> find_pattern(const Loudness& loudness, double bins_a_second,
                                        std::optional<double> nominal) {
  const Windows windows = spread_windows(loudness.above.size(), bins_a_second);
  if (windows.begins.empty()) return {};
  const double coarse_a_second = bins_a_second / static_cast<double>(coarse);
  const auto lags =
      std::min(windows.size / coarse / 2, static_cast<std::size_t>(farthest_s * coarse_a_second));
  const auto correlation = without_hum(autocorrelation(loudness, windows, lags), coarse_a_second);
  double from = shortest_s * coarse_a_second;
  double to = std::min(longest_s * coarse_a_second, static_cast<double>(lags) - 2.0);
  if (nominal) {
    const double middle = *nominal / static_cast<double>(coarse);
    from = middle * (1.0 - nominal_is_right_to);
    to = std::min(to, middle * (1.0 + nominal_is_right_to));
  }
  if (!(from < to)) return {};
  const double lag = best_lag(correlation, from, to);
  constexpr double significance = 5.0; // sigma, of the best of some thousand lags
  if (!(repeats(correlation, lag) >
        significance * chance(correlation, shortest_s * coarse_a_second)))
    return {};
  TickPattern pattern;
  pattern.period = lag * static_cast<double>(coarse);
  if (const auto second = second_sound(loudness, windows, pattern.period)) {
    pattern.tock_after = *second;
  } else if (nominal) {
    pattern.has_tocks = false;
  } else {
    pattern.tock_after = pattern.period;
    pattern.period *= 2.0;
    pattern.is_even = true;
  }
  const double period_s = pattern.period / bins_a_second;
  if (period_s < 2.0 * shortest_s || period_s > longest_s) return {};
  return pattern;
}

} // namespace goingrate
