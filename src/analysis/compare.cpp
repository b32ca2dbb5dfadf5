#include "goingrate/analysis/compare.hpp"

#include "base/special_values.hpp"
#include "goingrate/analysis/analyse.hpp"
#include "goingrate/base/errors.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <optional>

namespace goingrate {

namespace {

constexpr std::size_t fewest_common = 64, most_blocks = 240;

/// Interpolates a series with one value per beat linearly; NaN where more than one beat is missing.
/// Times must be asked for in rising order.
class Between {
public:
  Between(std::span<const Beat> beats, std::vector<double> values)
      : beats_(beats), values_(std::move(values)) {}
  double at(const Instant& time) {
    constexpr std::int64_t most_cycles = 2; // from one beat to the next
    while (i_ + 2 < beats_.size() && beats_[i_ + 1].time <= time)
      ++i_;
    const Beat &before = beats_[i_], &after = beats_[i_ + 1];
    if (after.cycle - before.cycle > most_cycles) return not_known;
    return std::lerp(values_[i_], values_[i_ + 1],
                     (time - before.time) / (after.time - before.time));
  }

private:
  std::span<const Beat> beats_;
  std::vector<double> values_;
  std::size_t i_ = 0;
};

/// The common times at which all clocks are sampled.
struct CommonTimes {
  Instant start;
  double step_s = 0.0;
  std::size_t count = 0;
  [[nodiscard]] Instant at(std::size_t k) const { return start + step_s * static_cast<double>(k); }
};

void refuse_mixed_times(std::span<const NumberedLog> logs) {
  const ClockLog& first = logs.front().log;
  for (const NumberedLog& one : logs)
    if ((one.log.origin == TimeOrigin::none) != (first.origin == TimeOrigin::none))
      throw InputError({one.log.source}, times_of(one.log.origin),
                       fmt::format("{}, as in {}", times_of(first.origin), first.source));
}

// A time of this log in the common count, which is from 1970 if the logs have dates.
Instant in_common(const NumberedLog& one, Instant time) {
  time.seconds -= seconds_before_1970(one.log.origin);
  return time;
}

Instant in_own(const NumberedLog& one, Instant time) {
  time.seconds += seconds_before_1970(one.log.origin);
  return time;
}

CommonTimes common_times(std::span<const NumberedLog> logs) {
  refuse_mixed_times(logs);
  CommonTimes common{in_common(logs.front(), logs.front().good.front().time), 0.0, 0};
  Instant end = in_common(logs.front(), logs.front().good.back().time);
  for (const NumberedLog& one : logs) {
    common.start = std::max(common.start, in_common(one, one.good.front().time));
    end = std::min(end, in_common(one, one.good.back().time));
    common.step_s = std::max(common.step_s, one.nominal_period_s);
  }
  const double length = end - common.start;
  if (length > 0.0) common.count = static_cast<std::size_t>(length / common.step_s) + 1;
  if (common.count < fewest_common)
    throw InputError({logs.back().log.source}, fmt::format("{} common periods", common.count),
                     fmt::format("at least {} in the hours that all logs have", fewest_common));
  return common;
}

bool is_known(double value) { return !std::isnan(value); }

std::vector<double> sampled(const NumberedLog& one, std::vector<double> at_beats,
                            const CommonTimes& times) {
  Between series(one.good, std::move(at_beats));
  std::vector<double> values;
  values.reserve(times.count);
  for (std::size_t k = 0; k < times.count; ++k)
    values.push_back(series.at(in_own(one, times.at(k))));
  const auto first = std::find_if(values.begin(), values.end(), is_known);
  const double from = first == values.end() ? 0.0 : *first;
  for (double& value : values)
    value -= from;
  return values;
}

std::span<const Beat> within(const NumberedLog& one, const CommonTimes& times) {
  const std::span<const Beat> beats = one.good;
  const Instant start = in_own(one, times.start), end = in_own(one, times.at(times.count - 1));
  const auto from = std::partition_point(beats.begin(), beats.end(),
                                         [&](const Beat& b) { return b.time < start; });
  const auto to =
      std::partition_point(from, beats.end(), [&](const Beat& b) { return b.time <= end; });
  return {from, to};
}

ComparedClock compared(const NumberedLog& one, const CommonTimes& times,
                       std::span<const std::size_t> factors) {
  ComparedClock clock;
  clock.source = one.log.source;
  const std::span<const Beat> common = within(one, times);
  if (common.size() < fewest_common)
    throw InputError({one.log.source},
                     fmt::format("{} beats in the hours that all logs have", common.size()),
                     fmt::format("at least {}", fewest_common));
  clock.rate = summarise_rates(common, one.nominal_period_s);
  clock.rate.nominal_is_known = one.nominal_is_known;
  add_time_base(clock.rate, one.log.time_base_sigma);
  clock.error_s = sampled(one, clock_error(one.good, one.nominal_period_s), times);
  clock.deviation = stability_table(DeviationKind::oadev, clock.error_s, times.step_s, factors);
  const TimingData data = fit_data(one);
  clock.weather = weather_parts(data);
  if (clock.weather.empty()) return clock;
  clock.own_error_s = clock.error_s;
  for (const WeatherPart& part : clock.weather) {
    const auto term = std::find_if(data.terms.begin(), data.terms.end(),
                                   [&](const RateTerm& t) { return t.name == part.name; });
    const std::vector<double> advance = sampled(one, term->advance_s, times);
    for (std::size_t k = 0; k < advance.size(); ++k)
      clock.own_error_s[k] -= part.coefficient * advance[k];
  }
  clock.own_deviation =
      stability_table(DeviationKind::oadev, clock.own_error_s, times.step_s, factors);
  return clock;
}

// The correlation over the blocks in which both rates are known.
double correlation(std::span<const double> a, std::span<const double> b) {
  double mean_a = 0.0, mean_b = 0.0, count = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!is_known(a[i] + b[i])) continue;
    mean_a += a[i];
    mean_b += b[i];
    ++count;
  }
  mean_a /= count;
  mean_b /= count;
  double aa = 0.0, bb = 0.0, ab = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!is_known(a[i] + b[i])) continue;
    aa += (a[i] - mean_a) * (a[i] - mean_a);
    bb += (b[i] - mean_b) * (b[i] - mean_b);
    ab += (a[i] - mean_a) * (b[i] - mean_b);
  }
  return aa > 0.0 && bb > 0.0 ? ab / std::sqrt(aa * bb) : not_known;
}

