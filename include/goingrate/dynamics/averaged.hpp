// The averaged equations of first order, solved in closed form.
//
// Equations (Hoyng, eqs. dotl4 and dotpsi4), x = lambda^2, scaled time:
//   dx/dt    = -2 eps x + 4 mu phi0 / pi
//   psi' - 1 = -s x/16 + (2 mu / pi) sqrt(x - phi0^2) / x
// with s = 1 under gravity (gravity_share).
// While eps, mu and phi0 are constant,
//   x(t) = X + (x0 - X) exp(-2 eps t),  X = 2 mu phi0 / (pi eps)           (cf. eq. l2jump),
// and both integrals of psi' - 1 close. With y = sqrt(x - phi0^2), dt = -y dy/(eps (y^2 - b)),
// b = X - phi0^2, and 2 mu/pi = eps X/phi0:
//   int x dt            = X t + (x0 - X) (1 - exp(-2 eps t)) / (2 eps)
//   (2 mu/pi) int y/x dt = -[atan(y/phi0) - c log(y + c phi0)]_y0^y + c eps t,  c = sqrt(b)/phi0,
// if b > 0, and if not, when the drive is too weak to keep the clock going,
//   (2 mu/pi) int y/x dt = -[atan(y/phi0) - c atan(y/(c phi0))]_y0^y,           c = sqrt(-b)/phi0.
// The term log|y - sqrt b| of the textbook integral, singular in stationary operation, was replaced
// by log|x - X| - log(y + sqrt b), whose first part is -2 eps t.
//
// lambda is the cycle average of the amplitude sqrt(phi^2 + phi'^2), not its value at a crossing.
#pragma once

#include <cmath>
#include <numbers>

namespace goingrate {

/// The averaged motion while the parameters are constant; T is double or an automatic derivative.
///
/// Domain: epsilon > 0, mu any sign, phi0 > 0, and lambda > phi0 all the while (see in_domain).
/// Accuracy: against step-by-step integration of the same equations 2e-13 in phase over one
/// relaxation time, the oracle's own rounding (AveragedTest.ClosedFormMatchesIntegration). The
/// error of the equations themselves, compared with the full pendulum, is measured by
/// StationaryTest and AveragedTest.
template <class T> class AveragedMotion {
public:
  /// `amplitude2_start` is lambda^2 (rad^2) at t = 0, `circular` is s/16.
  AveragedMotion(const T& epsilon, const T& mu, const T& phi0, const T& amplitude2_start,
                 const T& circular = T(1.0 / 16.0))
      : epsilon_(epsilon), torque_(mu * (2.0 / std::numbers::pi)), a_(phi0 * phi0),
        limit_(torque_ * phi0 / epsilon), start_(amplitude2_start), way_(start_ - limit_),
        way_per_decay_(way_ / (epsilon * 2.0)), per_phi0_(1.0 / phi0), circular_(circular) {
    using std::sqrt;
    const T b = limit_ - a_;
    going_ = b > 0.0;
    root_ = sqrt(going_ ? b : T(-b));
    c_ = root_ * per_phi0_;
    c_epsilon_ = c_ * epsilon_;
    if (start_ > a_) primitive0_ = primitive(sqrt(start_ - a_));
  }

  /// Amplitude and phase at one time.
  struct State {
    T amplitude2;   ///< lambda^2 (eq. l2jump), rad^2
    T phase_excess; ///< psi(t) - psi(0) - t: the integral of rate_excess
    T rate_excess;  ///< psi' - 1 (eq. dotpsi4)
  };

  /// The state at scaled time t; t must be in_domain.
  [[nodiscard]] State at(const T& t) const {
    using std::expm1, std::sqrt;
    const T gone = -expm1(epsilon_ * t * -2.0); // 1 - exp(-2 eps t)
    const T amplitude2 = start_ - way_ * gone;
    const T y = sqrt(amplitude2 - a_);
    T excess = primitive0_ - primitive(y) - (limit_ * t + way_per_decay_ * gone) * circular_;
    if (going_) excess += c_epsilon_ * t;
    return {amplitude2, excess, torque_ * y / amplitude2 - amplitude2 * circular_};
  }

  /// lambda^2 at scaled time t.
  [[nodiscard]] T amplitude2(const T& t) const {
    using std::expm1;
    return start_ + way_ * expm1(epsilon_ * t * -2.0);
  }

  /// Whether lambda > phi0 from 0 to t; x is monotonic, so the two ends decide.
  [[nodiscard]] bool in_domain(const T& t) const { return start_ > a_ && amplitude2(t) > a_; }
  /// The same for a time whose state is already known; at() may be called for any time.
  [[nodiscard]] bool in_domain(const State& state) const {
    return start_ > a_ && state.amplitude2 > a_;
  }

private:
  // The bracket of the header, as a function of y.
  [[nodiscard]] T primitive(const T& y) const {
    using std::atan, std::log;
    return atan(y * per_phi0_) - c_ * (going_ ? T(log(y + root_)) : T(atan(y / root_)));
  }

  T epsilon_;
  T torque_; // 2 mu / pi
  T a_;      // phi0^2
  T limit_;  // X
  T start_;  // x0
  T way_;    // x0 - X
  T way_per_decay_;
  T per_phi0_;
  T circular_;
  bool going_ = false; // b > 0
  T root_{};           // c phi0
  T c_{};
  T c_epsilon_{};
  T primitive0_{};
};

/// The largest angle of a swing whose cycle-average amplitude is lambda: lambda (1 + 5
/// lambda^2/192).
///
/// From the energy of the free pendulum, phi'^2 = 2 (cos phi - cos phi_max), averaged over a turn;
/// the next term is O(lambda^4), 1e-7 of the angle at 0.1 rad (AveragedModelTest.TurningAngle).
template <class T> T turning_angle(const T& lambda) {
  return lambda * (lambda * lambda * (5.0 / 192.0) + 1.0);
}

} // namespace goingrate
