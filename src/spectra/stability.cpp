// Notation: x phase in s, N phases, tau0 sampling interval, m averaging factor, n terms used.
#include "goingrate/spectra/stability.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/workers.hpp"
#include "bias.hpp"
#include "goingrate/base/errors.hpp"
#include "goingrate/base/sums.hpp"
#include "mean_squares.hpp"
#include "base/per_processor.hpp"
#include "spectra/degrees_of_freedom.hpp"
#include "spectra/noise_type.hpp"
#include "square_sums.hpp"

namespace goingrate {
namespace {

using Kind = DeviationKind;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

void check_interval(double tau0_s) {
  if (!(tau0_s > 0.0) || !std::isfinite(tau0_s))
    throw ArgumentError("tau0_s", tau0_s, "finite and above 0");
}

void check_factors(Kind kind, std::span<const std::size_t> factors, std::size_t phase_points) {
  const std::size_t largest = largest_factor(kind, phase_points);
  std::size_t previous = 0;
  for (std::size_t m : factors) {
    if (m <= previous)
      throw ArgumentError("factors", static_cast<double>(m), "1 or more and strictly increasing");
    if (m > largest)
      throw ArgumentError("factors", static_cast<double>(m),
                          "at most " + std::to_string(largest) + " for this kind and data");
    if (kind == Kind::theo1 && (m % 2 != 0 || m < 10))
      throw ArgumentError("factors", static_cast<double>(m), "even and 10 or more for theo1");
    previous = m;
  }
}

// Whether all are known.
bool check_phase(std::span<const double> phase_s) {
  if (phase_s.size() < 3)
    throw ArgumentError("phase_s.size()", static_cast<double>(phase_s.size()), "3 or more");
  if (is_finite(phase_s)) return true;
  for (double x : phase_s)
    if (std::isinf(x)) throw ArgumentError("phase_s", x, "finite, or NaN for a gap");
  return false;
}

void check_alpha(const std::optional<int>& alpha) {
  if (alpha && (*alpha < -4 || *alpha > 2)) throw ArgumentError("alpha", *alpha, "from -4 to 2");
}

// x - x_first errs by no more than the rounding already in x; the fused product then takes away an
// exact multiple of i.
GOINGRATE_PER_PROCESSOR("fma") // a call of the C library's fma at each phase otherwise
void take_line_away(double* x, std::size_t n, double offset, double slope) {
  for (std::size_t i = 0; i < n; ++i)
    x[i] = std::fma(-slope, static_cast<double>(i), x[i] - offset);
}

// The phase minus the line through its first and last known point.
std::vector<double> without_end_line(std::span<const double> phase_s) {
  std::vector<double> rest(phase_s.begin(), phase_s.end());
  const auto known = [](double x) { return !std::isnan(x); };
  const auto first = std::find_if(rest.begin(), rest.end(), known);
  if (first == rest.end()) return rest;
  const auto last = std::find_if(rest.rbegin(), rest.rend(), known).base() - 1;
  const double offset = *first;
  const double steps = static_cast<double>(last - first);
  const double slope = steps > 0.0 ? (*last - offset) / steps : 0.0;
  take_line_away(rest.data(), rest.size(), offset, slope);
  return rest;
}

bool is_hadamard(Kind kind) {
  return kind == Kind::hdev || kind == Kind::ohdev || kind == Kind::htotdev;
}

bool needs_an_unbroken_run(Kind kind) {
  return kind == Kind::mtotdev || kind == Kind::ttotdev || kind == Kind::htotdev ||
         kind == Kind::theo1 || kind == Kind::theoh || kind == Kind::pdev;
}

// The phases from which the deviation of `kind` is computed. Unknown phases at the ends are cut off
// if the ends matter, and gaps are bridged if the kind does not allow them.
struct PreparedPhases {
  std::vector<double> changed{}; // empty if the phases do as they are
  std::span<const double> x{};
  bool known = true; // all of x
  std::size_t bridged = 0;
};

void bridge_gaps(PreparedPhases& series) {
  std::vector<double>& x = series.changed;
  for (std::size_t i = 1; i < x.size(); ++i) {
    if (!std::isnan(x[i])) continue;
    std::size_t next = i;
    while (std::isnan(x[next]))
      ++next; // the last phase is known
    const double before = x[i - 1], span = static_cast<double>(next - i + 1);
    for (std::size_t k = i; k < next; ++k)
      x[k] = before + (x[next] - before) * (static_cast<double>(k - i + 1) / span);
    series.bridged += next - i;
    i = next;
  }
}

// Differences of single phases lose nothing to an offset or a slope that the phases have not lost
// already.
bool takes_single_phases(Kind kind) {
  return kind == Kind::adev || kind == Kind::oadev || kind == Kind::hdev || kind == Kind::ohdev ||
         kind == Kind::tierms || kind == Kind::mtie;
}

PreparedPhases prepared(Kind kind, std::span<const double> phase_s, bool known) {
  if (takes_single_phases(kind)) return {{}, phase_s, known};
  PreparedPhases series{without_end_line(phase_s), {}, known};
  std::vector<double>& x = series.changed;
  if (kind == Kind::totdev || needs_an_unbroken_run(kind)) {
    const auto is_known = [](double v) { return !std::isnan(v); };
    x.erase(std::find_if(x.rbegin(), x.rend(), is_known).base(), x.end());
    x.erase(x.begin(), std::find_if(x.begin(), x.end(), is_known));
  }
  if (needs_an_unbroken_run(kind)) bridge_gaps(series), series.known = true;
  series.x = x;
  return series;
}

// A row's factor in the variance it is taken from, and that variance's kind.
struct Source {
  Kind kind;
  std::size_t m;
  double tau; // in units of tau0
};

Source source_of(Kind kind, std::size_t m, std::size_t points) {
  const double factor = static_cast<double>(m);
  if (kind == Kind::theo1) return {kind, m, 0.75 * factor};
  if (kind != Kind::theoh) return {kind, m, factor};
  if (10 * m <= points - 1) return {Kind::oadev, m, factor};
  const auto even = 2 * static_cast<std::size_t>(std::lround(factor / 1.5));
  const std::size_t theo = std::clamp<std::size_t>(even, 10, largest_factor(Kind::theo1, points));
  return {Kind::theoh, theo, 0.75 * static_cast<double>(theo)};
}

// Theo1 times the mean ratio of AVAR to it (SP 1065 section 5.2.16, "TheoBR"): OADEV at 9 + 3i
// against Theo1 at 12 + 4i, which has the same tau.
MeanSquares scaled_theo1(std::span<const double> x) {
  const std::size_t pairs = x.size() >= 90 ? x.size() / 30 - 3 + 1 : 1;
  constexpr std::size_t most_pairs =
      32; // the ratio scatters less than Theo1 does at the tau it is for
  const std::size_t taken = std::min(pairs, most_pairs);
  const MeanSquares allan = phase_differences(x, true, 2, true), theo1 = theo1_differences(x);
  double ratio = 0.0;
  for (std::size_t k = 0; k < taken; ++k) {
    const std::size_t i = taken > 1 ? k * (pairs - 1) / (taken - 1) : 0;
    ratio += at_one(allan, 9 + 3 * i).value / at_one(theo1, 12 + 4 * i).value /
             static_cast<double>(taken);
  }
  return one_by_one([theo1, ratio](std::size_t m) {
    MeanSquare mean = at_one(theo1, m);
    if (std::isfinite(ratio)) mean.value *= ratio; // not so for phases without any noise
    return mean;
  });
}

MeanSquares mean_squares_of(Kind kind, std::span<const double> x, bool known) {
  switch (kind) {
  case Kind::adev:
  case Kind::oadev:
    return phase_differences(x, known, 2, kind == Kind::oadev);
  case Kind::hdev:
  case Kind::ohdev:
    return phase_differences(x, known, 3, kind == Kind::ohdev);
  case Kind::mdev:
  case Kind::tdev:
    return mean_phase_differences(x, known);
  case Kind::totdev:
    return reflected_differences(x, known);
  case Kind::mtotdev:
  case Kind::ttotdev:
    return modified_total(x);
  case Kind::htotdev:
    return hadamard_total(x);
  case Kind::theo1:
    return theo1_differences(x);
  case Kind::theoh:
    return scaled_theo1(x);
  case Kind::mtie:
    return largest_ranges(x);
  case Kind::tierms:
    return phase_differences(x, known, 1, true);
  default:
    return slope_differences(x);
  }
}

// Noise at the tau of a row; not identified if too little is left.
NoiseType noise_at(Kind kind, std::span<const double> x, double tau,
                   const DeviationOptions& options) {
  if (kind == Kind::mtie || kind == Kind::tierms) return {}; // without an interval it is no use
  if (options.alpha) return {*options.alpha, static_cast<double>(*options.alpha), 0, true};
  const auto m = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(tau)));
  const NoiseType found = identify_noise(x, m, is_hadamard(kind) ? 3 : 2);
  return found.identified ? found : identify_noise_by_ratio(x, m);
}

