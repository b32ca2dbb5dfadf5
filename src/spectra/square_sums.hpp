// Fast sums of squares over long series. Private to the spectra room.
#pragma once

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

// x[from] .. x[from+count-1] as an array of Eigen, which sums it in several lanes.
inline auto stretch_of(const double* x, std::size_t from, std::size_t count) {
  return Eigen::Map<const Eigen::ArrayXd>(x + from, static_cast<Eigen::Index>(count));
}

// Squares of the first, second or third differences (order 1, 2, 3) at distance m that start at
// p[0] .. p[count-1]. Differences with a NaN are left out. With `known` no phase is NaN, and none
// is looked for.
SquareSum squares_of_differences(const double* p, std::size_t count, std::size_t m,
                                 std::size_t order, bool known);

// Sum of squares of (p[i] - p[i+h-d]) + (p[i+2h] - p[i+h+d]) over i < count; none may be NaN.
double squares_of_bows(const double* p, std::size_t count, std::size_t h, std::size_t d);

inline bool is_finite(std::span<const double> x) {
  // infinity or NaN times zero is NaN, and stays so in a sum
  return (stretch_of(x.data(), 0, x.size()) * 0.0).sum() == 0.0;
}

} // namespace goingrate
