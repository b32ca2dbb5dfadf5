// Lines: strictly periodic parts of a series, as a wheel with a bad tooth makes them.
//
// A sinusoid of amplitude A in N values stands out of the periodogram by A^2 N / (4 sigma^2) of its
// surroundings, however broad those are. Noise of a density known from a median over n ordinates
// exceeds R times it at one frequency with probability (1 + R/nu)^-nu, nu = n (ln 2)^2 / 2, which
// tends to exp(-R). Where it means little: below three turns in the whole series, where a slow
// wander looks like a line, and for a period that itself wanders by more than one turn in the
// series.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace goingrate {

/// One line of a series.
struct SpectralLine {
  double frequency_hz;
  double amplitude;       ///< of a sin(2 pi f t + phase), unit of the series
  double amplitude_sigma; ///< from the density around the line
  double phase_rad;       ///< at the first value of the series, -pi to pi
  double ratio;           ///< periodogram over the density around it
  double false_alarm;     ///< probability that noise shows such a ratio anywhere in the search
  /// Place in the list of the line it belongs to, if it is a sideband.
  std::optional<std::size_t> sideband_of{};
};

/// How lines are looked for.
struct LineSearch {
  double false_alarm = 0.01; ///< what a line must stay below
  double from_hz = 0.0;      ///< lowest frequency; at least three turns in the series in any case
  std::size_t most = 20;     ///< lines at most
  std::size_t around = 128;  ///< resolutions that tell the density around a line
};

/// Finds the lines of a series, the strongest first, each taken out before the next is looked for.
///
/// The periodogram on frequencies half a resolution apart is compared with the density around it:
/// medians over blocks of up to `around` resolutions (at low frequencies half the frequency, so
/// that a slope is not a line), divided by ln 2. false_alarm = 1 - (1 - p)^N with N values (twice
/// the independent frequencies: the finer grid gives noise more chances). Frequency, amplitude and
/// phase are then those of least squares.
///
/// A periodic part whose size or pace changes within the series is one line with sidebands close to
/// it. A line within four resolutions of one that is stronger by half or more is named its
/// sideband: it may as well be a weak line of its own, which only a longer series would tell
/// (LinesTest.ALineThatSwellsIsOneWithSidebands).
///
/// `series`: 64 or more finite values; `interval_s` above 0. Throws ArgumentError otherwise.
/// Accuracy: white and red noise show a line no oftener than it says
/// (LinesTest.NoiseShowsALineNoOftenerThanItSays, LinesTest.ARedContinuumHasNoLines); frequency and
/// amplitude to their Cramer-Rao bounds (LinesTest.FindsALineToItsBound). Cost: one transform of 2
/// N values per line.
[[nodiscard]] std::vector<SpectralLine>
find_lines(std::span<const double> series, double interval_s, const LineSearch& search = {});

/// The series without these lines.
[[nodiscard]] std::vector<double> without_lines(std::span<const double> series, double interval_s,
                                                std::span<const SpectralLine> lines);

/// The mean course of a series over one turn of something periodic.
struct FoldedProfile {
  std::vector<double> phase; ///< middle of each bin, turns from 0 to 1
  std::vector<double> mean;  ///< unit of the series, less the mean of the whole
  std::vector<double>
      sigma; ///< of each mean, from the scatter within the bin; NaN below two values
};

/// Folds a series with a period; NaN values are left out. Throws ArgumentError unless period_s is
/// above two intervals and bins is from 2 to the values in a turn.
[[nodiscard]] FoldedProfile folded(std::span<const double> series, double interval_s,
                                   double period_s, std::size_t bins);

/// A period to be expected, and why.
struct ExpectedPeriod {
  double period_s;
  std::string_view kind; ///< "arbor", "mesh", "day" ...
  std::size_t place = 0; ///< which arbor, from the slowest as 1; of a mesh, the driving one
};

/// Periods of a going train: teeth of wheels and leaves of pinions from the slowest arbor to the
/// escape wheel, as 60, 8, 64, 8, 30: a wheel of 60 drives a pinion of 8 that carries a wheel of
/// 64, and so on; 30 teeth of the escape wheel pass one each period of the pendulum. The escape
/// wheel turns in 30 periods; each arbor before it slower by wheel over pinion. A mesh repeats with
/// every tooth: the time of a turn over the teeth. Slowest first. Throws ArgumentError unless there
/// is an odd count of numbers, each 2 or more.
[[nodiscard]] std::vector<ExpectedPeriod> train_periods(std::span<const int> train,
                                                        double period_s);

/// The solar day and its half, and the tides M2 and O1 (12.4206 h and 25.8193 h): what long logs of
/// clocks show of temperature, traffic and gravity.
[[nodiscard]] std::vector<ExpectedPeriod> natural_periods();

} // namespace goingrate
