// The figures of a report, built from the results of the analysis.
#pragma once

#include "goingrate/report/figure.hpp"
#include "goingrate/report/report.hpp"

#include <optional>
#include <vector>

namespace goingrate {

/// Whether the fit determines how far the pendulum swings. If several clocks explain a log equally
/// well, the fitted one may swing far from the true amplitudes, with a slow drive to make up the
/// difference; its course would mislead the reader.
bool tells_amplitude(const FitSummary& fit);

/// Mean rates of stretches against their mean amplitudes, with the slope of the circular error;
/// nullopt without amplitudes or for fewer than two stretches.
std::optional<Figure> rate_amplitude_figure(const Analysis& data);

/// The mean tick and tock of a recording of sound.
std::optional<Figure> beat_figure(const ClockLog& log);

/// mu(t)/mu0 with one sigma either way; nullopt without a history. The axis `time` shows seconds
/// times `time_factor`.
std::optional<Figure> drive_figure(const Analysis& data, const Axis& time, double time_factor,
                                   std::vector<Marker> markers);

/// For a free pendulum: the period against the squared amplitude, with the period of a free swing
/// as a line. The amplitudes are the log's, or the fit's if the log has none; nullopt if neither
/// tells them.
std::optional<Figure> period_amplitude_figure(const Analysis& data);

/// Q against the amplitude with its intervals; nullopt if fewer than two are determined.
std::optional<Figure> q_figure(const FitSummary& fit);

/// The correlation matrix of the parameters that the log determines; nullopt for fewer than two.
std::optional<Figure> correlation_figure(const FitSummary& fit);

/// The 68 % and 95 % intervals in units of sigma; nullopt if no parameter has them.
std::optional<Figure> interval_figure(const FitSummary& fit);

/// The profile likelihood of each parameter for which the fit traced it; nullopt if there is none.
std::optional<Figure> profile_figure(const FitSummary& fit);

/// A spectrum averaged in bands of equal logarithmic width, a few in each decade.
struct BinnedSpectrum {
  std::vector<double> frequency_hz; ///< geometric mean of the band
  std::vector<double> density;
};

/// `density` has one entry for each frequency; frequency 0 and NaN are left out. Each band holds at
/// least one frequency and spans at most a factor 10^(1/`per_decade`) otherwise.
BinnedSpectrum log_binned(const std::vector<double>& frequency_hz,
                          const std::vector<double>& density, int per_decade = 12);

} // namespace goingrate