double degrees_of(const Source& source, int alpha, std::size_t n, std::size_t points) {
  const auto differences = [&](DifferenceStride stride, std::size_t order, PhaseFilter filter) {
    return difference_degrees_of_freedom(alpha, source.m, n, {stride, order, filter});
  };
  using enum DifferenceStride;
  const PhaseFilter modified = source.m == 1 ? PhaseFilter::none : PhaseFilter::mean_of_tau;
  switch (source.kind) {
  case Kind::adev:
    return differences(one_tau, 2, PhaseFilter::none);
  case Kind::oadev:
    return differences(one_sample, 2, PhaseFilter::none);
  case Kind::hdev:
    return differences(one_tau, 3, PhaseFilter::none);
  case Kind::ohdev:
    return differences(one_sample, 3, PhaseFilter::none);
  case Kind::totdev: // at m = 1 no reflected phase takes part
    return source.m == 1 ? differences(one_sample, 2, PhaseFilter::none)
                         : total_degrees_of_freedom(alpha, source.m, points);
  case Kind::mtotdev:
  case Kind::ttotdev: // the fit is one for long averages; MVAR, the plainer one, has no more than
                      // it
    return source.m > 8 ? modified_total_degrees_of_freedom(alpha, source.m, points)
                        : differences(one_sample, 2, modified);
  case Kind::htotdev: // there is no fit for phase noises; the plain Hadamard variance has fewer
    return source.m > 1 && alpha <= 0 ? hadamard_total_degrees_of_freedom(alpha, source.m, points)
                                      : differences(one_sample, 3, PhaseFilter::none);
  case Kind::theo1:
  case Kind::theoh:
    return theo1_degrees_of_freedom(alpha, source.m, points);
  default: // mdev, tdev, pdev; at m = 1 they are the Allan variance
    return differences(one_sample, 2, modified);
  }
}

