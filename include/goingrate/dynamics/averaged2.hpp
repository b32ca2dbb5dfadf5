// The return map of second and third order, from one upward crossing to the next, in closed form.
//
// Equations (Hoyng, eqs. dotl2 and dotpsi2). With phi = lambda sin psi, phi' = lambda cos psi
// (eq. deflabpsi), rho = ln lambda, s = sin psi, c = cos psi and psi as the variable,
//   d rho/d psi = f c / (1 - f s) = f c + f^2 s c + ...
//   dt/d psi    = 1 / (1 - f s)   = 1 + f s + f^2 s^2 + ...
//   f = F/lambda = -2 eps c + q s^3/6 - q^2 s^5/120 + ... + m/lambda,   q = lambda^2.
// Small, and all of one order, are eps, m/lambda and q. Lambda is the value of lambda at the
// upward crossing, where it is phi'; it is not the cycle average that lambda is in averaged.hpp.
//
// Second order. r(psi) = int_0^psi f c is the displacement of rho of first order. To second order
// the time of a turn is 2 pi plus the integral of f s along the undisturbed lambda, and
//   (1) int f^2 s^2, the square of F;
//   (2) int (df/drho) r s, with df/drho = q s^3/3 - m/lambda, for F depends on lambda;
//   (3) the shift -tan(psi_s) r(psi_s) of the phase of a switch at a fixed angle, times f s before
//       the switch less f s after it.
// The amplitude is not taken from rho but from the work done, which is exact:
//   Lambda'^2 - Lambda^2 = 2 (work of the torque) - 4 eps A,   A = int phi'^2 dt,
// so that A is needed to one order less: A = q int c^2 (1 + 2 r + f s) for second order.
//
// What contains neither eps nor the torque is the free pendulum and known to all orders: with
// modulus n = Lambda/2 the time of a turn is 4 K(n), and A = 16 (E(n) - (1 - n^2) K(n)). Their
// series
//   4 K = 2 pi (1 + q/16 + 9 q^2/1024 + ...),  A = pi q (1 + q/32 + 3 q^2/1024 + ...)
// begin with what (1) and (2) give, and are taken further here, which costs next to nothing.
//
// Constant torque. The turn is twice the same half turn (the second mirrored), from psi = 0 to pi:
// m = mu up to the phase P of phi0, -mu from there on. With k = mu/Lambda, S = sin P =
// phi0/Lambda, C = cos P, t = tan P, the integrals (1) + (2) give, first order in front,
//   time = pi + pi q/16 - 2 k C + pi eps (eps/2 - pi q/16) + 9 pi q^2/1024
//          + k eps (2 S C^2 - 2 P C - pi) + 2 k^2 S (1 + C)
//          + k q (3 (pi - P) S - C (8 + S^2 + S^4)) / 12,
// (3) gives -2 k S t r(P), r(P) = k S - eps (P + S C) + q S^4/24, and the work is 2 mu phi0,
//   A/q  = pi/2 (1 + q/32) - pi^2 eps/2 + 2 k ((pi - P) S - C).
// Most of this is the drift of q during the half turn. It goes away, and the formulas get shorter,
// if q is not Lambda^2 but Q = (Lambda^2 + Lambda'^2)/2, the mean of both ends. From here on
// k, S, C are those of Q, and H = pi/2 - P is the phase from the switch to the apex:
//   time = pi + pi Q/16 - 2 k C                                                      first order
//        + 9 pi Q^2/1024 + pi eps^2/2 + 2 S k^2                                           second
//        + k Q (H S/4 - (8 - 7 S^2)/(12 C)) + k eps (2 S - pi + 2 H (C^2 - S^2)/C)
//        + 25 pi Q^3/16384 + k^2 Q (5 pi/16 - 2 S/3) + k^3 (2 C (1 - 4 S^2)/3)             third
//        + k Q^2 (9 H S/128 - (1024 - 1941 S^2 + 924 S^4 - 17 S^6)/(5760 C^3))
//        + eps {k Q [S B/4 + (15 pi C^2 - 30 S - 2 S^3 + 8 S^5)/(288 C^2)
//                    - H (30 + 54 S^2 - 108 S^4)/(288 C^3)]
//               + 2 k^2 S (2 S + pi (C^2 - S^2) - 2 C H)/C - eps Q pi (4 pi^2 - 15)/192
//               - eps k (2 C S H + (1 - 6 S^2 + 4 S^4) H^2
//                        + C^2 (S^2 + pi^2 (C^2 - S^2)/2))/C^3}
//   A/Q  = pi/2 (1 + Q/32 + 3 Q^2/1024) + 2 k (H S - C)                                  second
//        + k Q (9 H S - C (16 - S^2))/72 + k^2 (pi/2 - 2 S)                              third
//        + eps {k (2 C H + 2 S B + 2 S - pi) - eps pi (2 pi^2 - 3)/12},    B = pi^2/4 - H^2.
// Third order is the same expansion carried on by computer algebra. Q follows from the work:
//   Q (1 + 2 eps A/Q) = Lambda^2 + 2 mu phi0.
// The braces are left out in second order. What is of third order without eps is kept there: the
// free pendulum's Q^3 without its companions k Q^2 and k^2 Q would make the rate worse, for near
// the nominal rate, where Q/16 = 2 k C/pi, they cancel.
//
// The whole turn is done at once, at the mean Q of those of its halves, which differ by half of
// Delta = Lambda'^2 - Lambda^2. So the second half changes lambda^2 by 2 eps Delta d less than the
// first, d = dA/dQ = pi/2 (1 + Q/16) - k C, and
//   Q = Lambda^2 + g Delta/2,  g = 1 + eps d,  Delta = 8 (mu phi0 - eps A(Q)),
//   T = 2 time(Q) + (Delta/4)^2 time''(Q),  Q^2 time'' = k (2/C + 1/(2 C^3) - 4 C).
//
// Impulse. At phi1 lambda^2 jumps by 2e and, since phi stays, the phase goes back by
//   D = atan(phi1/w) - atan(phi1/w+),  w and w+ being phi' before and after.
// D is kept whole, so (3) is in it; the stretch D is passed twice. Let P in [0, 2 pi) be the phase
// of the jump, h = e/q the jump of rho to first order. In terms of q = Lambda^2,
//   time = 2 pi + 2 pi q/16 + D + 9 pi q^2/512 + pi eps (eps - pi q/4)
//        + h q/3 int_P^2pi s^4 + h S t (q S^3/6 - 2 eps C)                    (2), passed twice
//   w^2  = q (1 - 2 eps (P + S C) + q S^4/12) - phi1^2,  w+^2 = w^2 + 2e
//   A/q  = pi (1 + q/32) - 2 pi^2 eps + h (2 pi - P),    work = e,
// and in terms of the mean Q of both ends, with R = pi - P,
//   time = 2 pi + 2 pi Q/16 + D + 9 pi Q^2/512 + pi eps^2
//        + h (Q ((R + S C)/8 + S^3 C/12 + S^4 t/6) - 2 eps S^2)
//   w^2, w+^2 = Q (1 + 2 eps (R - S C) + Q S^4/12) - phi1^2 -+ e
//   A/Q  = pi (1 + Q/32) + h R,   Q (1 + 2 eps A/Q) = Lambda^2 + e.
#pragma once

