// Half a swing of the pendulum, from one passage through the vertical to the next, to rounding.
//
// Problem. phi'' + 2 eps phi' + sin phi = m (Hoyng, eq. ddt1), with the constant-torque escapement:
// a torque that helps the motion until the pendulum rises through phi0, then opposes it, and is
// kept until the mirrored switch in the other half swing. A swing to the left is the mirror image
// of a swing to the right, so one canonical case is enough: phi = 0, phi' = v > 0. Other laws of
// torque and friction (swing_laws.hpp) come as a list of angles to stop at and the force between
// them.
//
// Method. Harmonic motion with slowly varying a and b,
//   phi = a cos theta - b sin theta,  phi' = -a sin theta - b cos theta,  theta = t - pi,
// which starts at theta = -pi with a = 0, b = v. A Taylor step (swing_series.hpp) gives what the
// forces add, delta and delta', and with them a += delta cos - delta' sin, b -= delta sin + delta'
// cos at the new theta. At the passage phi = 0 and theta is the duration minus pi; v'^2 = a^2 +
// b^2. Neither is ever the small difference of large numbers: rounding is of the order 1e-16 of the
// forces, not of the motion. Stops are roots of the series, found by Newton steps.
//
// Degenerate cases, each a status: the escapement is not reached (no switch; the torque stays and
// opposes the next half swing), the pendulum does not come back through the vertical (stalled), it
// reaches pi and the angle at which nothing pulls it back (overturned). Grazing the switch (apex
// within rounding of phi0) is decided by the apex: switch if apex > phi0.
#pragma once

#include "goingrate/base/sums.hpp"
#include "goingrate/clock/restoring.hpp"
#include "goingrate/dynamics/swing_laws.hpp"
#include "goingrate/dynamics/swing_series.hpp"
#include "goingrate/dynamics/swing_status.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <boost/math/constants/constants.hpp>

