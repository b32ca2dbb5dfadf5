#include "final_clock.hpp"

namespace goingrate::timing_model {

namespace {

// The root of the growth by Newton's method; without a drive, the start.
double limiting_amplitude2(const AveragedLaws<double>& laws, double start) {
  if (!(laws.drive() > 0.0)) return start;
  double x = laws.drive() / (2.0 * laws.epsilon);
  for (int round = 0; round < 50; ++round) {
    const double next = std::max(0.1 * x, x - laws.growth(x) / laws.growth_slope(x));
    if (std::abs(next - x) < 1e-14 * x) break;
    x = next;
  }
  return x;
}

} // namespace

FinalClock final_clock(const Parameters& parameters, std::span<const double> x) {
  Going<double> going;
  if (parameters.escapement == Escapement::none) going.laws.phi0 = untouchable_angle;
  for (std::size_t event = 0; event <= parameters.event_cycles.size(); ++event)
    apply_changes(parameters, x, event, going);
  return {going.T0, going.laws, limiting_amplitude2(going.laws, going.amplitude2_start)};
}

} // namespace goingrate::timing_model
