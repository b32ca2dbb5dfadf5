#include "goingrate/fit/drive_split.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numbers>

namespace goingrate {

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
constexpr double one_sigma_tail = 0.15865525393145707; // beyond one standard deviation, one side
constexpr std::size_t least_bins = 3; // below the split, for a slow rms with any meaning

double shape_of_jitter(double frequency_hz, double period_s) {
  const double s = std::sin(std::numbers::pi * frequency_hz * period_s);
  return 8.0 * s * s / period_s;
}

// The two unknowns of the white model and their covariance.
struct White {
  double drive = 0.0;   // D_fast, 1/Hz
  double jitter2 = 0.0; // j^2, s^2
  double drive_sigma = 0.0;
  double jitter2_sigma = 0.0;
};

// Normal equations of sum w (S - D h - J s)^2 with w = 1/model^2: at convergence those of Whittle's
// likelihood.
struct Sums {
  double hh = 0.0, hs = 0.0, ss = 0.0, hy = 0.0, sy = 0.0;
};

// Medians over blocks of neighbouring frequencies: a line (a wheel with a bad tooth) raises a few
// frequencies a thousandfold and the median of their block hardly at all.
class WhiteFit {
public:
  WhiteFit(const Spectrum& spectrum, double period_s, const DriveResponse& response,
           double split_hz) {
    for (const double f : spectrum.frequency_hz) {
      gain2_.push_back(std::norm(response.at(f)));
      shape_.push_back(shape_of_jitter(f, period_s));
    }
    const auto& f = spectrum.frequency_hz;
    // The tail of the slow drive reaches above the split and falls as 1/f^2: from ten times the
    // split it is a hundredth. At least the upper half is left to fit the white part.
    const double clear_hz = std::max(10.0 * split_hz, spectrum.resolution_hz);
    auto first =
        static_cast<std::size_t>(std::upper_bound(f.begin(), f.end(), clear_hz) - f.begin());
    first = std::min(first, f.size() / 2);
    make_blocks(spectrum, first);
  }

  [[nodiscard]] const std::vector<double>& gain2() const { return gain2_; }
  [[nodiscard]] const std::vector<double>& shape() const { return shape_; }

  [[nodiscard]] White run() const {
    White white = start();
    constexpr int rounds = 50; // the weights settle in about ten
    Sums sums;
    for (int i = 0; i < rounds; ++i) {
      sums = weighted_sums(white);
      white = solve(sums);
    }
    const double determinant = sums.hh * sums.ss - sums.hs * sums.hs;
    white.drive_sigma = std::sqrt(block_variance_ * sums.ss / determinant);
    white.jitter2_sigma = std::sqrt(block_variance_ * sums.hh / determinant);
    return white;
  }

private:
  struct Block {
    double gain2 = 0.0, shape = 0.0, density = 0.0;
  };

  // Each density is chi-squared over its degrees of freedom times the truth: the median lies below
  // the mean by a known factor, and scatters as 1/(4 n p^2), p the probability density at the
  // median. Hann windowing correlates neighbours, so that 1.9 frequencies count as one.
  void make_blocks(const Spectrum& spectrum, std::size_t first) {
    const std::size_t n = gain2_.size() - first;
    const std::size_t size = std::clamp<std::size_t>(n / 100, std::min<std::size_t>(8, n), 256);
    const boost::math::chi_squared chi(spectrum.degrees_of_freedom);
    const double chi_median = median(chi);
    const double bias = chi_median / spectrum.degrees_of_freedom;
    const double p = pdf(chi, chi_median) * chi_median;
    block_variance_ = 1.9 / (4.0 * static_cast<double>(size) * p * p);
    for (std::size_t i = first; i + size <= gain2_.size(); i += size) {
      Block block;
      std::vector<double> values(spectrum.density.begin() + static_cast<std::ptrdiff_t>(i),
                                 spectrum.density.begin() + static_cast<std::ptrdiff_t>(i + size));
      const auto middle = values.begin() + static_cast<std::ptrdiff_t>(size / 2);
      std::nth_element(values.begin(), middle, values.end());
      block.density = *middle / bias;
      for (std::size_t k = i; k < i + size; ++k) {
        block.gain2 += gain2_[k] / static_cast<double>(size);
        block.shape += shape_[k] / static_cast<double>(size);
      }
      blocks_.push_back(block);
    }
  }

  [[nodiscard]] White start() const {
    Block sum;
    for (const Block& block : blocks_) {
      sum.density += block.density;
      sum.gain2 += block.gain2;
      sum.shape += block.shape;
    }
    return {0.5 * sum.density / sum.gain2, 0.5 * sum.density / sum.shape, 0.0, 0.0};
  }

  [[nodiscard]] Sums weighted_sums(const White& white) const {
    Sums sums;
    for (const Block& block : blocks_) {
      const double model = white.drive * block.gain2 + white.jitter2 * block.shape;
      const double w = 1.0 / (model * model);
      sums.hh += w * block.gain2 * block.gain2;
      sums.hs += w * block.gain2 * block.shape;
      sums.ss += w * block.shape * block.shape;
      sums.hy += w * block.gain2 * block.density;
      sums.sy += w * block.shape * block.density;
    }
    return sums;
  }

