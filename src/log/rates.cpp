#include "goingrate/log/rates.hpp"

#include "beat_noise.hpp"
#include "typical_period.hpp"

#include "base/per_processor.hpp"
#include "base/time_grain.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace goingrate {

std::optional<double> usual_period(double period_s) {
  // Pendulums swing in quarter seconds; clocks are read, or strike, at half minutes and half hours.
  constexpr double longest_swing_s = 60.0, shortest_half_hours_s = 1700.0;
  const double step_s = period_s < longest_swing_s         ? 0.25
                        : period_s < shortest_half_hours_s ? 30.0
                                                           : 1800.0;
  constexpr double largest_rate_excess = 0.002; // 3 minutes a day
  const double usual = std::round(period_s / step_s) * step_s;
  if (!(usual > 0.0) || !(std::abs(period_s / usual - 1.0) < largest_rate_excess)) return {};
  return usual;
}

double rounded_period(double period_s) { return usual_period(period_s).value_or(period_s); }

double nominal_period(const ClockLog& log, const Beats& beats,
                      std::vector<Assumption>& assumptions) {
  if (log.nominal_period_s) return *log.nominal_period_s;
  const double mean = beats.typical_period_s;
  if (const auto usual = usual_period(mean)) {
    if (*usual != mean)
      assumptions.push_back(
          {fmt::format("nominal period {} s, the mean period {:.6f} s rounded", *usual, mean),
           Setting::nominal_period});
    return *usual;
  }
  assumptions.push_back(
      {fmt::format("no nominal period is known: rates are relative to the mean period {:.9g} s",
                   mean),
       Setting::nominal_period});
  return mean;
}

double rate_between(const Beat& from, const Beat& to, double nominal_period_s) {
  const double late =
      residual_from_grid(to.time, from.time, to.cycle - from.cycle, nominal_period_s);
  return (0.0 - late) /
         (to.time - from.time); // keeps the digits that n T0 / dt - 1 loses, and no -0
}

std::vector<double> rate_per_period(std::span<const Beat> beats, double nominal_period_s) {
  std::vector<double> rates;
  rates.reserve(beats.size());
  for (std::size_t i = 1; i < beats.size(); ++i)
    rates.push_back(rate_between(beats[i - 1], beats[i], nominal_period_s));
  return rates;
}

std::vector<double> clock_error(std::span<const Beat> beats, double nominal_period_s) {
  std::vector<double> error;
  error.reserve(beats.size());
  for (const Beat& beat : beats)
    error.push_back(-residual_from_grid(beat.time, beats[0].time, beat.cycle - beats[0].cycle,
                                        nominal_period_s));
  return error;
}

std::vector<double> rate_on_every_cycle(std::span<const Beat> beats, double nominal_period_s) {
  const auto rates = rate_per_period(beats, nominal_period_s);
  std::vector<double> series;
  for (std::size_t i = 0; i < rates.size(); ++i)
    series.insert(series.end(), static_cast<std::size_t>(beats[i + 1].cycle - beats[i].cycle),
                  rates[i]);
  return series;
}

std::vector<double> on_every_cycle(std::span<const Beat> beats, std::span<const double> values,
                                   std::int64_t step) {
  if (beats.size() != values.size())
    throw ArgumentError("values", static_cast<double>(values.size()), "one for each beat");
  const auto place = [&](const Beat& beat) {
    return static_cast<std::size_t>((beat.cycle - beats.front().cycle) / step);
  };
  std::vector<double> series(place(beats.back()) + 1, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < beats.size(); ++i)
    if ((beats[i].cycle - beats.front().cycle) % step == 0) series[place(beats[i])] = values[i];
  return series;
}

void add_time_base(RateSummary& summary, double time_base_sigma) {
  summary.time_base_sigma = time_base_sigma;
  summary.rate_excess_sigma = std::hypot(summary.rate_excess_sigma, time_base_sigma);
  summary.mean_period_sigma_s =
      std::hypot(summary.mean_period_sigma_s, summary.mean_period_s * time_base_sigma);
}

double own_rate_sigma(const RateSummary& summary) {
  const double all = summary.rate_excess_sigma, common = summary.time_base_sigma;
  return std::sqrt(std::max(0.0, all * all - common * common));
}

