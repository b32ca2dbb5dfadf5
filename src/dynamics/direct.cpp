#include "goingrate/dynamics/direct.hpp"

#include "goingrate/clock/restoring.hpp"
#include "goingrate/dynamics/intermittent.hpp"

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
  const auto parts = action_parts(clock);
  in_parts_ = parts.has_value();
  if (!parts) return;
  before_ = period_profile(parts->before);
  after_ = period_profile(parts->after);
}

HalfSwing<double> DirectPendulum::half(const SwingProfile<double>& side, double factor) const {
  const double v = velocity();
  const double mu = clock_.acting_torque() * factor;
  if (clock_.is_plain()) return half_swing(v, clock_.epsilon, mu, clock_.phi0, helping_);
  const FreePendulum<double> free{clock_.epsilon, clock_.quadratic_drag, clock_.dry_friction,
                                  clock_.gravity_share};
  if (clock_.escapement == Escapement::constant_torque)
    return half_swing(v, free, mu, clock_.phi0, helping_);
  return half_swing(v, free, side, factor);
}

// The swing to the left, where one action ends and the next may begin.
SwingProfile<double> DirectPendulum::left_side(double before, double after) const {
  SwingProfile<double> left{0.0, after_.left.rise, before_.left.fall};
  const auto times = [](auto& stretches, double factor) {
    for (auto& stretch : stretches) {
      stretch.constant *= factor;
      stretch.slope *= factor;
    }
  };
  times(left.rise, after);
  times(left.fall, before);
  return left;
}

PeriodStep DirectPendulum::advance(double factor) {
  PeriodStep step;
  const double under_way = in_parts_ ? begun_ : factor;
  begun_ = factor;
  for (const bool right : {true, false}) {
    const auto swing = right       ? half(profile_.right, under_way)
                       : in_parts_ ? half(left_side(factor, under_way), 1.0)
                                   : half(profile_.left, factor);
    step.status = swing.status;
    if (swing.status != SwingStatus::crossed) return step;
    v2_ += swing.speed2_change;
    // The next half swing sees the torque mirrored: a torque that has switched helps, and one that
    // has not changes from helping to hindering or back.
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
  const auto swing = half(profile_.right, factor);
  if (swing.status != SwingStatus::crossed) return velocity();
  TwoPart<double> speed2 = v2_;
  speed2 += swing.speed2_change;
  return std::sqrt(speed2.value());
}

} // namespace goingrate
