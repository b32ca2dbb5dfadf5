#include "goingrate/fit/timing_data.hpp"

#include "base/scaled_time.hpp"
#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <cmath>

namespace goingrate {

TimingData timing_data(std::span<const Beat> beats) {
  if (beats.size() < 3)
    throw ArgumentError("beats", static_cast<double>(beats.size()), "at least 3");
  TimingData data;
  const Beat& first = beats.front();
  data.reference_period_s =
      (beats.back().time - first.time) / static_cast<double>(beats.back().cycle - first.cycle);
  const bool amplitudes = std::any_of(
      beats.begin(), beats.end(), [](const Beat& beat) { return !std::isnan(beat.amplitude_rad); });
  data.cycle.reserve(beats.size());
  data.elapsed_s.reserve(beats.size());
  data.lateness_s.reserve(beats.size());
  if (amplitudes) data.amplitude_rad.reserve(beats.size());
  for (const Beat& beat : beats) {
    const std::int64_t n = beat.cycle - first.cycle;
    data.cycle.push_back(static_cast<double>(n));
    data.elapsed_s.push_back(beat.time - first.time);
    data.lateness_s.push_back(
        residual_from_grid(beat.time, first.time, n, data.reference_period_s));
    if (amplitudes) data.amplitude_rad.push_back(beat.amplitude_rad);
  }
  RateTerm drift{"drift", "1/day", {}};
  const double length = data.elapsed_s.back();
  drift.advance_s.reserve(beats.size());
  for (const double t : data.elapsed_s)
    drift.advance_s.push_back(0.5 * t * (t - length) / seconds_per_day);
  data.terms.push_back(std::move(drift));
  return data;
}

namespace {

// The values with unknown ones filled in: on the straight line between their known neighbours, or,
// before the first of these and after the last, equal to it. All 0 if none is known.
std::vector<double> without_holes(std::span<const double> values, std::span<const double> t) {
  std::vector<double> filled(values.begin(), values.end());
  const auto is_known = [](double v) { return std::isfinite(v); };
  const auto first = std::find_if(filled.begin(), filled.end(), is_known);
  if (first == filled.end()) return std::vector<double>(values.size(), 0.0);
  std::fill(filled.begin(), first, *first);
  auto before = static_cast<std::size_t>(first - filled.begin());
  for (std::size_t i = before + 1; i < filled.size(); ++i) {
    if (!is_known(values[i])) continue;
    const double slope = (values[i] - values[before]) / (t[i] - t[before]);
    for (std::size_t k = before + 1; k < i; ++k)
      filled[k] = values[before] + slope * (t[k] - t[before]);
    before = i;
  }
  std::fill(filled.begin() + static_cast<std::ptrdiff_t>(before) + 1, filled.end(), filled[before]);
  return filled;
}

} // namespace

RateTerm rate_term(std::string name, std::string unit, const TimingData& data,
                   std::span<const double> values) {
  const std::vector<double> value = without_holes(values, data.elapsed_s);
  RateTerm term{std::move(name), std::move(unit), {0.0}};
  double sum = 0.0;
  for (std::size_t i = 1; i < data.size(); ++i) {
    sum += 0.5 * (value[i - 1] + value[i]) * (data.elapsed_s[i] - data.elapsed_s[i - 1]);
    term.advance_s.push_back(sum);
  }
  const double mean = sum / data.elapsed_s.back();
  for (std::size_t i = 0; i < data.size(); ++i)
    term.advance_s[i] -= mean * data.elapsed_s[i];
  const auto is_unknown = [](double v) { return !std::isfinite(v); };
  if (std::any_of(values.begin(), values.end(), is_unknown))
    for (const double v : values)
      term.is_known.push_back(is_unknown(v) ? 0 : 1);
  return term;
}

std::vector<double> relative_noise(std::span<const double> sigmas) {
  constexpr double largest_spread = 0.1; // relative: sigmas this near their rms count as equal
  double sum2 = 0.0, known = 0.0;
  for (const double sigma : sigmas) {
    if (!(sigma > 0.0) || !std::isfinite(sigma)) continue;
    sum2 += sigma * sigma;
    ++known;
  }
  if (known == 0.0) return {};
  const double rms = std::sqrt(sum2 / known);
  std::vector<double> relative;
  bool differ = false;
  for (const double sigma : sigmas) {
    relative.push_back(sigma > 0.0 && std::isfinite(sigma) ? sigma / rms : 1.0);
    differ = differ || std::abs(relative.back() - 1.0) > largest_spread;
  }
  return differ ? relative : std::vector<double>{};
}

TimingData subset(const TimingData& data, std::span<const std::size_t> chosen) {
  TimingData part;
  part.reference_period_s = data.reference_period_s;
  for (const RateTerm& term : data.terms)
    part.terms.push_back({term.name, term.unit, {}, {}, term.sigma, term.step_s});
  for (const std::size_t i : chosen) {
    part.cycle.push_back(data.cycle[i]);
    part.elapsed_s.push_back(data.elapsed_s[i]);
    part.lateness_s.push_back(data.lateness_s[i]);
    if (data.has_amplitude()) part.amplitude_rad.push_back(data.amplitude_rad[i]);
    if (!data.time_noise.empty()) part.time_noise.push_back(data.time_noise[i]);
    if (!data.amplitude_noise.empty()) part.amplitude_noise.push_back(data.amplitude_noise[i]);
    for (std::size_t k = 0; k < data.terms.size(); ++k) {
      part.terms[k].advance_s.push_back(data.terms[k].advance_s[i]);
      if (!data.terms[k].is_known.empty())
        part.terms[k].is_known.push_back(data.terms[k].is_known[i]);
    }
  }
  return part;
}

} // namespace goingrate
