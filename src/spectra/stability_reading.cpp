#include "spectra/stability_reading.hpp"

#include <cmath>
#include <limits>

#include "goingrate/base/errors.hpp"

namespace goingrate {
namespace {

using Kind = DeviationKind;

double slope_between(const DeviationRow& a, const DeviationRow& b) {
  return std::log(b.value / a.value) / std::log(b.tau_s / a.tau_s);
}

double prediction_factor(int alpha) {
  if (alpha >= 1) return 1.0 / std::sqrt(3.0);
  return alpha == -1 ? 1.0 / std::sqrt(std::log(2.0)) : 1.0;
}

// Overlapped rows at long tau rest on hardly more than one span of data; n/m counts the spans.
bool is_usable(const DeviationRow& row, Kind kind) {
  const bool overlapped = kind == Kind::oadev;
  const bool enough = overlapped ? row.n >= 2 * row.m : row.n >= 2;
  return row.interval && row.value > 0.0 && enough;
}

} // namespace

std::vector<SlopeRegion> slope_regions(const DeviationTable& table) {
  std::vector<SlopeRegion> regions;
  const DeviationRow* first = nullptr; // of the run the row before belongs to
  for (const DeviationRow& row : table.rows) {
    if (!row.interval || !(row.value > 0.0)) {
      first = nullptr;
      continue;
    }
    if (first == nullptr || first->alpha != row.alpha) {
      first = &row;
      regions.push_back(
          {row.tau_s, row.tau_s, std::numeric_limits<double>::quiet_NaN(), row.alpha});
      continue;
    }
    regions.back().to_s = row.tau_s;
    regions.back().slope = slope_between(*first, row);
  }
  return regions;
}

double slope_of_noise(DeviationKind kind, int alpha) {
  const double plain = alpha >= 1 ? -1.0 : -0.5 * static_cast<double>(alpha + 1);
  const double modified = alpha >= 2 ? -1.5 : plain;
  switch (kind) {
  case Kind::mdev:
  case Kind::mtotdev:
  case Kind::pdev:
    return modified;
  case Kind::tdev:
  case Kind::ttotdev:
    return modified + 1.0;
  case Kind::mtie:
  case Kind::tierms:
    return std::numeric_limits<double>::quiet_NaN();
  default:
    return plain;
  }
}

bool may_be_noise(const SlopeRegion& region, DeviationKind kind) {
  constexpr double largest_slope_difference = 0.4; // a slope over one octave scatters by 0.2 or so
  return !(std::abs(region.slope - slope_of_noise(kind, region.alpha)) > largest_slope_difference);
}

std::optional<double> jitter_of(const DeviationTable& table) {
  if (table.rows.empty()) return std::nullopt;
  const DeviationRow& row = table.rows.front();
  if (row.m != 1 || !row.interval || row.alpha != 2) return std::nullopt;
  switch (table.kind) {
  case Kind::hdev:
  case Kind::ohdev:
  case Kind::htotdev:
    return row.value * row.tau_s / std::sqrt(10.0 / 3.0);
  case Kind::tdev: // tau MDEV / sqrt 3
    return row.value;
  case Kind::adev:
  case Kind::oadev:
  case Kind::mdev:
  case Kind::totdev:
  case Kind::theoh:
  case Kind::pdev:
    return row.value * row.tau_s / std::sqrt(3.0);
  default:
    return std::nullopt;
  }
}

std::optional<TimePrediction> predict_time_error(const DeviationTable& table, double after_s) {
  if (!(after_s > 0.0) || !std::isfinite(after_s))
    throw ArgumentError("after_s", after_s, "finite and above 0");
  if (table.kind != Kind::adev && table.kind != Kind::oadev && table.kind != Kind::totdev &&
      table.kind != Kind::theoh)
    return std::nullopt;
  const DeviationRow *before = nullptr, *next = nullptr;
  for (const DeviationRow& row : table.rows) {
    if (!is_usable(row, table.kind)) continue;
    if (row.tau_s <= after_s) before = &row;
    if (row.tau_s > after_s && next == nullptr) next = &row;
  }
  if (before == nullptr) return std::nullopt; // shorter than the shortest tau
  const double slope =
      next != nullptr ? slope_between(*before, *next) : slope_of_noise(table.kind, before->alpha);
  const double sigma = before->value * std::pow(after_s / before->tau_s, slope);
  const double k = prediction_factor(before->alpha);
  const bool beyond = next == nullptr && after_s > before->tau_s * (1.0 + 1e-9); // a rounding
  return TimePrediction{after_s, k * after_s * sigma, k, before->alpha, before->tau_s, beyond};
}

} // namespace goingrate
