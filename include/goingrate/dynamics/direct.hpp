// Direct integration of the full equation of motion, period by period.
#pragma once

#include "goingrate/base/sums.hpp"
#include "goingrate/clock/parameters.hpp"
#include "goingrate/dynamics/period_step.hpp"
#include "goingrate/dynamics/swing_profile.hpp"

#include <cfloat>
#include <type_traits>

namespace goingrate {

/// The pendulum between upward crossings, for every clock law; v^2 is carried in two parts.
///
/// Crossing times of point C are within 1e-14 of those of 128-bit arithmetic after 2000 periods and
/// within 1e-12 after 1e5 noisy ones (DirectTest.CrossingTimesOfPointC,
/// DirectTest.CrossingTimesOfANoisyDrive); the velocity does not freeze short of the limit cycle
/// (DirectTest.LimitCycleDoesNotFreeze). About 1.3 us per period, 3 us for profiles and for
/// friction that is not linear.
class DirectPendulum {
public:
  /// Starts at an upward crossing with phi' = `velocity` (scaled, above 0 and below top_velocity,
  /// which is 2 under gravity), the torque helping. Throws ArgumentError naming the velocity or a
  /// clock parameter.
  DirectPendulum(const ClockParameters& clock, double velocity);

  /// From the present crossing on the clock has these parameters.
  void set_clock(const ClockParameters& clock);

  /// Advances one period with the torque (or the impulse) times `factor`; for an action that begins
  /// on the left (action_parts) that is the factor of the one that begins in this period. After a
  /// status other than crossed the state is spent.
  PeriodStep advance(double factor = 1.0);

  /// |phi'| at the next downward crossing, what acts until then times `factor`; velocity() if there
  /// is none. Nothing is advanced.
  [[nodiscard]] double speed_at_half(double factor) const;

  /// phi' at the last crossing, and its square to all digits.
  [[nodiscard]] double velocity() const;
  /// The square of velocity().
  [[nodiscard]] const TwoPart<double>& speed2() const { return v2_; }
  /// Restates the velocity for a nominal period changed by the factor `ratio`.
  void rescale(double ratio);

  /// Whether the escapement stands as it does in regular operation: it helps the coming swing.
  [[nodiscard]] bool is_regular() const { return helping_; }
  /// Restates v^2.
  void set_speed2(const TwoPart<double>& speed2) { v2_ = speed2; }
  /// What somebody else found one regular period, the drive times `factor`, to do to v^2.
  void add_period(double speed2_change, double factor) {
    v2_ += speed2_change;
    begun_ = factor;
  }
  /// The factor of an action that has begun and goes on in the coming period; 0 without one.
  [[nodiscard]] double begun() const { return in_parts_ ? begun_ : 0.0; }

private:
  [[nodiscard]] HalfSwing<double> half(const SwingProfile<double>& side, double factor) const;
  [[nodiscard]] SwingProfile<double> left_side(double before, double after) const;

  ClockParameters clock_;
  PeriodProfile profile_; // of escapements other than constant torque
  bool in_parts_ = false; // the action that begins in a period ends in the next (action_parts)
  PeriodProfile before_, after_; // its parts
  double begun_ = 0.0;           // its factor
  TwoPart<double> v2_;
  bool helping_ = true; // the constant torque helps the coming upward swing
};

/// The number with the most digits that the processor itself computes with: 64 bits of x86's long
/// double. Elsewhere a long double is no more than a double, or is computed by software some
/// hundred times as slowly.
#if LDBL_MANT_DIG == 64
using Wide = long double;
#else
using Wide = double;
#endif

/// One regular period from v^2: what the return map is made of.
template <class T> struct RegularPeriod {
  bool regular = false; ///< it crossed twice, and a torque that acts was switched both times
  T speed2_change{}, half_excess{}, excess{};
};
/// That period from `speed2` = v^2, the drive times `factor`. T is double or Wide; on x86 a double
/// is some three times as fast.
template <class T>
RegularPeriod<T> regular_period(const ClockParameters& clock, std::type_identity_t<T> speed2,
                                std::type_identity_t<T> factor);

/// |phi'| at the downward crossing that follows an upward one of `velocity` in regular operation,
/// the drive times `factor`; `velocity` itself where there is none
/// (DirectTest.SpeedAfterHalfAPeriod).
double speed_after_half(const ClockParameters& clock, double velocity, double factor);

} // namespace goingrate
