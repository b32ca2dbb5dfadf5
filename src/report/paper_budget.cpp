// The parts that make up the secular 1e-8 at C.
#include "paper_rates.hpp"

#include "base/scaled_time.hpp"
#include "goingrate/dynamics/swing_loss.hpp"

#include <cmath>

namespace goingrate::paper {

Scenario scenario_of(const ClockParameters& clock, std::int64_t periods, Method method) {
  Scenario scenario;
  scenario.clock = clock;
  scenario.periods = periods;
  scenario.method.method = method;
  scenario.method.dt = step;
  return scenario;
}

double mean_rate(const Scenario& scenario, std::int64_t settling) {
  ClockRun run(scenario, 0);
  double begin_s = 0.0, end_s = 0.0;
  std::int64_t begin = 0, end = 0;
  while (const auto period = run.next()) {
    if (period->cycle == settling) {
      begin = period->cycle;
      begin_s = period->time_s.value();
    }
    end = period->cycle;
    end_s = period->time_s.value();
  }
  return static_cast<double>(end - begin) * scenario.clock.nominal_period_s / (end_s - begin_s) -
         1.0;
}

double rk4_rate(const ClockParameters& clock, Rk4Torque torque) {
  // Ten times the 1/(4 pi epsilon) periods in which lambda^2 relaxes from the exact limit cycle to
  // RK4's. Many periods are counted because the rate wanders with the position of the time grid.
  const auto settling = static_cast<std::int64_t>(10.0 / (2.0 * two_pi * clock.epsilon));
  constexpr std::int64_t counted = 20'000;
  Scenario scenario = scenario_of(clock, settling + counted, Method::rk4);
  scenario.method.rk4_torque = torque;
  return mean_rate(scenario, settling);
}

namespace {

// The turning angle of the free swing that loses as much to C's friction as C's escapement gives,
// 4 mu phi0 whatever the swing: the limit of C's amplitude as friction and torque vanish together.
double free_angle() {
  const ClockParameters c = point_c();
  const auto loss = [&](double angle) { // 2 pi E/Q
    return two_pi * (1.0 - std::cos(angle)) * c.epsilon * inverse_q_per_friction(angle)[0];
  };
  double angle = *stationary_amplitude(c);
  constexpr int steps = 6; // the loss is nearly a parabola in the angle
  for (int i = 0; i < steps; ++i)
    angle *= std::sqrt(4.0 * c.mu * c.phi0 / loss(angle));
  return angle;
}

double free_rate() { return 1.0 / circular_period_ratio(free_angle()) - 1.0; }

// The escapement error in a swing that is not a sinusoid, per unit of the torque, from a clock with
// `share` of C's friction and torque: the smaller these are, the less of second order is left.
double escapement_error_at(double share) {
  ClockParameters clock = point_c();
  clock.epsilon *= share;
  clock.mu *= share;
  return (exact_rate(clock) - free_rate()) / share;
}

ClockParameters linear_oscillator() {
  ClockParameters clock = point_c();
  clock.gravity_share = 0.0;
  return clock;
}

// The rate of a linear oscillator with C's friction and nothing else.
double rate_by_friction_alone() {
  Scenario scenario = scenario_of(linear_oscillator(), 400, Method::direct);
  scenario.clock.escapement = Escapement::none;
  scenario.start_amplitude = *stationary_amplitude(point_c());
  return mean_rate(scenario, 0);
}

// RK4's error in the rate of a swing without drive and friction. The amplitude that the swing loses
// by RK4 is so small that the circular error does not change.
double phase_error_of_rk4() {
  ClockParameters clock = point_c();
  clock.escapement = Escapement::none;
  clock.epsilon = 0.0;
  const auto rate = [&](Method method) {
    constexpr std::int64_t periods = 20'000; // a crossing is interpolated within 5e-7
    Scenario scenario = scenario_of(clock, periods, method);
    scenario.start_amplitude = 1e-3;
    return mean_rate(scenario, 0);
  };
  return rate(Method::rk4) - rate(Method::direct);
}

} // namespace

std::vector<BudgetPart> budget_at_c() {
  const ClockParameters c = point_c(), linear = linear_oscillator();
  const double lambda = *stationary_amplitude(c);
  const double first = first_order_rate(c), exact = exact_rate(c);
  const double free_swing = free_rate() + lambda * lambda / 16.0;
  const double friction = rate_by_friction_alone();
  const double escapement = exact_rate(linear) - first_order_rate(linear) - friction;
  // Extrapolation from two small shares removes the second order in friction and torque.
  const double in_swing =
      2.0 * escapement_error_at(0.05) - escapement_error_at(0.1) - first_order_rate(linear);
  const double sum = first + free_swing + friction + escapement + in_swing;
  const double phase = phase_error_of_rk4(), rk4 = rk4_rate(c, Rk4Torque::per_stage);
  return {
      {"first order: eq. 20, a formula", first},
      {"the free swing beyond -λ²/16: the exact period, a quadrature, of the free swing "
       "that loses to friction what C's does",
       free_swing},
      {"friction's own part, -ε²/2: a run of a linear oscillator that dies away", friction},
      {"the escapement error of second order in a linear oscillator: its limit cycle less first "
       "order and less the line above",
       escapement},
      {"the escapement error of first order in a swing that is no sinusoid: limit cycles with a "
       "10th "
       "and a 20th of friction and torque, less the free swing and less first order",
       in_swing},
      {"sum of these", sum},
      {"the full equation of motion: its limit cycle", exact},
      {"what the sum lacks: third order", exact - sum},
      {"RK4's own phase error at dt = 0.03, -dt⁴/120: a run without drive and friction less "
       "the same by direct integration",
       phase},
      {"what RK4 shows at C, the torque chosen in every stage, and the paper saw: a run", rk4},
      {"what limit cycle and phase error lack of it: where in a step RK4 switches, and the swing "
       "it loses",
       rk4 - exact - phase}};
}

} // namespace goingrate::paper
