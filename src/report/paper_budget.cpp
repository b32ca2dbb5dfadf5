// What the secular 1e-8 at C is made of.
#include "paper_figures.hpp"
#include "paper_rates.hpp"

#include "goingrate/clock/restoring.hpp"
#include "goingrate/dynamics/averaged_pendulum.hpp"
#include "goingrate/dynamics/moments.hpp"

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

// The mean rate over all but the first tenth of a run.
double mean_rate(const Scenario& scenario) {
  ClockRun run(scenario, 0);
  double begin_s = 0.0, end_s = 0.0;
  std::int64_t begin = 0, end = 0;
  while (const auto period = run.next()) {
    if (period->cycle == *scenario.periods / 10) {
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
  Scenario scenario = scenario_of(clock, 4000, Method::rk4);
  scenario.method.rk4_torque = torque;
  return mean_rate(scenario);
}

namespace {

// What the escapement makes of second order, gravity's share being s: the rate of the limit cycle
// less first order, less friction's own part, less what the free pendulum's circular error has
// beyond lambda^2/16.
double second_order_at(double gravity_share) {
  ClockParameters clock = point_c();
  clock.gravity_share = gravity_share;
  const double lambda = *stationary_amplitude(clock);
  const double circular = gravity_share * (circular_error(lambda) + lambda * lambda / 16.0);
  return exact_rate(clock) - first_order_rate(clock) - circular +
         0.5 * clock.epsilon * clock.epsilon;
}

// What a free swing of C's amplitude has beyond eq. ce3, from its exact period. The largest angle
// of a swing whose cycle mean is lambda is lambda (1 + 5 s lambda^2/192).
double free_swing_beyond(double gravity_share) {
  const double lambda = *stationary_amplitude(point_c());
  const double angle = lambda * (1.0 + gravity_share * 5.0 * lambda * lambda / 192.0);
  const double ratio = free_period_ratio(gravity_share, angle);
  return 1.0 / ratio - 1.0 - gravity_share * circular_error(lambda);
}

// The rate of a linear oscillator with C's friction and nothing else.
double rate_by_friction_alone() {
  Scenario scenario = scenario_of(point_c(), 400, Method::direct);
  scenario.clock.escapement = Escapement::none;
  scenario.clock.gravity_share = 0.0;
  scenario.start_amplitude = *stationary_amplitude(point_c());
  return mean_rate(scenario);
}

// By how much the circular error of first order in full exceeds -lambda^2/16, of two runs.
double circular_error_beyond() {
  const auto rate = [](AveragedOrder order) {
    const ClockParameters c = point_c();
    AveragedPendulum pendulum(c, *stationary_amplitude(c), order);
    double excess = 0.0;
    constexpr int periods = 1000;
    for (int i = 0; i < periods; ++i)
      excess += pendulum.advance().excess / periods;
    return rate_excess_of(excess);
  };
  return rate(AveragedOrder::first_in_full) - rate(AveragedOrder::first);
}

} // namespace

std::vector<BudgetPart> budget_at_c() {
  const ClockParameters c = point_c();
  const double first = first_order_rate(c), exact = exact_rate(c);
  const double circular = circular_error_beyond(), friction = rate_by_friction_alone();
  const double escapement = second_order_at(0.0), free_swing = free_swing_beyond(1.0);
  // Of first order in s, found where gravity has half a share.
  const double interplay = 2.0 * (second_order_at(0.5) - escapement - free_swing_beyond(0.5));
  const double sum = first + circular + friction + escapement + free_swing + interplay;
  const double rk4 = rk4_rate(c, Rk4Torque::per_stage);
  return {
      {"first order, by eq. statrate", first},
      {"circular error beyond λ²/16, J1(λ)/λ - 1/2 (eq. ce3): two runs of the "
       "averaged equations",
       circular},
      {"friction's own part, -ε²/2: a run of a linear oscillator that dies away", friction},
      {"the free swing beyond eq. ce3: its exact period", free_swing},
      {"the escapement by itself, second order: the limit cycle of a linear oscillator",
       escapement},
      {"the escapement in a swing that is no sinusoid, second order: a limit cycle at half of "
       "gravity's share, doubled",
       interplay},
      {"sum of these", sum},
      {"the full equation of motion: its limit cycle", exact},
      {"what the sum lacks: third order", exact - sum},
      {"error of RK4 at dt = 0.03, torque chosen in every stage: a run less the limit cycle",
       rk4 - exact},
      {"what RK4 shows, and the paper saw: a run", rk4}};
}

} // namespace goingrate::paper
