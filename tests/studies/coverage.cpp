// The long form of the test of the fit's intervals: many simulated logs of each scene; how often
// the truth lies within the intervals, and sigma against the Cramer-Rao bound of the full
// simulator. Arguments: logs a scene (300), first seed (1000), and which scene (none: all).
#include "support/fit_scenes.hpp"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>

namespace {

using namespace goingrate;
using namespace goingrate::test;

std::vector<FitScene> scenes() {
  return {jump_scene("jump, jitter 1e-6 s, T0 known", 2000, 1e-6, true),
          jump_scene("jump, jitter 1e-6 s, T0 free", 2000, 1e-6, false),
          jump_scene("jump, jitter 1e-4 s, T0 known", 2000, 1e-4, true),
          jump_scene("jump, jitter 1e-4 s, T0 free", 2000, 1e-4, false),
          ring_down_scene(2000, 1e-6),
          start_up_scene(3000, 1e-6),
          noisy_jump_scene(4000),
          amplitude_scene(2000),
          noisy_scene(1000000, true),
          noisy_scene(1000000, false),
          slow_jump_scene(20000),
          impulse_scene(2000, 1e-6)};
}

void print(const FitScene& scene, SceneScore& score, double seconds) {
  std::printf("\n%s: %d logs, %d without a fit, %.3g s each\n", scene.name.c_str(), score.logs,
              score.failed, seconds / score.logs);
  for (const auto& [name, count] : score.dynamics)
    std::printf("  %s in %d\n", name.c_str(), count);
  for (const auto& [name, count] : score.noise)
    std::printf("  noise %s in %d\n", name.c_str(), count);
  const bool bounded = !scene.truth.contains("drive_rms") && !scene.truth.contains("impulse");
  const auto bounds = bounded ? cramer_rao(scene) : std::map<std::string, double>{};
  std::printf("  %-14s %10s %7s %7s %8s %7s %9s %9s\n", "parameter", "determined", "in 68 %",
              "in 95 %", "mean z", "rms z", "rel sigma", "of bound");
  for (auto& [name, p] : score.parameters) {
    const double n = p.determined, truth = scene.truth.at(name), sigma = p.median_sigma();
    std::printf("  %-14s %10d %7.3f %7.3f %8.3f %7.3f %9.2g", name.c_str(), p.determined,
                p.within68 / n, p.within95 / n, p.sum / n, std::sqrt(p.sum2 / n), sigma / truth);
    const auto bound = bounds.find(name);
    std::printf(bound == bounds.end() ? "\n" : " %9.3f\n",
                bound == bounds.end() ? 0.0 : sigma / bound->second);
  }
  std::fflush(stdout);
}

} // namespace

int main(int count, char** words) {
  const int logs = count > 1 ? std::atoi(words[1]) : 300;
  const auto seed = static_cast<std::uint64_t>(count > 2 ? std::atoll(words[2]) : 1000);
  const auto all = scenes();
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (count > 3 && static_cast<int>(k) != std::atoi(words[3])) continue;
    // The scene of a million periods is asked for a third as often.
    const int here = all[k].scenario.periods > 100000 ? std::max(1, logs / 3) : logs;
    const auto begin = std::chrono::steady_clock::now();
    std::vector<FitSummary> fits(static_cast<std::size_t>(here));
    const auto half = [&](std::size_t first) {
      for (std::size_t i = first; i < fits.size(); i += 2)
        fits[i] = fit_scene(all[k], seed + 1000 * k + i);
    };
    std::thread other(half, 1);
    half(0);
    other.join();
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin;
    SceneScore score;
    for (const FitSummary& fit : fits)
      score.add(fit, all[k].truth);
    print(all[k], score, 2.0 * time.count());
  }
}
