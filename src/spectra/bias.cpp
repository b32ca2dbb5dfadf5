#include "bias.hpp"

#include <array>
#include <cmath>

namespace goingrate {
namespace {

// SP 1065 section 5.2.11: 1 - a tau/T.
double total_bias(int alpha, double tau_over_run) {
  if (alpha == -1) return 1.0 - 0.481 * tau_over_run;
  if (alpha == -2) return 1.0 - 0.750 * tau_over_run;
  return 1.0;
}

// SP 1065 section 5.2.12, alpha from 2 down to -2.
double modified_total_bias(int alpha) {
  constexpr std::array ratio = {0.94, 0.83, 0.73, 0.70, 0.69};
  return alpha >= -2 && alpha <= 2 ? ratio[static_cast<std::size_t>(2 - alpha)] : 1.0;
}

// SP 1065 section 5.2.14: 1 + a, alpha from 0 down to -4.
double hadamard_total_bias(int alpha) {
  constexpr std::array a = {-0.005, -0.149, -0.229, -0.283, -0.321};
  return alpha >= -4 && alpha <= 0 ? 1.0 + a[static_cast<std::size_t>(-alpha)] : 1.0;
}

// SP 1065 section 5.2.15: AVAR over Theo1 is a + b/m^c, alpha from 2 down to -2.
double theo1_bias(int alpha, double m) {
  struct Fit {
    double a, b, c;
  };
  constexpr std::array<Fit, 5> fits = {{{0.09, 0.74, 0.40},
                                        {0.14, 0.82, 0.30},
                                        {1.00, 0.00, 0.00},
                                        {1.87, -1.05, 0.79},
                                        {2.70, -1.53, 0.85}}};
  if (alpha < -2 || alpha > 2) return 1.0;
  const Fit& fit = fits[static_cast<std::size_t>(2 - alpha)];
  return 1.0 / (fit.a + fit.b / std::pow(m, fit.c));
}

} // namespace

double variance_bias(DeviationKind kind, int alpha, std::size_t m, std::size_t points) {
  const double factor = static_cast<double>(m);
  switch (kind) {
  case DeviationKind::totdev:
    return total_bias(alpha, factor / static_cast<double>(points - 1));
  case DeviationKind::mtotdev:
  case DeviationKind::ttotdev:
    return modified_total_bias(alpha);
  case DeviationKind::htotdev: // at m = 1 it is the Hadamard variance itself
    return m == 1 ? 1.0 : hadamard_total_bias(alpha);
  case DeviationKind::theo1:
    return theo1_bias(alpha, factor);
  default:
    return 1.0;
  }
}

} // namespace goingrate
