// How the driving torque varies from period to period.
#pragma once

#include "goingrate/base/random.hpp"

#include <cstdint>

namespace goingrate {

/// Variability of the drive relative to mu. The factor is renewed at every upward crossing
/// (Hoyng, eq. dmu) and constant in between.
struct DriveVariability {
  double fast_rms = 0.0;    ///< white from period to period; 0 to 100
  double slow_rms = 0.0;    ///< rms of a stationary Ornstein-Uhlenbeck process; 0 to 100
  double slow_time_s = 0.0; ///< its correlation time, s; > 0 if slow_rms > 0
};

/// Throws ArgumentError naming the first value outside the ranges given above.
void check(const DriveVariability& drive);

/// The drive's factor of period after period: 1 + fast + slow, reproducible from the seed.
class DriveSequence {
public:
  /// `period_s` is the time between renewals that the slow process is stepped with (T0).
  DriveSequence(const DriveVariability& drive, double period_s, std::uint64_t seed);

  /// The factor for the next period. Exact in law for the slow part: s' = r s + sqrt(1-r^2) g with
  /// r = exp(-period/slow_time). Negative where a normal deviate makes it so, as in the paper.
  double next();

private:
  DriveVariability drive_;
  double memory_ = 0.0;     // r
  double innovation_ = 0.0; // sqrt(1 - r^2), without cancellation for long memories
  double slow_ = 0.0;       // unit variance
  RandomStream fast_stream_;
  RandomStream slow_stream_;
};

} // namespace goingrate
