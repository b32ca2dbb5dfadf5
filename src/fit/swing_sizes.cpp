#include "swing_sizes.hpp"

#include "fit_starts.hpp"
#include "held.hpp"

#include "base/workers.hpp"

#include <algorithm>
#include <array>

namespace goingrate::timing_model {

namespace {

// The clock with all angles, and its torque, `times` as large: its amplitude in units of phi0 then
// has the same course.
std::vector<double> at_size(const Parameters& parameters, std::vector<double> x, double times) {
  for (const Slot& slot : parameters.slots) {
    const bool scales = slot.quantity == Quantity::mu || slot.quantity == Quantity::phi0 ||
                        slot.quantity == Quantity::lambda0;
    if (scales && slot.free)
      x[slot.index] = slot.coordinate_of(times * slot.value(std::span<const double>(x)));
  }
  return x;
}

} // namespace

std::vector<Minimum> ends_of_every_size(const FitProblem& problem, const Minimum& best) {
  constexpr std::array angles{0.005, 0.01, 0.02, 0.04, 0.08, 0.16}; // rad, of phi0
  constexpr double largest_deficit = 30.0; // of L: with its size held, a clock is not at its best
  const Parameters& parameters = problem.parameters;
  const Slot* phi0 = parameters.find(Quantity::phi0);
  if (problem.data->has_amplitude() || parameters.event_cycles.empty() ||
      !parameters.has(Quantity::drive_rms) || !parameters.is_free(Quantity::T0) ||
      !parameters.is_free(Quantity::phi0) || !best.usable)
    return {};
  std::vector<Minimum> ends(angles.size());
  share(angles.size(), [&](std::size_t i) {
    const double now = phi0->value(std::span<const double>(best.x));
    for (Minimum& start : screened(problem, {at_size(parameters, best.x, angles[i] / now)})) {
      const auto place = static_cast<std::ptrdiff_t>(phi0->index);
      const double size = start.x[phi0->index];
      std::vector<double> without = start.x;
      without.erase(without.begin() + place);
      Minimum end = minimise(with_held(problem, phi0->index, size), without, {30, 1e-2});
      if (!end.usable || end.value > best.value + largest_deficit) return;
      end.x.insert(end.x.begin() + place, size);
      ends[i] = minimise(problem, end.x, {40, 1e-2});
    }
  });
  std::erase_if(ends, [](const Minimum& end) { return !end.usable; });
  return ends;
}

} // namespace goingrate::timing_model
