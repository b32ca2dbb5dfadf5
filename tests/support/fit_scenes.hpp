// Scenes whose parameters are known, to judge fits by: what is called determined must be right as
// often as its intervals say.
#pragma once

#include "goingrate/fit/clock_fit.hpp"
#include "support/simulated.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace goingrate::test {

constexpr double velocity_at_a = 0.0390886300401325, velocity_at_b = 0.0552840336990741;

struct FitScene {
  std::string name;
  Scenario scenario;
  FitOptions options;
  std::map<std::string, double> truth;
};

inline FitScene jump_scene(const std::string& name, std::int64_t periods, double jitter_s,
                           bool known_T0) {
  FitScene scene{name, jump_from_a_to_b(periods, jitter_s), {}, {}};
  scene.options.events = {{150, {"mu"}}};
  if (known_T0) scene.options.fixed["T0"] = 2.0;
  scene.truth = {{"T0", 2.0},
                 {"epsilon", 2.5e-4},
                 {"mu", 2e-5},
                 {"phi0", 0.03},
                 {"lambda0", velocity_at_a},
                 {"mu@1", 4e-5},
                 {"jitter_rms", jitter_s}};
  return scene;
}

inline FitScene ring_down_scene(std::int64_t periods, double jitter_s) {
  FitScene scene{"ring-down", ring_down(periods, jitter_s), {}, {}};
  scene.truth = {{"T0", 2.0}, {"epsilon", 2.5e-4}, {"lambda0", 0.1}, {"jitter_rms", jitter_s}};
  return scene;
}

inline FitScene start_up_scene(std::int64_t periods, double jitter_s) {
  FitScene scene{"start-up", at_point_b(periods), {}, {}};
  scene.scenario.start_amplitude = 0.04;
  scene.scenario.sensor.jitter_rms_s = jitter_s;
  scene.truth = {{"T0", 2.0},    {"epsilon", 2.5e-4}, {"mu", 4e-5},
                 {"phi0", 0.03}, {"lambda0", 0.04},   {"jitter_rms", jitter_s}};
  return scene;
}

/// A stationary log under drive noise fits two clocks equally (see model_fit.cpp); a rough look at
/// the amplitude tells which.
inline FitScene noisy_scene(std::int64_t periods, bool amplitude_is_seen) {
  FitScene scene{"stationary at B, drive noise 30 %, T0 known", at_point_b(periods), {}, {}};
  scene.scenario.drive.fast_rms = 0.3;
  scene.scenario.sensor.jitter_rms_s = 1e-6;
  scene.options.fixed["T0"] = 2.0;
  scene.truth = {{"epsilon", 2.5e-4}, {"mu", 4e-5}, {"phi0", 0.03}, {"drive_rms", 0.3}};
  if (amplitude_is_seen) {
    scene.name += ", amplitude seen to 10 %";
    scene.options.priors = {{"lambda0", velocity_at_b, 0.1 * velocity_at_b}};
  }
  return scene;
}

inline FitScene noisy_jump_scene(std::int64_t periods) {
  FitScene scene = jump_scene("jump, drive noise 3 %", periods, 1e-5, true);
  scene.scenario.drive.fast_rms = 0.03;
  scene.truth["drive_rms"] = 0.03;
  return scene;
}

/// Relaxation of 318 periods; the slow drive remembers three of them.
inline FitScene slow_jump_scene(std::int64_t periods) {
  FitScene scene = jump_scene("jump, fast drive 3 %, slow drive 2 %", periods, 1e-6, true);
  scene.scenario.drive.fast_rms = 0.03;
  scene.scenario.drive.slow_rms = 0.02;
  scene.scenario.drive.slow_time_s = 2000.0;
  scene.options.noise = FitNoise::slow;
  scene.truth["drive_rms"] = 0.03;
  scene.truth["slow_rms"] = 0.02;
  scene.truth["slow_time"] = 2000.0;
  return scene;
}

/// An impulse at phi1 in place of the torque; doubled at cycle 150.
inline FitScene impulse_scene(std::int64_t periods, double jitter_s) {
  FitScene scene{"single impulse, jump", at_point_a(periods), {}, {}};
  scene.scenario.clock.escapement = Escapement::single_impulse;
  scene.scenario.clock.mu = scene.scenario.clock.phi0 = 0.0;
  scene.scenario.clock.impulse = 2.4e-6;
  scene.scenario.clock.impulse_angle = 0.01;
  ClockEvent event;
  event.at_period = 150;
  event.impulse = 4.8e-6;
  scene.scenario.events = {event};
  scene.scenario.sensor.jitter_rms_s = jitter_s;
  scene.options.escapement = Escapement::single_impulse;
  scene.options.events = {{150, {"impulse"}}};
  scene.options.fixed["T0"] = 2.0;
  scene.truth = {{"epsilon", 2.5e-4},
                 {"impulse", 2.4e-6},
                 {"impulse_angle", 0.01},
                 {"impulse@1", 4.8e-6},
                 {"jitter_rms", jitter_s}};
  return scene;
}

inline FitScene amplitude_scene(std::int64_t periods) {
  FitScene scene = jump_scene("jump, amplitude column", periods, 1e-5, false);
  scene.scenario.sensor.amplitude_rms = 1e-5;
  scene.truth["amplitude_rms"] = 1e-5;
  return scene;
}

/// How one parameter fared over many logs.
struct ParameterScore {
  int determined = 0, within68 = 0, within95 = 0;
  double sum = 0.0, sum2 = 0.0; ///< of (value - truth)/sigma
  std::vector<double> sigma;

