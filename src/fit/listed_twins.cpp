#include "listed_twins.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <limits>

namespace goingrate::timing_model {

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

// The sigmas of the coordinates there; NaN where the model does not hold.
std::vector<double> sigmas_at(const FitProblem& problem, std::span<const double> x,
                              const Widening& widening) {
  std::vector<double> sigmas(x.size(), unknown);
  const auto there = evaluate(problem, x);
  if (!there) return sigmas;
  const Certainty known = certainty(problem, x, *there, widening);
  for (std::size_t k = 0; k < sigmas.size(); ++k)
    sigmas[k] = known.sigma(k);
  return sigmas;
}

// A parameter that is not determined even if it is this clock has no sigma.
ClockTwin clock_at(const Fitted& fitted, std::span<const double> x, double behind) {
  ClockTwin clock{{}, {}, 2.0 * behind};
  const FitProblem all = on_every_beat(fitted.problem);
  const std::vector<double> sigmas = sigmas_at(all, x, fitted.widening);
  for (const Slot& slot : fitted.problem.parameters.slots) {
    if (!slot.free || !is_of_clock(slot.quantity)) continue;
    const std::string name = fitted.problem.parameters.name_of(slot);
    const double sigma = sigmas[slot.index];
    const bool is_determined = sigma <= tolerable_sigma(all, slot, x);
    clock.parameters.emplace_back(name, slot.value(x));
    clock.sigma.emplace_back(name, is_determined ? sigma * std::abs(slot.slope(x)) : unknown);
  }
  return clock;
}

bool is_another_clock(const Fitted& fitted, std::span<const double> x) {
  const auto& slots = fitted.problem.parameters.slots;
  return std::any_of(slots.begin(), slots.end(), [&](const Slot& slot) {
    return slot.free && is_of_clock(slot.quantity) && slot.quantity != Quantity::T0 &&
           std::abs(x[slot.index] - fitted.minimum.x[slot.index]) >=
               rivals_apart * fitted.known.curvature_sigma(slot.index);
  });
}

std::string words_for(const ClockTwin& clock) {
  std::vector<std::string> parts;
  for (const auto& [name, value] : clock.parameters)
    if (name != "T0") parts.push_back(fmt::format("{} {:.3g}", name, value));
  return fmt::format("{}", fmt::join(parts, ", "));
}

} // namespace

void list_twins(const Fitted& fitted, FitSummary& summary) {
  Rivals listed;
  for (const Rival& rival : fitted.rivals) {
    const bool is_new = std::all_of(listed.begin(), listed.end(), [&](const Rival& other) {
      return fitted.known.tells_apart(rival.x, other.x);
    });
    if (is_new && is_another_clock(fitted, rival.x)) listed.push_back(rival);
  }
  std::stable_sort(listed.begin(), listed.end(),
                   [](const Rival& a, const Rival& b) { return a.behind < b.behind; });
  if (listed.empty()) return;
  for (const Rival& rival : listed)
    summary.twins.push_back(clock_at(fitted, rival.x, rival.behind));
  summary.likeliest_twin = clock_at(fitted, fitted.minimum.x, 0.0);
  summary.notes.push_back(
      {NoteKind::twin,
       fmt::format(
           "{} clocks explain this log: {}; or, {:.2g} times less likely, {}. {}",
           listed.size() == 1 ? "two" : "several", words_for(*summary.likeliest_twin),
           std::exp(listed.front().behind), words_for(summary.twins.front()),
           fitted.problem.data->has_amplitude()
               ? "A ring-down, or T0 from elsewhere, would tell which"
               : "A rough measurement of the amplitude decides which: a prior on lambda0")});
}

} // namespace goingrate::timing_model