namespace goingrate {

/// The result of a half swing, all in scaled time.
template <class T> struct HalfSwing {
  SwingStatus status = SwingStatus::crossed;
  T excess{};            ///< time between the two passages minus pi
  T speed2_change{};     ///< square of |phi'| at the second passage minus that at the first
  T apex{};              ///< largest angle in between, rad; found by laws that stop there, else 0
  bool switched = false; ///< the escapement switched in this half swing
};

/// One half swing under a law; use through half_swing().
///
/// `Law` offers force() (constant until the next stop), has_stop()/stop() (the next angle ahead, in
/// the present direction, at which the law changes; falling stops are above 0), pass() (the stop
/// is reached: the law changes and returns the energy of a kick), turn(phi) (the apex is reached),
/// held(phi) (the pendulum at rest there stays there).
template <class T, class Law> class HalfSwingRun {
public:
  /// Starts at the vertical with speed `v` > 0.
  HalfSwingRun(const T& v, Law law) : law_(std::move(law)), v_(v), w_(v) {}

  /// Runs it to the next passage or to what prevents that; once.
  [[nodiscard]] HalfSwing<T> run() {
    // A stop takes a step or two, a half swing some five; far more is a torque beyond all measure.
    constexpr int most_steps = 100000;
    for (int i = 0; i < most_steps && !done_; ++i)
      step();
    if (!done_) result_.status = SwingStatus::not_finite;
    result_.switched = law_.switched();
    return result_;
  }

private:
  using Series = SwingSeries<T, Law::any_law>;
  static inline const T pi = boost::math::constants::pi<T>();

  struct Ahead { // the state at the end of a step that may be taken
    T phi, w, a, b_gain, cosine, sine;
    TwoPart<T> theta;
  };

  void end(SwingStatus status) {
    result_.status = status;
    done_ = true;
  }

  // Where theta and the angles of the rotation will be after t.
  [[nodiscard]] Ahead turn_by(const T& t) const {
    using std::cos, std::sin;
    Ahead to;
    to.theta = theta_;
    to.theta += t;
    const T theta = to.theta.value();
    to.cosine = cos(theta);
    to.sine = sin(theta);
    return to;
  }

  void fill(Ahead& to, const Series& series, const T& t) const {
    const auto delta = series.deviation(t);
    to.a = a_ + (delta.angle * to.cosine - delta.speed * to.sine);
    to.b_gain = b_gain_ - (delta.angle * to.sine + delta.speed * to.cosine);
    const T b = v_ + to.b_gain;
    to.phi = to.a * to.cosine - b * to.sine;
    to.w = -to.a * to.sine - b * to.cosine;
  }

  [[nodiscard]] Ahead look(const Series& series, const T& t) const {
    Ahead to = turn_by(t);
    fill(to, series, t);
    return to;
  }

  void go(const Series& series, const T& t, const Ahead& to) {
    // The work of friction, where gravity moves a and b so much more than friction does that the
    // rounding of the one would drown the other.
    if constexpr (!Law::any_law)
      if (wide()) friction_ += series.friction_integral(t);
    theta_ = to.theta;
    a_ = to.a;
    b_gain_ = to.b_gain;
    phi_ = to.phi;
    w_ = to.w;
  }
  [[nodiscard]] bool wide() const { return v_ * v_ > 300 * law_.force().linear; }

  [[nodiscard]] bool passes_top(const T& phi) const {
    if (phi < pi) return false;
    if constexpr (!Law::any_law)
      return true;
    else
      return phi >= std::max(pi, T(top_angle(static_cast<double>(law_.force().gravity))));
  }

  void step() {
    using std::isfinite;
    Ahead to = turn_by(Series::step_length(rung_)); // while the series is being found
    const int rung_before = rung_;
    const Series series(phi_, w_, law_.force());
    find_rung(series);
    if (rung_ == Series::rungs) return end(SwingStatus::not_finite);
    const T& reach = Series::step_length(rung_);
    if (rising_ && law_.has_stop() && try_stop(series, reach)) return;
    if (!Law::stops_at_apex && !law_.has_stop() && try_passage(series, reach)) return;
    if (rung_ != rung_before) to = turn_by(reach);
    fill(to, series, reach);
    if (!isfinite(to.phi + to.w)) return end(SwingStatus::not_finite);
    rising_ ? step_up(series, reach, to) : step_down(series, reach, to);
  }

  // The longest step that the series allows, or one rung below: no to and fro.
  void find_rung(const Series& series) {
    const auto reaches = [&](int i) {
      if constexpr (Law::any_law) return series.reaches(i);
      return wide() ? series.reaches_with_work(i) : series.reaches(i);
    };
    if (rung_ > 1 && reaches(rung_ - 2))
      for (rung_ -= 2; rung_ > 0 && reaches(rung_ - 1);)
        --rung_;
    while (rung_ < Series::rungs && !reaches(rung_))
      ++rung_;
  }

  void step_up(const Series& series, const T& reach, const Ahead& to) {
    const bool turns = to.w <= 0;
    if (law_.has_stop() || (turns && Law::stops_at_apex)) {
      const T apex_time = turns ? time_of_turn(series, reach, false) : reach;
      if (law_.has_stop() && (turns ? series.angle(apex_time) : to.phi) > law_.stop())
        return pass_stop(series, root_of_stop(series, T(0), apex_time));
      if (turns && Law::stops_at_apex) return turn(series, apex_time);
      // The torque that was not switched stays; what is ahead now is the passage.
      if (turns) law_.turn(to.phi);
    }
    rising_ = !turns;
    if (turns && to.phi <= 0) return pass_vertical(series, root_of_passage(series, T(0), reach));
    if (passes_top(to.phi)) return end(SwingStatus::overturned);
    go(series, reach, to);
  }

  void step_down(const Series& series, const T& reach, const Ahead& to) {
    // A weak swing may dip through the vertical and turn back within the step.
    const bool turns = to.w >= 0;
    const T lowest_time = turns ? time_of_turn(series, reach, true) : reach;
    const T lowest = turns ? series.angle(lowest_time) : to.phi;
    if constexpr (Law::stops_at_apex) {
      if (law_.has_stop() && lowest <= law_.stop())
        return pass_stop(series, root_of_stop(series, T(0), lowest_time));
    }
    if (lowest <= 0) return pass_vertical(series, root_of_passage(series, T(0), lowest_time));
    if (turns) return end(SwingStatus::stalled);
    go(series, reach, to);
  }

  // Harmonic motion on from here reaches the stop, or the vertical, with a known velocity; the
  // deviation there gives a Newton step (with the curvature for the stop), and refine() one more.
  // False if that is not to be trusted: near the apex, or beyond the step.
  bool try_stop(const Series& series, const T& reach) {
    using std::abs, std::asin, std::sqrt;
    const T amplitude = sqrt(phi_ * phi_ + w_ * w_);
    const T& stop = law_.stop();
    if (!(stop < amplitude * T(0.98))) return false;
    const T guess = asin(T(stop / amplitude)) - (phi_ == 0 ? T(0) : asin(T(phi_ / amplitude)));
    if (!(guess > 0 && guess < reach)) return false;
    const auto delta = series.deviation(guess);
    const T w = sqrt((amplitude - stop) * (amplitude + stop)) + delta.speed;
    const T newton = -delta.angle / w;
    const T t = guess + newton * (1 + newton * stop / (2 * w));
    // The cube of the step is left to refine(), which squares it: 1e-20.
    if (!(abs(newton) < T(5e-4) && t > 0 && t < reach)) return false;
    pass_stop(series, t);
    return true;
  }

  bool try_passage(const Series& series, const T& reach) {
    using std::abs, std::atan, std::sqrt;
    if (!(w_ < v_ * T(-0.25))) return false;
    const T b = v_ + b_gain_;
    const T guess = atan(T(a_ / b)) - theta_.value();
    if (!(guess > 0 && guess < reach)) return false;
    const auto delta = series.deviation(guess);
    const T newton = delta.angle / (sqrt(a_ * a_ + b * b) - delta.speed);
    const T t = guess + newton;
    // Gravity does not bend the motion here: what is left is the square of the step by F/w.
    const T bend = law_.force().at(T(0), w_, T(0)) / w_;
    if (!(abs(newton) < T(0.01) && abs(newton * newton * bend) < T(1e-9) && t > 0 && t < reach))
      return false;
    pass_vertical(series, t);
    return true;
  }

  void turn(const Series& series, const T& t) {
    Ahead to = look(series, t);
    w_ = T(0);
    result_.apex = to.phi;
    go(series, t, to);
    law_.turn(phi_);
    rising_ = false;
    if (law_.held(phi_)) end(SwingStatus::stalled);
  }

  // The root is good to half the digits at least; the rest is one Newton step in theta, with the
  // change of a and b over it.
  Ahead refine(const Series& series, const T& t, const T& target) {
    Ahead to = look(series, t);
    const T force = law_.force().at(target, to.w, detail::sine_defects(target).g);
    const T dt = (target - to.phi) / to.w;
    friction_ += to.w * to.w * dt; // go() adds what comes before
    to.theta += dt;
    to.a -= force * dt * to.sine;
    to.b_gain -= force * dt * to.cosine;
    to.w += dt * (force - to.phi);
    to.phi = target;
    return to;
  }

  void pass_stop(const Series& series, const T& t) {
    using std::sqrt;
    go(series, t, refine(series, t, law_.stop()));
    const T energy = law_.pass();
    if (energy == 0) return;
    const T kicked = sqrt(w_ * w_ + 2 * energy);
    const T gain = 2 * energy / (kicked + (w_ > 0 ? w_ : T(-w_))) * (w_ > 0 ? T(1) : T(-1));
    const Ahead here = look_here();
    a_ -= gain * here.sine;
    b_gain_ -= gain * here.cosine;
    w_ += gain;
  }
  [[nodiscard]] Ahead look_here() const {
    using std::cos, std::sin;
    Ahead here;
    here.cosine = cos(theta_.value());
    here.sine = sin(theta_.value());
    return here;
  }

  void pass_vertical(const Series& series, const T& t) {
    const Ahead to = refine(series, t, T(0));
    go(series, t, to);
    result_.excess = theta_.value();
    result_.speed2_change = a_ * a_ + b_gain_ * (2 * v_ + b_gain_);
    if constexpr (!Law::any_law)
      if (wide()) result_.speed2_change = law_.work() - 2 * law_.force().linear * friction_.value();
    end(SwingStatus::crossed);
  }

  // ---- roots --------------------------------------------------------------------------------

  [[nodiscard]] T root_of_stop(const Series& series, const T& low, const T& high) const {
    return root_of_stop(series, low, high, (law_.stop() - phi_) / w_);
  }
  [[nodiscard]] T root_of_stop(const Series& series, const T& low, const T& high,
                               const T& guess) const {
    return root([&](const T& t) { return series.angle(t) - law_.stop(); },
                [&](const T& t) { return series.speed(t); }, rising_, guess, low, high);
  }
  [[nodiscard]] T root_of_passage(const Series& series, const T& low, const T& high) const {
    return root([&](const T& t) { return series.angle(t); },
                [&](const T& t) { return series.speed(t); }, false, high, low, high);
  }
  // The time at which w passes zero, upwards if `rising`.
  [[nodiscard]] T time_of_turn(const Series& series, const T& high, bool rising) const {
    return root([&](const T& t) { return series.speed(t); },
                [&](const T& t) {
                  const T phi = series.angle(t), w = series.speed(t);
                  return law_.force().at(phi, w, detail::sine_defects(phi).g) - phi;
                },
                rising, high / 2, T(0), high);
  }

  // Newton steps from `t`, kept inside a bracket that is halved whenever Newton leaves it.
  template <class Value, class Slope>
  static T root(Value value, Slope slope, bool rising, T t, T low, T high) {
    using std::abs, std::sqrt;
    // After a Newton step of this length the next would be shorter than rounding.
    static const T enough = T(sqrt(std::numeric_limits<T>::epsilon()) / 16);
    if (!(t > low && t < high)) t = low + (high - low) / 2;
    for (int i = 0; i < 200; ++i) {
      const T at = value(t);
      ((at > 0) == rising ? high : low) = t;
      const T newton = at / slope(t);
      const T next = t - newton;
      if (next >= low && next <= high) {
        t = next;
        if (abs(newton) <= enough) break;
      } else {
        t = low + (high - low) / 2;
        if (high - low <= std::numeric_limits<T>::epsilon() * abs(t)) break;
      }
    }
    return t;
  }

  Law law_;
  T v_;         // at the start
  T phi_{}, w_; // now
  T a_{};
  T b_gain_{}; // b - v
  TwoPart<T> theta_{-pi, pi_low()};
  TwoPart<T> friction_;
  bool rising_ = true;
  int rung_ = 3; // a good guess for a clock's amplitude
  bool done_ = false;
  HalfSwing<T> result_;

  // -pi minus its nearest T.
  static T pi_low() {
    if constexpr (std::numeric_limits<T>::digits == 53)
      return T(-1.2246467991473532e-16);
    else
      return T(0);
  }
};

/// Follows the pendulum from (phi = 0, phi' = v > 0) to its next passage through phi = 0, with
/// linear friction and constant torque.
///
/// `mu` any torque (a negative one too), `phi0` the switching angle, `helping` as in
/// ConstantTorqueSwing. Accuracy: excess and speed2_change to a few roundings of the forces for v
/// up to 1.9 (HalfSwingTest); about 0.6 us for double.
template <class T> HalfSwing<T> half_swing(T v, T eps, T mu, T phi0, bool helping) {
  using Law = ConstantTorqueSwing<T, true>;
  return HalfSwingRun<T, Law>(v, Law({eps, T(0), T(0), T(1)}, mu, phi0, helping)).run();
}

/// The same with quadratic and dry friction too, and any restoring torque.
template <class T>
HalfSwing<T> half_swing(T v, const FreePendulum<T>& free, T mu, T phi0, bool helping) {
  using Law = ConstantTorqueSwing<T, false>;
  return HalfSwingRun<T, Law>(v, Law(free, mu, phi0, helping)).run();
}

/// The same with the torque of a profile times `factor`.
template <class T>
HalfSwing<T> half_swing(T v, const FreePendulum<T>& free, const SwingProfile<T>& profile,
                        T factor) {
  using std::sqrt;
  const T kick = profile.kick_at_start * factor;
  const T kicked = kick == 0 ? v : T(sqrt(v * v + 2 * kick));
  auto swing =
      HalfSwingRun<T, ProfileSwing<T>>(kicked, ProfileSwing<T>(free, profile, factor)).run();
  swing.speed2_change += 2 * kick;
  return swing;
}

} // namespace goingrate
