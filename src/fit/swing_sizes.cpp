#include "swing_sizes.hpp"

#include "fit_starts.hpp"
#include "held.hpp"

#include "base/workers.hpp"

#include <algorithm>
#include <array>

namespace goingrate::timing_model {

namespace {

// The clock with mu, phi0 and lambda0 multiplied by `times`: lambda/phi0 then evolves as before.
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
  // A fit with phi0 held may be this much worse in L and still be worth finishing with phi0 free.
  constexpr double largest_deficit = 30.0;
  const Parameters& parameters = problem.parameters;
  const Slot* phi0 = parameters.find(Quantity::phi0);
  const bool size_is_open = !problem.data->has_amplitude() && !parameters.event_cycles.empty() &&
                            parameters.has(Quantity::drive_rms) &&
                            parameters.is_free(Quantity::T0) && parameters.is_free(Quantity::phi0);
  if (!size_is_open || !best.usable) return {};
  constexpr SearchLimits rough{30, 1e-2}, finishing{40, 1e-2};
  std::vector<Minimum> ends(angles.size());
  share(angles.size(), [&](std::size_t i) {
    const double now = phi0->value(std::span<const double>(best.x));
    const auto starts = screened(problem, {at_size(parameters, best.x, angles[i] / now)});
    if (starts.empty()) return;
    const auto place = static_cast<std::ptrdiff_t>(phi0->index);
    std::vector<double> without = starts.front().x;
    const double size = without[phi0->index];
    without.erase(without.begin() + place);
    Minimum end = minimise(with_held(problem, phi0->index, size), without, rough);
    if (!end.usable || end.value > best.value + largest_deficit) return;
    end.x.insert(end.x.begin() + place, size);
    ends[i] = minimise(problem, end.x, finishing);
  });
  std::erase_if(ends, [](const Minimum& end) { return !end.usable; });
  return ends;
}

} // namespace goingrate::timing_model
