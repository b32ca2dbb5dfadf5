// Several clocks side by side, each with a log of its own, on one time scale.
#pragma once

#include "goingrate/analysis/load.hpp"
#include "goingrate/causes/covariates.hpp"
#include "goingrate/log/rates.hpp"
#include "goingrate/spectra/stability.hpp"

#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace goingrate {

/// One clock of a comparison. `error_s` is sampled at the common times.
struct ComparedClock {
  std::string source;
  RateSummary rate;                  ///< of the common hours
  std::vector<double> error_s;       ///< of the hands, from 0 on; NaN where it is not known
  std::vector<WeatherPart> weather;  ///< effects of the weather, all parts found together
  std::vector<double> own_error_s;   ///< without these parts; empty if there are none
  DeviationTable deviation{};        ///< overlapping Allan, against the loggers' time
  DeviationTable own_deviation{};    ///< of own_error_s
};

/// The difference of two clocks, in which the loggers' time and all effects common to the clocks
/// cancel.
struct ClockPair {
  std::size_t first = 0, second = 0; ///< of the clocks
  double correlation = 0.0;          ///< of the rates in blocks; see Comparison::blocks
  DeviationTable deviation{};
  DeviationTable own_deviation{}; ///< without the weather; no rows where neither has any
};

/// The Allan variance of one clock alone, from the differences. An estimate may be negative where
/// the clock is much steadier than the others; it is kept, with its standard deviation.
struct HatEstimate {
  double variance = 0.0;
  double sigma = 0.0;
  double upper_limit = 0.0; ///< 95 % limit of the deviation (not of its square)
  /// Whether the variance is above two sigma; if not, only the limit is meaningful.
  [[nodiscard]] bool is_resolved() const { return variance > 2.0 * sigma; }
};

/// The estimates for one averaging time, in the order of the clocks.
struct HatRow {
  double tau_s = 0.0;
  std::vector<HatEstimate> clocks;
};

/// The clocks in the hours that all logs have.
struct Comparison {
  Instant start;           ///< first common time
  double step_s = 0.0;     ///< between common times: the longest of the nominal periods
  std::vector<ComparedClock> clocks;
  std::vector<ClockPair> pairs;
  std::vector<HatRow> hat;     ///< of three clocks or more, else empty
  std::vector<HatRow> own_hat; ///< without the weather; empty where no clock has any
  std::size_t blocks = 0;      ///< of equal length, for rates on one axis
};

/// Compares the clocks of two logs or more. Errors between beats are interpolated linearly, also
/// over one missing beat; where more are missing they are unknown.
///
/// For n >= 3 clocks with independent noises, the variances follow from those of the
/// differences, s_ij = v_i + v_j, by least squares: v_i = (S_i - T)/(n - 2), S_i = sum_j s_ij,
/// T = sum s_ij/(n - 1); for n = 3 the three-cornered hat (Gray and Allan, 1974). Sigma is the
/// scatter of these estimates at the EDF of each row, including the covariance of two differences
/// that share a clock. The upper limit belongs to the variance at which 5 % of estimates would be
/// as low as this one. (CompareTest.TheHatCoversAsOftenAsItSays)
///
/// Throws InputError if the logs have fewer than 64 common times, one has fewer than 64 beats
/// there, or some have dates and others not; ArgumentError for fewer than two logs.
Comparison compare(std::span<const NumberedLog> logs);

/// Mean rates (relative) in `count` blocks of equal length of an error sampled every `step_s`; NaN
/// for a block of which half is not known.
std::vector<double> block_rates_of(std::span<const double> error_s, double step_s,
                                   std::size_t count);

/// The estimates from the variances of the differences: s[k] is of pair k in the order (0,1),
/// (0,2), ... (1,2), ...; `edf` of each.
std::vector<HatEstimate> hat_estimates(std::span<const double> s, double edf, std::size_t clocks);

} // namespace goingrate
