// Names of a fit's states and choices, and the lookup of a parameter by name in a summary.
#include "goingrate/fit/clock_fit.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace goingrate {

std::string_view name_of(FitDynamics dynamics) {
  switch (dynamics) {
  case FitDynamics::automatic:
    return "automatic";
  case FitDynamics::averaged2:
    return "averaged2";
  case FitDynamics::map:
    return "map";
  case FitDynamics::averaged1:
    break;
  }
  return "averaged1";
}

std::string_view name_of(FitStatus status) {
  switch (status) {
  case FitStatus::stopped_early:
    return "stopped-early";
  case FitStatus::no_valid_model:
    return "no-valid-model";
  case FitStatus::contradicts_log:
    return "contradicts-log";
  case FitStatus::converged:
    break;
  }
  return "converged";
}

std::string ModelChoice::friction() const {
  return std::string("linear") + (quadratic ? " + quadratic" : "") + (dry ? " + dry" : "");
}

std::string ModelChoice::noise() const {
  std::vector<std::string> parts;
  if (jitter) parts.emplace_back("jitter");
  if (walk) parts.emplace_back("random walk");
  if (drive) parts.emplace_back("drive");
  if (slow) parts.emplace_back("slow drive");
  return fmt::format("{}", fmt::join(parts, " + "));
}

std::string ModelChoice::name() const {
  return fmt::format("{}, friction {}, noise {}{}", name_of(escapement), friction(), noise(),
                     amplitude_scale ? ", amplitude scale" : "");
}

const FittedParameter* FitSummary::find(std::string_view name) const {
  const auto at = std::find_if(parameters.begin(), parameters.end(),
                               [&](const FittedParameter& p) { return p.name == name; });
  return at == parameters.end() ? nullptr : &*at;
}

const FittedParameter& FitSummary::operator[](std::string_view name) const {
  if (const FittedParameter* found = find(name)) return *found;
  std::vector<std::string_view> names;
  for (const FittedParameter& p : parameters)
    names.push_back(p.name);
  throw ArgumentError("parameter", std::string(name),
                      fmt::format("one of {}", fmt::join(names, ", ")));
}

const DerivedQuantity* FitSummary::combination(std::string_view name) const {
  const auto at = std::find_if(combinations.begin(), combinations.end(),
                               [&](const DerivedQuantity& q) { return q.name == name; });
  return at == combinations.end() ? nullptr : &*at;
}

} // namespace goingrate