bool is_of_differences(Kind kind) {
  using enum DeviationKind;
  return kind == adev || kind == oadev || kind == mdev || kind == tdev || kind == hdev ||
         kind == ohdev || kind == pdev;
}

// Phase noise found at longer times than noise of the rate is not white from sample to sample: it
// means that the phase returns, while neighbours up to that time are correlated. So the degrees of
// freedom are taken for phases a `grain` apart.
void add_interval(DeviationRow& row, Source source, const NoiseType& noise, std::size_t points,
                  std::size_t grain, bool remove_bias) {
  if (!noise.identified) return;
  row.alpha = noise.alpha;
  if (remove_bias) {
    row.bias = variance_bias(source.kind, noise.alpha, source.m, points);
    row.value /= std::sqrt(row.bias);
  }
  const int lowest = is_hadamard(source.kind) ? -4 : -2;
  const bool none = source.kind == Kind::mtie || source.kind == Kind::tierms;
  if (row.n == 0 || noise.alpha < lowest || none) return;
  if (!is_of_differences(source.kind)) grain = 1; // the fits for the others know nothing of it
  source.m = std::max<std::size_t>(1, source.m / grain);
  const double degrees = degrees_of(source, noise.alpha, std::max<std::size_t>(1, row.n / grain),
                                    std::max<std::size_t>(3, points / grain));
  const DeviationInterval interval = chi_squared_interval(row.value, degrees);
  row.low = interval.low;
  row.high = interval.high;
  row.interval = true;
}

DeviationRow row_without_noise(const Source& source, const MeanSquare& mean, double tau0_s) {
  const double tau_s = source.tau * tau0_s;
  double value = std::sqrt(mean.value);
  if (source.kind == Kind::tdev || source.kind == Kind::ttotdev) value /= std::sqrt(3.0);
  if (!is_in_seconds(source.kind)) value /= tau_s;
  return {tau_s, source.m, mean.n, value, nan, nan, 0, false};
}

std::size_t threads_for(const DeviationOptions& options, std::size_t points, std::size_t factors) {
  if (options.threads > 0) return options.threads;
  constexpr std::size_t terms_a_thread = 10'000'000; // terms, some 10 ms
  return points * factors < terms_a_thread ? 1 : threads_or_usual(0);
}

