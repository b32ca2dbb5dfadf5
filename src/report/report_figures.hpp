// The figures of a report, built from what was found out about the log.
#pragma once

#include "goingrate/report/figure.hpp"
#include "goingrate/report/report.hpp"

#include <vector>

namespace goingrate {

/// Those figures for which there are data, in the order of the page: rate, clock error, amplitude,
/// residuals, spectrum, deviation. What rests on the fit is left out unless the fit converged.
std::vector<Figure> report_figures(const ReportData& data);

/// A logarithmically spaced mean: a few values in each decade, each the mean over its band.
struct BinnedSpectrum {
  std::vector<double> frequency_hz; ///< geometric mean of the band
  std::vector<double> density;
};

/// `density` has one entry for each frequency; frequency 0 and NaN are left out. Each band holds at
/// least one frequency and spans at most a factor 10^(1/`per_decade`) otherwise.
BinnedSpectrum log_binned(const std::vector<double>& frequency_hz,
                          const std::vector<double>& density, int per_decade = 12);

} // namespace goingrate
