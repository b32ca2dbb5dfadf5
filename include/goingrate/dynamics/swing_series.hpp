// Power series of the pendulum's motion about one point, as a deviation from harmonic motion.
//
// Between two stops (a switch of the torque, a turn, a passage) the equation of motion is
//   phi'' + phi = F,   F = s (phi - sin phi) + A + S phi - L phi' - K phi'^2,
// with constants s, A, S, L, K. Without F the motion is a rotation in the plane (phi, phi'), which
// loses no precision. What F adds, delta'' + delta = F with delta = delta' = 0 at the point of
// expansion, is smaller than the motion by 1e-3 in a clock, and so are its rounding errors:
// durations come out to 1e-19 instead of 1e-16.
//
// Coefficients, with w = phi', q = 1 - cos phi, g = phi - sin phi:
//   w_{k+1} = (F_k - phi_k) / (k+1),       phi_{k+1} = w_k / (k+1),
//   q_{k+1} = (A w_k - L (w^2)_k) / (k+1) - (w^2)_{k+1} / 2        (energy; if s = 1, S = K = 0),
//   or q_{k+1} = sum_j (phi - g)_j w_{k-j} / (k+1)                    (q' = w sin phi; any law),
//   g_{k+1} = sum_j q_j w_{k-j} / (k+1)                            (g' = w (1 - cos phi)).
// Products are summed from the middle outwards, so that the coefficient that was found last is used
// last and the processor has the others ready.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>
#include <utility>

