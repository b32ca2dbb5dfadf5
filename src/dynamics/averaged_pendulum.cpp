#include "goingrate/dynamics/averaged_pendulum.hpp"

#include "base/scaled_time.hpp"
#include "goingrate/base/errors.hpp"
#include "goingrate/clock/restoring.hpp"
#include "goingrate/dynamics/averaged2.hpp"
#include "goingrate/dynamics/moments.hpp"

#include <cmath>
#include <numbers>

namespace goingrate {

using std::numbers::pi;

bool knows_second_order(const ClockParameters& clock) {
  return clock.is_plain() || (clock.has_linear_friction() && clock.gravity_share == 1.0 &&
                              clock.escapement == Escapement::single_impulse);
}

AveragedPendulum::AveragedPendulum(const ClockParameters& clock, double velocity,
                                   AveragedOrder order)
    : order_(order), amplitude2_(velocity * velocity) {
  check_velocity(clock, velocity, "velocity");
  set_clock(clock);
}

void AveragedPendulum::set_clock(const ClockParameters& clock) {
  check(clock);
  if (order_ == AveragedOrder::second && !knows_second_order(clock))
    throw ArgumentError("method", "averaged2",
                        "constant torque or a single impulse, with linear friction and gravity "
                        "only");
  clock_ = clock;
  parts_ = action_parts(clock);
  kept_ = std::expm1(-4.0 * pi * clock.epsilon);
  kept_half_ = std::expm1(-2.0 * pi * clock.epsilon);
}

double AveragedPendulum::velocity() const { return std::sqrt(amplitude2_); }

PeriodStep AveragedPendulum::advance(double factor) {
  PeriodStep step = order_ == AveragedOrder::second ? second_order(factor)
                    : clock_.is_plain()             ? first_order(factor)
                                                    : first_order_any_law(factor);
  begun_ = factor;
  if (!std::isfinite(step.excess) || !(amplitude2_ > 0.0)) step.status = SwingStatus::stalled;
  step.half_excess = 0.5 * step.excess;
  return step;
}

double AveragedPendulum::circular(double amplitude2) const {
  return clock_.gravity_share * (order_ == AveragedOrder::first
                                     ? -amplitude2 / 16.0
                                     : circular_error(std::sqrt(amplitude2)));
}

PeriodStep AveragedPendulum::first_order(double factor) {
  const double mu = clock_.acting_torque() * factor;
  const double phi02 = clock_.phi0 * clock_.phi0;
  const double gain = 4.0 * mu * clock_.phi0 / pi; // d(lambda^2)/dt without friction
  // lambda^2 gains gain * (1 - exp(-2 eps t)) / (2 eps), which is gain * t without friction.
  const bool free = clock_.epsilon < 1e-12;
  const double limit = free ? 0.0 : gain / (2.0 * clock_.epsilon);
  const auto later = [&](double kept, double t) {
    return free ? amplitude2_ + gain * t : amplitude2_ + (amplitude2_ - limit) * kept;
  };
  const double end = later(kept_, 2.0 * pi), middle = later(kept_half_, pi);
  if (mu != 0.0 && !(std::fmin(amplitude2_, end) > phi02)) return {SwingStatus::stalled};
  const auto rate = [&](double x) {
    const double escapement = mu == 0.0 ? 0.0 : 2.0 * mu / pi * std::sqrt(x - phi02) / x;
    return circular(x) + escapement;
  };
  const double rate_at_end = rate(end);
  const double phase = (rate(amplitude2_) + 4.0 * rate(middle) + rate_at_end) * (pi / 3.0);
  PeriodStep step;
  step.excess = -phase / (1.0 + rate_at_end);
  amplitude2_ = end + (gain - 2.0 * clock_.epsilon * end) * step.excess;
  return step;
}

PeriodStep AveragedPendulum::first_order_any_law(double factor) {
  struct Slope {
    double amplitude, phase;
  };
  const auto drive_at = [&](double lambda) -> DriveMoments {
    if (!parts_) {
      const auto whole = drive_moments(clock_, lambda);
      return {factor * whole.a, factor * whole.b};
    }
    const auto before = drive_moments(parts_->before, lambda),
               after = drive_moments(parts_->after, lambda);
    return {factor * before.a + begun_ * after.a, factor * before.b + begun_ * after.b};
  };
  const auto slope = [&](double lambda) {
    const auto drive = drive_at(lambda);
    return Slope{drive.a - friction_moment(clock_, lambda),
                 circular(lambda * lambda) - drive.b / lambda};
  };
  const double h = two_pi, start = velocity();
  const Slope k1 = slope(start), k2 = slope(start + 0.5 * h * k1.amplitude),
              k3 = slope(start + 0.5 * h * k2.amplitude), k4 = slope(start + h * k3.amplitude);
  const double end =
      start + h / 6.0 * (k1.amplitude + 2.0 * (k2.amplitude + k3.amplitude) + k4.amplitude);
  if (!(end > 0.0)) return {SwingStatus::stalled};
  const Slope last = slope(end);
  PeriodStep step;
  step.excess = -h / 6.0 * (k1.phase + 2.0 * (k2.phase + k3.phase) + k4.phase) / (1.0 + last.phase);
  const double lambda = end + last.amplitude * step.excess;
  amplitude2_ = lambda * lambda;
  return step;
}

PeriodStep AveragedPendulum::second_order(double factor) {
  SecondOrderPeriod<double> period;
  if (clock_.escapement == Escapement::single_impulse) {
    if (!(amplitude2_ > clock_.impulse_angle * clock_.impulse_angle)) return {SwingStatus::stalled};
    period = second_order_impulse_period(clock_.epsilon, clock_.impulse * factor,
                                         clock_.impulse_angle, amplitude2_);
  } else {
    const double mu = clock_.acting_torque() * factor;
    // The mean of lambda^2 over the period must reach the switch; without torque there is none.
    const double mean =
        amplitude2_ + 4.0 * (mu * clock_.phi0 - 0.5 * pi * clock_.epsilon * amplitude2_);
    const double phi02 = clock_.phi0 * clock_.phi0;
    if (mu != 0.0 && !(std::fmin(mean, amplitude2_) > phi02)) return {SwingStatus::stalled};
    // Without torque any switching angle will do at which the formula is regular.
    const double phi0 = mu == 0.0 ? 0.5 * velocity() : clock_.phi0;
    period = second_order_period(clock_.epsilon, mu, phi0, amplitude2_);
  }
  amplitude2_ += period.amplitude2_change;
  PeriodStep step;
  step.excess = period.period_excess;
  return step;
}

} // namespace goingrate
