// Suggests other readings of a log that cannot be what it was taken for.
#include "column_names.hpp"
#include "typical_period.hpp"

#include "goingrate/log/rates.hpp"
#include "goingrate/log/reading.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace goingrate {

namespace {

constexpr double largest_rate_excess = 0.05; // no pendulum clock is off by an hour a day

OtherReading with_nominal(double period_s, bool both_edges) {
  OtherReading other;
  other.nominal_period_s = rounded_period(both_edges ? 2.0 * period_s : period_s);
  other.both_edges = both_edges;
  other.words = fmt::format("{}{:.6g} s",
                            both_edges ? "both directions are in the log, of a period of "
                                       : "the nominal period is ",
                            *other.nominal_period_s);
  return other;
}

} // namespace

std::vector<OtherReading> readings_for_period(double step_s, double nominal_s) {
  std::vector<OtherReading> others;
  for (const TimeUnit& unit : {in_milliseconds, in_microseconds, in_nanoseconds, in_minutes}) {
    const double in_unit_s = step_s * unit.seconds * std::pow(10.0, unit.power);
    const double periods = std::round(in_unit_s / nominal_s);
    if (periods < 1.0 || std::abs(in_unit_s / (periods * nominal_s) - 1.0) > largest_rate_excess ||
        periods > 4.0)
      continue;
    others.push_back({.words = fmt::format("the times are in {}", name_of(unit)),
                      .unit = std::string(name_of(unit))});
  }
  others.push_back(with_nominal(step_s, false));
  if (others.size() < 2) others.push_back(with_nominal(step_s, true));
  return others;
}

std::vector<OtherReading> readings_for_phases(const GridData& grid) {
  std::vector<double> values;
  std::copy_if(grid.phase_s.begin(), grid.phase_s.end(), std::back_inserter(values),
               [](double x) { return !std::isnan(x); });
  const bool whole = std::all_of(values.begin(), values.end(),
                                 [](double x) { return x >= 0.0 && x == std::round(x); });
  const double size = median(values);
  OtherReading periods{.words = "each value is a period", .format = LogFormat::periods};
  for (const TimeUnit& unit : {in_seconds, in_milliseconds, in_microseconds, in_nanoseconds}) {
    const double period_s = size * unit.seconds * std::pow(10.0, unit.power);
    if (!(period_s >= 0.02 && period_s < 100.0)) continue; // of a pendulum
    periods.unit = name_of(unit);
    periods.words = fmt::format("each value is a period in {}", name_of(unit));
    break;
  }
  std::vector<OtherReading> others;
  if (whole && !periods.unit.empty()) {
    others.push_back({.words = "a counter in microseconds that begins again at 65536",
                      .format = LogFormat::timestamps,
                      .nominal_period_s = 2.0,
                      .wrap_s = 0.065536,
                      .unit = "us"});
    others.push_back(std::move(periods));
  } else if (!periods.unit.empty() && values.front() > 0.0) {
    others.push_back(std::move(periods));
  }
  if (others.size() < 2)
    others.push_back(
        {.words = "each value is a relative frequency", .format = LogFormat::frequency});
  if (others.size() < 2)
    others.push_back({.words = "the values are phases, but not of a clock that is looked at as one",
                      .format = LogFormat::phase});
  return others;
}

} // namespace goingrate
