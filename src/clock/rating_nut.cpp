#include "goingrate/clock/rating_nut.hpp"

#include "goingrate/base/errors.hpp"

#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace goingrate {

namespace {

void demand_positive(const char* name, double value) {
  if (!(value > 0.0) || !std::isfinite(value)) throw ArgumentError(name, value, "above 0");
}

// The plausible range, without overflow.
void demand_between(const char* name, double value, double least, double most) {
  if (!(value >= least && value <= most))
    throw ArgumentError(name, value, fmt::format("between {} and {} m", least, most));
}

} // namespace

double mathematical_length(double nominal_period_s) {
  demand_positive("nominal_period_s", nominal_period_s);
  constexpr double gravity = 9.81; // m/s^2
  const double scaled = nominal_period_s / (2.0 * std::numbers::pi);
  return gravity * scaled * scaled;
}

NutTurns turns_to_zero_rate(const RatingNut& nut, double rate_excess, double sigma) {
  demand_between("pitch_m", nut.pitch_m, 1e-9, 1.0);
  demand_between("length_m", nut.length_m, 1e-6, 1e6);
  const double turns_a_rate = 2.0 * nut.length_m / nut.pitch_m;
  const double turns = -turns_a_rate * rate_excess;
  return {turns, turns_a_rate * sigma, turns * nut.pitch_m};
}

} // namespace goingrate
