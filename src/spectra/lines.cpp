#include "goingrate/spectra/lines.hpp"

#include "base/scaled_time.hpp"
#include "goingrate/base/errors.hpp"
#include "goingrate/spectra/spectrum.hpp"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>

namespace goingrate {

namespace {

// The least-squares sinusoid of one frequency: c cos + s sin, and how much of the sum of squares it
// takes.
struct Sinusoid {
  double cosine = 0.0, sine = 0.0, taken = 0.0;
};

// w in radians a value. The rotation is renewed every 1024 values, so that it loses no digits.
Sinusoid fit_sinusoid(std::span<const double> x, double w) {
  double cc = 0.0, cs = 0.0, ss = 0.0, xc = 0.0, xs = 0.0;
  constexpr std::size_t renewal = 1024;
  const double step_c = std::cos(w), step_s = std::sin(w);
  double c = 1.0, s = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (i % renewal == 0) {
      c = std::cos(w * static_cast<double>(i));
      s = std::sin(w * static_cast<double>(i));
    }
    cc += c * c;
    cs += c * s;
    ss += s * s;
    xc += x[i] * c;
    xs += x[i] * s;
    const double turned = c * step_c - s * step_s;
    s = c * step_s + s * step_c;
    c = turned;
  }
  const double determinant = cc * ss - cs * cs;
  if (!(determinant > 0.0)) return {};
  Sinusoid fit{(xc * ss - xs * cs) / determinant, (xs * cc - xc * cs) / determinant, 0.0};
  fit.taken = fit.cosine * xc + fit.sine * xs;
  return fit;
}

std::vector<double> centred(std::span<const double> series) {
  std::vector<double> x(series.begin(), series.end());
  const double mean = std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
  for (double& v : x)
    v -= mean;
  return x;
}

// A Tukey window: flat over the middle half of the series, with a quarter of a Hann window at each
// end; the sum over its squares is N.
std::vector<double> window(std::size_t size) {
  constexpr double tapered = 0.25; // of the series, at each end
  const auto n = static_cast<double>(size);
  const double scale = 1.0 / std::sqrt(1.0 - 1.25 * tapered);
  std::vector<double> weight(size, scale);
  for (std::size_t i = 0; i < size; ++i) {
    const double from_end = (static_cast<double>(std::min(i, size - 1 - i)) + 0.5) / n;
    if (from_end < tapered)
      weight[i] *= std::pow(std::sin(0.5 * std::numbers::pi * from_end / tapered), 2);
  }
  return weight;
}

// |X|^2 / N at frequencies k / (2 N), k = 0 .. N, through the window: for white noise its mean is
// the variance. Without a window a series whose ends differ leaks into every other one of these
// frequencies, so that a median over them is not the density.
std::vector<double> fine_periodogram(const std::vector<double>& x,
                                     const std::vector<double>& window) {
  std::vector<double> seen(x.size());
  std::transform(x.begin(), x.end(), window.begin(), seen.begin(), std::multiplies<>());
  std::vector<double> power = squared_transform(seen, 2 * seen.size());
  for (double& value : power)
    value /= static_cast<double>(x.size());
  return power;
}

// The density without the lines, as a function of frequency: medians of neighbouring ordinates,
// which a line does not raise, joined by straight lines in logarithms.
class Continuum {
public:
  Continuum(const std::vector<double>& power, std::size_t first, std::size_t around) {
    for (std::size_t from = first; from < power.size();) {
      const std::size_t most = 2 * around, least = 8;
      std::size_t to = from + std::clamp(from / 2, least, std::max(most, least));
      if (to + least > power.size()) to = power.size();
      std::vector<double> near(power.begin() + static_cast<std::ptrdiff_t>(from),
                               power.begin() + static_cast<std::ptrdiff_t>(to));
      const auto middle = near.begin() + static_cast<std::ptrdiff_t>(near.size() / 2);
      std::nth_element(near.begin(), middle, near.end());
      knots_.push_back({std::log(0.5 * static_cast<double>(from + to)),
                        std::log(*middle / std::numbers::ln2), static_cast<double>(to - from)});
      from = to;
    }
  }

  struct Level {
    double level;
    double freedom; // nu: a ratio R has the chance (1 + R/nu)^-nu
  };

