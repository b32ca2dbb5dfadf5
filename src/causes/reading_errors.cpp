#include "reading_errors.hpp"

#include "answer.hpp"
#include "rate_blocks.hpp"

#include "goingrate/spectra/spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <utility>

namespace goingrate::timing_model {

namespace {

// Mean power of the upper half of a spectrum, from its median, so that a line does not count.
double level_of_errors(std::span<const double> cosines) {
  std::vector<double> upper;
  for (const double c : cosines.last(cosines.size() / 2))
    upper.push_back(c * c);
  const auto middle = upper.begin() + static_cast<std::ptrdiff_t>(upper.size() / 2);
  std::nth_element(upper.begin(), middle, upper.end());
  constexpr double median_of_a_square = 0.4549; // of a normal variable of unit variance
  return *middle / median_of_a_square;
}

} // namespace

std::vector<double> signal_shares(std::span<const double> cosines) {
  const std::size_t n = cosines.size();
  const double errors = level_of_errors(cosines);
  std::vector<double> sums(n + 1, 0.0); // of all powers before each index
  for (std::size_t k = 0; k < n; ++k)
    sums[k + 1] = sums[k] + cosines[k] * cosines[k];
  constexpr double relative_reach = 0.1; // of a frequency, to either side
  constexpr std::size_t least_reach = 2;
  constexpr double sigmas = 3.0; // by which a mean power must exceed that of the errors
  std::vector<double> shares(n, 0.0);
  for (std::size_t k = 0; k < n; ++k) {
    const auto reach =
        std::max(least_reach, static_cast<std::size_t>(relative_reach * static_cast<double>(k)));
    const std::size_t from = k - std::min(k, reach), to = std::min(n, k + reach + 1);
    const auto count = static_cast<double>(to - from);
    const double power = (sums[to] - sums[from]) / count;
    const double chance = errors * (1.0 + sigmas * std::sqrt(2.0 / count));
    if (power > chance) shares[k] = 1.0 - errors / power;
  }
  return shares;
}

namespace {

// The series with these cosine coefficients: the first half of a series of twice the length that
// is even about its ends.
std::vector<double> series_of_cosines(std::span<const double> cosines) {
  const std::size_t n = cosines.size();
  const auto doubled = 2.0 * static_cast<double>(n);
  std::vector<std::complex<double>> transform(n + 1);
  for (std::size_t k = 0; k < n; ++k)
    transform[k] =
        std::polar(std::sqrt(doubled), std::numbers::pi * static_cast<double>(k) / doubled) *
        cosines[k];
  std::vector<double> series = inverse_real_transform(transform, 2 * n);
  series.resize(n);
  return series;
}

struct FreedReadings {
  std::vector<double> values; // unknown ones stay unknown
  double sigma;               // of the error of one reading
};

FreedReadings without_errors(std::span<const double> readings) {
  FreedReadings freed{{readings.begin(), readings.end()}, 0.0};
  std::vector<double> known;
  for (const double v : readings)
    known.push_back(std::isfinite(v) ? 1.0 : 0.0);
  std::vector<double> errors = freed.values;
  put_lines(known, errors);
  errors = cosines(errors, true);
  const std::vector<double> shares = signal_shares(errors);
  freed.sigma = std::sqrt(level_of_errors(errors));
  for (std::size_t k = 0; k < errors.size(); ++k)
    errors[k] *= 1.0 - shares[k];
  errors = series_of_cosines(errors);
  for (std::size_t i = 0; i < freed.values.size(); ++i)
    freed.values[i] -= errors[i];
  return freed;
}

// Whether the first of two terms explains the rate better than the second by more than a price.
bool is_likelier(const RateTerm& one, const RateTerm& other, TimingData& data) {
  constexpr std::size_t most_blocks = 1024, first = 2; // the mean and the line
  constexpr double price = 8.0; // in 2 log L: the second term is the one to be expected
  const std::size_t at = data.terms.size();
  data.terms.push_back(one);
  data.terms.push_back(other);
  const RateBlocks blocks = rate_blocks(data, std::min(most_blocks, data.size() / 8));
  data.terms.resize(at);
  const std::vector<double> rate = cosines(blocks.rate, true);
  const auto deviance = [&](std::size_t term) {
    return regress(rate, {cosines(blocks.values[term], true)}, RateNoise(first, {})).deviance;
  };
  return deviance(at) + price < deviance(at + 1);
}

} // namespace

void add_readings(std::string name, std::string unit, std::span<const double> readings,
                  TimingData& data) {
  RateTerm term = rate_term(name, unit, data, readings);
  constexpr std::size_t least_beats = 256; // below that, the level of the errors is a guess
  const bool is_known =
      std::any_of(readings.begin(), readings.end(), [](double v) { return std::isfinite(v); });
  if (readings.size() >= least_beats && is_known) {
    const FreedReadings freed = without_errors(readings);
    RateTerm smooth = rate_term(std::move(name), std::move(unit), data, freed.values);
    // Scaled to one reading per period, which has the same effect on the times.
    const auto count = static_cast<double>(
        std::count_if(readings.begin(), readings.end(), [](double v) { return std::isfinite(v); }));
    const double interval_s = data.elapsed_s.back() / (count - 1.0);
    smooth.sigma = freed.sigma * std::sqrt(interval_s / data.reference_period_s);
    if (!is_likelier(term, smooth, data)) term = std::move(smooth);
  }
  data.terms.push_back(std::move(term));
}

} // namespace goingrate::timing_model