namespace {

// The clock's error at a beat, without a vector of all: x_i = n_i T0 - (t_i - t_0).
class ClockError {
public:
  ClockError(std::span<const Beat> beats, double nominal_period_s)
      : beats_(beats), nominal_period_s_(nominal_period_s) {}
  double operator[](std::size_t i) const {
    return -residual_from_grid(beats_[i].time, beats_[0].time, beats_[i].cycle - beats_[0].cycle,
                               nominal_period_s_);
  }

private:
  std::span<const Beat> beats_;
  double nominal_period_s_;
};

// Jitter variance of a beat, from third differences of four successive beats: their variance is 20
// j^2 whatever the rate. A long log is sampled.
double jitter_variance(std::span<const Beat> beats) {
  std::vector<double> differences;
  for (const Stretch& stretch : sample_stretches(beats.size()))
    for (std::size_t i = stretch.first; i + 3 < stretch.last; ++i)
      if (beats[i + 3].cycle - beats[i].cycle == 3)
        differences.push_back((beats[i + 3].time - beats[i].time) -
                              3.0 * (beats[i + 2].time - beats[i + 1].time));
  constexpr std::size_t fewest_differences = 16;
  return differences.size() < fewest_differences ? 0.0 : trimmed_mean_square(differences) / 20.0;
}

// The jitter of the two ends, plus the largest excess of s^2/k over block counts k beyond the
// scatter that jitter explains. Many short blocks, whose scatter is mostly jitter, count only if
// their scatter clearly exceeds it. Blocks are equally long, so they have equal weights.
double mean_rate_sigma(std::span<const Beat> beats, const ClockError& error) {
  double largest = 0.0;
  constexpr std::size_t few_blocks = 8;
  const std::size_t last = beats.size() - 1;
  const double span_s = beats[last].time - beats[0].time;
  const double grain_s = time_grain(
      std::min(beats.size(), times_for_grain),
      span_s / static_cast<double>(std::max<std::int64_t>(1, beats[last].cycle - beats[0].cycle)),
      [&](std::size_t i) { return beats[i].time - beats[0].time; });
  const double jitter2 =
      std::max(jitter_variance(beats), std::pow(rounding_sigma(grain_s), 2)); // of one end
  const double ends = 2.0 * jitter2 / (span_s * span_s);
  for (std::size_t k = std::min<std::size_t>(4, last); k <= std::min<std::size_t>(64, last);
       k *= 2) {
    double sum = 0.0;
    double sum2 = 0.0;
    for (std::size_t b = 0; b < k; ++b) {
      const std::size_t from = b * last / k;
      const std::size_t to = (b + 1) * last / k;
      const double rate = (error[to] - error[from]) / (beats[to].time - beats[from].time);
      sum += rate;
      sum2 += rate * rate;
    }
    const auto count = static_cast<double>(k);
    const double variance = std::max(0.0, (sum2 - sum * sum / count) / (count - 1.0));
    const double jitter = ends * count * count;
    const bool stands_out = variance > jitter * (1.0 + 3.0 * std::sqrt(2.0 / (count - 1.0)));
    if (k <= few_blocks || stands_out) largest = std::max(largest, (variance - jitter) / count);
  }
  return std::sqrt(ends + largest);
}

// The slope of the straight line fitted to the clock's error. Times are counted from the middle of
// the log and errors from the line through its ends, so that the sums lose few digits.
GOINGRATE_PER_PROCESSOR("fma") // a call of the C library's fma at each beat otherwise
double slope(std::span<const Beat> beats, const ClockError& error) {
  const double half_s = 0.5 * (beats.back().time - beats.front().time);
  const double rate = error[beats.size() - 1] / (2.0 * half_s);
  double st = 0.0, sx = 0.0, stt = 0.0, stx = 0.0;
  for (std::size_t i = 0; i < beats.size(); ++i) {
    const double t = beats[i].time - beats.front().time - half_s;
    const double x = error[i] - rate * (t + half_s);
    st += t;
    sx += x;
    stt += t * t;
    stx += t * x;
  }
  const auto n = static_cast<double>(beats.size());
  return rate + (stx - st * sx / n) / (stt - st * st / n);
}

// Calls `take` with each run of good beats of one mark; with the log itself, uncopied, if it has
// nothing else. A part begins with the last beat of the one before, so that no period falls between
// them, unless the log is split there.
template <class Mark, class Take>
void for_each_part(std::span<const Beat> beats, Mark mark, Take take) {
  constexpr std::size_t nowhere = static_cast<std::size_t>(-1);
  std::size_t begin = nowhere, last = nowhere, count = 0;
  std::int64_t current = 0;
  const auto hand_over = [&] {
    const auto part = beats.subspan(begin, last - begin + 1);
    if (part.size() == count) return take(part);
    std::vector<Beat> good;
    for (const Beat& beat : part)
      if (beat.flag == BeatFlag::good) good.push_back(beat);
    take(std::span<const Beat>(good));
  };
  for (std::size_t i = 0; i < beats.size(); ++i) {
    if (beats[i].flag != BeatFlag::good) continue;
    const std::int64_t now = mark(beats[i]);
    if (begin == nowhere) {
      begin = i;
      count = 0;
    } else if (now != current) {
      hand_over();
      const bool joined = beats[last].segment == beats[i].segment;
      begin = joined ? last : i;
      count = joined ? 1 : 0;
    }
    current = now;
    last = i;
    ++count;
  }
  if (begin != nowhere) hand_over();
}

PartRate part_rate(std::span<const Beat> beats, double nominal_period_s) {
  PartRate part;
  part.segment = beats.front().segment;
  part.from_cycle = beats.front().cycle;
  part.to_cycle = beats.back().cycle;
  part.start = beats.front().time;
  part.rate = summarise_rates(beats, nominal_period_s);
  constexpr std::size_t fewest_for_scatter = 5; // four blocks
  if (beats.size() < fewest_for_scatter)
    part.rate.rate_excess_sigma = std::numeric_limits<double>::quiet_NaN();
  double sum = 0.0, count = 0.0;
  for (const Beat& beat : beats) {
    if (std::isnan(beat.amplitude_rad)) continue;
    sum += beat.amplitude_rad;
    ++count;
  }
  if (count > 0.0) part.amplitude_rad = sum / count;
  return part;
}

} // namespace

