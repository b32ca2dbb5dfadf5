// Variation of the driving torque from period to period.
#pragma once

#include "goingrate/base/random.hpp"

#include <cstdint>
#include <memory>
#include <vector>

namespace goingrate {

/// Variability of the drive relative to mu. The factor is renewed at every upward crossing
/// (Hoyng, eq. dmu) and constant in between.
struct DriveVariability {
  double fast_rms = 0.0;    ///< white from period to period; 0 to 100
  double slow_rms = 0.0;    ///< rms of a stationary Ornstein-Uhlenbeck process; 0 to 100
  double slow_time_s = 0.0; ///< its correlation time, s; > 0 if slow_rms > 0

  /// amplitude * sin(2 pi t / period), with t the time of the crossing.
  struct Sine {
    double amplitude; ///< relative; -100 to 100
    double period_s;  ///< > 0
    friend bool operator==(const Sine&, const Sine&) = default;
  };
  std::vector<Sine> sines{};

  /// One factor per period, in place of 1 and the random parts; sines are added to it.
  std::shared_ptr<const std::vector<double>> series{};

  /// Whether the factor is 1 in every period.
  [[nodiscard]] bool is_steady() const {
    return fast_rms == 0.0 && slow_rms == 0.0 && sines.empty() && !series;
  }
};

/// Throws ArgumentError naming the first value outside the ranges given above.
void check(const DriveVariability& drive);

/// The factor of the drive for each period in turn: 1 + fast + slow + sines, reproducible by seed.
class DriveSequence {
public:
  /// `period_s` is the step of the slow process: the time between renewals (T0).
  DriveSequence(const DriveVariability& drive, double period_s, std::uint64_t seed);

  /// The factor for the next period. Exact in law for the slow part: s' = r s + sqrt(1-r^2) g with
  /// r = exp(-period/slow_time). Negative where a normal deviate makes it so, as in the paper.
  /// `time_s`: when the period begins. Throws ArgumentError if a series has no factor left.
  double next(double time_s) {
    double factor = unusual_ ? unusual(time_s) : 1.0;
    if (drive_.fast_rms > 0.0) factor += drive_.fast_rms * fast_stream_.normal();
    if (drive_.slow_rms > 0.0) {
      factor += drive_.slow_rms * slow_;
      slow_ = memory_ * slow_ + innovation_ * slow_stream_.normal();
    }
    return factor;
  }

private:
  double unusual(double time_s); // the series' factor, or 1, and the sines

  DriveVariability drive_;
  double memory_ = 0.0;     // r
  double innovation_ = 0.0; // sqrt(1 - r^2), without cancellation for long memories
  double slow_ = 0.0;       // unit variance
  std::size_t used_ = 0;    // factors of the series
  bool unusual_ = false;    // there is a series or a sine
  RandomStream fast_stream_;
  RandomStream slow_stream_;
};

} // namespace goingrate
