// The averaged clock while its parameters are constant: laws, and the course of amplitude and
// phase. Private to the fit room.
//
// Equations (Hoyng, eqs. dotl4, dotpsi4, blow5; moments.hpp), x = lambda^2, scaled time, relative
// drive d:
//   dx/dt    = f = -2 eps x + (1 + d) D - (8/3pi) k x^(3/2) - (4/pi) c x^(1/2)
//   psi' - 1 = g = -s x/16 + (1 + d) push(x),   s = gravity_share
// constant torque:  D = 4 mu phi0/pi,  push = (2 mu/pi) y/x,  y = sqrt(x - phi0^2);
// single impulse:   D = e/pi,          push = -(e/2pi x) phi1/y,  y = sqrt(x - phi1^2).
// With constant torque and linear friction both are integrated in closed form
// (dynamics/averaged.hpp), otherwise by power series in time.
#pragma once

#include "goingrate/clock/parameters.hpp"
#include "goingrate/dynamics/averaged.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

namespace goingrate::timing_model {

/// The value of a number that may carry derivatives.
inline double plain(double value) { return value; }
template <class T> double plain(const T& value) { return value.a; }

/// The laws of a clock while its parameters are constant, as right sides of the averaged equations.
template <class T> struct AveragedLaws {
  Escapement escapement = Escapement::constant_torque;
  bool linear = true; ///< friction has no term but the linear one, not even one that is now 0
  T epsilon{}, mu{}, phi0{}, quadratic{}, dry{};
  T circular{1.0 / 16.0}; ///< s/16: the loss of rate per unit of x

  friend bool operator==(const AveragedLaws&, const AveragedLaws&) = default;

  [[nodiscard]] bool closed() const { return escapement != Escapement::single_impulse && linear; }
  [[nodiscard]] T drive() const {
    return escapement == Escapement::single_impulse ? T(mu * (1.0 / std::numbers::pi))
                                                    : T(mu * phi0 * (4.0 / std::numbers::pi));
  }
  [[nodiscard]] T growth(const T& x) const {
    using std::sqrt;
    T f = drive() - epsilon * x * 2.0;
    if (!linear) {
      const T lambda = sqrt(x);
      f -= (quadratic * x * (2.0 / 3.0) + dry) * lambda * (4.0 / std::numbers::pi);
    }
    return f;
  }
  [[nodiscard]] T growth_slope(const T& x) const {
    using std::sqrt;
    T slope = epsilon * -2.0;
    if (!linear) {
      const T lambda = sqrt(x);
      slope -= (quadratic * lambda + dry / lambda * 0.5) * (4.0 / std::numbers::pi);
    }
    return slope;
  }
  /// (growth(y) - growth(x))/(y - x), without cancellation.
  [[nodiscard]] T mean_growth_slope(const T& x, const T& y) const {
    using std::sqrt;
    T slope = epsilon * -2.0;
    if (!linear) {
      const T a = sqrt(x), b = sqrt(y), both = a + b;
      slope -= (quadratic * (both - a * b / both) * (2.0 / 3.0) + dry / both) *
               (4.0 / std::numbers::pi);
    }
    return slope;
  }
  [[nodiscard]] T push(const T& x) const {
    using std::sqrt;
    const T y = sqrt(x - phi0 * phi0);
    return escapement == Escapement::single_impulse
               ? T(mu * phi0 / (x * y) * (-0.5 / std::numbers::pi))
               : T(mu * y / x * (2.0 / std::numbers::pi));
  }
  [[nodiscard]] T push_slope(const T& x) const {
    using std::sqrt;
    const T y2 = x - phi0 * phi0;
    const T y = sqrt(y2);
    if (escapement == Escapement::single_impulse)
      return mu * phi0 / (x * y) * (T(1.0) / x + T(0.5) / y2) * (0.5 / std::numbers::pi);
    return mu / (x * y) * (T(0.5) - y2 / x) * (2.0 / std::numbers::pi);
  }
  [[nodiscard]] T rate(const T& x) const { return push(x) - x * circular; }
  /// Whether the swing passes the escapement and does not reach the top, whose x is that of half a
  /// turn, (1 - s) pi^2 + 4 s. With s above 1 the top is reached earlier; up to s = 1.1 that x is
  /// right to 1 %.
  [[nodiscard]] bool reaches(const T& x) const {
    constexpr double half_turn2 = std::numbers::pi * std::numbers::pi;
    return plain(x) > plain(phi0) * plain(phi0) &&
           plain(x) < half_turn2 - 16.0 * plain(circular) * (half_turn2 - 4.0);
  }
  /// The turning angle of a swing of averaged amplitude squared x, lambda (1 + 5 s lambda^2/192):
  /// turning_angle() of dynamics/averaged.hpp, whose circular part goes as s.
  [[nodiscard]] T turning_angle(const T& x) const {
    using std::sqrt;
    return sqrt(x) * (x * circular * (5.0 / 12.0) + 1.0);
  }
  /// Whether the averaged equations hold at such a rate: its excess is small compared with 1.
  static bool averages(const T& rate) { return std::abs(plain(rate)) < 0.5; }
};

/// Amplitude and phase about one time, as power series in the time since then.
///
/// With v = 1/lambda, a = 1 - phi0^2 v^2 and r = a^(1/2), or a^(-1/2) for the impulse:
///   lambda' = (D v - 2 eps lambda - (8/3pi) k lambda^2 - (4/pi) c) / 2,
///   push    = (2 mu/pi) v r,  or -(e phi1/2pi) v^3 r for the impulse,
/// and the coefficients of v and r follow from v lambda = 1 and a r' = +-1/2 a' r.
template <class T> class CourseSeries {
public:
  CourseSeries(const AveragedLaws<T>& laws, const T& amplitude) : laws_(laws) {
    amplitude_[0] = amplitude;
    inverse_[0] = 1.0 / amplitude;
    for (int n = 0; n < order; ++n)
      expand(n);
  }

  /// Amplitude and phase at `since`, at most reach() away.
  [[nodiscard]] T amplitude(const T& since) const { return sum(amplitude_, since); }
  [[nodiscard]] T phase_excess(const T& since) const { return sum(phase_, since); }

  /// How far the series are exact to rounding, after `decay` e-foldings of the approach to rest.
  /// The derivatives may still show a relaxation that the amplitude no longer shows, so the
  /// relaxation limits a step too; near rest it limits it less, because its part in the derivatives
  /// has died away as well.
  [[nodiscard]] double reach(double decay) const {
    constexpr double rounding = 1e-15, relaxations = 0.7; // 0.7^14/14! = 8e-14
    const double slope = std::abs(plain(laws_.growth_slope(amplitude_[0] * amplitude_[0])));
    double longest = relaxations * std::exp(std::max(0.0, decay) / order) / slope;
    for (const int k : {order - 1, order}) {
      longest = std::min(longest, within(rounding * plain(amplitude_[0]), amplitude_[at(k)], k));
      // rad: far below a nanosecond of any clock.
      longest = std::min(longest, within(rounding, phase_[at(k)], k));
    }
    return longest;
  }

private:
  static constexpr int order = 14;
  using Series = std::array<T, order + 1>;

  static std::size_t at(int k) { return static_cast<std::size_t>(k); }
  static double within(double error, const T& coefficient, int k) {
    return std::pow(error / std::abs(plain(coefficient)), 1.0 / k);
  }
  static T sum(const Series& series, const T& since) {
    T result = series[order];
    for (std::size_t k = order; k-- > 0;)
      result = result * since + series[k];
    return result;
  }
  // The n-th coefficient of a product.
  static T product(const Series& a, const Series& b, int n) {
    T result = a[0] * b[at(n)];
    for (int j = 1; j <= n; ++j)
      result += a[at(j)] * b[at(n - j)];
    return result;
  }

  // Everything of order n, then the amplitude and the phase of order n + 1.
  void expand(int n) {
    const bool impulse = laws_.escapement == Escapement::single_impulse;
    const double over_pi = 1.0 / std::numbers::pi, power = impulse ? -0.5 : 0.5;
    if (n > 0) {
      T rest = amplitude_[1] * inverse_[at(n - 1)];
      for (int j = 2; j <= n; ++j)
        rest += amplitude_[at(j)] * inverse_[at(n - j)];
      inverse_[at(n)] = -rest * inverse_[0];
    }
    square_[at(n)] = product(amplitude_, amplitude_, n);
    inverse2_[at(n)] = product(inverse_, inverse_, n);
    clear_[at(n)] = T(n == 0 ? 1.0 : 0.0) - laws_.phi0 * laws_.phi0 * inverse2_[at(n)];
    if (n == 0) {
      using std::sqrt;
      per_clear_ = 1.0 / clear_[0];
      root_[0] = impulse ? sqrt(per_clear_) : sqrt(clear_[0]);
    } else {
      T rest = T(0.0);
      for (int j = 1; j <= n; ++j)
        rest += clear_[at(j)] * root_[at(n - j)] * (power * j - (n - j));
      root_[at(n)] = rest * per_clear_ * (1.0 / n);
    }
    pushed_[at(n)] = product(impulse ? inverse2_ : inverse_, root_, n);
    const T push = impulse
                       ? T(product(inverse_, pushed_, n) * laws_.mu * laws_.phi0 * (-0.5 * over_pi))
                       : T(pushed_[at(n)] * laws_.mu * (2.0 * over_pi));
    phase_[at(n + 1)] = (push - square_[at(n)] * laws_.circular) * (1.0 / (n + 1));
    T growth = laws_.drive() * inverse_[at(n)] - laws_.epsilon * amplitude_[at(n)] * 2.0;
    if (!laws_.linear) {
      growth -= laws_.quadratic * square_[at(n)] * (8.0 / 3.0 * over_pi);
      if (n == 0) growth -= laws_.dry * (4.0 * over_pi);
    }
    amplitude_[at(n + 1)] = growth * (0.5 / (n + 1));
  }

  AveragedLaws<T> laws_;
  Series amplitude_{}, phase_{};                                           // lambda, psi - t
  Series inverse_{}, inverse2_{}, square_{}, clear_{}, root_{}, pushed_{}; // v, v^2, x, a, r
  T per_clear_{};
};

/// Amplitude and phase while the laws are constant, from t = 0 on.
template <class T> class Course {
public:
  struct State {
    T amplitude2{};   ///< x
    T phase_excess{}; ///< psi - t since the start
    T rate{};         ///< psi' - 1
  };

  Course(const AveragedLaws<T>& laws, const T& amplitude2)
      : laws_(laws),
        closed_(laws.epsilon, acting_torque(laws), laws.phi0, amplitude2, laws.circular) {
    using std::sqrt;
    if (!laws.closed()) go_on_from(0.0, sqrt(amplitude2), T(0.0));
  }

  /// The state at t; nullopt if the model does not hold. Cost without a closed form: the sums of
  /// two series, and an expansion for each step from the last time asked for, about 25 from any
  /// start to rest.
  std::optional<State> at(const T& t) {
    if (settled()) return settled_at(t);
    if (laws_.closed()) return in_closed_form(t);
    return series_ ? by_series(t) : std::nullopt;
  }
  /// Whether amplitude and rate are constant: the remaining approach to rest is below the rounding
  /// of a double.
  [[nodiscard]] bool settled() const { return decay_ > 45.0; }
  [[nodiscard]] const AveragedLaws<T>& laws() const { return laws_; }

private:
  static T acting_torque(const AveragedLaws<T>& laws) {
    return laws.escapement == Escapement::single_impulse ? T(0.0) : laws.mu;
  }

  [[nodiscard]] State settled_at(const T& t) const {
    return {rest_.amplitude2, rest_.phase_excess + rest_.rate * (t - settled_), rest_.rate};
  }
  void settle(const T& t, const State& state) {
    settled_ = t;
    rest_ = state;
  }

  std::optional<State> in_closed_form(const T& t) {
    const auto there = closed_.at(t);
    if (!closed_.in_domain(there) || !laws_.averages(there.rate_excess)) return {};
    const State state{there.amplitude2, there.phase_excess, there.rate_excess};
    decay_ = 2.0 * plain(laws_.epsilon) * plain(t);
    if (settled()) settle(t, state);
    return state;
  }

  std::optional<State> by_series(const T& t) {
    // Some 25 steps lead to rest, some 100 down to the escapement. A clock that rests at the very
    // edge of the escapement, or runs away from a possible rest, would need ever more.
    constexpr int most_steps = 200;
    for (;;) {
      const double left = plain(t) - from_;
      if (std::abs(left) <= reach_) {
        const T since = t - from_, amplitude = series_->amplitude(since);
        const T x = amplitude * amplitude;
        if (!laws_.reaches(x)) return {};
        return State{x, phase_ + series_->phase_excess(since), laws_.rate(x)};
      }
      const double step = std::copysign(reach_, left);
      const T amplitude = series_->amplitude(T(step)), halfway = series_->amplitude(T(0.5 * step));
      decay_ -= step * plain(laws_.growth_slope(halfway * halfway));
      if (++steps_ > most_steps ||
          !go_on_from(from_ + step, amplitude, phase_ + series_->phase_excess(T(step))))
        return {};
      if (settled()) return settled_at(t);
    }
  }

  // Only where the model holds: the steps of a clock that turns too fast would never end.
  bool go_on_from(double t, const T& amplitude, const T& phase) {
    const T x = amplitude * amplitude, rate = laws_.rate(x);
    if (!laws_.reaches(x) || !laws_.averages(rate)) return false;
    from_ = t;
    phase_ = phase;
    series_.emplace(laws_, amplitude);
    reach_ = series_->reach(decay_);
    if (settled()) settle(T(t), {x, phase, rate});
    return true;
  }

  AveragedLaws<T> laws_;
  AveragedMotion<T> closed_;
  std::optional<CourseSeries<T>> series_; // about from_, where the phase excess was phase_,
  double from_ = 0.0, reach_ = 0.0;       // and how far they hold
  T phase_{};
  int steps_ = 0;      // taken so far
  double decay_ = 0.0; // e-foldings of the approach to rest so far
  T settled_{};        // the time at which amplitude and rate became constant
  State rest_{};
};

} // namespace goingrate::timing_model
