// Half a swing of the pendulum, from one passage through the vertical to the next, to rounding.
//
// Problem. phi'' + 2 eps phi' + sin phi = m (Hoyng, eq. ddt1), with the constant-torque escapement:
// a torque that helps the motion until the pendulum rises through phi0, then opposes it, and is
// kept until the mirrored switch in the other half swing. A swing to the left is the mirror image
// of a swing to the right, so one canonical case is enough: phi = 0, phi' = v > 0.
//
// Method. Power series in time of phi, w = phi', w^2, c = cos phi and s = sin phi. With
//   w_{k+1} = (-2 eps w_k - s_k + m [k=0]) / (k+1)          from the equation of motion,
//   c_{k+1} = (w^2)_{k+1} / 2 + (2 eps (w^2)_k - m w_k)/(k+1)  from the energy equation,
//   s_{k+1} = sum_j c_j w_{k-j} / (k+1)                        from s' = c phi',
// a step costs one and a half convolutions. Switch, apex and crossing are roots of the polynomials.
//
// The change of v^2 over the half swing is not taken from v'^2 - v^2, which would lose its digits,
// but from the work done: v'^2 - v^2 = 4 mu phi0 [switched] - 4 eps * integral of w^2 dt. Friction
// and drive change v^2 by parts per thousand, so carrying v^2 in two parts keeps the limit cycle
// from freezing at the rounding of v (DirectTest.LimitCycleDoesNotFreeze).
//
// Degenerate cases, each a status: the escapement is not reached (no switch; the torque stays and
// opposes the next half swing), the pendulum does not come back through the vertical (stalled), it
// passes the top (overturned). Grazing the switch (apex within rounding of phi0) is decided by the
// apex: switch if apex > phi0.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>

#include "goingrate/base/sums.hpp"

