#include "goingrate/log/amplitude.hpp"

#include "issue_list.hpp"
#include "typical_period.hpp"

#include "base/scaled_time.hpp"
#include "base/special_values.hpp"
#include "goingrate/clock/restoring.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <vector>

namespace goingrate {

namespace {

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
  if (!(tau > 0.0 && tau < std::numbers::pi)) return not_known;
  double amplitude = half / std::sin(0.5 * tau);
  // Newton with the slope of small swings: each step gains a factor of the amplitude squared.
  constexpr int most_steps = 60;
  for (int i = 0; i < most_steps; ++i) {
    if (!(amplitude > half && amplitude < 3.1)) return not_known; // never reaches, or turns over
    const double excess = free_passage_time(gravity_share, amplitude, half) - tau;
    const double step = excess * amplitude / (2.0 * std::tan(0.5 * tau));
    amplitude += step;
    if (std::abs(step) < 1e-14 * amplitude) return amplitude;
  }
  return not_known;
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

// The fall of the amplitude A over a radian of phase, f A^0 + f A^1 + f A^2: of dry, linear and
// quadratic friction.
using Fall = std::array<double, 3>;

constexpr Fall linear{0.0, 1.0, 0.0};

double relative_fall(const Fall& fall, double amplitude) {
  return fall[0] / amplitude + fall[1] + fall[2] * amplitude;
}

// epsilon from the fall of the amplitudes about each event that has one, -(d log A/d cycle)/2 pi,
// which depends on the amplitude as `fall` does. NaN if too few amplitudes are known.
std::vector<double> local_friction(const ClockLog& log, double period_s, const Fall& fall) {
  constexpr std::size_t reach = 20; // events either way
  std::vector<std::size_t> known;
  for (std::size_t i = 0; i < log.events.size(); ++i)
    if (!std::isnan(log.events[i].amplitude_rad) && log.events[i].flag != BeatFlag::spurious)
      known.push_back(i);
  std::vector<double> friction(log.events.size(), not_known);
  for (std::size_t k = 0; k < known.size(); ++k) {
    double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, mean_fall = 0.0;
    const Beat& here = log.events[known[k]];
    for (std::size_t j = k > reach ? k - reach : 0; j < std::min(known.size(), k + reach + 1);
         ++j) {
      const Beat& beat = log.events[known[j]];
      if (beat.segment != here.segment) continue;
      const double cycles = (beat.time - here.time) / period_s,
                   log_a = std::log(beat.amplitude_rad);
      ++n, x += cycles, y += log_a, xx += cycles * cycles, xy += cycles * log_a;
      mean_fall += relative_fall(fall, beat.amplitude_rad);
    }
    const double spread = n * xx - x * x;
    if (n > 2.0 && spread > 0.0)
      friction[known[k]] = -(n * xy - x * y) / spread / two_pi *
                           relative_fall(fall, here.amplitude_rad) / (mean_fall / n);
  }
  return friction;
}

// The fall that explains -d log A/d psi best, with no part below 0. A width tells a wide swing less
// well: the scatter of log A grows with A.
Fall fall_of(const ClockLog& log, const std::vector<double>& friction) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < friction.size(); ++i) {
    if (!std::isfinite(friction[i])) continue;
    const double a = log.events[i].amplitude_rad;
    const Eigen::Vector3d row = Eigen::Vector3d{1.0 / a, 1.0, a} / a;
    normal += row * row.transpose();
    right += row * (friction[i] / a);
  }
  Fall best = linear;
  double most = 0.0; // of the squares explained
  constexpr int sets = 8;
  for (int set = 1; set < sets; ++set) { // of the laws that act
    Eigen::Matrix3d chosen = normal;
    Eigen::Vector3d wanted = right;
    for (Eigen::Index k = 0; k < 3; ++k) {
      if (((set >> k) & 1) != 0) continue;
      chosen.row(k).setZero();
      chosen.col(k).setZero();
      chosen(k, k) = 1.0;
      wanted[k] = 0.0;
    }
    const Eigen::Vector3d found = chosen.ldlt().solve(wanted);
    if (!found.allFinite() || found.minCoeff() < 0.0 || !(found.dot(wanted) > most)) continue;
    most = found.dot(wanted);
    best = {found[0], found[1], found[2]};
  }
  return best;
}

// The linear friction that delays the middle of the dark time as much as the real one, in units of
// the one by which the amplitude falls. With W(x) the work of a friction F from the vertical to x,
// an edge at h is passed m later than without, where
//   m = integral of W(x)/(v^2 - x^2)^(3/2) from 0 to h,
// which is for F = f, 2 eps phi', k phi'^2, with h = v sin u,
//   f/v (1/cos u - 1),   eps u tan u,   k v (2/3 (1/cos u - 1) + (1 - cos u)/3),
// while the amplitude falls by 2 f/pi, eps v, 4 k v^2/(3 pi) over a radian of phase.
double share_at_flag(const Fall& fall, double amplitude, double u) {
  const double more = 1.0 / std::cos(u) - 1.0, less = 1.0 - std::cos(u);
  const std::array<double, 3> delay{0.5 * std::numbers::pi * more, u * std::tan(u),
                                    0.25 * std::numbers::pi * (2.0 * more + less)};
  double all = 0.0, seen = 0.0, power = 1.0;
  for (std::size_t k = 0; k < fall.size(); ++k, power *= amplitude) {
    all += fall[k] * power;
    seen += fall[k] * power * delay[k];
  }
  return seen / (all * delay[1]);
}

} // namespace

void correct_widths_for_friction(ClockLog& log, double flag_width_rad, double period_s) {
  const Fall fall = fall_of(log, local_friction(log, period_s, linear));
  std::vector<double> friction = local_friction(log, period_s, fall);
  for (std::size_t i = 0; i < log.events.size(); ++i) {
    if (!std::isfinite(friction[i])) continue;
    Beat& beat = log.events[i];
    const double half = std::asin(0.5 * flag_width_rad / beat.amplitude_rad); // of tau
    friction[i] *= share_at_flag(fall, beat.amplitude_rad, half);
    const double late = std::atan(std::tanh(friction[i] * half) * std::tan(half));
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