  [[nodiscard]] Level at(std::size_t k) const {
    const double place = std::log(static_cast<double>(k));
    const auto after =
        std::upper_bound(knots_.begin(), knots_.end(), place,
                         [](double at, const Knot& knot) { return at < knot.place; });
    const Knot& right = after == knots_.end() ? knots_.back() : *after;
    const Knot& left = after == knots_.begin() ? right : *(after - 1);
    const double share = &left == &right || after == knots_.end()
                             ? 1.0
                             : (place - left.place) / (right.place - left.place);
    // A median of n exponential values is known to 1/(ln 2 sqrt n); of the ordinates of the fine
    // grid, seen through the window, 9/22 are independent.
    constexpr double per_ordinate = 9.0 / 22.0 * std::numbers::ln2 * std::numbers::ln2;
    return {std::exp(left.level + share * (right.level - left.level)),
            per_ordinate * std::min(left.count, right.count)};
  }

private:
  struct Knot {
    double place, level, count;
  };
  std::vector<Knot> knots_;
};

struct Peak {
  std::size_t k = 0;
  double level = 0.0, log_chance = 0.0; // of this frequency alone
};

// The frequency that stands out most.
Peak highest_peak(const std::vector<double>& power, std::size_t first, std::size_t around) {
  Peak best;
  const Continuum continuum(power, first, around);
  for (std::size_t k = first; k + 1 < power.size(); ++k) {
    if (power[k] < power[k - 1] || power[k] < power[k + 1]) continue;
    const auto [level, freedom] = continuum.at(k);
    if (!(level > 0.0)) continue;
    const double ratio = power[k] / level;
    const double log_chance = -freedom * std::log1p(ratio / freedom);
    if (log_chance < best.log_chance) best = {k, level, log_chance};
  }
  return best;
}

SpectralLine refined(std::span<const double> x, double interval_s, const Peak& peak,
                     double false_alarm) {
  const auto n = static_cast<double>(x.size());
  const double bin = std::numbers::pi / n; // of the fine grid, in radians a value
  const double middle = static_cast<double>(peak.k) * bin;
  constexpr int bits = 26; // of the frequency: beyond, the sum of squares is flat
  const auto best = boost::math::tools::brent_find_minima(
      [&](double w) { return -fit_sinusoid(x, w).taken; }, middle - bin, middle + bin, bits);
  const Sinusoid fit = fit_sinusoid(x, best.first);
  SpectralLine line{};
  line.frequency_hz = best.first / (two_pi * interval_s);
  line.amplitude = std::hypot(fit.cosine, fit.sine);
  line.amplitude_sigma = std::sqrt(2.0 * peak.level / n);
  line.phase_rad = std::atan2(fit.cosine, fit.sine);
  line.ratio = 0.5 * fit.taken / peak.level; // as without a window
  line.false_alarm = false_alarm;
  return line;
}

// Chance that any of N values shows it: 1 - (1 - p)^N, without losing digits where it is small.
double chance_anywhere(double log_chance, std::size_t values) {
  return -std::expm1(static_cast<double>(values) * std::log1p(-std::exp(log_chance)));
}

void take_out(std::vector<double>& x, double interval_s, const SpectralLine& line) {
  const double w = two_pi * line.frequency_hz * interval_s;
  for (std::size_t i = 0; i < x.size(); ++i)
    x[i] -= line.amplitude * std::sin(w * static_cast<double>(i) + line.phase_rad);
}

void check(std::span<const double> series, double interval_s) {
  constexpr std::size_t fewest_values = 64;
  if (series.size() < fewest_values)
    throw ArgumentError("series.size()", static_cast<double>(series.size()), "64 or more");
  if (!(interval_s > 0.0) || !std::isfinite(interval_s))
    throw ArgumentError("interval_s", interval_s, "finite and above 0");
  for (const double v : series)
    if (!std::isfinite(v)) throw ArgumentError("series", v, "finite");
}

// The strongest line close to `line`, of which it may be a sideband made by a slow variation.
std::optional<std::size_t> main_line_of(const SpectralLine& line,
                                        const std::vector<SpectralLine>& stronger,
                                        double resolution_hz) {
  // A sideband closer than this belongs to a modulation of at most four cycles in the series.
  constexpr double sideband_resolutions = 4.0;
  constexpr double largest_sideband_share =
      0.667; // a sideband has at most half, in noise a little more
  for (std::size_t i = 0; i < stronger.size(); ++i)
    if (!stronger[i].sideband_of &&
        line.amplitude < largest_sideband_share * stronger[i].amplitude &&
        std::abs(line.frequency_hz - stronger[i].frequency_hz) <
            sideband_resolutions * resolution_hz)
      return i;
  return {};
}

} // namespace

