#include "held.hpp"

namespace goingrate::timing_model {

namespace {

// Of the slots that stay free those behind the held one move up.
void hold(Slot& slot, std::size_t index, std::span<const double> x) {
  if (!slot.free) return;
  if (slot.index == index) {
    slot.fixed_value = slot.value(x);
    slot.free = false;
  } else if (slot.index > index) {
    --slot.index;
  }
}

} // namespace

FitProblem with_held(const FitProblem& problem, std::size_t index, double coordinate) {
  FitProblem held = problem;
  std::vector<double> x(problem.parameters.free_count, 0.0);
  x[index] = coordinate;
  for (Slot& slot : held.parameters.slots)
    hold(slot, index, x);
  --held.parameters.free_count;
  std::erase_if(held.priors,
                [&](const CoordinatePrior& p) { return p.index == index && !p.planned; });
  for (CoordinatePrior& prior : held.priors) {
    if (prior.planned) {
      hold(prior.planned->after, index, x);
      hold(prior.planned->before, index, x);
    } else if (prior.index > index) {
      --prior.index;
    }
  }
  if (!held.bounds.empty())
    held.bounds.erase(held.bounds.begin() + static_cast<std::ptrdiff_t>(index));
  return held;
}

} // namespace goingrate::timing_model
