#include "row_stack.hpp"

#include "base/lanes.hpp"

#include <cmath>
#include <cstring>

// Vectors of eight are passed between functions of this file only, which are all inlined.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace goingrate::timing_model {

namespace {

typedef double Lanes __attribute__((vector_size(64)));
constexpr Eigen::Index lanes = 8;

[[gnu::always_inline]] inline Lanes lanes_at(const double* x) {
  Lanes result;
  std::memcpy(&result, x, sizeof result);
  return result;
}

[[gnu::always_inline]] inline double sum(const Lanes& x) {
  return ((x[0] + x[1]) + (x[2] + x[3])) + ((x[4] + x[5]) + (x[6] + x[7]));
}

[[gnu::always_inline]] inline double dot(const double* a, const double* b, Eigen::Index count) {
  Lanes even{}, odd{};
  Eigen::Index i = 0;
  for (; i + 2 * lanes <= count; i += 2 * lanes) {
    even += lanes_at(a + i) * lanes_at(b + i);
    odd += lanes_at(a + i + lanes) * lanes_at(b + i + lanes);
  }
  for (; i < count; i += lanes)
    even += lanes_at(a + i) * lanes_at(b + i);
  return sum(even + odd);
}

[[gnu::always_inline]] inline void add_multiple(double factor, const double* x, double* y,
                                                Eigen::Index count) {
  for (Eigen::Index i = 0; i < count; i += lanes) {
    const Lanes moved = lanes_at(y + i) + factor * lanes_at(x + i);
    std::memcpy(y + i, &moved, sizeof moved);
  }
}

// Householder steps on a triangle of `size` columns with `count` rows below it, a multiple of
// `lanes`; columns are `stride` apart. Reflector k touches row k of the triangle and the rows below
// it only: between them column k is zero.
GOINGRATE_WIDEST_LANES
void fold_below(double* triangle, Eigen::Index size, double* rows, Eigen::Index stride,
                Eigen::Index count) {
  for (Eigen::Index k = 0; k < size; ++k) {
    double* const column = rows + k * stride;
    const double below = dot(column, column, count);
    if (below == 0.0) continue;
    double& diagonal = triangle[k * size + k];
    const double length = std::sqrt(diagonal * diagonal + below);
    const double folded = diagonal > 0.0 ? -length : length; // no cancellation in the difference
    const double head = diagonal - folded;
    const double scale = 2.0 / (head * head + below);
    diagonal = folded;
    for (Eigen::Index j = k + 1; j < size; ++j) {
      double& beside = triangle[j * size + k];
      double* const other = rows + j * stride;
      const double along = scale * (head * beside + dot(column, other, count));
      beside -= along * head;
      add_multiple(-along, column, other, count);
    }
  }
}

} // namespace

void RowStack::fold() {
  if (used_ == 0) return;
  const Eigen::Index count = (used_ + lanes - 1) / lanes * lanes;
  fold_below(triangle_.data(), n_ + 1, rows_.data(), block, count);
  rows_.topRows(count).setZero();
  used_ = 0;
}

void RowStack::add(RowStack& other) {
  other.fold();
  for (Eigen::Index i = 0; i <= n_; ++i)
    add(other.triangle_(i, n_), [&](Eigen::Index k) { return other.triangle_(i, k); });
}

} // namespace goingrate::timing_model
