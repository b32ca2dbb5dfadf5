// Notation, after Greenhall and Riley:
//   u       lag in samples (their t is u/m, so nothing here divides by m)
//   w(u)    generalised autocovariance of the time integral of phase noise with S_y ~ f^alpha, up
//           to a positive factor
//   s_x(u)  that of the phase averaged over one sampling interval, 2w(u) - w(u-1) - w(u+1)
//   s_z(u)  autocovariance of the second difference over m samples
//   M, J, S number of differences, number of lags summed, starts per tau
// References: C. A. Greenhall and W. J. Riley, "Uncertainty of stability variances based on finite
// differences", PTTI 2003; W. J. Riley and C. A. Greenhall, "Power law noise identification using
// the lag 1 autocorrelation", EFTF 2004; W. J. Riley, NIST SP 1065 (2008).
#include "goingrate/spectra/noise_type.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <boost/math/distributions/chi_squared.hpp>

#include "goingrate/base/errors.hpp"

namespace goingrate {
namespace {

std::vector<double> every_mth(std::span<const double> phase, std::size_t m) {
  std::vector<double> taken;
  taken.reserve(phase.size() / m + 1);
  for (std::size_t i = 0; i < phase.size(); i += m)
    taken.push_back(phase[i]);
  return taken;
}

std::size_t count_finite(std::span<const double> z) {
  return static_cast<std::size_t>(
      std::count_if(z.begin(), z.end(), [](double v) { return std::isfinite(v); }));
}

// <a, b> over the places where z is known.
double inner(std::span<const double> z, std::span<const double> a, std::span<const double> b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < z.size(); ++i)
    if (std::isfinite(z[i])) sum += a[i] * b[i];
  return sum;
}

void take_out(std::span<const double> z, std::span<const double> basis, std::span<double> v) {
  const double norm = inner(z, basis, basis);
  if (norm == 0.0) return; // fewer known points than coefficients: that power is already fitted
  const double share = inner(z, basis, v) / norm;
  for (std::size_t i = 0; i < v.size(); ++i)
    v[i] -= share * basis[i];
}

// Least-squares removal of 1, t, t^2, made orthogonal on the known points so that gaps do no harm.
void remove_parabola(std::vector<double>& z) {
  const std::size_t n = z.size();
  std::array<std::vector<double>, 3> basis;
  for (std::size_t k = 0; k < basis.size(); ++k) {
    basis[k].resize(n);
    for (std::size_t i = 0; i < n; ++i) { // t in [-1, 1] keeps the powers of similar size
      const double t =
          n > 1 ? 2.0 * static_cast<double>(i) / static_cast<double>(n - 1) - 1.0 : 0.0;
      basis[k][i] = std::pow(t, static_cast<double>(k));
    }
    for (std::size_t earlier = 0; earlier < k; ++earlier)
      take_out(z, basis[earlier], basis[k]);
    take_out(z, basis[k], z);
  }
}

struct Lag1 {
  double r1;
  std::size_t pairs;
};

// Autocorrelation at lag 1 about the mean. Without gaps n/(pairs + 1) is 1 and this is the textbook
// estimate; with gaps it scales the sum of products to the pairs that exist.
Lag1 lag1_autocorrelation(std::span<const double> z) {
  double sum = 0.0;
  std::size_t n = 0;
  for (double v : z)
    if (std::isfinite(v)) sum += v, ++n;
  const double mean = n > 0 ? sum / static_cast<double>(n) : 0.0;
  double squares = 0.0;
  double products = 0.0;
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < z.size(); ++i) {
    if (!std::isfinite(z[i])) continue;
    squares += (z[i] - mean) * (z[i] - mean);
    if (i + 1 < z.size() && std::isfinite(z[i + 1])) {
      products += (z[i] - mean) * (z[i + 1] - mean);
      ++pairs;
    }
  }
  const double scale = static_cast<double>(n) / static_cast<double>(pairs + 1);
  return {squares > 0.0 ? scale * products / squares : std::numeric_limits<double>::quiet_NaN(),
          pairs};
}

void difference(std::vector<double>& z) {
  for (std::size_t i = 0; i + 1 < z.size(); ++i)
    z[i] = z[i + 1] - z[i]; // NaN stays NaN
  z.pop_back();
}

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

