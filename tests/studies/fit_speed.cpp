// Time of a fit against its error, for the dynamics and for thinned logs. Error: the largest
// |value - truth| of a determined parameter of the clock, in the sigma of the whole log's fit.
// Argument: "year" adds a log of 1.6e7 periods.
#include "support/fit_scenes.hpp"

#include <chrono>
#include <cstdio>
#include <cstring>

namespace {

using namespace goingrate;
using namespace goingrate::test;

struct Timed {
  FitSummary fit;
  double ms = 0.0; // median
};

Timed timed(const TimingData& data, const FitOptions& options, int repeats) {
  Timed result;
  std::vector<double> times;
  for (int i = 0; i < repeats; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    result.fit = fit_clock(data, 2.0, options);
    const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - begin;
    times.push_back(time.count());
  }
  std::sort(times.begin(), times.end());
  result.ms = times[times.size() / 2];
  return result;
}

double sigma_of(const FitSummary& fit, const std::string& name) {
  for (const FittedParameter& p : fit.parameters)
    if (p.name == name) return p.sigma;
  return 0.0;
}

void print(const char* what, const Timed& t, const FitScene& scene, const FitSummary& whole) {
  double worst = 0.0;
  for (const FittedParameter& p : t.fit.parameters) {
    const auto truth = scene.truth.find(p.name);
    if (truth == scene.truth.end() || p.name.find("_rms") != std::string::npos) continue;
    const double sigma = sigma_of(whole, p.name);
    if (std::isfinite(p.value) && std::isfinite(sigma))
      worst = std::max(worst, std::abs(p.value - truth->second) / sigma);
  }
  std::printf("  %-22s %10.1f ms   error %8.2f sigma   sigma of epsilon %.2g %%   (%s)\n", what,
              t.ms, worst, 100.0 * sigma_of(t.fit, "epsilon") / 2.5e-4, t.fit.dynamics.c_str());
}

void dynamics_of(const FitScene& given, int repeats) {
  FitScene scene = given;
  scene.options.noise = FitNoise::jitter; // what a wrong model leaves is not to be called noise
  const TimingData data = timing_data(simulated_beats(scene.scenario, 1));
  std::printf("%s, %zu beats\n", scene.name.c_str(), data.size());
  const Timed whole = timed(data, scene.options, repeats);
  for (const auto& [name, dynamics] : {std::pair{"averaged1", FitDynamics::averaged1},
                                       {"averaged2", FitDynamics::averaged2},
                                       {"map", FitDynamics::map},
                                       {"auto", FitDynamics::automatic}}) {
    scene.options.dynamics = dynamics;
    print(name, timed(data, scene.options, repeats), scene, whole.fit);
  }
}

void thinnings_of(const FitScene& scene, const std::vector<std::size_t>& strides) {
  const TimingData data = timing_data(simulated_beats(scene.scenario, 1));
  std::printf("%s, %zu beats\n", scene.name.c_str(), data.size());
  const int repeats = data.size() > 1000000 ? 1 : 3;
  const Timed whole = timed(data, scene.options, repeats);
  std::printf("  (the fit itself takes %zu beats and loses %.2g %% of the information)\n",
              whole.fit.thinning.beats, 100.0 * whole.fit.thinning.information_lost);
  print("as it is", whole, scene, whole.fit);
  std::fflush(stdout);
  for (const std::size_t stride : strides) {
    std::vector<std::size_t> kept;
    for (std::size_t i = 0; i < data.size(); i += stride)
      kept.push_back(i);
    char name[32];
    std::snprintf(name, sizeof name, "every %zu-th beat", stride);
    print(name, timed(subset(data, kept), scene.options, 3), scene, whole.fit);
  }
}

} // namespace

int main(int count, char** words) {
  dynamics_of(jump_scene("jump, jitter 1e-6 s", 2000, 1e-6, true), 11);
  dynamics_of(jump_scene("jump, jitter 1e-4 s", 2000, 1e-4, true), 11);
  dynamics_of(jump_scene("jump, jitter 1e-6 s", 20000, 1e-6, true), 3);
  thinnings_of(noisy_scene(100000, true), {4, 16});
  if (count > 1 && std::strcmp(words[1], "year") == 0)
    thinnings_of(noisy_scene(16000000, true), {});
}
