#include "dynamics/amplitude_history.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <numbers>

namespace goingrate {

using std::numbers::pi;

double amplitude2_at(double t, const std::function<double(double)>& mu, double epsilon, double phi0,
                     const std::vector<double>& jumps) {
  if (!(epsilon > 0.0)) throw ArgumentError("epsilon", epsilon, "above 0");
  // Beyond 20 relaxation times exp(-2 eps tau) is below 1e-17.
  constexpr double memory = 20.0;
  std::vector<double> edges; // of tau, in relaxation times 1/(2 eps)
  for (double edge = 0.0; edge <= memory; edge += 1.0)
    edges.push_back(2.0 * edge);
  for (const double jump : jumps) {
    const double tau = 2.0 * epsilon * (t - jump);
    if (tau > 0.0 && tau < 2.0 * memory) edges.push_back(tau);
  }
  std::sort(edges.begin(), edges.end());
  double sum = 0.0;
  for (std::size_t i = 1; i < edges.size(); ++i)
    sum += boost::math::quadrature::gauss_kronrod<double, 15>::integrate(
        [&](double x) { return std::exp(-x) * mu(t - x / (2.0 * epsilon)); }, edges[i - 1],
        edges[i], 8, 1e-13);
  return 4.0 * phi0 / pi * sum / (2.0 * epsilon);
}

double amplitude2_after_jump(double t, double mu0, double mu1, double epsilon, double phi0) {
  if (!(epsilon > 0.0)) throw ArgumentError("epsilon", epsilon, "above 0");
  const double mu = t < 0.0 ? mu0 : mu0 - (mu1 - mu0) * std::expm1(-2.0 * epsilon * t);
  return 2.0 * phi0 / (pi * epsilon) * mu;
}

} // namespace goingrate
