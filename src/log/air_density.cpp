#include "goingrate/log/weather.hpp"

#include <cmath>

namespace goingrate {

namespace {

// Saturated vapour of water, Pa.
double vapour_pressure(double kelvin) {
  return std::exp(1.2378847e-5 * kelvin * kelvin - 1.9121316e-2 * kelvin + 33.93711047 -
                  6.3431645e3 / kelvin);
}

// The compressibility of air at pressure `p` (Pa) and t (degrees C), its departure from an ideal
// gas; x is the mole fraction of vapour.
double compressibility(double p, double t, double x) {
  const double ratio = p / (t + 273.15);
  return 1.0 -
         ratio * (1.58123e-6 - 2.9331e-8 * t + 1.1043e-10 * t * t + (5.707e-6 - 2.051e-8 * t) * x +
                  (1.9898e-4 - 2.376e-6 * t) * x * x) +
         ratio * ratio * (1.83e-11 - 0.765e-8 * x * x);
}

double density(double t, double p, double humidity) {
  constexpr double air_kg = 28.96546e-3, water_kg = 18.01528e-3; // a mole
  constexpr double gas_constant = 8.314472;                      // J/(mol K)
  const double kelvin = t + 273.15;
  const double enhancement = 1.00062 + 3.14e-8 * p + 5.6e-7 * t * t;
  const double x = humidity * enhancement * vapour_pressure(kelvin) / p;
  return p * air_kg / (compressibility(p, t, x) * gas_constant * kelvin) *
         (1.0 - x * (1.0 - water_kg / air_kg));
}

} // namespace

std::vector<double> air_density(std::span<const double> temperature_c,
                                std::span<const double> pressure_mbar,
                                std::span<const double> humidity_percent) {
  constexpr double usual_humidity = 0.5, pascals = 100.0; // of a room; in a mbar
  std::vector<double> result;
  result.reserve(temperature_c.size());
  for (std::size_t i = 0; i < temperature_c.size(); ++i) {
    const double humidity = humidity_percent.empty() ? usual_humidity : 0.01 * humidity_percent[i];
    result.push_back(density(temperature_c[i], pascals * pressure_mbar[i], humidity));
  }
  return result;
}

} // namespace goingrate
