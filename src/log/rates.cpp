#include "goingrate/log/rates.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace goingrate {

double nominal_period(const ClockLog& log, const Beats& beats,
                      std::vector<std::string>& assumptions) {
  if (log.nominal_period_s) return *log.nominal_period_s;
  const double mean = beats.typical_period_s;
  const double quarters = std::round(mean * 4.0) / 4.0;
  if (quarters > 0.0 && std::abs(mean / quarters - 1.0) < 0.002) {
    assumptions.push_back(fmt::format(
        "nominal period {} s, the mean period {:.6f} s rounded (--nominal-period says otherwise)",
        quarters, mean));
    return quarters;
  }
  assumptions.push_back(fmt::format("no nominal period is known: rates are relative to the mean "
                                    "period {:.9g} s (--nominal-period says otherwise)",
                                    mean));
  return mean;
}

std::vector<double> rate_per_period(std::span<const Beat> beats, double nominal_period_s) {
  std::vector<double> rates;
  rates.reserve(beats.size());
  for (std::size_t i = 1; i < beats.size(); ++i) {
    const double elapsed = beats[i].time - beats[i - 1].time;
    const std::int64_t cycles = beats[i].cycle - beats[i - 1].cycle;
    const double late =
        residual_from_grid(beats[i].time, beats[i - 1].time, cycles, nominal_period_s);
    rates.push_back((0.0 - late) / elapsed); // keeps the digits that n T0 / dt - 1 loses, and no -0
  }
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

std::vector<double> on_every_cycle(std::span<const Beat> beats, std::span<const double> values) {
  if (beats.size() != values.size())
    throw ArgumentError("values", static_cast<double>(values.size()), "one for each beat");
  const auto cycles = static_cast<std::size_t>(beats.back().cycle - beats.front().cycle) + 1;
  std::vector<double> series(cycles, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < beats.size(); ++i)
    series[static_cast<std::size_t>(beats[i].cycle - beats.front().cycle)] = values[i];
  return series;
}

namespace {

// Largest s/sqrt(k) over block counts k; elapsed times weigh as nothing since blocks are equal.
double mean_rate_sigma(std::span<const Beat> beats, std::span<const double> error) {
  double largest = 0.0;
  const std::size_t last = beats.size() - 1;
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
    largest = std::max(largest, std::sqrt(variance / count));
  }
  return largest;
}

double slope(std::span<const Beat> beats, std::span<const double> error) {
  double st = 0.0, sx = 0.0;
  const auto n = static_cast<double>(beats.size());
  for (std::size_t i = 0; i < beats.size(); ++i) {
    st += beats[i].time - beats[0].time;
    sx += error[i];
  }
  double stt = 0.0, stx = 0.0;
  for (std::size_t i = 0; i < beats.size(); ++i) {
    const double t = beats[i].time - beats[0].time - st / n;
    stt += t * t;
    stx += t * (error[i] - sx / n);
  }
  return stx / stt;
}

} // namespace

RateSummary summarise_rates(std::span<const Beat> beats, double nominal_period_s) {
  if (beats.size() < 3)
    throw ArgumentError("beats", static_cast<double>(beats.size()), "at least 3");
  RateSummary summary;
  const auto error = clock_error(beats, nominal_period_s);
  summary.crossings = static_cast<std::int64_t>(beats.size());
  summary.periods = beats.back().cycle - beats.front().cycle;
  summary.duration_s = beats.back().time - beats.front().time;
  summary.nominal_period_s = nominal_period_s;
  summary.mean_period_s = summary.duration_s / static_cast<double>(summary.periods);
  summary.rate_excess = error.back() / summary.duration_s;
  summary.rate_excess_sigma = mean_rate_sigma(beats, error);
  summary.mean_period_sigma_s = summary.rate_excess_sigma * summary.mean_period_s;
  const auto& before_last = beats[beats.size() - 2];
  summary.last_period_s = (beats.back().time - before_last.time) /
                          static_cast<double>(beats.back().cycle - before_last.cycle);
  summary.slope_rate_excess = slope(beats, error);
  return summary;
}

} // namespace goingrate