std::vector<SpectralLine> find_lines(std::span<const double> series, double interval_s,
                                     const LineSearch& search) {
  check(series, interval_s);
  std::vector<double> x = centred(series);
  const double fine_hz = 0.5 / (static_cast<double>(x.size()) * interval_s);
  constexpr std::size_t three_turns = 6; // of the fine grid
  const auto wanted = static_cast<std::size_t>(std::ceil(search.from_hz / fine_hz));
  const std::size_t first = std::max(three_turns, wanted);
  const std::vector<double> taper = window(x.size());
  std::vector<SpectralLine> lines;
  while (lines.size() < search.most) {
    const Peak peak = highest_peak(fine_periodogram(x, taper), first, search.around);
    const double chance = chance_anywhere(peak.log_chance, x.size());
    if (peak.k == 0 || !(chance < search.false_alarm)) break;
    SpectralLine line = refined(x, interval_s, peak, chance);
    line.sideband_of = main_line_of(line, lines, 2.0 * fine_hz);
    lines.push_back(line);
    take_out(x, interval_s, lines.back());
  }
  return lines;
}

std::vector<double> without_lines(std::span<const double> series, double interval_s,
                                  std::span<const SpectralLine> lines) {
  std::vector<double> x(series.begin(), series.end());
  for (const SpectralLine& line : lines)
    take_out(x, interval_s, line);
  return x;
}

FoldedProfile folded(std::span<const double> series, double interval_s, double period_s,
                     std::size_t bins) {
  if (!(period_s > 2.0 * interval_s) || !std::isfinite(period_s))
    throw ArgumentError("period_s", period_s, "above two intervals");
  const double in_a_turn = period_s / interval_s;
  if (bins < 2 || static_cast<double>(bins) > std::ceil(in_a_turn))
    throw ArgumentError("bins", static_cast<double>(bins), "from 2 to the values in a turn");
  std::vector<double> sum(bins, 0.0), sum2(bins, 0.0), count(bins, 0.0);
  double all = 0.0, known = 0.0;
  // Taking off a value of the series keeps its digits where it stands far from 0.
  const auto first = std::ranges::find_if(series, [](double x) { return !std::isnan(x); });
  for (std::size_t i = 0; i < series.size(); ++i) {
    if (std::isnan(series[i])) continue;
    const double turns = static_cast<double>(i) / in_a_turn;
    const auto bin = std::min(bins - 1, static_cast<std::size_t>((turns - std::floor(turns)) *
                                                                 static_cast<double>(bins)));
    const double v = series[i] - *first;
    sum[bin] += v;
    sum2[bin] += v * v;
    ++count[bin];
    all += v;
    ++known;
  }
  FoldedProfile profile;
  for (std::size_t b = 0; b < bins; ++b) {
    const double mean = sum[b] / count[b];
    const double variance = (sum2[b] / count[b] - mean * mean) / (count[b] - 1.0);
    profile.phase.push_back((static_cast<double>(b) + 0.5) / static_cast<double>(bins));
    profile.mean.push_back(mean - all / known);
    profile.sigma.push_back(count[b] < 2.0 ? std::numeric_limits<double>::quiet_NaN()
                                           : std::sqrt(std::max(0.0, variance)));
  }
  return profile;
}

std::vector<ExpectedPeriod> train_periods(std::span<const int> train, double period_s) {
  if (train.empty() || train.size() % 2 == 0)
    throw ArgumentError("train", static_cast<double>(train.size()),
                        "an odd count of numbers: wheel, pinion, wheel, ..., escape wheel");
  for (const int teeth : train)
    if (teeth < 2) throw ArgumentError("train", static_cast<double>(teeth), "2 teeth or more each");
  std::vector<ExpectedPeriod> periods;
  double turn = train.back() * period_s;
  std::size_t arbor = train.size() / 2 + 1;
  periods.push_back({turn, "arbor", arbor});
  for (std::size_t i = train.size() - 1; i >= 2; i -= 2) {
    const int pinion = train[i - 1], wheel = train[i - 2];
    --arbor;
    periods.push_back({turn / pinion, "mesh", arbor}); // the tooth of the pinion it drives
    turn *= static_cast<double>(wheel) / pinion;
    periods.push_back({turn, "arbor", arbor});
  }
  std::stable_sort(periods.begin(), periods.end(),
                   [](const auto& a, const auto& b) { return a.period_s > b.period_s; });
  return periods;
}

std::vector<ExpectedPeriod> natural_periods() {
  return {{25.8193 * 3600.0, "tide O1"},
          {86400.0, "day"},
          {12.4206 * 3600.0, "tide M2"},
          {43200.0, "half a day"}};
}

} // namespace goingrate
