// By how much the choice of the dynamics shifts the parameters: logs of the full simulator with a
// jitter of 1e-6 s over 20,000 periods (a ring-down over 6,000), fitted by `auto` and by
// `averaged1`; prints the mean of (value - truth)/sigma, sigma being that of `auto`. Arguments:
// logs a scene (400), first seed (1).
#include "support/fit_scenes.hpp"

#include <cstdio>
#include <cstdlib>

namespace {

using namespace goingrate;
using namespace goingrate::test;

struct Bias {
  double chosen = 0.0, first = 0.0, sigma = 0.0;
  int logs = 0;
};

std::map<std::string, Bias> biases(FitScene scene, int logs, std::uint64_t first_seed,
                                   std::map<std::string, int>& dynamics) {
  std::map<std::string, Bias> sums;
  for (int i = 0; i < logs; ++i) {
    const auto seed = first_seed + static_cast<std::uint64_t>(i);
    const auto data = timing_data(simulated_beats(scene.scenario, seed));
    scene.options.dynamics = FitDynamics::automatic;
    const FitSummary chosen = fit_clock(data, 2.0, scene.options);
    ++dynamics[std::string(name_of(chosen.dynamics))];
    scene.options.dynamics = FitDynamics::averaged1;
    scene.options.noise = FitNoise::jitter;
    const FitSummary first = fit_clock(data, 2.0, scene.options);
    scene.options.noise = FitNoise::automatic;
    for (const FittedParameter& p : chosen.parameters) {
      const FittedParameter* other = first.find(p.name);
      if (!std::isfinite(p.sigma) || !scene.truth.contains(p.name) || other == nullptr) continue;
      const double truth = scene.truth.at(p.name);
      Bias& bias = sums[p.name];
      bias.chosen += (p.value - truth) / p.sigma;
      bias.first += (other->value - truth) / p.sigma;
      bias.sigma = p.sigma / truth;
      ++bias.logs;
    }
  }
  return sums;
}

} // namespace

int main(int count, char** words) {
  const int logs = count > 1 ? std::atoi(words[1]) : 400;
  const auto seed = static_cast<std::uint64_t>(count > 2 ? std::atoll(words[2]) : 1);
  const std::vector<FitScene> scenes{
      jump_scene("jump, T0 known", 20000, 1e-6, true),
      jump_scene("jump, T0 free", 20000, 1e-6, false),
      ring_down_scene(6000, 1e-6),
      start_up_scene(20000, 1e-6),
  };
  std::printf("%-16s %-11s %5s %10s %22s %14s\n", "scene", "parameter", "logs", "rel sigma",
              "mean z of auto", "of averaged1");
  for (const FitScene& scene : scenes) {
    std::map<std::string, int> dynamics;
    for (const auto& [name, bias] : biases(scene, logs, seed, dynamics)) {
      const double n = bias.logs;
      std::printf("%-16s %-11s %5d %10.2g %13.3f +- %5.3f %14.1f\n", scene.name.c_str(),
                  name.c_str(), bias.logs, bias.sigma, bias.chosen / n, 1.0 / std::sqrt(n),
                  bias.first / n);
    }
    for (const auto& [name, times] : dynamics)
      std::printf("  auto took %s in %d\n", name.c_str(), times);
    std::fflush(stdout);
  }
}
