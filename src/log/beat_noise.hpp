// How uncertain a log's crossing times are, and how that grows with the number of periods.
//
// The crossing of cycle n is seen at t[n] + j eta, with
//   t[n+1] = t[n] + P[n] + w zeta,   P[n+1] = P[n] + r xi,
// eta, zeta and xi independent standard normal deviates. Second differences at lag m,
//   d = t[i+2m] - 2 t[i+m] + t[i],
// do not depend on the period and have the variance 6 j^2 + 2 m w^2 + (2 m^3 + m) r^2 / 3: the
// three kinds are told apart by how d grows with m.
#pragma once

#include "goingrate/log/clock_log.hpp"
#include "typical_period.hpp"

#include <array>
#include <span>
#include <vector>

namespace goingrate {

/// Variances of the three kinds of noise, s^2.
struct BeatNoise {
  double jitter2 = 0.0;    ///< j^2: white in time, the sensor
  double walk2 = 0.0;      ///< w^2 per cycle: white in rate, the drive
  double rate_walk2 = 0.0; ///< r^2 per cycle: the rate itself wanders, drifts or steps
};

/// Mean square of `values` (mean zero) without the largest 5 %, scaled up to what it is for a
/// normal distribution. More than half of equal values (a coarse clock) do not make it zero, as
/// they do a median. Reorders `values`.
double trimmed_mean_square(std::span<double> values);

/// A guess from neighbouring intervals alone, for a first numbering: on the wide side.
BeatNoise rough_noise(const TypicalPeriod& typical);

/// `noise` with a jitter no smaller than the error caused by the steps of the times, and no smaller
/// than 1e-9 of the period, which is finer than any sensor and above the rounding of times.
BeatNoise at_least_finest(BeatNoise noise, const TypicalPeriod& typical);

/// Collects second differences of numbered beats and fits the noise to them.
class SecondDifferences {
public:
  /// Adds a run of beats in which `cycle` is right and never decreases. At most 4000 differences
  /// per octave of lags are taken from one run, spread over it.
  void add(std::span<const Beat> run);

  /// Noise by maximum likelihood of the octaves' variances, each distributed as chi^2 with as many
  /// degrees of freedom as it has independent differences
  /// (NumberingNoise.FindsJitterWalkAndRateWalk).
  [[nodiscard]] BeatNoise fit() const;

  /// The noise with each variance raised by its own standard error, as it may just as well be in a
  /// log of this length. For judging gaps, where too small a noise leads to wrong counts.
  [[nodiscard]] BeatNoise cautious_fit() const;

private:
  struct Octave {
    std::vector<double> differences;
    double independent = 0.0; // differences that do not overlap
  };
  struct Row {
    std::array<double, 3> shares; // of j^2, w^2, r^2 in the variance
    double variance, freedom;
  };
  struct Fit {
    std::array<double, 3> variances; // j^2, w^2, r^2
    std::array<double, 3> errors;    // their standard errors
  };
  [[nodiscard]] std::vector<Row> rows() const;
  [[nodiscard]] Fit maximise_likelihood() const;

  std::vector<Octave> octaves_; // lag 2^k
};

} // namespace goingrate
