// Error-free sums: a + b as a pair (high, low) that together hold the exact result.
//
// Notation: hi + lo with |lo| <= ulp(hi)/2. The identities hold in round-to-nearest arithmetic and
// are destroyed by -ffast-math, which the build therefore never uses.
// Reference: T. J. Dekker, Numer. Math. 18 (1971) 224; D. E. Knuth, TAOCP 2, 4.2.2.
#pragma once

namespace goingrate {

/// An unevaluated sum hi + lo: about 106 significant bits for T = double.
template <class T> struct TwoPart {
  T hi{};
  T lo{};

  /// Adds `x`; the result is exact to about one part in 2^105.
  TwoPart& operator+=(T x) {
    const T sum = hi + x;
    const T part = sum - hi;
    const T rounding = (hi - (sum - part)) + (x - part);
    lo += rounding;
    hi = sum;
    renormalise();
    return *this;
  }

  /// Adds both parts.
  TwoPart& operator+=(const TwoPart& other) {
    *this += other.hi;
    return *this += other.lo;
  }

  /// The nearest T. (`SumsTest` compares 1e6 additions with a sum in wider arithmetic.)
  [[nodiscard]] T value() const { return hi + lo; }

private:
  void renormalise() {
    const T sum = hi + lo;
    lo -= sum - hi;
    hi = sum;
  }
};

} // namespace goingrate
