#include "model_words.hpp"

#include "parameter_words.hpp"
#include "wording.hpp"

#include "goingrate/report/tables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <string_view>
#include <vector>

namespace goingrate {

namespace {

std::string percent(const FittedParameter& share) {
  return with_sigma(100.0 * share.value, 100.0 * share.sigma, 2) + " %";
}

const FittedParameter* known(const FitSummary& fit, std::string_view name) {
  const FittedParameter* found = fit.find(name);
  return found != nullptr && std::isfinite(found->value) ? found : nullptr;
}

// The noise of the clock itself that the model needs to explain the log. Where fast and slow drive
// are split by the spectrum, the table has their sizes.
std::string wander(const Analysis& data, bool told_a_change) {
  const FitSummary& fit = data.fit;
  const std::string change =
      fit.events.empty() && told_a_change ? ", which absorbs the change" : "";
  const FittedParameter* slow = known(fit, "slow_rms");
  if (fit.model.slow)
    return (slow != nullptr ? fmt::format(" with a drive that wanders slowly, by {} rms", percent(*slow))
                            : " with a drive that may wander slowly") +
           change;
  const FittedParameter* fast = known(fit, "drive_rms");
  if (fit.model.drive)
    return " with a drive that varies from period to period" +
           (data.drive.split || fast == nullptr ? "" : fmt::format(", by {} rms", percent(*fast)));
  return fit.model.walk && known(fit, "walk_rms") != nullptr ? " with periods that vary by themselves, one by one" + change : "";
}

// "the friction ε, the driving torque μ or ...": the parameters without a row in the table.
std::string undetermined(const FitSummary& fit) {
  constexpr std::array<std::string_view, 6> asked{"T0",   "epsilon", "mu",
                                                  "phi0", "impulse", "impulse_angle"};
  std::vector<std::string> names;
  for (const std::string_view name : asked)
    if (const FittedParameter* found = fit.find(name);
        found != nullptr && found->status == ParameterStatus::undetermined)
      names.push_back(has_symbol(name) ? fmt::format("the {} {}", meaning_of(name), symbol_of(name))
                                       : fmt::format("the {}", meaning_of(name)));
  return listed(names, "or");
}

// Advice on how to determine the parameters that are left open.
std::string remedy(const Analysis& data, bool sees_amplitude) {
  const bool has_step_of_drive =
      std::any_of(data.suspicions.begin(), data.suspicions.end(),
                  [](const Suspicion& s) { return s.cause == Cause::drive_step; });
  const std::string amplitudes = sees_amplitude ? "" : "amplitudes, ";
  if (!swings_freely(data))
    return fmt::format("; {}a ring-down or a {}change of the driving weight would", amplitudes,
                       has_step_of_drive ? "larger " : "");
  const bool is_told = data.fit.decay && !std::isfinite(data.fit.decay->q.value);
  return is_told ? "" : fmt::format("; {}a longer log or a larger first swing would", amplitudes);
}

} // namespace

std::string model_sentence(const Analysis& data, bool sees_amplitude, bool told_a_change) {
  const FitSummary& fit = data.fit;
  if (!fit.has_result() && !fit.termination.empty())
    return fmt::format("No pendulum was fitted: {}.", fit.termination);
  if (!fit.has_result() || fit.parameters.empty())
    return "No model of a pendulum could be fitted to this log.";
  if (fit.status == FitStatus::contradicts_log && fit.impulses && !fit.impulses->is_regular)
    return "A drive that waits for the swing to fall is not the steady one of the model, so none "
           "of its numbers is given.";
  if (fit.status == FitStatus::contradicts_log)
    return "The model of the pendulum does not explain this log, so none of its numbers is given.";
  constexpr double least_p = 1e-3; // probability of such residuals, and of such a χ²
  const bool is_rough = fit.quality.whiteness_p < least_p || fit.quality.p_value < least_p;
  const std::string needs = wander(data, told_a_change);
  std::string text = "The model of the pendulum explains this log";
  text += is_rough ? " only roughly" : needs.empty() ? " to within its noise" : needs;
  if (const std::string open = undetermined(fit); !open.empty())
    text += fmt::format(", {} the log does not tell {}{}", is_rough ? "and" : "but", open,
                        remedy(data, sees_amplitude));
  return text + ".";
}

} // namespace goingrate
