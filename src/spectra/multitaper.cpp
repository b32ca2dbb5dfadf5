#include "goingrate/spectra/multitaper.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <limits>
#include <numbers>

namespace goingrate {

namespace {

using Complex = std::complex<double>;

std::vector<double> detrended(std::span<const double> series, bool linear) {
  const auto n = static_cast<double>(series.size());
  const double middle = 0.5 * (n - 1.0);
  double level = 0.0, tilt = 0.0, spread = 0.0;
  for (std::size_t i = 0; i < series.size(); ++i) {
    const double t = static_cast<double>(i) - middle;
    level += series[i] - series.front();
    tilt += t * (series[i] - series.front());
    spread += t * t;
  }
  std::vector<double> x;
  x.reserve(series.size());
  const double slope = linear ? tilt / spread : 0.0;
  for (std::size_t i = 0; i < series.size(); ++i)
    x.push_back(series[i] - series.front() - level / n - slope * (static_cast<double>(i) - middle));
  return x;
}

void check(std::span<const double> series, double interval_s, std::size_t tapers) {
  if (series.size() < 8)
    throw ArgumentError("series.size()", static_cast<double>(series.size()), "8 or more");
  if (!(interval_s > 0.0) || !std::isfinite(interval_s))
    throw ArgumentError("interval_s", interval_s, "finite and above 0");
  if (tapers < 1 || tapers > series.size() / 4)
    throw ArgumentError("tapers", static_cast<double>(tapers), "from 1 to a quarter of the values");
  for (const double v : series)
    if (!std::isfinite(v)) throw ArgumentError("series", v, "finite");
}

std::vector<Complex> tapered_transform(const std::vector<double>& x, std::size_t k) {
  const auto n = static_cast<double>(x.size());
  const double turn = std::numbers::pi * static_cast<double>(k) / (n + 1.0);
  std::vector<double> tapered(x.size());
  for (std::size_t i = 0; i < x.size(); ++i)
    tapered[i] = x[i] * std::sqrt(2.0 / (n + 1.0)) * std::sin(turn * static_cast<double>(i + 1));
  return real_transform(tapered);
}

} // namespace

Spectrum multitaper_spectrum(std::span<const double> series, double interval_s, std::size_t tapers,
                             bool detrend_linear) {
  check(series, interval_s, tapers);
  const auto x = detrended(series, detrend_linear);
  const std::size_t n = x.size();
  Spectrum spectrum{};
  spectrum.resolution_hz = 1.0 / (static_cast<double>(n) * interval_s);
  spectrum.degrees_of_freedom = 2.0 * static_cast<double>(tapers);
  spectrum.segments = 1;
  spectrum.segment_length = n;
  spectrum.density.assign(n / 2 + 1, 0.0);
  for (std::size_t k = 1; k <= tapers; ++k) {
    const auto transform = tapered_transform(x, k);
    for (std::size_t i = 0; i < transform.size(); ++i)
      spectrum.density[i] += std::norm(transform[i]) / static_cast<double>(tapers);
  }
  for (std::size_t i = 0; i < spectrum.density.size(); ++i) {
    const bool alone = i == 0 || 2 * i == n; // has no mirror image at negative frequency
    spectrum.density[i] *= (alone ? 1.0 : 2.0) * interval_s;
    spectrum.frequency_hz.push_back(static_cast<double>(i) * spectrum.resolution_hz);
  }
  return spectrum;
}

DensityInterval density_interval(double degrees_of_freedom, double probability) {
  if (!(degrees_of_freedom > 0.0) || !std::isfinite(degrees_of_freedom))
    throw ArgumentError("degrees_of_freedom", degrees_of_freedom, "finite and above 0");
  if (!(probability > 0.0 && probability < 1.0))
    throw ArgumentError("probability", probability, "between 0 and 1");
  const boost::math::chi_squared chi(degrees_of_freedom);
  const double tail = 0.5 * (1.0 - probability);
  return {degrees_of_freedom / quantile(complement(chi, tail)),
          degrees_of_freedom / quantile(chi, tail)};
}

CrossSpectrum cross_spectrum(std::span<const double> cause, std::span<const double> answer,
                             double interval_s, std::size_t tapers) {
  check(cause, interval_s, tapers);
  check(answer, interval_s, tapers);
  if (cause.size() != answer.size())
    throw ArgumentError("answer.size()", static_cast<double>(answer.size()), "that of the cause");
  if (tapers < 2) throw ArgumentError("tapers", 1.0, "2 or more: one is always coherent");
  const auto x = detrended(cause, true), y = detrended(answer, true);
  const std::size_t bins = x.size() / 2 + 1;
  std::vector<double> xx(bins, 0.0), yy(bins, 0.0);
  std::vector<Complex> xy(bins);
  for (std::size_t k = 1; k <= tapers; ++k) {
    const auto a = tapered_transform(x, k), b = tapered_transform(y, k);
    for (std::size_t i = 0; i < bins; ++i) {
      xx[i] += std::norm(a[i]);
      yy[i] += std::norm(b[i]);
      xy[i] += std::conj(a[i]) * b[i];
    }
  }
  CrossSpectrum cross;
  cross.significant = 1.0 - std::pow(0.01, 1.0 / (static_cast<double>(tapers) - 1.0));
  for (std::size_t i = 0; i < bins; ++i) {
    const double both = xx[i] * yy[i];
    cross.frequency_hz.push_back(static_cast<double>(i) /
                                 (static_cast<double>(x.size()) * interval_s));
    cross.coherence.push_back(both > 0.0 ? std::norm(xy[i]) / both : 0.0);
    cross.gain.push_back(xx[i] > 0.0 ? std::abs(xy[i]) / xx[i] : 0.0);
    cross.phase_rad.push_back(std::arg(xy[i]));
  }
  return cross;
}

GappedPeriodogram lomb_scargle(std::span<const double> series, double interval_s) {
  if (!(interval_s > 0.0) || !std::isfinite(interval_s))
    throw ArgumentError("interval_s", interval_s, "finite and above 0");
  const std::size_t n = series.size();
  double known = 0.0, mean = 0.0;
  for (const double v : series) {
    if (std::isinf(v)) throw ArgumentError("series", v, "finite, or NaN for a gap");
    if (!std::isnan(v)) mean += v, ++known;
  }
  if (known < 8.0) throw ArgumentError("series", known, "8 known values or more");
  mean /= known;
  // Twice the length makes the frequencies half a resolution apart; four times holds those at 2 f.
  std::vector<double> values(2 * n, 0.0), mask(4 * n, 0.0);
  double variance = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    if (std::isnan(series[i])) continue;
    values[i] = (series[i] - mean) / known;
    mask[i] = 1.0 / known;
    variance += values[i] * (series[i] - mean);
  }
  const auto moments = real_transform(values), known_at = real_transform(mask);
  GappedPeriodogram result;
  for (std::size_t k = 1; k + 1 <= n - 1; ++k) {
    const Complex window = known_at[2 * k]; // at f
    // At 2 f = 4 k of the fine grid, mirrored beyond its end.
    const std::size_t twice = 4 * k;
    const Complex second = twice <= 2 * n ? known_at[twice] : std::conj(known_at[4 * n - twice]);
    const double c = window.real(), s = -window.imag();
    const double yc = moments[k].real(), ys = -moments[k].imag();
    const double cc = 0.5 * (1.0 + second.real()) - c * c;
    const double ss = 0.5 * (1.0 - second.real()) - s * s;
    const double cs = -0.5 * second.imag() - c * s;
    const double determinant = cc * ss - cs * cs;
    const double taken = ss * yc * yc + cc * ys * ys - 2.0 * cs * yc * ys;
    result.frequency_hz.push_back(static_cast<double>(k) /
                                  (2.0 * static_cast<double>(n) * interval_s));
    result.power.push_back(determinant > 0.0 && variance > 0.0 ? taken / (determinant * variance)
                                                               : 0.0);
    result.window.push_back(std::norm(window));
  }
  return result;
}

} // namespace goingrate