  void add(const FittedParameter& p, double truth) {
    ++determined;
    within68 += truth >= p.low68 && truth <= p.high68;
    within95 += truth >= p.low95 && truth <= p.high95;
    const double z = (p.value - truth) / p.sigma;
    sum += z;
    sum2 += z * z;
    sigma.push_back(p.sigma);
  }
  [[nodiscard]] double median_sigma() {
    if (sigma.empty()) return 0.0;
    const auto middle = sigma.begin() + static_cast<std::ptrdiff_t>(sigma.size() / 2);
    std::nth_element(sigma.begin(), middle, sigma.end());
    return *middle;
  }
};

struct SceneScore {
  int logs = 0, failed = 0;
  std::map<std::string, ParameterScore> parameters;
  std::map<std::string, int> dynamics, noise;

  void add(const FitSummary& fit, const std::map<std::string, double>& truth) {
    ++logs;
    if (!fit.has_result()) {
      ++failed;
      return;
    }
    ++dynamics[std::string(name_of(fit.dynamics))];
    ++noise[fit.model.noise()];
    for (const FittedParameter& p : fit.parameters) {
      const auto known = truth.find(p.name);
      if (known != truth.end() && std::isfinite(p.sigma)) parameters[p.name].add(p, known->second);
    }
  }
};

inline FitSummary fit_scene(const FitScene& scene, std::uint64_t seed) {
  return fit_clock(timing_data(simulated_beats(scene.scenario, seed)),
                   scene.scenario.clock.nominal_period_s, scene.options);
}

/// The scenario with one parameter at another value.
inline Scenario with_parameter(Scenario scenario, const std::string& name, double value) {
  if (name == "T0") {
    scenario.clock.nominal_period_s = value;
  } else if (name == "epsilon") {
    scenario.clock.epsilon = value;
  } else if (name == "mu") {
    scenario.clock.mu = value;
  } else if (name == "phi0") {
    scenario.clock.phi0 = value;
  } else if (name == "lambda0") {
    scenario.start_amplitude = value;
  } else if (name == "mu@1") {
    scenario.events.at(0).mu = value;
  }
  return scenario;
}

/// Crossing times (s) of the full simulator, without noise.
inline std::vector<double> exact_times(Scenario scenario) {
  scenario.method.method = Method::direct;
  ClockRun run(scenario, 0);
  std::vector<double> times{0.0};
  while (const auto period = run.next())
    times.push_back(period->time_s.value());
  return times;
}

/// Cramer-Rao bounds of the full simulator under jitter alone (and amplitude noise), by central
/// differences: sigmas by name of every clock parameter of the scene that is not fixed, all free at
/// once, with the time of the first crossing free too.
inline std::map<std::string, double> cramer_rao(const FitScene& scene) {
  std::vector<std::string> names;
  for (const auto& [name, value] : scene.truth)
    if (!scene.options.fixed.contains(name) && name.find("_rms") == std::string::npos)
      names.push_back(name);
  // A stationary start is a start at its own velocity, whatever else changes.
  Scenario scenario = scene.scenario;
  if (scene.truth.contains("lambda0")) scenario.start_amplitude = scene.truth.at("lambda0");
  scenario.sensor = {};
  const auto amplitudes = [](Scenario s) {
    s.method.method = Method::direct;
    ClockRun run(s, 0);
    std::vector<double> seen{0.0};
    while (const auto period = run.next())
      seen.push_back(period->amplitude_rad);
    return seen;
  };
  const bool with_amplitude = scene.scenario.sensor.amplitude_rms.has_value();
  const auto beats = static_cast<Eigen::Index>(exact_times(scenario).size());
  const auto n = static_cast<Eigen::Index>(names.size());
  Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(with_amplitude ? 2 * beats : beats, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const std::string& name = names[static_cast<std::size_t>(k)];
    const double value = scene.truth.at(name), step = 1e-5 * value;
    const Scenario up = with_parameter(scenario, name, value + step);
    const Scenario down = with_parameter(scenario, name, value - step);
    const auto t_up = exact_times(up), t_down = exact_times(down);
    const auto a_up = with_amplitude ? amplitudes(up) : std::vector<double>{};
    const auto a_down = with_amplitude ? amplitudes(down) : std::vector<double>{};
    for (Eigen::Index i = 0; i < beats; ++i) {
      const auto at = static_cast<std::size_t>(i);
      slopes(i, k) =
          (t_up[at] - t_down[at]) / (2.0 * step) * value / scene.scenario.sensor.jitter_rms_s;
      if (with_amplitude && i > 0)
        slopes(beats + i, k) =
            (a_up[at] - a_down[at]) / (2.0 * step) * value / *scene.scenario.sensor.amplitude_rms;
    }
    slopes.col(k).head(beats).array() -= slopes.col(k).head(beats).mean();
  }
  const Eigen::MatrixXd r = Eigen::HouseholderQR<Eigen::MatrixXd>(slopes).matrixQR().topRows(n);
  const Eigen::MatrixXd inverse =
      r.triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(n, n));
  std::map<std::string, double> bounds;
  for (Eigen::Index k = 0; k < n; ++k) {
    const std::string& name = names[static_cast<std::size_t>(k)];
    bounds[name] = inverse.row(k).norm() * scene.truth.at(name);
  }
  return bounds;
}

} // namespace goingrate::test
