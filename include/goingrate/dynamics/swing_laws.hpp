// Laws of torque and friction as half_swing() runs the pendulum by them: the force until the next
// angle at which it changes.
#pragma once

#include "goingrate/dynamics/swing_series.hpp"

#include <cstddef>
#include <vector>

namespace goingrate {

/// The pendulum without its escapement, as half_swing sees it: friction that is linear, quadratic
/// and dry together, and gravity's share of the restoring torque.
template <class T> struct FreePendulum { T epsilon{}, quadratic{}, dry{}, gravity_share{1}; };

/// The constant torque as half_swing sees it: +mu until phi0, then -mu, or -mu all the way.
/// `linear_only` promises that friction is and that gravity acts alone.
template <class T, bool linear_only> class ConstantTorqueSwing {
public:
  static constexpr bool any_law = !linear_only;
  static constexpr bool stops_at_apex = !linear_only; // where other friction changes its sign

  /// `helping`: the torque acts along the motion and switches at phi0; otherwise it opposes it all
  /// the way, as after a switch that was missed.
  ConstantTorqueSwing(const FreePendulum<T>& free, const T& mu, const T& phi0, bool helping)
      : force_{(helping ? mu : T(-mu)) - free.dry, T(0), 2 * free.epsilon, free.quadratic,
               free.gravity_share},
        mu_(mu), phi0_(phi0), dry_(free.dry), to_switch_(helping && phi0 > 0) {}

  /// Until the next stop.
  [[nodiscard]] const SwingForce<T>& force() const { return force_; }
  /// Whether the law changes at an angle ahead.
  [[nodiscard]] bool has_stop() const { return to_switch_; }
  /// That angle.
  [[nodiscard]] const T& stop() const { return phi0_; }
  /// The stop is reached: returns the energy of a kick there.
  T pass() {
    force_.constant -= 2 * mu_;
    to_switch_ = false;
    switched_ = true;
    return T(0);
  }
  /// The apex is reached.
  void turn(const T&) {
    to_switch_ = false;
    force_.constant += 2 * dry_;
    force_.quadratic = -force_.quadratic;
  }
  /// Whether the pendulum at rest there stays there.
  [[nodiscard]] bool held(const T& phi) const {
    // constant holds +dry here
    return dry_ > 0 && force_.at(phi, T(0), detail::sine_defects(phi).g) >= phi;
  }
  /// Whether the escapement did.
  [[nodiscard]] bool switched() const { return switched_; }
  /// The change of v^2 that the torque alone makes over the half swing.
  [[nodiscard]] T work() const { return switched_ ? T(4 * mu_ * phi0_) : T(0); }

private:
  SwingForce<T> force_;
  T mu_, phi0_, dry_;
  bool to_switch_;
  bool switched_ = false;
};

/// Stretches of torque that is linear in the angle, as met in a half swing to the right: those of
/// the rise from the vertical upwards, those of the fall from the top downwards.
template <class T> struct SwingStretch {
  T until{};             ///< where it ends; of the last one, beyond reach (rise) or 0 (fall)
  T constant{}, slope{}; ///< torque = constant + slope phi
  T kick{};              ///< energy of an impulse at its end
};
/// The torque of a half swing to the right, and the energy of an impulse right at its start.
template <class T> struct SwingProfile {
  T kick_at_start{};
  std::vector<SwingStretch<T>> rise, fall;
};

/// A half swing under a SwingProfile times `factor`.
template <class T> class ProfileSwing {
public:
  static constexpr bool any_law = true;
  static constexpr bool stops_at_apex = true;

  /// `profile` must outlive the swing.
  ProfileSwing(const FreePendulum<T>& free, const SwingProfile<T>& profile, const T& factor)
      : free_(free), profile_(&profile), factor_(factor) {
    set_force();
  }

  /// Until the next stop.
  [[nodiscard]] const SwingForce<T>& force() const { return force_; }
  /// Whether the law changes at an angle ahead.
  [[nodiscard]] bool has_stop() const { return at_ + 1 < side().size(); }
  /// That angle.
  [[nodiscard]] const T& stop() const { return side()[at_].until; }
  /// The stop is reached: returns the energy of a kick there.
  T pass() {
    const T energy = side()[at_].kick * factor_;
    ++at_;
    set_force();
    return energy;
  }
  /// The apex is reached.
  void turn(const T& phi) {
    rising_ = false;
    at_ = 0;
    while (has_stop() && stop() >= phi)
      ++at_;
    set_force();
  }
  /// Whether the pendulum at rest there stays there.
  [[nodiscard]] bool held(const T& phi) const {
    return free_.dry > 0 && force_.at(phi, T(0), detail::sine_defects(phi).g) >= phi;
  }
  /// Whether the escapement did.
  [[nodiscard]] bool switched() const { return true; }

private:
  [[nodiscard]] const std::vector<SwingStretch<T>>& side() const {
    return rising_ ? profile_->rise : profile_->fall;
  }
  void set_force() {
    const T sign = rising_ ? T(1) : T(-1);
    const SwingStretch<T>& stretch = side()[at_];
    force_ = {stretch.constant * factor_ - sign * free_.dry, stretch.slope * factor_,
              2 * free_.epsilon, sign * free_.quadratic, free_.gravity_share};
  }

  FreePendulum<T> free_;
  const SwingProfile<T>* profile_;
  T factor_;
  SwingForce<T> force_;
  std::size_t at_ = 0;
  bool rising_ = true;
};

} // namespace goingrate
