#include "goingrate/dynamics/swing_profile.hpp"

#include <algorithm>
#include <limits>

namespace goingrate {

namespace {

using Stretch = SwingStretch<double>;
constexpr double no_angle = std::numeric_limits<double>::infinity();

TorqueTable mirrored(TorqueTable table) {
  for (auto& point : table.points)
    point = {-point.angle, -point.torque};
  std::reverse(table.points.begin(), table.points.end());
  return table;
}

// The part of a torque table at phi > 0 as stretches, from the vertical upwards.
std::vector<Stretch> upwards(const TorqueTable& table) {
  std::vector<Stretch> stretches;
  if (!table.points.empty() && table.points.front().angle > 0.0)
    stretches.push_back({table.points.front().angle});
  for (std::size_t i = 1; i < table.points.size(); ++i) {
    const auto& [from, torque] = table.points[i - 1];
    const auto& [to, torque_to] = table.points[i];
    if (to <= 0.0) continue;
    const double slope = (torque_to - torque) / (to - from);
    stretches.push_back({to, torque - slope * from, slope});
  }
  stretches.push_back({no_angle});
  return stretches;
}

// The same stretches in the order of the way down.
std::vector<Stretch> downwards(const TorqueTable& table) {
  std::vector<Stretch> stretches = upwards(table);
  std::reverse(stretches.begin(), stretches.end());
  for (std::size_t i = 0; i < stretches.size(); ++i)
    stretches[i].until = i + 1 < stretches.size() ? stretches[i + 1].until : 0.0;
  return stretches;
}

// No torque; a kick at `angle`.
std::vector<Stretch> kick_at(double angle, double energy, double end) {
  return {{angle, 0.0, 0.0, energy}, {end}};
}

} // namespace

PeriodProfile period_profile(const ClockParameters& clock) {
  PeriodProfile profile;
  if (clock.escapement == Escapement::profile) {
    profile.right = {0.0, upwards(clock.rising), downwards(clock.falling)};
    profile.left = {0.0, upwards(mirrored(clock.falling)), downwards(mirrored(clock.rising))};
    return profile;
  }
  for (SwingProfile<double>* side : {&profile.right, &profile.left}) {
    side->rise = {{no_angle}};
    side->fall = {{0.0}};
  }
  if (clock.escapement != Escapement::single_impulse) return profile;
  const double angle = clock.impulse_angle;
  if (angle > 0.0) profile.right.rise = kick_at(angle, clock.impulse, no_angle);
  if (angle < 0.0) profile.left.fall = kick_at(-angle, clock.impulse, 0.0);
  if (angle == 0.0) profile.right.kick_at_start = clock.impulse;
  return profile;
}

} // namespace goingrate
