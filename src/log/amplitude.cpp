#include "goingrate/log/amplitude.hpp"

#include "issue_list.hpp"
#include "typical_period.hpp"

#include "base/scaled_time.hpp"
#include "goingrate/clock/restoring.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numbers>
#include <vector>

namespace goingrate {

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

double median_amplitude(const ClockLog& log) {
  std::vector<double> known;
  for (const Beat& event : log.events)
    if (!std::isnan(event.amplitude_rad)) known.push_back(event.amplitude_rad);
  return known.empty() ? 0.0 : median(known);
}

} // namespace

double amplitude_from_width(double width_s, double flag_width_rad, double period_s,
                            double gravity_share) {
  const double half = 0.5 * flag_width_rad;
  const double tau = two_pi * width_s / period_s;
  if (!(tau > 0.0 && tau < std::numbers::pi)) return unknown;
  double amplitude = half / std::sin(0.5 * tau);
  // Newton with the slope of small swings: each step gains a factor of the amplitude squared.
  constexpr int most_steps = 60;
  for (int i = 0; i < most_steps; ++i) {
    if (!(amplitude > half && amplitude < 3.1)) return unknown; // never reaches, or turns over
    const double excess = free_passage_time(gravity_share, amplitude, half) - tau;
    const double step = excess * amplitude / (2.0 * std::tan(0.5 * tau));
    amplitude += step;
    if (std::abs(step) < 1e-14 * amplitude) return amplitude;
  }
  return unknown;
}

double small_swing_period(const ClockLog& log, double flag_width_rad, double period_s,
                          double gravity_share) {
  double found = period_s;
  constexpr int rounds = 4; // each leaves an eighth of the squared amplitude of the error before
  for (int round = 0; round < rounds; ++round) {
    std::vector<double> periods;
    const Beat* before = nullptr;
    for (std::size_t i = 0; i < log.events.size(); ++i) {
      const Beat& beat = log.events[i];
      if (beat.flag != BeatFlag::good) continue;
      const double amplitude =
          amplitude_from_width(log.columns.width_s[i], flag_width_rad, found, gravity_share);
      if (before != nullptr && before->segment == beat.segment && before->cycle < beat.cycle &&
          std::isfinite(amplitude))
        periods.push_back((beat.time - before->time) /
                          static_cast<double>(beat.cycle - before->cycle) /
                          free_period_ratio(gravity_share, amplitude));
      before = &beat;
    }
    if (!periods.empty()) found = median(periods);
  }
  return found;
}

namespace {

// epsilon from the fall of the amplitudes about each event that has one: -(d log A/d cycle)/2 pi.
// NaN if too few amplitudes are known.
std::vector<double> local_friction(const ClockLog& log, double period_s) {
  constexpr std::size_t reach = 20; // events either way
  std::vector<std::size_t> known;
  for (std::size_t i = 0; i < log.events.size(); ++i)
    if (!std::isnan(log.events[i].amplitude_rad) && log.events[i].flag != BeatFlag::spurious)
      known.push_back(i);
  std::vector<double> friction(log.events.size(), unknown);
  for (std::size_t k = 0; k < known.size(); ++k) {
    double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
    const Beat& here = log.events[known[k]];
    for (std::size_t j = k > reach ? k - reach : 0; j < std::min(known.size(), k + reach + 1);
         ++j) {
      const Beat& beat = log.events[known[j]];
      if (beat.segment != here.segment) continue;
      const double cycles = (beat.time - here.time) / period_s,
                   log_a = std::log(beat.amplitude_rad);
      ++n, x += cycles, y += log_a, xx += cycles * cycles, xy += cycles * log_a;
    }
    const double spread = n * xx - x * x;
    if (n > 2.0 && spread > 0.0) friction[known[k]] = -(n * xy - x * y) / spread / two_pi;
  }
  return friction;
}

} // namespace

void correct_widths_for_friction(ClockLog& log, double flag_width_rad, double period_s) {
  const std::vector<double> friction = local_friction(log, period_s);
  for (std::size_t i = 0; i < log.events.size(); ++i) {
    if (!std::isfinite(friction[i])) continue;
    Beat& beat = log.events[i];
    const double half = std::asin(0.5 * flag_width_rad / beat.amplitude_rad), // of tau
        late = std::atan(std::tanh(friction[i] * half) * std::tan(half));
    beat.time = beat.time + -log.columns.width_s[i] * late / (2.0 * half);
    beat.amplitude_rad *=
        std::exp(friction[i] * (half + late)) * std::sin(half) / std::sin(half + late);
  }
}

double amplitude_sigma_from_width(double width_s, double sigma_s, double amplitude_rad,
                                  double period_s) {
  return amplitude_rad / std::tan(std::numbers::pi * width_s / period_s) * std::numbers::pi *
         sigma_s / period_s;
}

void set_amplitudes_from_widths(ClockLog& log, double flag_width_rad, double period_s,
                                double gravity_share) {
  IssueList issues(log, false);
  for (std::size_t i = 0; i < log.events.size(); ++i) {
    Beat& event = log.events[i];
    const double width = log.columns.width_s[i];
    if (std::isnan(width)) continue;
    event.amplitude_rad = amplitude_from_width(width, flag_width_rad, period_s, gravity_share);
    log.has_amplitude = log.has_amplitude || !std::isnan(event.amplitude_rad);
    if (std::isnan(event.amplitude_rad))
      issues.add(event.line, 1, IssueKind::out_of_range,
                 fmt::format("a width of {:.6g} s, which fits no swing over this flag", width),
                 "amplitude taken as unknown");
  }
  log.assumptions.push_back(
      {fmt::format("amplitudes from the widths, for a flag {:g} mrad wide", flag_width_rad * 1e3),
       Setting::flag_width});
}

double rate_without_circular_error(double rate_excess, double amplitude_rad, double gravity_share) {
  if (amplitude_rad == 0.0) return rate_excess;
  const double longer = free_period_ratio(gravity_share, amplitude_rad);
  // (1 + r) k - 1 without loss of digits
  return rate_excess * longer + (longer - 1.0);
}

void move_to_vertical(ClockLog& log, double rising_rad, double falling_rad, double period_s) {
  if (rising_rad == 0.0 && falling_rad == 0.0) return;
  const double typical = median_amplitude(log);
  IssueList issues(log, false);
  for (Beat& event : log.events) {
    const double angle = event.edge == Edge::up ? rising_rad : -falling_rad;
    const bool reaches = event.amplitude_rad > std::abs(angle);
    if (!reaches)
      issues.add(event.line, 1, IssueKind::missing,
                 std::isnan(event.amplitude_rad)
                     ? std::string("no amplitude")
                     : fmt::format("amplitude {} rad that does not reach the sensor at {} rad",
                                   event.amplitude_rad, angle),
                 "the log's median amplitude taken for its time");
    const double amplitude = reaches ? event.amplitude_rad : typical;
    if (amplitude > std::abs(angle))
      event.time = event.time + -std::asin(angle / amplitude) * period_s / two_pi;
  }
  log.assumptions.push_back({fmt::format(
      "times moved from the sensor at {:.4g} mrad to the vertical, with each beat's amplitude",
      rising_rad * 1e3)});
}

} // namespace goingrate
