#include "goingrate/dynamics/intermittent.hpp"

#include "goingrate/clock/restoring.hpp"
#include "goingrate/dynamics/moments.hpp"
#include "goingrate/dynamics/stationary.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace goingrate {

using std::numbers::pi;

bool escapement_acts(const ClockParameters& clock, std::int64_t cycle, double velocity,
                     bool under_way) {
  if (clock.below > 0.0)
    return !under_way && velocity < velocity_of_turning_angle(clock.gravity_share, clock.below);
  return clock.every == 1 || cycle % clock.every == 0;
}

namespace {

// The part of a table on one side of the vertical.
TorqueTable one_side(const TorqueTable& table, bool right) {
  TorqueTable part;
  const auto add_middle = [&](const auto& from, const auto& to) {
    if (from.angle < 0.0 && to.angle > 0.0)
      part.points.push_back(
          {0.0, std::lerp(from.torque, to.torque, -from.angle / (to.angle - from.angle))});
  };
  for (std::size_t i = 0; i < table.points.size(); ++i) {
    const auto& point = table.points[i];
    if (i > 0) add_middle(table.points[i - 1], point);
    if (right ? point.angle >= 0.0 : point.angle <= 0.0) part.points.push_back(point);
  }
  return part;
}

bool acts_anywhere(const TorqueTable& table) {
  return table.points.size() > 1 && std::any_of(table.points.begin(), table.points.end(),
                                                [](const auto& p) { return p.torque != 0.0; });
}

} // namespace

std::optional<ActionParts> action_parts(const ClockParameters& clock) {
  if (!clock.is_intermittent() || clock.escapement != Escapement::profile) return {};
  ActionParts parts{clock, clock};
  for (ClockParameters* part : {&parts.before, &parts.after}) {
    part->every = 1;
    part->below = 0.0;
  }
  parts.before.rising = one_side(clock.rising, false);
  parts.before.falling = {};
  parts.after.rising = one_side(clock.rising, true);
  if (!acts_anywhere(parts.before.rising) || !acts_anywhere(parts.after.rising)) return {};
  return parts;
}

std::int64_t fewest_periods_between_actions(const ClockParameters& clock) {
  return action_parts(clock) ? 2 : 1;
}

bool waits_for_amplitude(const ClockParameters& clock) {
  if (!(clock.below > 0.0)) return false;
  return drive_moments(clock, clock.below).a >
         static_cast<double>(fewest_periods_between_actions(clock)) *
             friction_moment(clock, clock.below);
}

ClockParameters with_drive_divided(ClockParameters clock, double periods) {
  const double share = 1.0 / periods;
  clock.mu *= share;
  clock.impulse *= share;
  for (TorqueTable* table : {&clock.rising, &clock.falling})
    for (auto& point : table->points)
      point.torque *= share;
  clock.every = 1;
  clock.below = 0.0;
  return clock;
}

double energy_of_period(const ClockParameters& clock, double lambda) {
  return 2.0 * pi * lambda * drive_moments(clock, lambda).a;
}

std::optional<SawTooth> saw_tooth(const ClockParameters& clock) {
  if (!clock.is_intermittent() || !clock.has_linear_friction() || !(clock.epsilon > 0.0)) return {};
  const auto mean = stationary_amplitude(clock);
  if (!mean) return {};
  const double lift = 2.0 * energy_of_period(clock, *mean);
  SawTooth tooth{static_cast<double>(clock.every), 0.0, 0.0, 0.0, 0.0};
  if (clock.below > 0.0) {
    tooth.low2 = clock.below * clock.below;
    tooth.periods = std::log1p(lift / tooth.low2) / (4.0 * pi * clock.epsilon);
    if (tooth.periods < 1.0) return {}; // it acts in every period and does not reach the limit
  } else {
    tooth.low2 = lift / std::expm1(4.0 * pi * clock.epsilon * tooth.periods);
  }
  tooth.high2 = tooth.low2 + lift;
  tooth.mean2 = lift / (4.0 * pi * clock.epsilon * tooth.periods);
  const double late = tooth.high2 - tooth.mean2 - tooth.mean2 * std::log(tooth.high2 / tooth.mean2);
  tooth.peak_lateness_s =
      clock.gravity_share * late / (32.0 * clock.epsilon) * clock.nominal_period_s / (2.0 * pi);
  return tooth;
}

} // namespace goingrate
