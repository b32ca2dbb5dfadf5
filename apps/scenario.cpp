#include "scenario.hpp"

#include "common.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace goingrate::apps {

void add_override_option(CLI::App& command, ScenarioOptions& options) {
  command
      .add_option("--set", options.overrides,
                  "override a key of the scenario: clock.mu=3e-5, "
                  "run.method=map")
      ->allow_extra_args(false);
}

// What --set says is read as a scenario is, but faults in it are wrong usage.
ReadScenario read_scenario(const ScenarioOptions& options) {
  std::string text = read_text(options.path);
  try {
    Scenario scenario = parse_scenario(text, options.path, options.overrides);
    return {std::move(text), std::move(scenario)};
  } catch (const InputError& error) {
    const auto& said = options.overrides;
    if (std::find(said.begin(), said.end(), error.place().file) == said.end()) throw;
    throw UsageError(fmt::format("--set {}", error.what()));
  }
}

} // namespace goingrate::apps
