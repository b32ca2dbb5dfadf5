// Notation: x phase in s, N phases, tau0 sampling interval, m averaging factor, n differences used.
#include "goingrate/spectra/stability.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "goingrate/base/errors.hpp"
#include "goingrate/base/sums.hpp"
#include "goingrate/spectra/noise_type.hpp"

namespace goingrate {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

void check_interval(double tau0_s) {
  if (!(tau0_s > 0.0) || !std::isfinite(tau0_s))
    throw ArgumentError("tau0_s", tau0_s, "finite and above 0");
}

void check_factors(std::span<const std::size_t> factors, std::size_t phase_points) {
  std::size_t previous = 0;
  for (std::size_t m : factors) {
    if (m <= previous)
      throw ArgumentError("factors", static_cast<double>(m), "1 or more and strictly increasing");
    if (m > (phase_points - 1) / 2)
      throw ArgumentError("factors", static_cast<double>(m), "below half the number of phases");
    previous = m;
  }
}

void check_phase(std::span<const double> phase_s) {
  if (phase_s.size() < 3)
    throw ArgumentError("phase_s.size()", static_cast<double>(phase_s.size()), "3 or more");
  for (double x : phase_s)
    if (std::isinf(x)) throw ArgumentError("phase_s", x, "finite, or NaN for a gap");
}

// The phase less the line through its first and last known point. x - x_first errs by no more than
// the rounding already in x; the fused product then takes away an exact multiple of i.
std::vector<double> without_end_line(std::span<const double> phase_s) {
  std::vector<double> rest(phase_s.begin(), phase_s.end());
  const auto known = [](double x) { return !std::isnan(x); };
  const auto first = std::find_if(rest.begin(), rest.end(), known);
  if (first == rest.end()) return rest;
  const auto last = std::find_if(rest.rbegin(), rest.rend(), known).base() - 1;
  const double offset = *first;
  const double steps = static_cast<double>(last - first);
  const double slope = steps > 0.0 ? (*last - offset) / steps : 0.0;
  for (std::size_t i = 0; i < rest.size(); ++i)
    rest[i] = std::fma(-slope, static_cast<double>(i), rest[i] - offset);
  return rest;
}

struct SquareSum {
  double sum = 0.0;
  std::size_t n = 0;
};

SquareSum sum_squared_differences(std::span<const double> x, std::size_t m, std::size_t stride) {
  SquareSum total;
  for (std::size_t i = 0; i + 2 * m < x.size(); i += stride) {
    const double difference = (x[i + 2 * m] - x[i + m]) - (x[i + m] - x[i]);
    if (std::isnan(difference)) continue;
    total.sum += difference * difference;
    ++total.n;
  }
  return total;
}

// Noise for the first row of a table when the factor asked for leaves too few points: the largest
// smaller factor that leaves 30, which is the nearest averaging time at which anything is known.
NoiseType noise_at_or_below(std::span<const double> x, std::size_t m) {
  const NoiseType here = identify_noise(x, m);
  const std::size_t largest = (x.size() - 1) / (least_points_for_noise_type - 1);
  if (here.identified || largest == 0 || largest >= m) return here;
  return identify_noise(x, largest);
}

DeviationRow deviation_row(DeviationKind kind, std::span<const double> x, double tau0_s,
                           std::size_t m) {
  const bool overlapped = kind == DeviationKind::oadev;
  const SquareSum total = sum_squared_differences(x, m, overlapped ? 1 : m);
  const double tau_s = static_cast<double>(m) * tau0_s;
  const double value =
      total.n > 0 ? std::sqrt(total.sum / (2.0 * static_cast<double>(total.n))) / tau_s : nan;
  return {tau_s, m, total.n, value, nan, nan, 0, false};
}

void add_interval(DeviationRow& row, DeviationKind kind, const NoiseType& noise) {
  if (!noise.identified) return;
  row.alpha = noise.alpha;
  if (row.n == 0 || noise.alpha < -2) return;
  const auto stride =
      kind == DeviationKind::oadev ? DifferenceStride::one_sample : DifferenceStride::one_tau;
  const double degrees = allan_degrees_of_freedom(noise.alpha, row.m, row.n, stride);
  const DeviationInterval interval = chi_squared_interval(row.value, degrees);
  row.low = interval.low;
  row.high = interval.high;
  row.interval = true;
}

void check_points(std::size_t phase_points) {
  if (phase_points < 3)
    throw ArgumentError("phase_points", static_cast<double>(phase_points), "3 or more");
}

} // namespace

