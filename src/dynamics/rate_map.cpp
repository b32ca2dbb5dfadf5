#include "goingrate/dynamics/rate_map.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/base/pulse.hpp"
#include "goingrate/dynamics/stationary.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace goingrate {

namespace {

// Smaller values have no visible effect in the lifetime of a clock; with larger ones the pendulum
// does not swing.
void check_axis(const char* name, const std::vector<double>& values) {
  for (const double value : values)
    if (!(value >= 1e-15 && value <= 1.0)) throw ArgumentError(name, value, "from 1e-15 to 1");
}

double stationary_rate(const ClockParameters& clock, Equations equations) {
  constexpr double no_rate = std::numeric_limits<double>::quiet_NaN();
  if (equations == Equations::first_order)
    return stationary_rate_first_order(clock).value_or(no_rate);
  const auto cycle = limit_cycle(clock);
  return cycle ? cycle->rate_excess : no_rate;
}

} // namespace

RateMap rate_map(double phi0, std::vector<double> epsilon, std::vector<double> mu,
                 Equations equations) {
  check_axis("epsilon", epsilon);
  check_axis("mu", mu);
  if (!(phi0 > 0.0 && phi0 < std::numbers::pi))
    throw ArgumentError("phi0", phi0, "above 0 and below pi rad");
  RateMap map{phi0, std::move(epsilon), std::move(mu), {}};
  for (const double torque : map.mu) {
    pulse();
    map.rate_excess.emplace_back();
    for (const double friction : map.epsilon)
      map.rate_excess.back().push_back(stationary_rate({2.0, friction, torque, phi0}, equations));
  }
  return map;
}

std::vector<double> log_grid(double low, double high, std::size_t points) {
  if (!(low > 0.0)) throw ArgumentError("low", low, "above 0");
  if (!(high > low)) throw ArgumentError("high", high, "above the low end");
  if (points < 2) throw ArgumentError("points", static_cast<double>(points), "2 or more");
  std::vector<double> grid;
  for (std::size_t i = 0; i < points; ++i)
    grid.push_back(low *
                   std::pow(high / low, static_cast<double>(i) / static_cast<double>(points - 1)));
  grid.back() = high; // exactly, without rounding
  return grid;
}

} // namespace goingrate
