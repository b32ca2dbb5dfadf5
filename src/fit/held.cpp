#include "held.hpp"

namespace goingrate::timing_model {

namespace {

// Fixes the slot if it has that index; free slots behind the fixed one move up.
void hold(Slot& slot, std::size_t index, std::span<const double> x) {
  if (!slot.free) return;
  if (slot.index == index) {
    slot.fixed_value = slot.value(x);
    slot.free = false;
  } else if (slot.index > index) {
    --slot.index;
  }
}

// The change of the correction by the held coordinate becomes a part of the correction.
void hold(Correction& correction, std::size_t index, double coordinate) {
  Correction::Slopes& slopes = correction.slopes;
  if (index >= slopes.late_s.size()) return; // no slope, as for the noise
  const auto place = static_cast<std::ptrdiff_t>(index);
  const double moved = coordinate - slopes.at[index];
  const auto fold = [&](std::vector<double>& into, std::vector<std::vector<double>>& by) {
    for (std::size_t i = 0; i < into.size(); ++i)
      into[i] += moved * by[index][i];
    by.erase(by.begin() + place);
  };
  fold(correction.late_s, slopes.late_s);
  fold(correction.amplitude, slopes.amplitude);
  slopes.at.erase(slopes.at.begin() + place);
}

} // namespace

FitProblem with_held(const FitProblem& problem, std::size_t index, double coordinate) {
  FitProblem held = problem;
  std::vector<double> x(problem.parameters.free_count, 0.0);
  x[index] = coordinate;
  for (Slot& slot : held.parameters.slots)
    hold(slot, index, x);
  --held.parameters.free_count;
  hold(held.correction, index, coordinate);
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
