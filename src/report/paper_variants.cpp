#include "paper_variants.hpp"

#include "paper_rates.hpp"

#include "goingrate/dynamics/moments.hpp"
#include "goingrate/dynamics/operating_point.hpp"
#include "goingrate/dynamics/swing_loss.hpp"

#include <cmath>
#include <numbers>

namespace goingrate::paper {

using std::numbers::pi;

namespace {

double amplitude_at_c() { return *stationary_amplitude(point_c()); }

// C's escapement and friction, and an additional torque.
CustomLaws laws_with(const ForceLaw& added) {
  const ClockParameters c = point_c();
  const auto torque = [=](double phi, double w) {
    const bool helps_right = w > 0.0 ? phi < c.phi0 : phi < -c.phi0;
    return (helps_right ? c.mu : -c.mu) + added(phi, w);
  };
  const auto friction = [=](double, double w) { return 2.0 * c.epsilon * w; };
  return {torque, friction, {-c.phi0, c.phi0}, true};
}

} // namespace

Cycle cycle_of(const CustomLaws& laws, double start) {
  double excess = 0.0;
  const auto growth = [&](double velocity) {
    CustomPendulum pendulum(laws, velocity);
    excess = pendulum.advance().excess;
    return pendulum.velocity() - velocity;
  };
  double before = start, grew = growth(start);
  // A step of some parts in a thousand: large enough to measure a slope, and small enough for the
  // slope to be constant over it.
  double now = before * (1.0 + std::copysign(3e-3, grew));
  constexpr int step_limit = 30; // steps; from C's amplitude it takes four
  for (int i = 0; i < step_limit && now != before; ++i) {
    const double grows = growth(now);
    if (grows == grew) break;
    const double next = now - grows * (now - before) / (grows - grew);
    before = now;
    grew = grows;
    now = next;
    if (std::abs(now - before) < 1e-12) break; // the error of the integration itself
  }
  growth(now);
  return {now, rate_excess_of(excess)};
}

Cycle with_harmonic(int n, bool sine) {
  const double size = point_c().mu;
  const auto harmonic = [=](double phi, double w) {
    const double phase = n * std::atan2(phi, w);
    return size * (sine ? std::sin(phase) : std::cos(phase));
  };
  return cycle_of(laws_with(harmonic), amplitude_at_c());
}

Lengthened lengthened(double change) {
  const double less = change / (1.0 + change);
  const Cycle cycle = cycle_of(laws_with([=](double phi, double) { return less * std::sin(phi); }),
                               amplitude_at_c());
  // A free pendulum with this velocity turns at this angle, by conservation of energy with the new
  // gravity over length.
  const double angle = 2.0 * std::asin(0.5 * cycle.velocity * std::sqrt(1.0 + change));
  return {cycle.rate, std::sqrt(0.5 * (angle * angle + cycle.velocity * cycle.velocity)), angle};
}

ClockParameters single_impulse(double energy, double angle) {
  ClockParameters clock = point_c();
  clock.escapement = Escapement::single_impulse;
  clock.impulse = energy * 4.0 * clock.mu * clock.phi0;
  clock.impulse_angle = angle;
  return clock;
}

ClockParameters push(double centre, double width) {
  ClockParameters clock = point_c();
  clock.escapement = Escapement::profile;
  // Two pushes a period do the work that friction takes, 2 pi epsilon lambda^2.
  const double torque = pi * clock.epsilon * std::pow(amplitude_at_c(), 2) / width;
  constexpr double edge_rad = 1e-7; // width of the edges, because a table cannot jump
  const double from = centre - 0.5 * width, to = centre + 0.5 * width;
  clock.rising.points = {{from - edge_rad, 0.0},
                         {from + edge_rad, torque},
                         {to - edge_rad, torque},
                         {to + edge_rad, 0.0}};
  for (const TorqueTable::Point& p : clock.rising.points)
    clock.falling.points.insert(clock.falling.points.begin(), {-p.angle, -p.torque});
  return clock;
}

double escapement_error_of(const ClockParameters& clock) {
  const auto cycle = limit_cycle(clock);
  if (!cycle) return not_known;
  const double free = 1.0 / circular_period_ratio(2.0 * std::asin(0.5 * cycle->velocity)) - 1.0;
  return cycle->rate_excess - free;
}

ClockParameters same_moments(double width) {
  const ClockParameters c = point_c();
  const double lambda = amplitude_at_c();
  const DriveMoments moments = drive_moments(c, lambda);
  if (width == 0.0) {
    ClockParameters impulse =
        single_impulse(1.0, lambda * std::sin(std::atan(moments.b / moments.a)));
    impulse.impulse = 2.0 * pi * lambda * moments.a;
    return impulse;
  }
  // The moment b of a push with C's work rises with the place of the push.
  double low = -(lambda - 0.5 * width), high = 0.0;
  constexpr int halvings = 50;
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (low + high);
    const double error = escapement_error(c.epsilon, lambda, middle, width);
    (error > -moments.b / lambda ? low : high) = middle;
  }
  return push(low, width);
}

} // namespace goingrate::paper