std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> result;
  for (std::size_t i = 0; i < a.size(); ++i)
    result.push_back(a[i] - b[i]);
  return result;
}

// The degrees of freedom of a chi2 variable with the relative spread of this variance; n/m if it
// has no interval.
double edf_of(const DeviationRow& row) {
  constexpr double fewest_degrees = 1.0;
  if (!row.interval)
    return std::max(fewest_degrees, static_cast<double>(row.n) / static_cast<double>(row.m));
  const double relative = 0.5 * (row.high * row.high - row.low * row.low) / (row.value * row.value);
  return std::max(fewest_degrees, 2.0 / (relative * relative));
}

/// Estimates the variances of clocks from those of their differences, with standard deviations.
class Hat {
public:
  Hat(std::size_t clocks, double edf) : clocks_(static_cast<Eigen::Index>(clocks)), edf_(edf) {
    for (Eigen::Index i = 0; i < clocks_; ++i)
      for (Eigen::Index j = i + 1; j < clocks_; ++j)
        pairs_.push_back({i, j});
    const double n = static_cast<double>(clocks);
    weights_.resize(clocks_, static_cast<Eigen::Index>(pairs_.size()));
    for (Eigen::Index k = 0; k < weights_.cols(); ++k)
      for (Eigen::Index c = 0; c < clocks_; ++c)
        weights_(c, k) = ((has(k, c) ? 1.0 : 0.0) - 1.0 / (n - 1.0)) / (n - 2.0);
  }

  [[nodiscard]] std::vector<HatEstimate> estimates(std::span<const double> s) const {
    const Eigen::VectorXd found =
        weights_ * Eigen::Map<const Eigen::VectorXd>(s.data(), weights_.cols());
    const Eigen::VectorXd possible = found.cwiseMax(0.0);
    std::vector<HatEstimate> result;
    for (Eigen::Index c = 0; c < clocks_; ++c)
      result.push_back(
          {found[c], scatter(c, possible), std::sqrt(largest_variance(c, found[c], possible))});
    return result;
  }

private:
  struct Pair {
    Eigen::Index i, j;
  };
  [[nodiscard]] bool has(Eigen::Index pair, Eigen::Index clock) const {
    const Pair& p = pairs_[static_cast<std::size_t>(pair)];
    return p.i == clock || p.j == clock;
  }

  // Standard deviation of the estimate of clock c, if the clocks have these variances.
  [[nodiscard]] double scatter(Eigen::Index c, const Eigen::VectorXd& variance) const {
    double sum = 0.0;
    for (Eigen::Index k = 0; k < weights_.cols(); ++k)
      for (Eigen::Index l = 0; l < weights_.cols(); ++l) {
        double shared = 0.0; // the covariance of both differences
        for (Eigen::Index clock = 0; clock < clocks_; ++clock)
          if (has(k, clock) && has(l, clock)) shared += variance[clock];
        sum += weights_(c, k) * weights_(c, l) * 2.0 * shared * shared / edf_;
      }
    return std::sqrt(std::max(0.0, sum));
  }

