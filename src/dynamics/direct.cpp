#include "goingrate/dynamics/direct.hpp"

#include "goingrate/clock/restoring.hpp"

#include <cmath>

namespace goingrate {

DirectPendulum::DirectPendulum(const ClockParameters& clock, double velocity)
    : v2_{velocity * velocity, 0.0} {
  check_velocity(clock, velocity, "velocity");
  v2_.lo = std::fma(velocity, velocity, -v2_.hi);
  set_clock(clock);
}

void DirectPendulum::set_clock(const ClockParameters& clock) {
  check(clock);
  clock_ = clock;
  if (clock.escapement != Escapement::constant_torque) profile_ = period_profile(clock);
}

HalfSwing<double> DirectPendulum::half(bool right, double factor) const {
  const double v = velocity();
  const double mu = clock_.acting_torque() * factor;
  if (clock_.is_plain()) return half_swing(v, clock_.epsilon, mu, clock_.phi0, helping_);
  const FreePendulum<double> free{clock_.epsilon, clock_.quadratic_drag, clock_.dry_friction,
                                  clock_.gravity_share};
  if (clock_.escapement == Escapement::constant_torque)
    return half_swing(v, free, mu, clock_.phi0, helping_);
  return half_swing(v, free, right ? profile_.right : profile_.left, factor);
}

PeriodStep DirectPendulum::advance(double factor) {
  PeriodStep step;
  for (const bool right : {true, false}) {
    const auto swing = half(right, factor);
    step.status = swing.status;
    if (swing.status != SwingStatus::crossed) return step;
    v2_ += swing.speed2_change;
    // The torque that helped and did not switch, or that switched, is seen mirrored from here on.
    helping_ = swing.switched || !helping_;
    step.excess += swing.excess;
    if (right) step.half_excess = step.excess;
  }
  return step;
}

double DirectPendulum::velocity() const { return std::sqrt(v2_.value()); }

void DirectPendulum::rescale(double ratio) {
  const double v = velocity() * ratio;
  v2_ = {v * v, std::fma(v, v, -v * v)};
}

double speed_after_half(const ClockParameters& clock, double velocity, double factor) {
  return DirectPendulum(clock, velocity).speed_at_half(factor);
}

double DirectPendulum::speed_at_half(double factor) const {
  const auto swing = half(true, factor);
  if (swing.status != SwingStatus::crossed) return velocity();
  TwoPart<double> speed2 = v2_;
  speed2 += swing.speed2_change;
  return std::sqrt(speed2.value());
}

} // namespace goingrate
