// The scenario that a command line names.
#pragma once

#include "goingrate/clock/scenario.hpp"

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace goingrate::apps {

/// Where a scenario is and what is changed of it.
struct ScenarioOptions {
  std::string path;
  std::vector<std::string> overrides; ///< KEY=VALUE
};

/// Adds --set.
void add_override_option(CLI::App& command, ScenarioOptions& options);

/// A scenario and the text it was made of.
struct ReadScenario {
  std::string text;
  Scenario scenario;
};

/// Throws InputError for the file, UsageError for what an override says.
ReadScenario read_scenario(const ScenarioOptions& options);

} // namespace goingrate::apps
