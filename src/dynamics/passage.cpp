#include "dynamics/passage.hpp"

#include "goingrate/clock/restoring.hpp"

#include <algorithm>
#include <array>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#include <cmath>
#include <limits>
#include <vector>

namespace goingrate {

namespace {

// Angles are counted along the motion: x = phi while phi rises, -phi while it falls.
class ForwardMotion {
public:
  ForwardMotion(const ClockParameters& clock, bool rising, double factor)
      : clock_(clock), rising_(rising), factor_(factor) {}

  // The part of x'' that is due to the escapement.
  [[nodiscard]] double torque(double x) const {
    switch (clock_.escapement) {
    case Escapement::constant_torque: // pushes until the switch, then holds back
      return (x < clock_.phi0 ? clock_.mu : -clock_.mu) * factor_;
    case Escapement::profile:
      return rising_ ? factor_ * at(clock_.rising, x) : -factor_ * at(clock_.falling, -x);
    case Escapement::single_impulse:
    case Escapement::none:
      break;
    }
    return 0.0;
  }

  // The jump of phi'^2/2 on passing x, from a single impulse there.
  [[nodiscard]] double jump(double x) const {
    const bool here =
        clock_.escapement == Escapement::single_impulse && rising_ && x == clock_.impulse_angle;
    return here ? clock_.impulse * factor_ : 0.0;
  }

  // (1 - s) x + s sin x
  [[nodiscard]] double restoring(double x) const {
    return x - clock_.gravity_share * (x - std::sin(x));
  }

  [[nodiscard]] double friction(double speed) const {
    return (2.0 * clock_.epsilon + clock_.quadratic_drag * speed) * speed + clock_.dry_friction;
  }

  // Angles between 0 and x at which a force jumps, in order from 0.
  [[nodiscard]] std::vector<double> breaks_before(double x) const {
    std::vector<double> all;
    if (clock_.escapement == Escapement::constant_torque) all.push_back(clock_.phi0);
    if (clock_.escapement == Escapement::single_impulse && rising_)
      all.push_back(clock_.impulse_angle);
    if (clock_.escapement == Escapement::profile)
      for (const auto& point : (rising_ ? clock_.rising : clock_.falling).points)
        all.push_back(rising_ ? point.angle : -point.angle);
    std::erase_if(
        all, [x](double place) { return !(place * x > 0.0 && std::abs(place) < std::abs(x)); });
    std::sort(all.begin(), all.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
    return all;
  }

private:
  static double at(const TorqueTable& table, double angle) {
    const auto& points = table.points;
    if (points.empty() || angle < points.front().angle || angle > points.back().angle) return 0.0;
    const auto next = std::lower_bound(
        points.begin() + 1, points.end() - 1, angle,
        [](const TorqueTable::Point& point, double value) { return point.angle < value; });
    const auto& a = *(next - 1);
    const auto& b = *next;
    return a.torque + (b.torque - a.torque) * (angle - a.angle) / (b.angle - a.angle);
  }

  const ClockParameters& clock_;
  bool rising_;
  double factor_;
};

using State = std::array<double, 2>; // x'^2/2 and time

// Integrates from x to `to`, a stretch without jumps of the forces; false if the pendulum turns
// back before it. The variable of integration is psi with x = reach sin psi, in which the motion is
// smooth up to the turning point.
bool move(const ForwardMotion& motion, State& state, double x, double to, double reach) {
  const double begin = std::asin(x / reach), end = std::asin(to / reach);
  constexpr double step = 0.1; // rad of psi: the 8th-order formula is then good to 1e-14
  const int steps = 1 + static_cast<int>(std::abs(end - begin) / step);
  const double h = (end - begin) / steps;
  // At the ends of the stretch the forces are the limits from inside it.
  const double low = std::min(x, to), high = std::max(x, to);
  const double inside = 1e-12 * (high - low);
  boost::numeric::odeint::runge_kutta_fehlberg78<State> formula;
  for (int i = 0; i < steps; ++i) {
    State next;
    formula.do_step(
        [&](const State& s, State& slope, double psi) {
          const double angle = reach * std::sin(psi);
          const double along = reach * std::cos(psi); // dx/dpsi
          const double speed = std::sqrt(2.0 * s[0]);
          const double place = std::clamp(angle, low + inside, high - inside);
          slope = {along *
                       (motion.torque(place) - motion.friction(speed) - motion.restoring(angle)),
                   along / speed};
        },
        state, begin + i * h, next, h);
    if (!(next[0] > 0.0)) return false;
    state = next;
  }
  return true;
}

} // namespace

double time_from_vertical(const ClockParameters& clock, double speed, bool rising, double factor,
                          double angle) {
  if (angle == 0.0) return 0.0;
  const ForwardMotion motion(clock, rising, factor);
  const double end = rising ? angle : -angle;
  const double reach = turning_angle_of_velocity(
      clock.gravity_share, std::min(speed, top_velocity(clock.gravity_share)));
  if (!(std::abs(end) < reach)) return std::numeric_limits<double>::quiet_NaN();
  State state{0.5 * speed * speed, 0.0};
  double x = 0.0;
  for (const double place : motion.breaks_before(end)) {
    if (!move(motion, state, x, place, reach)) return std::numeric_limits<double>::quiet_NaN();
    state[0] += std::copysign(motion.jump(place), end); // integrating backwards removes it
    x = place;
  }
  if (!(state[0] > 0.0) || !move(motion, state, x, end, reach))
    return std::numeric_limits<double>::quiet_NaN();
  return state[1];
}

} // namespace goingrate
