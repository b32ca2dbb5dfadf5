// Lines: strictly periodic parts of a series, such as a wheel with a bad tooth causes.
//
// A sinusoid of amplitude A in N values of noise of variance sigma^2 rises above the periodogram of
// the noise by a factor A^2 N / (4 sigma^2), and through the window of the search by 9/11 of it.
// Noise exceeds R times its density, as estimated from a median over n ordinates, at one frequency
// with probability (1 + R/nu)^-nu, nu = 9 n (ln 2)^2 / 22, which tends to exp(-R). A line means
// little below three periods in the whole series, where slow wander looks like one, and if its
// period wanders by more than one cycle over the series.
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
  double ratio;           ///< A^2 N / (4 sigma^2), sigma^2 from the density around it
  double false_alarm;     ///< probability that noise shows such a ratio anywhere in the search
  /// For a sideband: the index, in the list, of the line it belongs to.
  std::optional<std::size_t> sideband_of{};
};

/// Settings of the search for lines.
struct LineSearch {
  double false_alarm = 0.01; ///< the largest SpectralLine::false_alarm of a line
  double from_hz = 0.0;      ///< lowest frequency; never below three periods in the series
  std::size_t most = 20;     ///< the largest number of lines
  std::size_t around = 128;  ///< width, in resolutions, over which the density is estimated
};

/// Finds the lines of a series, the strongest first; each is removed before the next is searched.
///
/// The periodogram on frequencies half a resolution apart, through a window that tapers a quarter
/// of the series at each end, is compared with the density around each frequency: medians over
/// blocks of up to `around` resolutions (at low frequencies over half the frequency, so that a
/// slope does not count as a line), divided by ln 2. false_alarm = 1 - (1 - p)^N with N values
/// (twice the independent frequencies: the finer grid gives noise more chances). Frequency,
/// amplitude and phase are then found by least squares.
///
/// A periodic part whose amplitude or frequency changes within the series appears as one line with
/// sidebands close to it. A line within four resolutions of one that is stronger by half or more is
/// marked as its sideband. It may also be a weak line of its own, which only a longer series would
/// show (LinesTest.ALineThatSwellsIsOneWithSidebands).
///
/// `series`: 64 or more finite values; `interval_s` above 0. Throws ArgumentError otherwise.
/// Accuracy: white and red noise show a line no more often than false_alarm says
/// (LinesTest.NoiseShowsALineNoOftenerThanItSays, LinesTest.ARedContinuumHasNoLines,
/// LinesTest.ASeriesThatDriftsHasNoLines); frequency and amplitude are as accurate as their
/// Cramer-Rao bounds (LinesTest.FindsALineToItsBound). Cost: one transform of 2 N values per line.
[[nodiscard]] std::vector<SpectralLine>
find_lines(std::span<const double> series, double interval_s, const LineSearch& search = {});

/// The series without these lines.
[[nodiscard]] std::vector<double> without_lines(std::span<const double> series, double interval_s,
                                                std::span<const SpectralLine> lines);

/// The mean of a series as a function of the phase of a period.
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
  std::size_t place = 0; ///< number of the arbor, the slowest being 1; of a mesh, the driving one
};

/// Periods of a going train: teeth of wheels and leaves of pinions from the slowest arbor to the
/// escape wheel. In 60, 8, 64, 8, 30, a wheel of 60 drives a pinion of 8 on the arbor of a wheel of
/// 64, and so on; one of the 30 teeth of the escape wheel passes in each period of the pendulum.
/// The escape wheel turns in 30 periods, and each arbor before it is slower by wheel over pinion. A
/// mesh repeats with every tooth: the time of a turn divided by the number of teeth. Slowest first.
/// Throws ArgumentError unless there is an odd count of numbers, each 2 or more.
[[nodiscard]] std::vector<ExpectedPeriod> train_periods(std::span<const int> train,
                                                        double period_s);

/// The solar day and half of it, and the tides M2 and O1 (12.4206 h and 25.8193 h): the periods at
/// which temperature, traffic and gravity show in long logs of clocks.
[[nodiscard]] std::vector<ExpectedPeriod> natural_periods();

} // namespace goingrate