double power_log(double u, int power) {
  u = std::abs(u);
  return u == 0.0 ? 0.0 : std::pow(u, power) * std::log(u);
}

// s_x(u) for whole u. Polynomial cases are differenced by hand; in the logarithmic ones a direct
// difference loses about u^2 in relative accuracy, so from u = 32 the series takes over: there its
// first neglected term is below 1e-12 of the value, and so is the loss of the direct difference.
double averaged_phase_covariance(int alpha, double u) {
  u = std::abs(u);
  constexpr double series_from = 32.0;
  switch (alpha) {
  case 2:
    return u == 0.0 ? 2.0 : 0.0;
  case 1:
    if (u >= series_from) return -second_difference_u2_log(u);
    return 2.0 * power_log(u, 2) - power_log(u - 1, 2) - power_log(u + 1, 2);
  case 0:
    return u == 0.0 ? -2.0 : -6.0 * u;
  case -1:
    if (u >= series_from) return second_difference_u4_log(u);
    return power_log(u - 1, 4) + power_log(u + 1, 4) - 2.0 * power_log(u, 4);
  default: // -2
    return u == 0.0 ? 2.0 : (20.0 * u * u + 10.0) * u;
  }
}

double second_difference_covariance(int alpha, double u, double m) {
  return 6.0 * averaged_phase_covariance(alpha, u) - 4.0 * averaged_phase_covariance(alpha, u - m) -
         4.0 * averaged_phase_covariance(alpha, u + m) +
         averaged_phase_covariance(alpha, u - 2.0 * m) +
         averaged_phase_covariance(alpha, u + 2.0 * m);
}

} // namespace

NoiseType identify_noise(std::span<const double> phase, std::size_t m) {
  if (m == 0) throw ArgumentError("m", 0.0, "1 or more");
  std::vector<double> z = every_mth(phase, m);
  NoiseType noise;
  noise.points = count_finite(z);
  if (noise.points < least_points_for_noise_type) return noise;
  remove_parabola(z);
  constexpr std::size_t most_differences = 2; // what the second difference of an Allan variance has
  for (std::size_t d = 0;; ++d) {
    const Lag1 lag1 = lag1_autocorrelation(z);
    const bool enough = lag1.pairs + d + 1 >= least_points_for_noise_type;
    if (!enough || std::isnan(lag1.r1)) return noise;
    // r1 near -1 (alternating phase) would send rho to minus infinity; -0.9 is already far past
    // white phase noise, whose alpha of 2 is the limit below.
    const double r1 = std::max(lag1.r1, -0.9);
    const double rho = r1 / (1.0 + r1);
    if (rho < 0.25 || d == most_differences) {
      noise.exponent = 2.0 - 2.0 * (rho + static_cast<double>(d));
      noise.alpha = std::min(2, static_cast<int>(std::lround(noise.exponent)));
      noise.identified = true;
      return noise;
    }
    difference(z);
  }
}

double allan_degrees_of_freedom(int alpha, std::size_t m, std::size_t n, DifferenceStride stride) {
  if (alpha < -2 || alpha > 2) throw ArgumentError("alpha", alpha, "from -2 to 2");
  if (m == 0) throw ArgumentError("m", 0.0, "1 or more");
  if (n == 0) throw ArgumentError("n", 0.0, "1 or more");
  const bool overlapped = stride == DifferenceStride::one_sample;
  const std::size_t starts_per_tau = overlapped ? m : 1;
  const double step = overlapped ? 1.0 : static_cast<double>(m);
  const double tau = static_cast<double>(m);
  const double count = static_cast<double>(n);
  // Beyond 3 tau two second differences share no sample and their correlation dies away.
  const std::size_t lags = std::min(n, 3 * starts_per_tau);

  const auto squared = [&](std::size_t j) {
    const double s = second_difference_covariance(alpha, static_cast<double>(j) * step, tau);
    return s * s;
  };
  double sum = (1.0 - static_cast<double>(lags) / count) * squared(lags);
  for (std::size_t j = 1; j < lags; ++j)
    sum += 2.0 * (1.0 - static_cast<double>(j) / count) * squared(j);
  const double variance = squared(0);
  return count * variance / (variance + sum);
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
