#include "goingrate/dynamics/method_choice.hpp"

#include "base/scaled_time.hpp"
#include "goingrate/clock/restoring.hpp"
#include "goingrate/dynamics/averaged_pendulum.hpp"
#include "goingrate/dynamics/clock_run.hpp"
#include "goingrate/dynamics/direct.hpp"
#include "goingrate/dynamics/intermittent.hpp"
#include "goingrate/dynamics/stationary.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numbers>

namespace goingrate {

using std::numbers::pi;

namespace {

constexpr double no_bound = std::numeric_limits<double>::infinity();
constexpr double safety = 2.0;

// The clocks and amplitudes that occur in a scenario.
struct Scene {
  std::vector<ClockParameters> clocks; // at the start and after each event
  double low2 = 0.0, high2 = 0.0;      // range of v^2
  double periods = 0.0;
  FactorRange factors;
};

Scene scene_of(const Scenario& scenario) {
  Scene scene;
  scene.clocks.push_back(scenario.clock);
  for (const ClockEvent& event : scenario.events)
    scene.clocks.push_back(event.applied_to(scene.clocks.back()));
  scene.periods = scenario.periods
                      ? static_cast<double>(*scenario.periods)
                      : std::ceil(*scenario.duration_s / scenario.clock.nominal_period_s);
  scene.factors = factor_range(scenario.drive);
  if (std::any_of(scene.clocks.begin(), scene.clocks.end(),
                  [](const ClockParameters& clock) { return clock.is_intermittent(); }))
    scene.factors.low = std::min(scene.factors.low, 0.0);
  std::vector<double> speeds;
  if (scenario.start_amplitude) speeds.push_back(*scenario.start_amplitude);
  for (const ClockParameters& clock : scene.clocks) {
    if (const auto tooth = saw_tooth(clock)) speeds.push_back(std::sqrt(tooth->high2));
    if (const auto start = stationary_start(clock, false))
      speeds.push_back(*start);
    else if (scenario.start_amplitude) // it runs down, at most by its whole friction
      speeds.push_back(*scenario.start_amplitude *
                       std::exp(-std::min(50.0, 2.0 * pi * clock.epsilon * scene.periods)));
  }
  if (speeds.empty()) return scene;
  const auto [low, high] = std::minmax_element(speeds.begin(), speeds.end());
  // Variations of the drive change the swing in proportion to the square root of a relaxation time.
  const double spread = std::min(0.5, (scene.factors.high - scene.factors.low) *
                                          std::sqrt(2.0 * pi * scenario.clock.epsilon));
  scene.low2 = *low * *low * (1.0 - spread);
  const double top = top_velocity(scenario.clock.gravity_share);
  scene.high2 = std::min(0.975 * top * top, *high * *high * (1.0 + spread));
  return scene;
}

std::vector<double> between(double low, double high, int count) {
  if (!(high > low * (1.0 + 1e-9))) return {high};
  std::vector<double> values;
  for (int i = 0; i < count; ++i)
    values.push_back(low * std::pow(high / low, static_cast<double>(i) / (count - 1)));
  return values;
}

struct OnePeriod {
  bool regular = false;
  double change = 0.0, excess = 0.0; // of v^2; T - 2 pi
};

template <class Pendulum> OnePeriod one_period(Pendulum pendulum, double factor, double x) {
  const auto step = pendulum.advance(factor);
  const double v = pendulum.velocity();
  return {step.status == SwingStatus::crossed, v * v - x, step.excess};
}

OnePeriod exact_period(const ClockParameters& clock, double x, double factor) {
  DirectPendulum pendulum(clock, std::sqrt(x));
  const auto step = pendulum.advance(factor);
  const bool regular = step.status == SwingStatus::crossed && pendulum.is_regular();
  return {regular, pendulum.speed2().hi - x, step.excess};
}

// The clocks of the periods in which a push acts: one for each part of an action that crossings
// cut.
std::vector<ClockParameters> acting_clocks(const std::vector<ClockParameters>& clocks) {
  std::vector<ClockParameters> acting;
  for (const ClockParameters& clock : clocks) {
    if (const auto parts = action_parts(clock))
      acting.insert(acting.end(), {parts->before, parts->after});
    else
      acting.push_back(clock);
  }
  return acting;
}

// The error bound that the header states for an averaged method, s.
double averaged_bound(const Scene& scene, AveragedOrder order) {
  if (!(scene.low2 > 0.0)) return no_bound;
  double worst_excess = 0.0, worst_amplitude = 0.0;
  for (const ClockParameters& clock : acting_clocks(scene.clocks)) {
    double steepest = pi / 8.0, change_off = 0.0;
    for (const double factor :
         {0.5 * (scene.factors.low + scene.factors.high), scene.factors.low, scene.factors.high}) {
      double x_before = 0.0, excess_before = 0.0;
      for (const double x : between(scene.low2, scene.high2, 5)) {
        const OnePeriod exact = exact_period(clock, x, factor);
        const OnePeriod averaged =
            one_period(AveragedPendulum(clock, std::sqrt(x), order), factor, x);
        if (!exact.regular || !averaged.regular) return no_bound;
        worst_excess = std::max(worst_excess, std::abs(averaged.excess - exact.excess));
        change_off = std::max(change_off, std::abs(averaged.change - exact.change));
        if (x_before > 0.0)
          steepest = std::max(steepest, std::abs((exact.excess - excess_before) / (x - x_before)));
        x_before = x;
        excess_before = exact.excess;
      }
    }
    const double memory = std::min(scene.periods, 1.0 / (4.0 * pi * clock.epsilon + 1e-300));
    worst_amplitude = std::max(worst_amplitude, steepest * memory * change_off);
  }
  const double scaled = safety * scene.periods * (worst_excess + worst_amplitude);
  return scaled * scene.clocks.front().nominal_period_s / two_pi;
}

// Orders of magnitude on a machine of the 2020s, s; only their ratios matter.
double cost_of(Method method, const Scene& scene) {
  const bool plain = scene.clocks.front().is_plain();
  switch (method) {
  case Method::averaged1:
    return scene.periods * (plain ? 3e-8 : 3e-7);
  case Method::averaged2:
    return scene.periods * 6e-8;
  case Method::map: {
    const bool steady = !(scene.factors.high > scene.factors.low);
    const double patches = 1.0 + std::log(std::max(1.0, scene.high2 / scene.low2)) / 0.08;
    const double patch_s = (steady ? 5e-4 : 5e-3) * (plain ? 1.0 : 3.0);
    return scene.periods * 4e-8 + patches * static_cast<double>(scene.clocks.size()) * patch_s;
  }
  default:
    return scene.periods * (plain ? 1.3e-6 : 3e-6);
  }
}

double tolerance_of(const Scenario& scenario) {
  if (scenario.method.tolerance_s) return *scenario.method.tolerance_s;
  return 0.1 * std::max(scenario.sensor.jitter_rms_s, scenario.sensor.resolution_s);
}

} // namespace

std::vector<MethodEstimate> estimate_methods(const Scenario& scenario) {
  const Scene scene = scene_of(scenario);
  const bool halves = scenario.sensor.edges != SensorEdges::up;
  const bool averages = scenario.length.none() && (!halves || scenario.clock.is_plain());
  std::vector<MethodEstimate> estimates;
  if (averages)
    estimates.push_back({Method::averaged1, averaged_bound(scene, AveragedOrder::first_in_full),
                         cost_of(Method::averaged1, scene)});
  if (averages && std::all_of(scene.clocks.begin(), scene.clocks.end(), knows_second_order))
    estimates.push_back({Method::averaged2, averaged_bound(scene, AveragedOrder::second),
                         cost_of(Method::averaged2, scene)});
  estimates.push_back({Method::map, 0.0, cost_of(Method::map, scene)});
  estimates.push_back({Method::direct, 0.0, cost_of(Method::direct, scene)});
  return estimates;
}

MethodChoice choose_method(const Scenario& scenario) {
  if (scenario.method.method != Method::automatic)
    return {scenario.method.method, 0.0, 0.0, "as asked for"};
  const double tolerance = tolerance_of(scenario);
  std::vector<MethodEstimate> estimates;
  if (tolerance > 0.0) {
    estimates = estimate_methods(scenario);
  } else {
    const Scene scene = scene_of(scenario);
    for (const Method method : {Method::map, Method::direct})
      estimates.push_back({method, 0.0, cost_of(method, scene)});
  }
  std::sort(estimates.begin(), estimates.end(),
            [](const auto& a, const auto& b) { return a.seconds < b.seconds; });
  std::string cheaper;
  for (const MethodEstimate& estimate : estimates) {
    if (estimate.error_bound_s <= tolerance) {
      const std::string asked = tolerance > 0.0
                                    ? fmt::format("times are to be good to {:.1e} s", tolerance)
                                    : std::string("times are to be exact");
      const std::string bound = estimate.error_bound_s > 0.0
                                    ? fmt::format("bound {:.1e} s", estimate.error_bound_s)
                                    : std::string("exact to rounding");
      return {estimate.method, estimate.error_bound_s, tolerance,
              fmt::format("{}; {} is the cheapest that keeps that ({}){}", asked,
                          name_of(estimate.method), bound, cheaper)};
    }
    cheaper += fmt::format("; {} could be off by {}", name_of(estimate.method),
                           std::isfinite(estimate.error_bound_s)
                               ? fmt::format("{:.1e} s", estimate.error_bound_s)
                               : std::string("any amount here"));
  }
  return {Method::direct, 0.0, tolerance, "the only one that is sure"};
}

} // namespace goingrate