  // The variance at which an estimate is as low as `found` in 5 cases of 100.
  [[nodiscard]] double largest_variance(Eigen::Index c, double found,
                                        Eigen::VectorXd variance) const {
    constexpr double quantile_95 = 1.644854; // quantile of the normal law, 95 %
    const auto is_too_small = [&](double v) {
      variance[c] = v;
      return v - quantile_95 * scatter(c, variance) < found;
    };
    double low = std::max(0.0, found), high = std::max(low, variance.maxCoeff());
    constexpr int doublings = 40, halvings = 50;
    for (int i = 0; i < doublings && is_too_small(high); ++i)
      high *= 2.0;
    if (is_too_small(high)) return std::numeric_limits<double>::infinity(); // too few degrees
    for (int i = 0; i < halvings; ++i) {
      const double middle = 0.5 * (low + high);
      (is_too_small(middle) ? low : high) = middle;
    }
    return high;
  }

  Eigen::Index clocks_;
  double edf_;
  std::vector<Pair> pairs_;
  Eigen::MatrixXd weights_; // of each difference for each clock
};

std::vector<HatRow> hat_of(const std::vector<DeviationTable>& pairs, std::size_t clocks) {
  std::vector<HatRow> rows;
  for (std::size_t r = 0; r < pairs.front().rows.size(); ++r) {
    std::vector<double> variances;
    double edf = 0.0;
    for (const DeviationTable& pair : pairs) {
      variances.push_back(std::pow(pair.rows[r].value, 2));
      edf += edf_of(pair.rows[r]) / static_cast<double>(pairs.size());
    }
    const bool is_known = std::all_of(variances.begin(), variances.end(),
                                      [](double v) { return std::isfinite(v); });
    if (is_known)
      rows.push_back({pairs.front().rows[r].tau_s, hat_estimates(variances, edf, clocks)});
  }
  return rows;
}

} // namespace

std::vector<double> block_rates_of(std::span<const double> error_s, double step_s,
                                   std::size_t count) {
  std::vector<double> rates;
  for (std::size_t b = 0; b < count; ++b) {
    std::size_t from = b * (error_s.size() - 1) / count, to = (b + 1) * (error_s.size() - 1) / count;
    const std::size_t half = (to - from) / 2;
    while (from < to && !is_known(error_s[from]))
      ++from;
    while (from < to && !is_known(error_s[to]))
      --to;
    const bool is_seen = to - from > half; // of the block
    rates.push_back(is_seen ? (error_s[to] - error_s[from]) /
                                  (step_s * static_cast<double>(to - from))
                            : not_known);
  }
  return rates;
}

std::vector<HatEstimate> hat_estimates(std::span<const double> s, double edf, std::size_t clocks) {
  return Hat(clocks, edf).estimates(s);
}

Comparison compare(std::span<const NumberedLog> logs) {
  if (logs.size() < 2)
    throw ArgumentError("logs", static_cast<double>(logs.size()), "two or more");
  const CommonTimes times = common_times(logs);
  const auto factors = octave_factors(times.count);
  Comparison result{times.start, times.step_s, {}, {}, {}, {}, 0};
  result.blocks = std::min(most_blocks, times.count / 8);
  for (const NumberedLog& one : logs)
    result.clocks.push_back(compared(one, times, factors));
  std::vector<std::vector<double>> rates;
  bool has_weather = false;
  for (const ComparedClock& clock : result.clocks) {
    rates.push_back(block_rates_of(clock.error_s, times.step_s, result.blocks));
    has_weather = has_weather || !clock.own_error_s.empty();
  }
  std::vector<DeviationTable> all, own;
  const auto table_of = [&](const std::vector<double>& a, const std::vector<double>& b) {
    return stability_table(DeviationKind::oadev, difference(a, b), times.step_s, factors);
  };
  const auto own_of = [](const ComparedClock& clock) -> const std::vector<double>& {
    return clock.own_error_s.empty() ? clock.error_s : clock.own_error_s;
  };
  for (std::size_t i = 0; i < logs.size(); ++i)
    for (std::size_t j = i + 1; j < logs.size(); ++j) {
      const ComparedClock &a = result.clocks[i], &b = result.clocks[j];
      all.push_back(table_of(a.error_s, b.error_s));
      result.pairs.push_back({i, j, correlation(rates[i], rates[j]), all.back()});
      if (!has_weather) continue;
      own.push_back(table_of(own_of(a), own_of(b)));
      result.pairs.back().own_deviation = own.back();
    }
  if (logs.size() < 3) return result;
  result.hat = hat_of(all, logs.size());
  if (has_weather) result.own_hat = hat_of(own, logs.size());
  return result;
}

} // namespace goingrate