namespace goingrate {

/// The force between two stops besides a harmonic pull, scaled: A + S phi - L phi' - K phi'^2, and
/// what gravity's share s takes from that pull, s (phi - sin phi).
template <class T> struct SwingForce {
  T constant{};  ///< A: torque, dry friction
  T slope{};     ///< S: torque that changes with the angle
  T linear{};    ///< L = 2 epsilon
  T quadratic{}; ///< K: quadratic drag, with the sign of phi'
  T gravity{1};  ///< s: share of the restoring torque that goes as sin phi

  /// F at (phi, w), with `defect` = phi - sin phi.
  [[nodiscard]] T at(const T& phi, const T& w, const T& defect) const {
    return gravity * defect + constant + slope * phi - w * (linear + quadratic * w);
  }
};

namespace detail {

// (phi - sin phi) and (1 - cos phi) without cancellation.
template <class T> struct SineDefects { T g, q; };

// a[0] + a[stride] t + a[2 stride] t^2 + ... as even part + t (odd part): no addition waits for
// all before it.
template <std::size_t count, std::size_t stride, class T, class A>
[[gnu::always_inline]] inline A polynomial(const A* a, const T& t) {
  if constexpr (count == 1)
    return *a;
  else if constexpr (count == 2)
    return a[0] + t * a[stride];
  else
    return polynomial<(count + 1) / 2, 2 * stride>(a, T(t * t)) +
           t * polynomial<count / 2, 2 * stride>(a + stride, T(t * t));
}

// 1/(n+1)!, 1/(n+3)!, ... with alternating signs.
template <class T, std::size_t terms> std::array<T, terms> alternating_series(int n) {
  std::array<T, terms> a;
  T term = 1;
  for (int i = 2; i <= n; ++i)
    term /= i;
  for (std::size_t i = 0; i < terms; ++i, n += 2) {
    a[i] = term;
    term /= T(-(n + 1) * (n + 2));
  }
  return a;
}

template <class T> SineDefects<T> sine_defects(const T& phi) {
  using std::abs, std::sin;
  if (abs(phi) > 0.5) {
    const T half = sin(phi / 2);
    return {phi - sin(phi), 2 * half * half};
  }
  // This many terms leave less than rounding at 1/2 rad.
  constexpr std::size_t terms = std::numeric_limits<T>::digits <= 64 ? 10 : 18;
  static const auto sine = alternating_series<T, terms>(3),
                    cosine = alternating_series<T, terms>(2);
  const T x = phi * phi;
  return {x * phi * polynomial<terms, 1>(sine.data(), x),
          x * polynomial<terms, 1>(cosine.data(), x)};
}

// Two numbers that are multiplied and added together, in one register where T allows.
template <class T> struct PairOf {
  struct type {
    T a, b;
    friend type operator*(const type& x, const type& y) { return {x.a * y.a, x.b * y.b}; }
    friend type operator*(const T& x, const type& y) { return {x * y.a, x * y.b}; }
    friend type operator+(const type& x, const type& y) { return {x.a + y.a, x.b + y.b}; }
    type& operator+=(const type& y) {
      a += y.a;
      b += y.b;
      return *this;
    }
    const T& operator[](int i) const { return i == 0 ? a : b; }
  };
};
template <> struct PairOf<double> { typedef double type __attribute__((vector_size(16))); };

// Coefficients of a series that is multiplied with others of its kind. Beside each stand pairs, so
// that a product takes two terms at a time: those of the first factor rising, of the second
// (`second`) falling.
template <class T, std::size_t count, bool second> class ProductSeries {
public:
  using Second = ProductSeries<T, count, true>;

  template <std::size_t k> [[gnu::always_inline]] void set(const T& value) {
    a_[k] = value;
    if constexpr (second && k > 0) falling_[k] = Pair{value, a_[k - 1]};
    if constexpr (k > 1 && k % 2 == 0) rising_[k / 2] = Pair{a_[k - 1], value};
  }
  [[gnu::always_inline]] const T& operator[](std::size_t k) const { return a_[k]; }
  [[nodiscard]] const std::array<T, count>& all() const { return a_; }

  // a_1 b_{n-1} + a_2 b_{n-2} + ... + a_{n-1} b_1, from the middle outwards.
  template <std::size_t n>
  [[nodiscard, gnu::always_inline]] T inner_product(const Second& b) const {
    T last = T(0);
    if constexpr (n >= 2 && n % 2 == 0) last = a_[n - 1] * b[1];
    if constexpr (n < 3)
      return last;
    else
      return last + pairs<n, (n - 1) / 2>(b);
  }

  // a_1 a_{n-1} + a_2 a_{n-2} + ..., each product once: half of coefficient n of the square without
  // a_0 a_n.
  template <std::size_t n> [[nodiscard, gnu::always_inline]] T inner_half_square() const {
    constexpr std::size_t products = n < 2 ? 0 : (n - 1) / 2;
    T middle = T(0);
    if constexpr (n >= 2 && n % 2 == 0) middle = a_[n / 2] * a_[n / 2] * T(0.5);
    if constexpr (products % 2 == 1) middle += a_[products] * a_[n - products];
    if constexpr (products < 2)
      return middle;
    else
      return middle + pairs<n, products / 2>(*this);
  }

private:
  friend class ProductSeries<T, count, false>;
  using Pair = typename PairOf<T>::type;

  // The first 2 `number` terms of inner_product<n>. Two sums, so that neither of the two newest
  // factors, one at each end, waits for the other.
  template <std::size_t n, std::size_t number>
  [[gnu::always_inline]] T pairs(const Second& b) const {
    constexpr std::size_t middle = number < n / 4 + 1 ? number : n / 4 + 1;
    Pair low = rising_[middle] * b.falling_[n - 2 * middle + 1];
    [&]<std::size_t... i>(std::index_sequence<i...>) __attribute__((always_inline)) {
      ((low += rising_[middle - 1 - i] * b.falling_[n - 2 * (middle - 1 - i) + 1]), ...);
    }
    (std::make_index_sequence<middle - 1>{});
    if constexpr (number > middle) {
      Pair high = rising_[middle + 1] * b.falling_[n - 2 * (middle + 1) + 1];
      [&]<std::size_t... i>(std::index_sequence<i...>) __attribute__((always_inline)) {
        ((high += rising_[middle + 2 + i] * b.falling_[n - 2 * (middle + 2 + i) + 1]), ...);
      }
      (std::make_index_sequence<number - middle - 1>{});
      low += high;
    }
    return low[0] + low[1];
  }

  std::array<T, count> a_;
  std::array<Pair, second ? count : 1> falling_; // (a_k, a_{k-1}) at k
  std::array<Pair, count / 2 + 1> rising_;       // (a_{2k-1}, a_{2k}) at k
};

} // namespace detail

/// The series about (phi, w). `any_law`: S and K may differ from zero, s from one.
template <class T, bool any_law> class SwingSeries {
public:
  // This order was fastest (measured): 22 for double, 44 for 113 bits.
  static constexpr std::size_t order = std::numeric_limits<T>::digits * 38 / 100 + 2;

  /// About angle `phi` and speed `w` under `force`.
  SwingSeries(const T& phi, const T& w, const SwingForce<T>& force) : phi_(phi), force_(force) {
    const auto defects = detail::sine_defects(phi);
    w_.template set<0>(w);
    q_.template set<0>(defects.q);
    g_[0] = defects.g;
    expand(std::make_index_sequence<order - 1>{});
  }

  /// Whether the terms after the last are below an eighth of the rounding of the motion in step i
  /// of the ladder.
  ///
  /// Terms come in pairs, even and odd. What follows the last pair p1 is p1 r and less, with r the
  /// ratio of pairs, which falls. Two frequencies can cancel in one pair, so p1 counts at least as
  /// much as the pairs before it predict, and r is the larger of the last two.
  [[nodiscard]] bool reaches(int i) const {
    const Rung& rung = ladder()[static_cast<std::size_t>(i)];
    const T h2 = rung.step * rung.step;
    const T p3 = pair<order - 5>(rung.step), p2 = pair<order - 3>(rung.step) * h2,
            p1 = pair<order - 1>(rung.step) * (h2 * h2);
    const T before = p2 / p3;
    const T ratio = before * p2 > p1 ? before : T(p1 / p2);
    const T last = before * p2 > p1 ? T(before * p2) : p1;
    const T allowed = abs_sum(phi_, w_[0]) * (std::numeric_limits<T>::epsilon() / 8);
    return !(last * ratio * rung.power > allowed); // 0/0: there is no deviation
  }

  /// The same for the series of w^2 that friction_integral sums, to rounding of the energy.
  [[nodiscard]] bool reaches_with_work(int i) const {
    using std::abs;
    const Rung& rung = ladder()[static_cast<std::size_t>(i)];
    const T tail = (abs(half_square(order)) * rung.step + abs(half_square(order - 1))) * rung.power;
    const T energy = phi_ * phi_ + w_[0] * w_[0];
    return reaches(i) &&
           tail * rung.step * rung.step <= energy * (std::numeric_limits<T>::epsilon() / 8);
  }

  /// The steps that are taken: a short ladder, so that the step of the last series is likely to
  /// serve the next and the processor need not wait for the test. None is longer than 1.16: the
  /// events of half_swing are further apart or looked for one by one.
  static constexpr int rungs = 200; // down to 1e-9
  /// The length of step i, 0 to rungs - 1, from long to short.
  [[nodiscard]] static const T& step_length(int i) {
    return ladder()[static_cast<std::size_t>(i)].step;
  }

  /// The deviation from harmonic motion since the point of expansion, and its derivative.
  struct Deviation {
    T angle, speed;
  };
  /// The deviation at `t` after the point of expansion.
  [[nodiscard]] Deviation deviation(const T& t) const {
    const Pair both = detail::polynomial<order + 1, 1>(deviation_.data(), t);
    return {both[0], both[1]};
  }
  /// phi' at `t`.
  [[nodiscard]] T speed(const T& t) const { return sum(w_.all(), t); }
  /// phi at `t`.
  [[nodiscard]] T angle(const T& t) const { return phi_ + integral(w_.all(), t); }
  /// The integral of w^2 over [0, t].
  [[nodiscard]] T friction_integral(const T& t) const {
    Coefficients half_squares;
    for (std::size_t k = 0; k <= order; ++k)
      half_squares[k] = half_square(k);
    return 2 * integral(half_squares, t);
  }

private:
  using Coefficients = std::array<T, order + 1>;
  using Pair = typename detail::PairOf<T>::type;

  // Terms k and k+1 of the deviation in a step h, without h^k.
  template <std::size_t k> [[nodiscard]] T pair(const T& h) const {
    return abs_sum(deviation_[k][0], deviation_[k][1]) +
           abs_sum(deviation_[k + 1][0], deviation_[k + 1][1]) * h;
  }

  // Half of coefficient n of w^2.
  [[nodiscard]] T half_square(std::size_t n) const {
    T sum = 0;
    for (std::size_t i = 0; i <= n; ++i)
      sum += w_[i] * w_[n - i];
    return sum / 2;
  }

  static T abs_sum(const T& x, const T& y) {
    using std::abs;
    return abs(x) + abs(y);
  }

  struct Rung {
    T step, power; // and step^(order-5)
  };
  static const std::array<Rung, rungs>& ladder() {
    static const auto made = [] {
      std::array<Rung, rungs> all;
      T step = T(1.16);
      for (Rung& rung : all) {
        rung = {step, power<order - 5>(step)};
        step *= T(0.9);
      }
      return all;
    }();
    return made;
  }

  template <std::size_t... k> void expand(std::index_sequence<k...>) {
    half_square_ = w_[0] * w_[0] * T(0.5);
    harmonic_[0] = w_[0];
    harmonic_[1] = -phi_;
    T force = force_.constant - force_.linear * w_[0];
    if constexpr (any_law)
      force += force_.gravity * g_[0] + other_force<0>();
    else
      force += g_[0];
    deviation_[0] = Pair{T(0), T(0)};
    deviation_[1] = Pair{T(0), force};
    speed_delta_[0] = T(0);
    speed_delta_[1] = force;
    w_.template set<1>(force - phi_);
    (advance<k>(), ...);
  }

  // From w_{k+1}, q_{k-1} and all before them to w_{k+2} and q_k. The newest coefficients enter
  // last: w_k to q_k to w_{k+2} is the chain the processor has to wait for.
  template <std::size_t k> [[gnu::always_inline]] void advance() {
    constexpr int n = static_cast<int>(k);
    const T by2 = T(1) / (n + 2), by12 = T(1) / ((n + 1) * (n + 2));
    if constexpr (k > 0) next_cosine<k>();
    T product = q_.template inner_product<k>(w_) + q_[0] * w_[k];
    if constexpr (any_law) {
      g_[k + 1] = (product + (k > 0 ? q_[k] * w_[0] : T(0))) * (T(1) / (n + 1));
      product = product * force_.gravity + other_force<k + 1>() * T(n + 1);
    }
    product -= speed_delta_[k % 2];
    if constexpr (k > 0) product += any_law ? T(q_[k] * w_[0] * force_.gravity) : q_[k] * w_[0];
    const T friction = w_[k + 1] * (force_.linear * by2);
    harmonic_[k % 2] *= -by12;
    const T speed_delta = product * by12 - friction;
    w_.template set<k + 2>((product * by12 + harmonic_[k % 2]) - friction);
    deviation_[k + 2] = Pair{speed_delta_[(k + 1) % 2] * by2, speed_delta};
    speed_delta_[k % 2] = speed_delta;
  }

  // q_k; and (w^2)_k / 2 on the way.
  template <std::size_t k> [[gnu::always_inline]] void next_cosine() {
    const T by = T(1) / static_cast<int>(k);
    const T inner = w_.template inner_half_square<k>();
    const T outer = w_[0] * w_[k];
    const T half_square_before = half_square_;
    half_square_ = inner + outer;
    if constexpr (any_law) {
      s_.template set<k - 1>(angle_coefficient<k - 1>() - g_[k - 1]);
      T product = s_.template inner_product<k - 1>(w_) + s_[0] * w_[k - 1];
      if constexpr (k > 1) product += s_[k - 1] * w_[0];
      q_.template set<k>(product * by);
    } else {
      q_.template set<k>(
          ((force_.constant * w_[k - 1] - twice_linear_ * half_square_before) * by - inner) -
          outer);
    }
  }

  template <std::size_t k> [[nodiscard, gnu::always_inline]] T angle_coefficient() const {
    if constexpr (k == 0)
      return phi_;
    else
      return w_[k - 1] * (T(1) / static_cast<int>(k));
  }

  // What S and K add to F_k.
  template <std::size_t k> [[nodiscard, gnu::always_inline]] T other_force() const {
    T half_square = w_[0] * w_[0] * T(0.5);
    if constexpr (k > 0) half_square = w_.template inner_half_square<k>() + w_[0] * w_[k];
    return force_.slope * angle_coefficient<k>() - force_.quadratic * 2 * half_square;
  }

  [[gnu::always_inline]] static T sum(const Coefficients& a, const T& t) {
    return detail::polynomial<order + 1, 1>(a.data(), t);
  }

  [[gnu::always_inline]] static T integral(const Coefficients& a, const T& t) {
    Coefficients share;
    for (std::size_t k = 0; k <= order; ++k)
      share[k] = a[k] * (T(1) / static_cast<int>(k + 1));
    return sum(share, t) * t;
  }

  template <std::size_t n> [[gnu::always_inline]] static T power(const T& t) {
    if constexpr (n == 1)
      return t;
    else if constexpr (n % 2 == 0)
      return power<n / 2>(t * t);
    else
      return t * power<n - 1>(t);
  }

  template <bool second> using Factor = detail::ProductSeries<T, order + 1, second>;

  T phi_;
  SwingForce<T> force_;
  T twice_linear_ = 2 * force_.linear;
  Factor<true> w_;
  Factor<false> q_;
  std::array<Pair, order + 1> deviation_; // angle and speed
  // Only the last ones are needed: of even and odd order, and of order k.
  std::array<T, 2> harmonic_, speed_delta_;
  T half_square_;
  std::array<T, any_law ? order + 1 : 1> g_;
  std::conditional_t<any_law, Factor<false>, T> s_;
};

} // namespace goingrate
