// Whether fits of clocks with a noisy drive are biased, and whether their intervals hold: at three
// Q, with and without an amplitude column, T0 known or not; the drive varies from period to period,
// and in some scenes slowly, jumps, or is a single impulse. Arguments: logs per scene (300), first
// seed (1), words that a scene's name must contain.
#include "support/simulated.hpp"

#include "goingrate/fit/clock_fit.hpp"

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <string>
#include <thread>
#include <vector>

namespace {

using namespace goingrate;

struct Scene {
  std::string name;
  Scenario scenario;
  FitOptions options;
  std::map<std::string, double> truth;
};

Scene noisy_scene(double Q, bool amplitudes, bool known_T0) {
  Scene scene;
  scene.name = "Q " + std::to_string(static_cast<int>(Q)) +
               (amplitudes ? ", amplitudes" : ", times") + (known_T0 ? ", T0 known" : "");
  Scenario& s = scene.scenario;
  s.clock.nominal_period_s = 1.0;
  s.clock.epsilon = 0.5 / Q;
  s.clock.mu = 0.4 * s.clock.epsilon * 0.5;
  s.clock.phi0 = 0.04;
  s.periods = 10000;
  s.drive.fast_rms = 0.2;
  s.sensor.jitter_rms_s = 1e-5;
  if (amplitudes) s.sensor.amplitude_rms = 2e-5;
  scene.truth = {{"T0", 1.0},
                 {"epsilon", s.clock.epsilon},
                 {"mu", s.clock.mu},
                 {"phi0", s.clock.phi0},
                 {"drive_rms", 0.2}};
  if (known_T0) scene.options.fixed["T0"] = 1.0;
  return scene;
}

std::vector<Scene> scenes() {
  std::vector<Scene> all;
  for (const double Q : {300.0, 500.0, 2000.0})
    for (const bool amplitudes : {true, false})
      for (const bool known_T0 : {true, false})
        all.push_back(noisy_scene(Q, amplitudes, known_T0));
  Scene slow = noisy_scene(500.0, true, false);
  slow.name += ", slow drive";
  slow.scenario.drive.slow_rms = 0.1;
  slow.scenario.drive.slow_time_s = 300.0;
  slow.truth["slow_rms"] = 0.1;
  slow.truth["slow_time"] = 300.0;
  all.push_back(slow);
  Scene missed = noisy_scene(500.0, true, false);
  missed.name += ", a tenth missed";
  missed.scenario.sensor.missed = 0.1;
  all.push_back(missed);
  Scene jump = noisy_scene(500.0, true, false);
  jump.name += ", jump";
  ClockEvent event;
  event.at_period = 3000;
  event.mu = 1.4 * jump.scenario.clock.mu;
  jump.scenario.events = {event};
  jump.options.events = {{3000, {"mu"}}};
  jump.truth["mu@1"] = *event.mu;
  all.push_back(jump);
  Scene drag = noisy_scene(500.0, true, false);
  drag.name += ", quadratic drag";
  drag.scenario.clock.quadratic_drag = 3e-3;
  drag.options.freed = {"quadratic_drag"};
  drag.truth["quadratic_drag"] = 3e-3;
  all.push_back(drag);
  Scene impulse = noisy_scene(500.0, true, false);
  impulse.name += ", single impulse";
  ClockParameters& clock = impulse.scenario.clock;
  clock.escapement = Escapement::single_impulse;
  clock.impulse = 4.0 * clock.mu * clock.phi0;
  clock.impulse_angle = 0.02;
  clock.mu = 0.0;
  clock.phi0 = 0.0;
  impulse.options.escapement = Escapement::single_impulse;
  impulse.truth.erase("mu");
  impulse.truth.erase("phi0");
  impulse.truth["impulse"] = clock.impulse;
  impulse.truth["impulse_angle"] = clock.impulse_angle;
  all.push_back(impulse);
  return all;
}

struct Tally {
  int logs = 0, within = 0;
  double z = 0.0, z2 = 0.0, sigma = 0.0;
};

void study(const Scene& scene, int logs, std::uint64_t first_seed) {
  std::vector<FitSummary> fits(static_cast<std::size_t>(logs));
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < fits.size(); i = next++)
      fits[i] = fit_clock(timing_data(test::simulated_beats(scene.scenario, first_seed + i)), 1.0,
                          scene.options);
  };
  std::thread other(work);
  work();
  other.join();
  std::map<std::string, Tally> tallies;
  std::map<std::string, int> models;
  for (const FitSummary& fit : fits) {
    ++models[fit.model.name() + ", " + std::string(name_of(fit.dynamics))];
    for (const auto& [name, truth] : scene.truth) {
      const FittedParameter* p = fit.find(name);
      if (p == nullptr || !std::isfinite(p->sigma)) continue;
      Tally& tally = tallies[name];
      const double z = (p->value - truth) / p->sigma;
      ++tally.logs;
      tally.within += p->low68 <= truth && truth <= p->high68;
      tally.z += z;
      tally.z2 += z * z;
      tally.sigma += p->sigma / truth;
    }
  }
  std::printf("%s\n", scene.name.c_str());
  for (const auto& [model, times] : models)
    std::printf("  %4d x %s\n", times, model.c_str());
  for (const auto& [name, t] : tallies) {
    const double n = t.logs, mean = t.z / n;
    std::printf("  %-15s %4d stated, sigma %8.2g, mean z %+6.2f +- %.2f, sd %.2f, in 68 %% %.3f\n",
                name.c_str(), t.logs, t.sigma / n, mean, 1.0 / std::sqrt(n),
                std::sqrt(std::max(0.0, t.z2 / n - mean * mean)), t.within / n);
  }
  std::fflush(stdout);
}

} // namespace

int main(int count, char** words) {
  const int logs = count > 1 ? std::atoi(words[1]) : 300;
  const auto seed = static_cast<std::uint64_t>(count > 2 ? std::atoll(words[2]) : 1);
  for (const Scene& scene : scenes())
    if (count < 4 || scene.name.find(words[3]) != std::string::npos) study(scene, logs, seed);
}