RateSummary summarise_rates(std::span<const Beat> beats, double nominal_period_s) {
  if (beats.size() < 3)
    throw ArgumentError("beats", static_cast<double>(beats.size()), "at least 3");
  RateSummary summary;
  const ClockError error(beats, nominal_period_s);
  summary.crossings = static_cast<std::int64_t>(beats.size());
  summary.periods = beats.back().cycle - beats.front().cycle;
  summary.duration_s = beats.back().time - beats.front().time;
  summary.nominal_period_s = nominal_period_s;
  summary.mean_period_s = summary.duration_s / static_cast<double>(summary.periods);
  summary.rate_excess = error[beats.size() - 1] / summary.duration_s;
  summary.rate_excess_sigma = mean_rate_sigma(beats, error);
  summary.mean_period_sigma_s = summary.rate_excess_sigma * summary.mean_period_s;
  const auto& before_last = beats[beats.size() - 2];
  summary.last_period_s = (beats.back().time - before_last.time) /
                          static_cast<double>(beats.back().cycle - before_last.cycle);
  summary.slope_rate_excess = slope(beats, error);
  return summary;
}

std::vector<PartRate> block_rates(std::span<const Beat> beats, double nominal_period_s,
                                  double block_s) {
  if (!(block_s > 0.0)) throw ArgumentError("block", block_s, "a positive number of seconds");
  std::vector<PartRate> blocks;
  const Beat* start = nullptr;
  for_each_part(
      beats,
      [&](const Beat& beat) {
        if (start == nullptr || start->segment != beat.segment) start = &beat;
        const auto block = static_cast<std::int64_t>((beat.time - start->time) / block_s);
        return (static_cast<std::int64_t>(beat.segment) << 40) + block;
      },
      [&](std::span<const Beat> part) {
        if (part.size() >= 3) blocks.push_back(part_rate(part, nominal_period_s));
      });
  return blocks;
}

std::vector<PartRate> segment_rates(std::span<const Beat> beats, double nominal_period_s) {
  std::vector<PartRate> segments;
  for_each_part(
      beats, [](const Beat& beat) { return static_cast<std::int64_t>(beat.segment); },
      [&](std::span<const Beat> part) {
        if (part.size() >= 3) segments.push_back(part_rate(part, nominal_period_s));
      });
  return segments;
}

std::vector<PartRate> rates_between(std::span<const Beat> beats, std::span<const Instant> cuts,
                                    double nominal_period_s) {
  std::vector<PartRate> stretches;
  const auto take = [&](std::span<const Beat> part) {
    if (part.size() >= 3) stretches.push_back(part_rate(part, nominal_period_s));
  };
  const auto place = [&](const auto& is_before) {
    return std::partition_point(beats.begin(), beats.end(), is_before);
  };
  auto first = beats.begin();
  for (const Instant& cut : cuts) {
    const auto end = place([&](const Beat& beat) { return beat.time <= cut; });
    if (end > first) take({first, end});
    first = place([&](const Beat& beat) { return beat.time < cut; });
  }
  take({first, beats.end()});
  return stretches;
}

} // namespace goingrate