  static White solve(const Sums& s) {
    const double determinant = s.hh * s.ss - s.hs * s.hs;
    White white;
    white.drive = (s.hy * s.ss - s.sy * s.hs) / determinant;
    white.jitter2 = (s.sy * s.hh - s.hy * s.hs) / determinant;
    if (white.drive <= 0.0)
      white = {0.0, s.sy / s.ss, 0.0, 0.0};
    else if (white.jitter2 <= 0.0)
      white = {s.hy / s.hh, 0.0, 0.0, 0.0};
    return white;
  }

  std::vector<double> gain2_, shape_;
  std::vector<Block> blocks_;
  double block_variance_ = 0.0; // relative, of a block's density
};

// The rms of a variance with a normal error; an upper limit alone where it is within its own error.
RmsEstimate rms_of(double variance, double sigma) {
  return {std::sqrt(std::max(0.0, variance)), std::sqrt(std::max(0.0, variance - sigma)),
          std::sqrt(std::max(0.0, variance) + sigma)};
}

RmsEstimate slow_part(const Spectrum& spectrum, const std::vector<double>& gain2,
                      const std::vector<double>& shape, const White& white, double split_hz) {
  double total = 0.0;
  double fourth = 0.0;
  double white_part = 0.0;
  std::size_t bins = 0;
  for (std::size_t i = 1; i < gain2.size() && spectrum.frequency_hz[i] <= split_hz; ++i, ++bins) {
    const double drive = spectrum.density[i] / gain2[i] * spectrum.resolution_hz;
    total += drive;
    fourth += drive * drive;
    white_part += (white.drive + white.jitter2 * shape[i] / gain2[i]) * spectrum.resolution_hz;
  }
  if (bins < least_bins) return {unknown, unknown, unknown};
  // A sum of scaled chi-squareds counts as one with (sum)^2/(sum of squares) x their freedom each.
  const double freedom = std::max(1.0, spectrum.degrees_of_freedom * total * total / fourth / 1.9);
  const boost::math::chi_squared chi(freedom);
  const double low = total * freedom / quantile(complement(chi, one_sigma_tail));
  const double high = total * freedom / quantile(chi, one_sigma_tail);
  const auto rms = [&](double variance) { return std::sqrt(std::max(0.0, variance - white_part)); };
  return {rms(total), rms(low), rms(high)};
}

} // namespace

std::vector<double> rate_about_fit(std::span<const Beat> beats, double nominal_period_s,
                                   const FitSummary& fit) {
  if (fit.residual_s.size() != beats.size()) return rate_on_every_cycle(beats, nominal_period_s);
  std::vector<double> series;
  for (std::size_t i = 1; i < beats.size(); ++i) {
    const double late = fit.residual_s[i] - fit.residual_s[i - 1];
    const double rate = -late / (beats[i].time - beats[i - 1].time);
    series.insert(series.end(), static_cast<std::size_t>(beats[i].cycle - beats[i - 1].cycle),
                  rate);
  }
  return series;
}

DriveSplit split_drive(const Spectrum& spectrum, double period_s, const DriveResponse& response,
                       double split_hz) {
  if (!(period_s > 0.0)) throw ArgumentError("period", period_s, "a positive number of seconds");
  if (spectrum.frequency_hz.size() < 8)
    throw ArgumentError("spectrum", static_cast<double>(spectrum.frequency_hz.size()),
                        "at least 8 frequencies");
  DriveSplit result;
  result.split_hz = split_hz > 0.0 ? split_hz : response.corner_hz;
  const WhiteFit fit(spectrum, period_s, response, result.split_hz);
  const White white = fit.run();
  const double nyquist = 0.5 / period_s;
  result.fast = rms_of(white.drive * nyquist, white.drive_sigma * nyquist);
  result.jitter_s = rms_of(white.jitter2, white.jitter2_sigma);
  result.slow = slow_part(spectrum, fit.gain2(), fit.shape(), white, result.split_hz);
  for (std::size_t i = 0; i < spectrum.frequency_hz.size(); ++i) {
    result.jitter_density.push_back(white.jitter2 * fit.shape()[i]);
    result.fast_density.push_back(white.drive * fit.gain2()[i]);
  }
  if (result.fast.low68 == 0.0)
    result.note = "the sensor's jitter hides the fast drive: its rms is an upper limit";
  if (std::isnan(result.slow.rms))
    result.note += fmt::format("{}the log is too short for the slow drive: it would take {:.3g} s",
                               result.note.empty() ? "" : "; ", 3.0 / result.split_hz);
  return result;
}

DriveAnalysis analyse_drive(std::span<const Beat> beats, double nominal_period_s,
                            const FitSummary& fit, double split_hz) {
  DriveAnalysis drive;
  const auto rates = rate_about_fit(beats, nominal_period_s, fit);
  if (rates.size() < 8) return drive;
  // One segment, for the longest reach; a trend is a slow variation too and stays in.
  drive.rate_spectrum =
      welch_spectrum(rates, nominal_period_s, {.segment = rates.size(), .detrend_linear = false});
  const auto clock = fitted_clock(fit);
  if (clock) drive.response = drive_response(*clock);
  if (drive.response && drive.rate_spectrum->frequency_hz.size() >= 8)
    drive.split = split_drive(*drive.rate_spectrum, nominal_period_s, *drive.response, split_hz);
  return drive;
}

} // namespace goingrate
