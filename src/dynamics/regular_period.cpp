// One period of an undisturbed clock, computed in double or in Wide.
#include "goingrate/dynamics/direct.hpp"

#include <cmath>

namespace goingrate {

namespace {

template <class T> SwingProfile<T> converted(const SwingProfile<double>& from) {
  SwingProfile<T> to{from.kick_at_start, {}, {}};
  for (const auto& s : from.rise)
    to.rise.push_back({s.until, s.constant, s.slope, s.kick});
  for (const auto& s : from.fall)
    to.fall.push_back({s.until, s.constant, s.slope, s.kick});
  return to;
}

} // namespace

template <class T>
RegularPeriod<T> regular_period(const ClockParameters& clock, std::type_identity_t<T> speed2,
                                std::type_identity_t<T> factor) {
  const FreePendulum<T> free{clock.epsilon, clock.quadratic_drag, clock.dry_friction,
                             clock.gravity_share};
  const T mu = clock.acting_torque() * factor;
  const bool tabulated =
      clock.escapement == Escapement::profile || clock.escapement == Escapement::single_impulse;
  const PeriodProfile profile = tabulated ? period_profile(clock) : PeriodProfile{};
  RegularPeriod<T> period;
  for (const bool right : {true, false}) {
    const T v = std::sqrt(speed2 + period.speed2_change);
    HalfSwing<T> swing;
    if (tabulated)
      swing = half_swing(v, free, converted<T>(right ? profile.right : profile.left), factor);
    else if (clock.is_plain())
      swing = half_swing<T>(v, clock.epsilon, mu, clock.phi0, true);
    else
      swing = half_swing<T>(v, free, mu, clock.phi0, true);
    const bool switches = tabulated || mu == 0 || swing.switched;
    if (swing.status != SwingStatus::crossed || !switches) return {};
    period.speed2_change += swing.speed2_change;
    period.excess += swing.excess;
    if (right) period.half_excess = period.excess;
  }
  period.regular = true;
  return period;
}

template RegularPeriod<double> regular_period<double>(const ClockParameters&, double, double);
#if LDBL_MANT_DIG == 64 // otherwise Wide is double
template RegularPeriod<Wide> regular_period<Wide>(const ClockParameters&, Wide, Wide);
#endif

} // namespace goingrate