namespace goingrate {

/// How a half swing ended.
enum class SwingStatus {
  crossed,    ///< back at the vertical
  stalled,    ///< turned round before reaching the vertical, held up by the torque
  overturned, ///< passed the top
  not_finite, ///< the numbers overflowed
};

/// The result of half_swing, all in scaled time.
template <class T> struct HalfSwing {
  SwingStatus status = SwingStatus::crossed;
  TwoPart<T> duration;   ///< time between the two passages
  T speed{};             ///< |phi'| at the second passage
  T speed2_change{};     ///< its square minus that at the first passage, to full relative accuracy
  T apex{};              ///< largest angle in between, rad
  bool switched = false; ///< the escapement switched in this half swing
};

/// Power series of the motion about one point: order fixed by the precision of T.
template <class T> class SwingSeries {
public:
  // Half the digits of T in nepers plus a few: the optimum of Jorba and Zou (2005), sec. 3.2, for
  // smooth problems; 20 for double, 41 for 113 bits.
  static constexpr int order = std::numeric_limits<T>::digits * 35 / 100 + 2;

  /// The series about (phi, w) for friction eps and constant torque m.
  SwingSeries(T phi, T w, T eps, T m) : eps_(eps), m_(m) {
    using std::cos, std::sin;
    phi_[0] = phi;
    w_[0] = w;
    w2_[0] = w * w;
    s_[0] = sin(phi);
    c_[0] = cos(phi);
    expand(eps, m, std::make_index_sequence<order>{});
  }

  /// A step for which the last two terms of phi and w stay below rounding of the amplitude.
  [[nodiscard]] T safe_step() const {
    using std::abs, std::exp, std::log, std::sqrt;
    const T size = sqrt(phi_[0] * phi_[0] + w2_[0]);
    const T allowed = size * std::numeric_limits<T>::epsilon() / 2;
    T shortest = std::numeric_limits<T>::max();
    for (int k : {order - 1, order}) {
      const T term = abs(phi_[static_cast<std::size_t>(k)]) + abs(w_[static_cast<std::size_t>(k)]);
      if (term > 0) shortest = std::min<T>(shortest, exp(log(T(allowed / term)) / k));
    }
    return std::min<T>(shortest, T(3)); // below half a period whatever the series says
  }

  [[nodiscard]] T angle(T t) const { return sum(phi_, t); }
  [[nodiscard]] T speed(T t) const { return sum(w_, t); }

  /// w' = -2 eps w - sin phi + m.
  [[nodiscard]] T acceleration(T t) const { return m_ - 2 * eps_ * speed(t) - sum(s_, t); }

  /// The integral of w^2 over [0, t].
  [[nodiscard]] T friction_integral(T t) const {
    Coefficients share;
    for (std::size_t k = 0; k <= order; ++k)
      share[k] = w2_[k] * (T(1) / static_cast<int>(k + 1));
    return sum(share, t) * t;
  }

  /// The time in [0, high] at which the rising angle reaches `target`, which it does there.
  [[nodiscard]] T time_of_rise(T target, T high) const {
    return root([&](T t) { return angle(t) - target; }, [&](T t) { return speed(t); }, true,
                (target - phi_[0]) / w_[0], T(0), high, newton_enough);
  }
  /// The time in [low, high] at which the falling angle passes zero; it does so between.
  [[nodiscard]] T time_of_return(T low, T high) const {
    return root([&](T t) { return angle(t); }, [&](T t) { return speed(t); }, false,
                high - angle(high) / speed(high), low, high, newton_enough);
  }
  /// The time in [0, high] at which w falls through zero. The angle is flat there, so that half the
  /// digits of the time give all those of the angle.
  [[nodiscard]] T time_of_apex(T high) const {
    using std::sqrt;
    return root([&](T t) { return speed(t); }, [&](T t) { return acceleration(t); }, false,
                -w_[0] / w_[1], T(0), high, T(sqrt(newton_enough)));
  }

private:
  using Coefficients = std::array<T, order + 1>;

  // After a Newton step of this length the next would be shorter than rounding.
  static inline const T newton_enough = [] {
    using std::sqrt;
    return T(sqrt(std::numeric_limits<T>::epsilon()) / 16);
  }();

  // All loops over coefficients are unrolled when compiled: they are short and of known length.
  template <std::size_t... k> void expand(T eps, T m, std::index_sequence<k...>) {
    (advance<k>(eps, m), ...);
  }

  template <std::size_t k> void advance(T eps, T m) {
    const T share = T(1) / static_cast<int>(k + 1); // a constant: a division a coefficient is dear
    phi_[k + 1] = w_[k] * share;
    w_[k + 1] = (-2 * eps * w_[k] - s_[k] + (k == 0 ? m : T(0))) * share;
    w2_[k + 1] = square_term<k + 1>();
    c_[k + 1] = w2_[k + 1] / 2 + (2 * eps * w2_[k] - m * w_[k]) * share;
    s_[k + 1] = product<k + 1>(c_.data(), w_.data() + k) * share;
  }

  // Coefficient n of w(t)^2, using the symmetry of the products.
  template <std::size_t n> [[nodiscard]] T square_term() const {
    const T half = product<(n + 1) / 2>(w_.data(), w_.data() + n);
    if constexpr (n % 2 == 0)
      return 2 * half + w_[n / 2] * w_[n / 2];
    else
      return 2 * half;
  }

  // a[0] b[0] + a[1] b[-1] + ...: `count` terms, b running backwards, added pairwise, which is both
  // quicker (no addition waits for all before it) and closer.
  template <std::size_t count> [[gnu::always_inline]] static T product(const T* a, const T* b) {
    if constexpr (count == 1)
      return *a * *b;
    else
      return product<count / 2>(a, b) + product<count - count / 2>(a + count / 2, b - count / 2);
  }

  // a[0] + a[stride] t + a[2 stride] t^2 + ... as even part + t (odd part), for the same two
  // reasons.
  template <std::size_t count, std::size_t stride>
  [[gnu::always_inline]] static T polynomial(const T* a, T t) {
    if constexpr (count == 1)
      return *a;
    else if constexpr (count == 2)
      return a[0] + t * a[stride];
    else
      return polynomial<(count + 1) / 2, 2 * stride>(a, t * t) +
             t * polynomial<count / 2, 2 * stride>(a + stride, t * t);
  }
  static T sum(const Coefficients& a, T t) { return polynomial<order + 1, 1>(a.data(), t); }

  // Newton steps from `t`, kept inside a bracket that is halved whenever Newton leaves it. `value`
  // and `slope` are functions of time.
  template <class Value, class Slope>
  static T root(Value value, Slope slope, bool rising, T t, T low, T high, T enough) {
    using std::abs;
    if (!(t > low && t < high)) t = low + (high - low) / 2;
    for (int i = 0; i < 200; ++i) {
      const T at = value(t);
      ((at > 0) == rising ? high : low) = t;
      const T step = at / slope(t);
      const T next = t - step;
      if (next >= low && next <= high) {
        t = next;
        if (abs(step) <= enough) break;
      } else {
        t = low + (high - low) / 2;
        if (high - low <= std::numeric_limits<T>::epsilon() * abs(t)) break;
      }
    }
    return t;
  }

  T eps_, m_;
  Coefficients phi_, w_, w2_, s_, c_;
};

/// Follows the pendulum from (phi = 0, phi' = v > 0) to its next passage through phi = 0.
///
/// `mu` any torque (a negative one too), `phi0` the switching angle. `helping`: the torque acts
/// along the motion at the start and switches at phi0; otherwise it opposes all the way, as after a
/// switch that was missed. Accuracy: duration and speed2_change to a few roundings of T for v up to
/// 1.9 (HalfSwingTest); about 1 us for double.
template <class T> HalfSwing<T> half_swing(T v, T eps, T mu, T phi0, bool helping) {
  using std::isfinite;
  HalfSwing<T> result;
  T phi = 0;
  T w = v;
  T m = helping ? mu : T(-mu);
  bool rising = true;
  TwoPart<T> friction;
  const auto go_on_from = [&](const SwingSeries<T>& series, T t, T new_phi) {
    result.duration += t;
    friction += series.friction_integral(t);
    phi = new_phi;
    w = series.speed(t);
  };

  for (;;) {
    const SwingSeries<T> series(phi, w, eps, m);
    const T step = series.safe_step();
    const T phi_end = series.angle(step);
    const T w_end = series.speed(step);
    if (!isfinite(phi_end + w_end)) { // a torque or friction beyond all measure
      result.status = SwingStatus::not_finite;
      return result;
    }
    T top = phi_end;
    T apex_time = rising ? step : T(0);
    if (rising && w_end <= 0) {
      apex_time = series.time_of_apex(step);
      top = series.angle(apex_time);
    }
    if (rising && helping && !result.switched && top > phi0) {
      const T t = series.time_of_rise(phi0, apex_time);
      go_on_from(series, t, phi0);
      result.switched = true;
      m = -mu;
      continue;
    }
    if (rising && w_end <= 0) {
      rising = false;
      result.apex = top;
    }
    if (!rising && phi_end <= 0) {
      const T t = series.time_of_return(apex_time, step);
      go_on_from(series, t, T(0));
      result.speed = -w;
      result.speed2_change =
          (result.switched ? T(4 * mu * phi0) : T(0)) - 4 * eps * friction.value();
      return result;
    }
    if (rising ? phi_end >= T(std::numbers::pi) || step <= 0 : w_end >= 0) {
      result.status = rising ? SwingStatus::overturned : SwingStatus::stalled;
      return result;
    }
    go_on_from(series, step, phi_end);
  }
}

} // namespace goingrate
