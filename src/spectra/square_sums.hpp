// Sums of squares over long rows, quick and exact to a few roundings. Private to the spectra room.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>

#include <Eigen/Core>

namespace goingrate {

struct SquareSum {
  double sum = 0.0;
  std::size_t n = 0;

  SquareSum& operator+=(const SquareSum& other) {
    sum += other.sum;
    n += other.n;
    return *this;
  }
};

// x[from] .. x[from+count-1] as one array. Sums over such are taken in several lanes.
inline auto stretch_of(const double* x, std::size_t from, std::size_t count) {
  return Eigen::Map<const Eigen::ArrayXd>(x + from, static_cast<Eigen::Index>(count));
}

// Of an expression of such arrays. NaN are left out, one by one; if all are `known` there are none.
template <class Differences> SquareSum sum_of_squares(const Differences& differences, bool known) {
  if (known) return {differences.square().sum(), static_cast<std::size_t>(differences.size())};
  SquareSum total;
  for (Eigen::Index i = 0; i < differences.size(); ++i) {
    const double value = differences.coeff(i);
    if (std::isnan(value)) continue;
    total.sum += value * value;
    ++total.n;
  }
  return total;
}

inline bool is_finite(std::span<const double> x) {
  // infinity or NaN times zero is NaN, and stays so in a sum
  return (stretch_of(x.data(), 0, x.size()) * 0.0).sum() == 0.0;
}

} // namespace goingrate
