// Notation, after Greenhall and Riley:
//   u       lag in samples (their t is u/m, so nothing here divides by m)
//   w(u)    generalised autocovariance of the time integral of phase noise with S_y ~ f^alpha, up
//           to a positive factor
//   s_x(u)  that of the phase averaged over one sampling interval (or over tau, if filtered):
//           2w(u) - w(u-1) - w(u+1), or with m for 1
//   s_z(u)  autocovariance of the second or third difference over m samples
//   M, J, S number of differences, number of lags summed, starts per tau
// References: C. A. Greenhall and W. J. Riley, "Uncertainty of stability variances based on finite
// differences", PTTI 2003; W. J. Riley, NIST SP 1065 (2008).
#include "spectra/degrees_of_freedom.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <boost/math/distributions/chi_squared.hpp>

#include "goingrate/base/errors.hpp"

namespace goingrate {
namespace {

// sum over k of 2 f^(2k)(u)/(2k)!, the second difference at spacing 1 of f = u^2 ln u.
double second_difference_u2_log(double u) {
  const double v = 1.0 / (u * u);
  return 2.0 * std::log(u) + 3.0 - v * (1.0 / 6.0 + v / 30.0);
}

// The same for f = u^4 ln u.
double second_difference_u4_log(double u) {
  const double l = std::log(u);
  const double v = 1.0 / (u * u);
  return u * u * (12.0 * l + 7.0) + 2.0 * l + 25.0 / 6.0 - v / 15.0;
}

// The same for f = u^6 ln u.
double second_difference_u6_log(double u) {
  const double l = std::log(u);
  const double square = u * u;
  return square * (square * (30.0 * l + 11.0) + 30.0 * l + 28.5) + 2.0 * l + 4.9 -
         1.0 / (28.0 * square);
}

double whole_power(double u, int power) { // std::pow takes five times as long
  double product = 1.0;
  for (; power > 0; --power)
    product *= u;
  return product;
}

double power_log(double u, int power) {
  u = std::abs(u);
  return u == 0.0 ? 0.0 : whole_power(u, power) * std::log(u);
}

// u^power ln u differenced directly at spacing 1.
double second_difference_power_log(double u, int power) {
  return power_log(u - 1, power) + power_log(u + 1, power) - 2.0 * power_log(u, power);
}

// s_x(u) for whole u. Polynomial cases are differenced by hand; in the logarithmic ones a direct
// difference loses about u^2 in relative accuracy, so from u = 32 the series takes over: there its
// first neglected term is below 1e-12 of the value, and so is the loss of the direct difference.
double averaged_phase_covariance(int alpha, double u) {
  u = std::abs(u);
  const bool series = u >= 32.0;
  switch (alpha) {
  case 2:
    return u == 0.0 ? 2.0 : 0.0;
  case 1:
    return series ? -second_difference_u2_log(u) : -second_difference_power_log(u, 2);
  case 0:
    return u == 0.0 ? -2.0 : -6.0 * u;
  case -1:
    return series ? second_difference_u4_log(u) : second_difference_power_log(u, 4);
  case -2:
    return u == 0.0 ? 2.0 : (20.0 * u * u + 10.0) * u;
  case -3:
    return series ? -second_difference_u6_log(u) : -second_difference_power_log(u, 6);
  default: // -4
    return u == 0.0 ? -2.0 : -((42.0 * u * u + 70.0) * u * u + 14.0) * u;
  }
}

// w at the lag t, in units of tau.
double power_law_covariance(int alpha, double t) {
  const double a = std::abs(t);
  const double sign = alpha == 2 || alpha == -1 || alpha == -2 ? -1.0 : 1.0;
  return sign * (alpha % 2 == 0 ? whole_power(a, 3 - alpha) : power_log(a, 3 - alpha));
}

// s_x of phases averaged over tau. Lags reach 4 tau, so the direct difference costs few digits.
double mean_phase_covariance(int alpha, double t) {
  return 2.0 * power_law_covariance(alpha, t) - power_law_covariance(alpha, t - 1.0) -
         power_law_covariance(alpha, t + 1.0);
}

// s_z(u) from s_x: the 2d-th difference, signs alternating, over steps of tau.
template <class Covariance>
double difference_covariance(std::size_t order, double u, double tau, const Covariance& s_x) {
  constexpr std::array<std::array<double, 4>, 2> binomials = {
      {{6.0, -4.0, 1.0, 0.0}, {20.0, -15.0, 6.0, -1.0}}};
  const auto& coefficient = binomials[order - 2];
  double sum = coefficient[0] * s_x(u);
  for (std::size_t k = 1; k <= order; ++k) {
    const double lag = static_cast<double>(k) * tau;
    sum += coefficient[k] * (s_x(u - lag) + s_x(u + lag));
  }
  return sum;
}

// sum of term(j) over 1 <= j < end. Terms vary quickly only near multiples of `period`; farther off
// a block of a 64th of the distance is as good as its middle.
template <class Term> double blocked_sum(std::size_t end, std::size_t period, const Term& term) {
  constexpr std::size_t single_terms = 512;
  double sum = 0.0;
  for (std::size_t j = 1; j < end;) {
    const std::size_t past = j % period;
    const std::size_t distance = std::min(past, period - past);
    std::size_t length = distance > single_terms ? distance / 64 | 1 : 1;
    if (past >= period / 2 && length > 1) // nearing: the far end of the block must be as good
      length = (period - past) / 65 | 1;
    if (length == 1 || j + length > end) length = 1;
    sum += static_cast<double>(length) * term(j + length / 2);
    j += length;
  }
  return sum;
}

void check_alpha(int alpha, int lowest) {
  if (alpha < lowest || alpha > 2)
    throw ArgumentError("alpha", alpha, lowest == -4 ? "from -4 to 2" : "from -2 to 2");
}

void check_factor(std::size_t m, std::size_t points) {
  if (m == 0 || m >= points)
    throw ArgumentError("m", static_cast<double>(m), "1 or more, below the number of phases");
}

} // namespace

double difference_degrees_of_freedom(int alpha, std::size_t m, std::size_t n,
                                     const DifferenceVariance& variance) {
  if (variance.order != 2 && variance.order != 3)
    throw ArgumentError("order", static_cast<double>(variance.order), "2 or 3");
  check_alpha(alpha, variance.order == 2 ? -2 : -4);
  if (m == 0) throw ArgumentError("m", 0.0, "1 or more");
  if (n == 0) throw ArgumentError("n", 0.0, "1 or more");
  const bool overlapped = variance.stride == DifferenceStride::one_sample;
  const std::size_t starts_per_tau = overlapped ? m : 1;
  const double step = overlapped ? 1.0 : static_cast<double>(m);
  const double tau = static_cast<double>(m);
  const double count = static_cast<double>(n);
  // Beyond (d + 1) tau two differences share no sample and their correlation dies away.
  const std::size_t lags = std::min(n, (variance.order + 1) * starts_per_tau);

  const auto squared = [&](std::size_t j) {
    const double u = static_cast<double>(j) * step;
    const double s =
        variance.filter == PhaseFilter::none
            ? difference_covariance(variance.order, u, tau,
                                    [&](double v) { return averaged_phase_covariance(alpha, v); })
            : difference_covariance(variance.order, u / tau, 1.0,
                                    [&](double t) { return mean_phase_covariance(alpha, t); });
    return s * s;
  };
  const auto term = [&](std::size_t j) {
    return (1.0 - static_cast<double>(j) / count) * squared(j);
  };
  const double sum = term(lags) + 2.0 * blocked_sum(lags, starts_per_tau, term);
  const double at_zero = squared(0);
  return count * at_zero / (at_zero + sum);
}

double allan_degrees_of_freedom(int alpha, std::size_t m, std::size_t n, DifferenceStride stride) {
  return difference_degrees_of_freedom(alpha, m, n, {stride, 2, PhaseFilter::none});
}

double total_degrees_of_freedom(int alpha, std::size_t m, std::size_t points) {
  check_alpha(alpha, -2);
  check_factor(m, points);
  const double n = static_cast<double>(points), tau = static_cast<double>(m);
  const double spans = (n - 1.0) / tau; // T/tau
  double edf = 1.0;
  if (alpha == 2) edf = (n + 1.0) * (n - 2.0 * tau) / (2.0 * (n - tau));
  if (alpha == 1 && spans > 2.0)
    edf =
        std::exp(std::sqrt(std::log(0.5 * spans) * std::log((2.0 * tau + 1.0) * (n - 1.0) / 4.0)));
  if (alpha == 0) edf = 1.50 * spans;
  if (alpha == -1) edf = 1.17 * spans - 0.22;
  if (alpha == -2) edf = 0.93 * spans - 0.36;
  return std::max(edf, 1.0);
}

double modified_total_degrees_of_freedom(int alpha, std::size_t m, std::size_t points) {
  check_alpha(alpha, -2);
  check_factor(m, points);
  struct Fit {
    double b, c;
  };
  constexpr std::array<Fit, 5> fits = {
      {{1.90, 2.10}, {1.20, 1.40}, {1.10, 1.20}, {0.85, 0.50}, {0.75, 0.31}}};
  const Fit& fit = fits[static_cast<std::size_t>(2 - alpha)];
  const double spans = static_cast<double>(points) / static_cast<double>(m);
  return std::max(fit.b * spans - fit.c, 1.0);
}

double hadamard_total_degrees_of_freedom(int alpha, std::size_t m, std::size_t points) {
  if (alpha < -4 || alpha > 0) throw ArgumentError("alpha", alpha, "from -4 to 0");
  check_factor(m, points);
  struct Fit {
    double b0, b1;
  };
  constexpr std::array<Fit, 5> fits = {
      {{0.559, 1.004}, {0.868, 1.140}, {0.938, 1.696}, {0.974, 2.554}, {1.276, 3.149}}};
  const Fit& fit = fits[static_cast<std::size_t>(-alpha)];
  const double spans = static_cast<double>(points - 1) / static_cast<double>(m);
  return std::max(spans / (fit.b0 + fit.b1 / spans), 1.0);
}

double theo1_degrees_of_freedom(int alpha, std::size_t m, std::size_t points) {
  check_alpha(alpha, -2);
  check_factor(m, points);
  const double n = static_cast<double>(points), r = 0.75 * static_cast<double>(m);
  double edf = 1.0;
  if (alpha == 2) edf = 0.86 * (n + 1.0) * (n - 4.0 / 3.0 * r) / (n - r) * (r / (r + 1.14));
  if (alpha == 1)
    edf = (4.798 * n * n - 6.374 * n * r + 12.387 * r) / (std::sqrt(r + 36.6) * (n - r)) *
          (r / (r + 0.3));
  const double power = std::pow(r, 1.5);
  if (alpha == 0) edf = ((4.1 * n + 0.8) / r - (3.1 * n + 6.5) / n) * (power / (power + 5.2));
  if (alpha == -1)
    edf = (2.0 * n * n - 1.3 * n * r - 3.5 * r) / (n * r) * (r * r * r / (r * r * r + 2.3));
  const double q = 4.4 * n - 1.0;
  if (alpha == -2)
    edf = (4.4 * n - 2.0) / (2.9 * r) * (q * q - 8.6 * r * q + 11.4 * r * r) /
          ((q - 2.0) * (q - 2.0));
  return std::max(edf, 1.0);
}

DeviationInterval chi_squared_interval(double deviation, double degrees_of_freedom,
                                       double probability) {
  if (!(deviation >= 0.0) || !std::isfinite(deviation))
    throw ArgumentError("deviation", deviation, "finite and not negative");
  if (!(degrees_of_freedom > 0.0) || !std::isfinite(degrees_of_freedom))
    throw ArgumentError("degrees_of_freedom", degrees_of_freedom, "finite and above 0");
  if (!(probability > 0.0 && probability < 1.0))
    throw ArgumentError("probability", probability, "between 0 and 1, ends excluded");
  const boost::math::chi_squared distribution(degrees_of_freedom);
  const double tail = 0.5 * (1.0 - probability);
  const double upper = boost::math::quantile(boost::math::complement(distribution, tail));
  const double lower = boost::math::quantile(distribution, tail);
  return {deviation * std::sqrt(degrees_of_freedom / upper),
          deviation * std::sqrt(degrees_of_freedom / lower)};
}

} // namespace goingrate
