// Cramer-Rao bounds of the full simulator for the parameters of a scenario under jitter alone, to
// compare a fit's sigmas with: study_coverage SCENARIO.toml [--set KEY=VALUE ...] [NAME ...], the
// names being those of parameters that a fit holds. Nothing where the drive varies or the
// escapement is none of those whose slopes are known here.
#include "goingrate/analysis/simulated_logs.hpp"
#include "goingrate/log/reading.hpp"
#include "support/fit_scenes.hpp"

#include <cstdio>

int main(int count, char** words) {
  using namespace goingrate;
  if (count < 2) return 2;
  const std::string file = words[1];
  std::vector<std::string> overrides;
  test::FitScene scene;
  for (int i = 2; i < count; ++i) {
    const std::string word = words[i];
    if (word == "--set" && i + 1 < count)
      overrides.emplace_back(words[++i]);
    else
      scene.options.fixed[word] = 0.0;
  }
  scene.options.fixed["gravity_share"] = 1.0; // fits hold it
  scene.scenario = parse_scenario(read_text(file), file, overrides);
  scene.truth = true_parameters(scene.scenario);
  if (!scene.scenario.drive.is_steady() || scene.truth.contains("impulse")) return 0;
  std::printf("bounds:");
  for (const auto& [name, sigma] : test::cramer_rao(scene))
    std::printf("  %s %.3g", name.c_str(), sigma);
  std::printf("\n");
}
