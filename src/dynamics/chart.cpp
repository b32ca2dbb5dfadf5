#include "goingrate/dynamics/chart.hpp"

#include "base/robust.hpp"
#include "base/scaled_time.hpp"
#include "base/special_values.hpp"
#include "goingrate/base/random.hpp"
#include "goingrate/dynamics/averaged_pendulum.hpp"
#include "goingrate/dynamics/direct.hpp"
#include "goingrate/dynamics/map.hpp"
#include "goingrate/dynamics/rk4.hpp"
#include "goingrate/dynamics/stationary.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <optional>

namespace goingrate {

namespace {

ChartScene scene_at(std::string name, const ClockParameters& clock, double velocity,
                    std::size_t periods) {
  return {std::move(name), velocity, {{0, clock}}, std::vector<double>(periods, 1.0)};
}

FactorRange range_of(const ChartScene& scene) {
  const auto [low, high] = std::minmax_element(scene.factors.begin(), scene.factors.end());
  return {*low, *high};
}

// The lateness of each crossing in wide arithmetic, the reference, up to the first period that is
// not regular.
std::vector<Wide> exact_lateness(const ChartScene& scene) {
  std::vector<Wide> lateness;
  Wide speed2 = static_cast<Wide>(scene.velocity) * scene.velocity, late = 0;
  std::size_t stretch = 0;
  for (std::size_t i = 0; i < scene.factors.size(); ++i) {
    if (stretch + 1 < scene.stretches.size() && scene.stretches[stretch + 1].from_period == i)
      ++stretch;
    const auto period =
        regular_period<Wide>(scene.stretches[stretch].clock, speed2, scene.factors[i]);
    if (!period.regular) break;
    speed2 += period.speed2_change;
    late += period.excess;
    lateness.push_back(late);
  }
  return lateness;
}

double largest_error(const std::vector<double>& lateness, const std::vector<Wide>& exact) {
  double worst = 0.0;
  for (std::size_t i = 0; i < std::min(lateness.size(), exact.size()); ++i)
    worst = std::max(worst, static_cast<double>(std::abs(lateness[i] - exact[i])));
  return worst;
}

ChartMethod rk4_method(Rk4Torque torque, double dt) {
  const char* name = torque == Rk4Torque::per_step    ? "rk4-per-step"
                     : torque == Rk4Torque::per_stage ? "rk4"
                                                      : "rk4-at-switches";
  return {name, fmt::format("dt={}", dt), [=](const ChartScene& scene) {
            return run_scene(scene, [&](const ClockParameters& clock, double velocity) {
              return Rk4Clock(clock, velocity, dt, torque);
            });
          }};
}

ChartMethod averaged_method(std::string name, std::string setting, AveragedOrder order) {
  return {std::move(name), std::move(setting), [=](const ChartScene& scene) {
            return run_scene(scene, [&](const ClockParameters& clock, double velocity) {
              return AveragedPendulum(clock, velocity, order);
            });
          }};
}

ChartMethod map_method() {
  return {"map", "to rounding", [](const ChartScene& scene) {
            return run_scene(scene, [&](const ClockParameters& clock, double velocity) {
              MapPendulum map(clock, velocity, range_of(scene));
              map.find_halves(false);
              return map;
            });
          }};
}

ChartMethod direct_method() {
  return {"direct", "to rounding", [](const ChartScene& scene) {
            return run_scene(scene, [](const ClockParameters& clock, double velocity) {
              return DirectPendulum(clock, velocity);
            });
          }};
}

} // namespace

std::vector<ChartScene> chart_scenes(std::size_t periods) {
  const ClockParameters a{two_pi, 2.5e-4, 2e-5, 0.03}, c{two_pi, 1.167245e-4, 1.5e-5, 0.03};
  std::vector<ChartScene> scenes;
  const double v_c = limit_cycle(c)->velocity;
  scenes.push_back(scene_at("C steady", c, v_c, periods));

  ChartScene noisy = scene_at("C noisy", c, v_c, periods);
  RandomStream random(1, StreamPurpose::fast_drive);
  for (double& factor : noisy.factors)
    factor += 0.3 * random.normal();
  scenes.push_back(std::move(noisy));

  ChartScene jump = scene_at("jump", a, limit_cycle(a)->velocity, periods);
  jump.stretches.push_back({150, a});
  jump.stretches.back().clock.mu = 4e-5;
  scenes.push_back(std::move(jump));

  const ClockParameters free{two_pi, 2.5e-4, 0.0, 0.0, Escapement::none};
  scenes.push_back(scene_at("ring-down", free, 0.1, periods));

  const double grazing = 1.1 * 0.03;
  const ClockParameters weak{two_pi, 2.5e-4, std::numbers::pi * 2.5e-4 * grazing * grazing / 0.06,
                             0.03};
  scenes.push_back(scene_at("near stall", weak, limit_cycle(weak)->velocity, periods));

  const ClockParameters wide{two_pi, 1e-3, 4.5e-3, 0.5};
  scenes.push_back(scene_at("large amplitude", wide, limit_cycle(wide)->velocity, periods));
  return scenes;
}

std::vector<ChartMethod> chart_methods() {
  return {
      rk4_method(Rk4Torque::per_step, 0.03),
      rk4_method(Rk4Torque::per_stage, 0.03),
      rk4_method(Rk4Torque::at_switches, 0.03),
      rk4_method(Rk4Torque::at_switches, 0.01),
      rk4_method(Rk4Torque::at_switches, 0.003),
      averaged_method("averaged1", "circular error -lambda^2/16", AveragedOrder::first),
      averaged_method("averaged1", "circular error in full", AveragedOrder::first_in_full),
      averaged_method("averaged2", "second order", AveragedOrder::second),
      map_method(),
      direct_method(),
  };
}

std::vector<ChartRow> measure_chart(const std::vector<ChartScene>& scenes,
                                    const std::vector<ChartMethod>& methods, int repetitions) {
  std::vector<ChartRow> rows;
  for (const ChartScene& scene : scenes) {
    const auto exact = exact_lateness(scene);
    for (const ChartMethod& method : methods) {
      std::vector<double> running, setup;
      ChartRun run;
      for (int i = 0; i < std::max(1, repetitions); ++i) {
        run = method.run(scene);
        running.push_back(run.running_s);
        setup.push_back(run.setup_s);
      }
      ChartRow row{scene.name, method.name, method.setting, run.status,
                   not_known,  not_known,   not_known};
      if (run.status == SwingStatus::crossed) {
        row.ns_per_period = 1e9 * median_of(running) / static_cast<double>(scene.factors.size());
        row.setup_us = 1e6 * median_of(setup);
        row.max_error = largest_error(run.lateness, exact);
      }
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

std::vector<ChartRow> chart_frontier(const std::vector<ChartRow>& rows, const std::string& scene) {
  std::vector<ChartRow> mine;
  for (const ChartRow& row : rows)
    if (row.scenario == scene && row.status == SwingStatus::crossed) mine.push_back(row);
  std::sort(mine.begin(), mine.end(),
            [](const auto& a, const auto& b) { return a.ns_per_period < b.ns_per_period; });
  std::vector<ChartRow> frontier;
  for (const ChartRow& row : mine)
    if (frontier.empty() || row.max_error < frontier.back().max_error) frontier.push_back(row);
  return frontier;
}

// ---- limits -------------------------------------------------------------------------------------

namespace {

struct LimitScene {
  ChartScene scene;
  double epsilon, ratio, amplitude;
};

LimitScene limit_scene(double epsilon, double ratio, double amplitude, std::size_t periods) {
  const double phi0 = amplitude / ratio;
  const double mu = 0.5 * std::numbers::pi * epsilon * amplitude * amplitude / phi0;
  // A clock must have mu below 1 and phi0 below pi; where they are cut off here, the swing is not
  // that of equilibrium.
  constexpr double largest_mu = 0.99, largest_phi0_rad = 3.1;
  ClockParameters clock{two_pi, epsilon, std::min(mu, largest_mu),
                        std::min(phi0, largest_phi0_rad)};
  // The velocity from which a free swing turns at `amplitude`.
  return {scene_at("", clock, 2.0 * std::sin(0.5 * amplitude), periods), epsilon, ratio, amplitude};
}

constexpr double noted_relative_error = 1e-6; // of the period

// What most likely makes the error of a method exceed that, by its place in the grid.
std::string reason_for(const LimitScene& at, const std::string& method) {
  if (method.starts_with("rk4")) return "its step of 0.03";
  if (method == "map" || method == "direct") return "rounding";
  const double circular = at.amplitude * at.amplitude / 16.0;
  if (at.epsilon >= 0.01 && at.epsilon > circular) return "friction is not small";
  if (at.amplitude > 0.15)
    return method == "averaged1 -l2/16" ? "the circular error is more than -lambda^2/16"
                                        : "the amplitude is not small";
  if (at.ratio < 1.2) return "the switch is close to the apex";
  return "second-order terms";
}

LimitRow limits_at(const LimitScene& at, const std::vector<ChartMethod>& methods) {
  LimitRow row{at.epsilon, at.ratio, at.amplitude, SwingStatus::crossed, {}, {}};
  const auto direct = methods.front().run(at.scene);
  row.exact = direct.status;
  const auto exact = exact_lateness(at.scene);
  for (const ChartMethod& method : methods) {
    const ChartRun run = method.run(at.scene);
    double error = not_known;
    if (run.status == SwingStatus::crossed && row.exact == SwingStatus::crossed) {
      const std::size_t last = run.lateness.size() - 1;
      // The reference stops if the escapement misses a switch; `direct` is then the reference.
      const Wide truth = exact.size() > last ? exact[last] : direct.lateness[last];
      error = static_cast<double>(std::abs(run.lateness[last] - truth)) /
              (two_pi * static_cast<double>(last + 1));
    }
    row.errors.push_back({method.name, run.status, error});
    const bool differs = run.status != row.exact;
    if (row.breaks.empty() && (differs || error > noted_relative_error))
      row.breaks = differs ? fmt::format("{}: {}", method.name, words_for(run.status))
                           : fmt::format("{}: {}", method.name, reason_for(at, method.name));
  }
  return row;
}

// The columns of the table of limits; the first is the reference.
std::vector<ChartMethod> limit_methods() {
  ChartMethod rk4 = rk4_method(Rk4Torque::at_switches, 0.03);
  rk4.name = "rk4 at switches";
  return {direct_method(),
          map_method(),
          averaged_method("averaged2", "second order", AveragedOrder::second),
          averaged_method("averaged1 full", "circular error in full", AveragedOrder::first_in_full),
          averaged_method("averaged1 -l2/16", "circular error -lambda^2/16", AveragedOrder::first),
          rk4};
}

} // namespace

std::vector<LimitRow> measure_limits(int periods) {
  const auto methods = limit_methods();
  std::vector<LimitRow> rows;
  for (const double epsilon : {1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.3})
    for (const double ratio : {1.0, 1.01, 1.05, 1.2, 2.0, 10.0})
      for (const double amplitude : {0.01, 0.05, 0.2, 1.0, 2.0, 3.0})
        rows.push_back(limits_at(
            limit_scene(epsilon, ratio, amplitude, static_cast<std::size_t>(periods)), methods));
  return rows;
}

} // namespace goingrate
