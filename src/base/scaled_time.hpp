// Conversion between seconds and the paper's scaled time; nothing else converts them.
//
// The paper scales time so that the nominal small-amplitude period T0 is 2 pi:
// t_scaled = 2 pi t / T0 (Hoyng, below eq. ddt1). A rate excess psi' - 1 has no unit.
#pragma once

#include "goingrate/base/sums.hpp"

#include <numbers>

namespace goingrate {

inline constexpr double two_pi = 2.0 * std::numbers::pi;
inline constexpr double two_pi_low = 2.4492935982947064e-16; ///< 2 pi minus its nearest double
inline constexpr double seconds_per_day = 86400.0;

/// Converts between seconds and scaled time for a clock of nominal period `T0` (s, > 0).
class TimeScale {
public:
  /// For a clock of this T0, s.
  explicit constexpr TimeScale(double nominal_period_s) : nominal_period_s_(nominal_period_s) {}

  /// Exact (factor 1) when the nominal period is 2 pi, so that scaled scenarios stay scaled.
  [[nodiscard]] constexpr double seconds(double scaled) const {
    return nominal_period_s_ == two_pi ? scaled : scaled * (nominal_period_s_ / two_pi);
  }
  /// The inverse conversion, exact in the same case.
  [[nodiscard]] constexpr double scaled(double seconds) const {
    return nominal_period_s_ == two_pi ? seconds : seconds * (two_pi / nominal_period_s_);
  }

  /// T0 in seconds, and its half; 2 pi to all digits when the nominal period is 2 pi.
  [[nodiscard]] constexpr TwoPart<double> nominal() const {
    return {nominal_period_s_, nominal_period_s_ == two_pi ? two_pi_low : 0.0};
  }
  /// Half of nominal().
  [[nodiscard]] constexpr TwoPart<double> half_nominal() const {
    return {0.5 * nominal().hi, 0.5 * nominal().lo};
  }

private:
  double nominal_period_s_;
};

/// A rate excess (a fraction) in seconds gained per day.
constexpr double seconds_gained_per_day(double rate_excess) {
  return rate_excess * seconds_per_day;
}

} // namespace goingrate
