// Numbers for Appendix D of Hoyng's paper: how RK4 switches the torque and how crossings are found.
#include "paper_rates.hpp"

#include "base/scaled_time.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace goingrate::paper {

namespace {

// The rms of the rates of single periods about their mean, at C's amplitude.
double scatter_of_rates(const ClockParameters& clock, Method method) {
  constexpr std::int64_t periods = 2000; // crossings fall everywhere within a step
  Scenario scenario = scenario_of(clock, periods, method);
  scenario.method.rk4_torque = Rk4Torque::per_stage;
  if (clock.escapement == Escapement::none)
    scenario.start_amplitude = *stationary_amplitude(point_c());
  ClockRun run(scenario, 0);
  double sum = 0.0, squares = 0.0;
  while (const auto period = run.next()) {
    sum += period->rate_excess;
    squares += period->rate_excess * period->rate_excess;
  }
  const double mean = sum / periods;
  return std::sqrt(std::max(0.0, squares / periods - mean * mean));
}

// The same for crossings of phi = lambda sin t that are interpolated along a straight line between
// points `step` apart, x the place of the crossing in its step: dt^3 x (1 - x)(1 - 2 x)/6 late.
double scatter_of_interpolation() {
  constexpr int periods = 2000;
  const auto late = [](int period) {
    const double steps = two_pi / step * period, x = steps - std::floor(steps);
    return std::pow(step, 3) / 6.0 * x * (1.0 - x) * (1.0 - 2.0 * x);
  };
  double squares = 0.0;
  for (int i = 0; i < periods; ++i)
    squares += std::pow((late(i + 1) - late(i)) / two_pi, 2);
  return std::sqrt(squares / periods);
}

} // namespace

void add_numerics(std::vector<PaperNumber>& numbers) {
  const double exact = exact_rate(point_c());
  const auto by_rk4 = [&](const char* when, Rk4Torque torque, const char* why) {
    numbers.push_back({fmt::format("gain at C by RK4, the torque chosen {}", when), "App. D",
                       "1e-8", rk4_rate(point_c(), torque), exact, "", why});
  };
  by_rk4("once a step", Rk4Torque::per_step,
         "the switch comes half a step late: first order, 300 times too much");
  by_rk4("in each stage", Rk4Torque::per_stage,
         "the switch is displaced within its step, early as often as late");
  by_rk4("at the switch, where the step is cut", Rk4Torque::at_switches,
         "the phase error -dt⁴/120, and the swing that RK4 loses");
  ClockParameters free = point_c();
  free.escapement = Escapement::none;
  free.epsilon = 0.0;
  numbers.push_back({"rms noise of a period's rate by RK4, without drive and friction", "App. D",
                     "acceptable", scatter_of_rates(free, Method::rk4), scatter_of_interpolation(),
                     "", "ours is the error of a straight line between two points of a sinusoid"});
  const double noise = scatter_of_rates(point_c(), Method::rk4);
  numbers.push_back({"the same at C, the torque chosen in each stage", "App. D", "acceptable",
                     noise, scatter_of_rates(point_c(), Method::direct), "",
                     fmt::format("direct integration solves for switches and crossings. Most of "
                                 "the noise is that of displaced switches")});
}

} // namespace goingrate::paper
