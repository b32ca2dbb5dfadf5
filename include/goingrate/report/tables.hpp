// Results as text: tables for programs (CSV) and summaries for people.
#pragma once

#include "goingrate/fit/clock_fit.hpp"
#include "goingrate/fit/drive_split.hpp"
#include "goingrate/log/beats.hpp"
#include "goingrate/log/rates.hpp"
#include "goingrate/spectra/stability.hpp"

#include <string>

namespace goingrate {

/// A value with its uncertainty, rounded to two digits of the latter: "2.00031 +- 0.00012".
/// A sigma of 0 or NaN gives the value with `digits` digits and no sigma.
std::string with_sigma(double value, double sigma, int digits = 6);

/// The per-period table as CSV:
/// cycle,time_s,period_s,rate_excess,rate_s_per_day,amplitude_rad,flags. Every event has its row; a
/// missing beat has a row without times, flagged `missed`, and a run of more than `rows_per_gap` of
/// them one row flagged `gap`. A period after a missing beat is the mean over the cycles since the
/// last one.
std::string rate_table(const Beats& beats, double nominal_period_s);

/// Two or three lines: how many beats, how long, the rate and its uncertainty.
std::string rate_text(const Beats& beats, const RateSummary& summary);

/// The fit as people know it from other fitting programs: statistics, variables, correlations above
/// 0.1, what is undetermined, the models that were tried.
std::string fit_text(const FitSummary& fit);

/// The deviation as a table: tau, averaging factor, count, value, 68 % interval, noise type.
std::string deviation_text(const DeviationTable& table);

/// What the spectrum says of drive and jitter, in a few lines.
std::string split_text(const std::optional<DriveResponse>& response,
                       const std::optional<DriveSplit>& split);

/// The spectrum as CSV: frequency_hz,density_per_hz.
std::string spectrum_table(const Spectrum& spectrum);

} // namespace goingrate