// How many factors one thread takes together. For sums over windows this does not depend on the
// number of threads, because their last digit depends on the sums from which they were widened.
std::size_t factors_together(Kind kind, std::size_t factors, std::size_t threads) {
  if (takes_single_phases(kind) || kind == Kind::totdev) return (factors + threads - 1) / threads;
  const bool windows = kind == Kind::mdev || kind == Kind::tdev || kind == Kind::pdev;
  return windows ? std::clamp<std::size_t>(factors / 16, 32, 256) : 1;
}

// One for each factor.
std::vector<MeanSquare> mean_squares(Kind kind, std::span<const double> x, bool known,
                                     std::span<const std::size_t> factors, std::size_t threads) {
  const MeanSquares of_kind = mean_squares_of(kind, x, known);
  const MeanSquares allan = // the first part of THEOH
      kind == Kind::theoh ? phase_differences(x, true, 2, true) : MeanSquares{};
  const std::size_t together = factors_together(kind, factors.size(), threads);
  std::vector<MeanSquare> means(factors.size());
  share((factors.size() + together - 1) / together, threads, [&](std::size_t part) {
    const std::size_t first = part * together, end = std::min(first + together, factors.size());
    std::vector<std::size_t> taken;
    for (std::size_t i = first; i < end; ++i)
      taken.push_back(source_of(kind, factors[i], x.size()).m);
    const bool from_allan =
        kind == Kind::theoh && source_of(kind, factors[first], x.size()).kind == Kind::oadev;
    const std::vector<MeanSquare> found = from_allan ? allan(taken) : of_kind(taken);
    std::copy(found.begin(), found.end(), means.begin() + static_cast<std::ptrdiff_t>(first));
  });
  return means;
}

} // namespace

DeviationTable stability_table(DeviationKind kind, std::span<const double> phase_s, double tau0_s,
                               std::span<const std::size_t> factors,
                               const DeviationOptions& options) {
  const bool known = check_phase(phase_s);
  check_interval(tau0_s);
  check_factors(kind, factors, phase_s.size());
  check_alpha(options.alpha);
  if (factors.empty()) return {kind, tau0_s, {}};
  const PreparedPhases series = prepared(kind, phase_s, known);
  const std::span<const double> x = series.x;
  check_factors(kind, factors, x.size());
  DeviationTable table{kind, tau0_s, std::vector<DeviationRow>(factors.size()), series.bridged};
  std::vector<NoiseType> noises(factors.size());
  const std::size_t threads = threads_for(options, x.size(), factors.size());
  const std::vector<MeanSquare> means = mean_squares(kind, x, series.known, factors, threads);
  share(factors.size(), threads, [&](std::size_t i) {
    const Source source = source_of(kind, factors[i], x.size());
    table.rows[i] = row_without_noise(source, means[i], tau0_s);
    noises[i] = noise_at(kind, x, source.tau, options);
  });
  // A first row without noise borrows it from the longest time at which it can be found.
  NoiseType noise;
  if (!noises.empty() && !noises[0].identified)
    noise = noise_at(
        kind, x, static_cast<double>((x.size() - 1) / (least_points_for_noise_type - 1)), options);
  std::vector<std::size_t> grains;
  std::size_t noisy = 1; // the longest factor at which the rate is noisy
  for (std::size_t i = 0; i < noises.size(); ++i) {
    // If none is found, that of the row before is kept.
    noises[i] = noise = noises[i].identified ? noises[i] : noise;
    if (noise.identified && noise.alpha <= 0) noisy = factors[i];
    grains.push_back(noise.alpha >= 1 && !options.alpha ? noisy : 1);
  }
  share(factors.size(), threads, [&](std::size_t i) {
    add_interval(table.rows[i], source_of(kind, factors[i], x.size()), noises[i], x.size(),
                 grains[i], options.remove_bias);
  });
  return table;
}

std::vector<double> phase_from_frequency(std::span<const double> y, double tau0_s,
                                         double gap_frequency) {
  check_interval(tau0_s);
  if (!std::isfinite(gap_frequency)) throw ArgumentError("gap_frequency", gap_frequency, "finite");
  std::vector<double> phase;
  phase.reserve(y.size() + 1);
  phase.push_back(0.0);
  TwoPart<double> sum; // of frequencies; two parts, so that long series do not collect rounding
  for (double frequency : y) {
    if (std::isinf(frequency)) throw ArgumentError("y", frequency, "finite, or NaN for a gap");
    const bool gap = std::isnan(frequency);
    sum += gap ? gap_frequency : frequency;
    phase.push_back(gap ? nan : sum.value() * tau0_s);
  }
  return phase;
}

} // namespace goingrate
