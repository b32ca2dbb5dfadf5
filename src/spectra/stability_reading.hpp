// What a stability table says about a clock: which noise dominates over which times, the jitter of
// its readings, and how far its time will wander.
#pragma once

#include <optional>
#include <vector>

#include "goingrate/spectra/stability.hpp"

namespace goingrate {

/// Neighbouring rows of a table with one noise type.
struct SlopeRegion {
  double from_s, to_s; ///< tau of the first and the last row
  double slope;        ///< d log(value) / d log(tau) between these two; NaN for a single row
  int alpha;
};

/// Parts a table into runs of rows of one noise type; rows without a value or a type end a run.
/// Cost: O(rows). Tested by StabilityReading.PartsATableByNoise.
[[nodiscard]] std::vector<SlopeRegion> slope_regions(const DeviationTable& table);

/// d log(value) / d log(tau) of power-law noise: -1, -1, -1/2, 0, +1/2, +1 for alpha 2 to -3 where
/// the deviation is Allan's or Hadamard's, -3/2 for alpha 2 where it is a modified or parabolic
/// one, and one more for deviations of time. NaN for mtie and tierms, which have none of their own.
[[nodiscard]] double slope_of_noise(DeviationKind kind, int alpha);

/// Whether a region may be the noise as which its values were identified: its slope is within 0.4
/// of that noise's (types are 0.5 apart), or neither has one. A step or a trend of the rate, or a
/// periodic variation, makes slopes that no noise has.
/// Tested by StabilityReading.ASlopeThatIsNoNoises.
[[nodiscard]] bool may_be_noise(const SlopeRegion& region, DeviationKind kind);

/// The rms of white phase noise, s, if the row at m = 1 shows that noise.
///
/// sigma = sqrt(3) j/tau for the Allan variances and sqrt(10/3) j/tau for the Hadamard ones (SP
/// 1065 section 5.2), whose differences of four and of eight binomial weights have 6 and 20 times
/// the variance j^2. Nothing if the first row is not at m = 1, alpha is not 2 there, or the kind
/// has no such relation (mtotdev, ttotdev, theo1, mtie, tierms). Accuracy: that of the row's
/// deviation (StabilityReading.FindsTheJitterPutIn).
[[nodiscard]] std::optional<double> jitter_of(const DeviationTable& table);

/// The expected error of the clock some time after it was set and its rate was known.
struct TimePrediction {
  double after_s;
  double error_s;    ///< rms
  double k;          ///< see predict_time_error
  int alpha;         ///< of the row it rests on
  double from_tau_s; ///< the longest tau of the table used
  bool extrapolated; ///< after_s is beyond it: the noise is taken to go on as it is there
};

/// The rms time error `after_s` ahead, x = k tp sigma_y(tp) (SP 1065, time prediction error): k = 1
/// for white rate and random walk of rate, 1/sqrt(ln 2) = 1.20 for flicker rate, 1/sqrt(3) for the
/// phase noises, whose error does not grow. sigma_y is interpolated between rows on logarithmic
/// axes; beyond the last row that rests on two or more spans of its own length, it goes on as
/// tau^-1, -1, -1/2, 0, +1/2 for alpha 2 to -2.
///
/// nullopt for kinds other than adev, oadev, totdev and theoh, and if no such row has a noise type
/// from -2 to 2. Drift, temperature and other effects are not included.
/// Tested by StabilityReading.PredictsTheTimeErrorOfARandomWalk. Throws ArgumentError if `after_s`
/// is not finite and above 0.
[[nodiscard]] std::optional<TimePrediction> predict_time_error(const DeviationTable& table,
                                                               double after_s);

} // namespace goingrate