#include <cmath>
#include <numbers>

namespace goingrate {

/// What a period (or half of it) does to the clock, in scaled time and rad.
template <class T> struct SecondOrderPeriod {
  T amplitude2_change; ///< Lambda'^2 - Lambda^2, Lambda = |phi'| at the vertical
  T period_excess;     ///< T - 2 pi (T - pi for half a period), formed without cancellation
};

/// The formulas of this file's header; the functions below them are for use.
namespace second_order {

/// pi to the digits of T, up to 32: the double and what it lacks. For the terms of first order;
/// those of higher order make do with constants that are doubles, the quicker for a derivative.
template <class T> T exact_pi() { return T(std::numbers::pi) + 1.2246467991473532e-16; }

/// (4 K/2 pi - 1)/q of the free pendulum; the next term is q^4/17000.
template <class T> T free_time(const T& q) {
  return ((q * (1225.0 / 4194304.0) + 25.0 / 16384.0) * q + 9.0 / 1024.0) * q + 1.0 / 16.0;
}

/// (A/(pi q) - 1)/q of the free pendulum; the next term is q^3/17000.
template <class T> T free_area(const T& q) {
  return (q * (25.0 / 65536.0) + 3.0 / 1024.0) * q + 1.0 / 32.0;
}

/// What the formulas of constant torque are made of, at some q.
template <class T> struct Switch {
  T q, k, S, C, over_C, H, HS, S2;

  /// From the square of the amplitude (above phi0^2), mu and phi0.
  Switch(const T& amplitude2, const T& mu, const T& phi0) : q(amplitude2) {
    using std::atan, std::sqrt;
    const T y = sqrt(q - phi0 * phi0), lambda = sqrt(q), inverse = 1.0 / lambda;
    k = mu * inverse;
    S = phi0 * inverse;
    C = y * inverse;
    over_C = lambda / y;
    H = atan(y / phi0);
    HS = H * S;
    S2 = S * S;
  }
};

/// A/Q of a half turn.
template <int order, class T> T area(const Switch<T>& at, const T& eps) {
  const auto& [q, k, S, C, over_C, H, HS, S2] = at;
  using std::numbers::pi;
  T bracket =
      2.0 * (HS - C) + q * (9.0 * HS - C * (16.0 - S2)) * (1.0 / 72.0) + k * (0.5 * pi - 2.0 * S);
  T alone = 0.5 * exact_pi<T>() * (1.0 + q * free_area(q));
  if constexpr (order == 3) {
    const T B = 0.25 * pi * pi - H * H;
    bracket += eps * (2.0 * (C * H + S * (B + 1.0)) - pi);
    alone -= eps * eps * (pi * (2.0 * pi * pi - 3.0) * (1.0 / 12.0));
  }
  return alone + k * bracket;
}

/// The terms of the time with k, divided by k, all but the first, -2 C.
template <int order, class T> T bend(const Switch<T>& at, const T& eps) {
  const auto& [q, k, S, C, over_C, H, HS, S2] = at;
  using std::numbers::pi;
  const T over_C2 = over_C * over_C, D = 1.0 - 2.0 * S2;
  const T q_terms = 0.25 * HS - (8.0 - 7.0 * S2) * (1.0 / 12.0) * over_C +
                    q * (HS * (9.0 / 128.0) - (1024.0 - S2 * (1941.0 - S2 * (924.0 - 17.0 * S2))) *
                                                  (1.0 / 5760.0) * over_C * over_C2);
  const T k_terms =
      2.0 * S + q * (pi * (5.0 / 16.0) - S * (2.0 / 3.0)) + k * C * (1.0 - 4.0 * S2) * (2.0 / 3.0);
  T eps_terms = 2.0 * S - pi + 2.0 * H * D * over_C;
  if constexpr (order == 3) {
    const T B = 0.25 * pi * pi - H * H;
    const T with_q =
        0.25 * S * B + (pi * (15.0 / 288.0)) -
        (S * (30.0 + S2 * (2.0 - 8.0 * S2)) + H * (30.0 + S2 * (54.0 - 108.0 * S2)) * over_C) *
            (1.0 / 288.0) * over_C2;
    const T with_k = 2.0 * S * ((2.0 * S + pi * D) * over_C - 2.0 * H);
    const T with_eps = (S2 + 0.5 * pi * pi * D +
                        (2.0 * C * HS + (1.0 - S2 * (6.0 - 4.0 * S2)) * H * H) * over_C2) *
                       over_C;
    eps_terms += q * with_q + k * with_k - eps * with_eps;
  }
  return q * q_terms + k * k_terms + eps * eps_terms;
}

/// One half turn, or both at once.
template <int order, int halves, class T>
SecondOrderPeriod<T> turn(const T& eps, const T& mu, const T& phi0, const T& Lambda2) {
  using std::numbers::pi;
  constexpr double n = halves;
  const T work = (2.0 * n) * mu * phi0;
  // Everything is taken at Q as of first order; the step from there to Q itself is of second
  // order, so that only the terms of first order feel it.
  const Switch<T> at(Lambda2 + work - (n * pi) * eps * Lambda2, mu, phi0);
  const T loss = (2.0 * n) * eps * area<order>(at, eps);
  T g(1.0);
  if constexpr (halves == 2) g += eps * (pi * (0.5 + at.q * (1.0 / 32.0)) - at.k * at.C);
  const T half_change = (work - loss * Lambda2) / (1.0 + loss * g); // Delta / 2
  const T Q = Lambda2 + g * half_change;
  const T over_q = at.S2 / (phi0 * phi0);
  T with_k = bend<order>(at, eps) - 2.0 * at.C - (at.over_C - 2.0 * at.C) * (Q - at.q) * over_q;
  T alone = Q * free_time(Q) + 0.5 * eps * eps;
  if constexpr (order == 3) alone -= eps * eps * Q * ((4.0 * pi * pi - 15.0) * (1.0 / 192.0));
  if constexpr (halves == 2) {
    const T x = half_change * over_q;
    with_k += x * x * (0.25 * at.over_C + at.over_C * at.over_C * at.over_C * 0.0625 - 0.5 * at.C);
  }
  return {2.0 * half_change, n * (exact_pi<T>() * alone + at.k * with_k)};
}

} // namespace second_order

/// Half a period of the constant-torque escapement: from a passage of the vertical to the next. The
/// torque mu acts along the motion until |phi| rises through phi0, then against it.
///
/// Two of these in a row are second_order_period but for terms of third order
/// (Averaged2Test.TwoHalvesMakeAPeriod); use it where mu changes at every passage.
template <class T>
SecondOrderPeriod<T> second_order_half_period(const T& eps, const T& mu, const T& phi0,
                                              const T& Lambda2) {
  return second_order::turn<2, 1>(eps, mu, phi0, Lambda2);
}

/// A period of phi'' + 2 eps phi' + sin phi = m from one upward crossing to the next: the torque m
/// is +mu until phi rises through phi0, then -mu until it falls through -phi0, then +mu.
///
/// eps friction; mu torque over moment of inertia, of any sign, for it may be one period's value of
/// a noisy drive; phi0 > 0, rad; Lambda2 = phi'^2 at the upward crossing, not a cycle average. T is
/// double, a wider type or an automatic derivative.
/// Domain: lambda > phi0 at both switches; eps, |mu|/Lambda and Lambda^2 small. It is not a number
/// where the mean of lambda^2 over the period, as of first order, is not above phi0^2; between the
/// two nothing tells that the escapement is not reached.
/// Accuracy: time and relative change of Lambda^2 are off by third order, s^3 if all small terms go
/// as s (Averaged2Test.ErrorFallsAsTheCube). The rate of the limit cycle is off by 7e-13, 1.6e-11
/// and 1.7e-12 at the paper's points A, B, C (Averaged2Test.RatesAtThePapersPoints). At A's drive a
/// period's T is off by 7e-10 and less down to Lambda = 1.03 phi0; with five times the torque
/// 2e-9 at 1.5 phi0, 7e-9 at 1.1 and 2.5e-8 at 1.03, as the switch nears the apex
/// (Averaged2Test.ErrorGrowsTowardsTheSwitchAngle).
template <class T>
SecondOrderPeriod<T> second_order_period(const T& eps, const T& mu, const T& phi0,
                                         const T& Lambda2) {
  return second_order::turn<2, 2>(eps, mu, phi0, Lambda2);
}

/// The same to third order. Off by s^4 (Averaged2Test.ThirdOrderErrorFallsAsTheFourthPower); the
/// rate of the limit cycle by 7e-15, 1.1e-13, 1e-14 at A, B, C
/// (Averaged2Test.RatesAtThePapersPoints).
template <class T>
SecondOrderPeriod<T> third_order_period(const T& eps, const T& mu, const T& phi0,
                                        const T& Lambda2) {
  return second_order::turn<3, 2>(eps, mu, phi0, Lambda2);
}

/// A period of the escapement with a single impulse (Hoyng, Appendix C): where phi rises through
/// phi1, phi'^2/2 jumps by e. From one upward crossing to the next; an impulse at phi1 = 0 comes
/// just after the first of them.
///
/// e and phi1 (rad) of any sign, |phi1| < lambda all the while, or the result is not a number; eps,
/// Lambda2 and T as in second_order_period. Accuracy: time and relative change of Lambda^2 are off
/// by third order (Averaged2Test.ImpulseErrorFallsAsTheCube); the rate of the limit cycle at A's
/// friction and amplitude by 6e-11 for phi1 = 0 and 6e-10 for |phi1| = 0.6 lambda, where first
/// order is off by 3e-8 to 5e-8 (Averaged2Test.ImpulseRateMatchesTheFullEquation).
template <class T>
SecondOrderPeriod<T> second_order_impulse_period(const T& eps, const T& e, const T& phi1,
                                                 const T& Lambda2) {
  using std::atan, std::sqrt;
  using std::numbers::pi;
  const T exact_pi = second_order::exact_pi<T>();
  const T q = Lambda2 + e - 2.0 * pi * eps * Lambda2; // Q as of first order
  const T over_q = 1.0 / q, phi1_2 = phi1 * phi1;
  const T y = sqrt(q - phi1_2);
  const T t = phi1 / y, S2 = phi1_2 * over_q, SC = phi1 * y * over_q;
  const T h = e * over_q;
  T R = pi - atan(t);
  if (phi1 < 0.0) R -= 2.0 * pi; // an impulse before the crossing comes at the end of the period

  const T loss = 2.0 * eps * (exact_pi * (1.0 + q * second_order::free_area(q)) + h * R);
  const T half_change = (e - loss * Lambda2) / (1.0 + loss);
  const T Q = Lambda2 + half_change;
  const T w2 = Q * (1.0 + 2.0 * eps * (R - SC) + Q * S2 * S2 * (1.0 / 12.0)) - phi1_2;
  const T w = sqrt(w2 - e), w_after = sqrt(w2 + e);
  // tan D, with the difference w_after - w free of cancellation; D^5/5 is beyond the order.
  const T tan_D = phi1 * 2.0 * e / ((w + w_after) * (w * w_after + phi1_2));
  const T D = tan_D * (1.0 - tan_D * tan_D * (1.0 / 3.0));

  const T circular = 0.125 * (R + SC) + S2 * (SC * (1.0 / 12.0) + S2 * t * (1.0 / 6.0));
  const T excess = exact_pi * (2.0 * Q * second_order::free_time(Q) + eps * eps) +
                   h * (Q * circular - 2.0 * eps * S2) + D;
  return {2.0 * half_change, excess};
}

} // namespace goingrate
