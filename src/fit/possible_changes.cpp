#include "possible_changes.hpp"

#include "fit_setup.hpp"
#include "fit_starts.hpp"

#include <algorithm>

namespace goingrate::timing_model {

namespace {

double cycle_of(const Parameters& parameters, const Slot& slot) {
  return slot.event == 0 ? 0.0 : parameters.event_cycles[slot.event - 1];
}

// The place among more parameters where nothing changes but what changed before.
std::vector<double> same_place(const Parameters& from, std::span<const double> x,
                               const Parameters& to) {
  std::vector<double> place(to.free_count, 0.0);
  for (const Slot& slot : to.slots) {
    if (!slot.free) continue;
    for (const Slot& before : from.slots) // in order of events: the last is in force
      if (before.quantity == slot.quantity && before.term == slot.term &&
          cycle_of(from, before) <= cycle_of(to, slot))
        place[slot.index] = slot.coordinate_of(before.value(x));
  }
  return place;
}

} // namespace

std::vector<FitEvent> joined(const std::vector<FitEvent>& events,
                             const std::vector<FitEvent>& more) {
  std::vector<FitEvent> all = events;
  for (const FitEvent& event : more)
    if (std::none_of(events.begin(), events.end(),
                     [&](const FitEvent& other) { return other.cycle == event.cycle; }))
      all.push_back(event);
  std::sort(all.begin(), all.end(),
            [](const FitEvent& a, const FitEvent& b) { return a.cycle < b.cycle; });
  return all;
}

double promised_gain(const Fitted& fitted, const FitOptions& wider) {
  FitProblem problem = make_problem(*fitted.problem.data, wider, fitted.model);
  if (problem.parameters.free_count > most_parameters) return 0.0;
  problem.parameters.start_ratio = fitted.problem.parameters.start_ratio;
  problem.correction = on_every_beat(fitted.problem).correction; // as these data are
  const auto x = same_place(fitted.problem.parameters, fitted.minimum.x, problem.parameters);
  problem.priors = make_priors(wider, problem.parameters, x);
  const auto there = evaluate(problem, x);
  return there ? 0.5 * there->projected.squaredNorm() : 0.0;
}

} // namespace goingrate::timing_model