DeviationTable allan_deviation(DeviationKind kind, std::span<const double> phase_s, double tau0_s,
                               std::span<const std::size_t> factors) {
  check_phase(phase_s);
  check_interval(tau0_s);
  check_factors(factors, phase_s.size());
  const std::vector<double> x = without_end_line(phase_s);
  DeviationTable table{kind, tau0_s, {}};
  table.rows.reserve(factors.size());
  NoiseType noise; // of the last row in which it could be identified
  for (std::size_t m : factors) {
    const NoiseType found = noise.identified ? identify_noise(x, m) : noise_at_or_below(x, m);
    if (found.identified) noise = found;
    DeviationRow row = deviation_row(kind, x, tau0_s, m);
    add_interval(row, kind, noise);
    table.rows.push_back(row);
  }
  return table;
}

std::vector<std::size_t> octave_factors(std::size_t phase_points) {
  check_points(phase_points);
  std::vector<std::size_t> factors;
  for (std::size_t m = 1; m <= (phase_points - 1) / 2; m *= 2)
    factors.push_back(m);
  return factors;
}

std::vector<std::size_t> decade_factors(std::size_t phase_points) {
  check_points(phase_points);
  const std::size_t largest = (phase_points - 1) / 2;
  std::vector<std::size_t> factors;
  for (std::size_t decade = 1; decade <= largest; decade *= 10)
    for (std::size_t step : {1, 2, 4})
      if (step * decade <= largest) factors.push_back(step * decade);
  return factors;
}

std::vector<std::size_t> all_factors(std::size_t phase_points) {
  check_points(phase_points);
  std::vector<std::size_t> factors((phase_points - 1) / 2);
  for (std::size_t i = 0; i < factors.size(); ++i)
    factors[i] = i + 1;
  return factors;
}

std::vector<double> phase_from_frequency(std::span<const double> y, double tau0_s,
                                         double gap_frequency) {
  check_interval(tau0_s);
  if (!std::isfinite(gap_frequency)) throw ArgumentError("gap_frequency", gap_frequency, "finite");
  std::vector<double> phase;
  phase.reserve(y.size() + 1);
  phase.push_back(0.0);
  TwoPart<double> sum; // of frequencies; two parts, so that long series do not collect rounding
  for (double frequency : y) {
    if (std::isinf(frequency)) throw ArgumentError("y", frequency, "finite, or NaN for a gap");
    const bool gap = std::isnan(frequency);
    sum += gap ? gap_frequency : frequency;
    phase.push_back(gap ? nan : sum.value() * tau0_s);
  }
  return phase;
}

std::vector<std::size_t> factors_for(std::span<const double> taus_s, std::size_t phase_points,
                                     double tau0_s) {
  std::vector<std::size_t> factors;
  for (const double tau : taus_s) {
    const double m = std::round(tau / tau0_s);
    const bool multiple = std::abs(m * tau0_s - tau) <= 1e-6 * tau;
    if (!multiple || !(m >= 1.0) || !(2.0 * m < static_cast<double>(phase_points)))
      throw ArgumentError("tau", tau,
                          "a multiple of " + std::to_string(tau0_s) + " s below half the data");
    factors.push_back(static_cast<std::size_t>(m));
  }
  std::sort(factors.begin(), factors.end());
  factors.erase(std::unique(factors.begin(), factors.end()), factors.end());
  return factors;
}

} // namespace goingrate
