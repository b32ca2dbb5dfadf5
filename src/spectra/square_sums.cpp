#include "square_sums.hpp"

#include <array>
#include <cmath>

#include "base/per_processor.hpp"

namespace goingrate {

namespace {

// The sum of square(0) .. square(count-1), in lanes that need not wait for each other.
template <class Square>
GOINGRATE_INLINE inline double in_lanes(std::size_t count, const Square& square) {
  std::array<double, 8> lanes{};
  std::size_t i = 0;
  for (; i + lanes.size() <= count; i += lanes.size())
    for (std::size_t k = 0; k < lanes.size(); ++k)
      lanes[k] += square(i + k);
  double sum = 0.0;
  for (const double lane : lanes)
    sum += lane;
  for (; i < count; ++i)
    sum += square(i);
  return sum;
}

GOINGRATE_INLINE inline double first_difference(const double* p, std::size_t m) {
  return p[m] - p[0];
}
GOINGRATE_INLINE inline double second_difference(const double* p, std::size_t m) {
  return (p[2 * m] - p[m]) - (p[m] - p[0]);
}
GOINGRATE_INLINE inline double third_difference(const double* p, std::size_t m) {
  return (p[3 * m] - p[0]) - 3.0 * (p[2 * m] - p[m]);
}

template <class Difference>
GOINGRATE_INLINE inline double squares_of(std::size_t count, const Difference& difference) {
  return in_lanes(count, [&](std::size_t i) GOINGRATE_INLINE {
    const double value = difference(i);
    return value * value;
  });
}

// The sum over the differences that are known.
template <class Difference>
SquareSum known_squares(std::size_t count, const Difference& difference) {
  SquareSum total;
  for (std::size_t i = 0; i < count; ++i) {
    const double value = difference(i);
    if (!std::isnan(value)) total += {value * value, 1};
  }
  return total;
}

// With AVX2 the sums take about two thirds of the time; less is gained where memory is slow.
GOINGRATE_PER_PROCESSOR("avx2")
double first_squares(const double* p, std::size_t count, std::size_t m) {
  return squares_of(count,
                    [=](std::size_t i) GOINGRATE_INLINE { return first_difference(p + i, m); });
}
GOINGRATE_PER_PROCESSOR("avx2")
double second_squares(const double* p, std::size_t count, std::size_t m) {
  return squares_of(count,
                    [=](std::size_t i) GOINGRATE_INLINE { return second_difference(p + i, m); });
}
GOINGRATE_PER_PROCESSOR("avx2")
double third_squares(const double* p, std::size_t count, std::size_t m) {
  return squares_of(count,
                    [=](std::size_t i) GOINGRATE_INLINE { return third_difference(p + i, m); });
}
GOINGRATE_PER_PROCESSOR("avx2")
double bow_squares(const double* p, std::size_t count, std::size_t h, std::size_t d) {
  return squares_of(count, [=](std::size_t i) GOINGRATE_INLINE {
    return (p[i] - p[i + h - d]) + (p[i + 2 * h] - p[i + h + d]);
  });
}

} // namespace

SquareSum squares_of_differences(const double* p, std::size_t count, std::size_t m,
                                 std::size_t order, bool known) {
  if (order == 1) {
    if (known) return {first_squares(p, count, m), count};
    return known_squares(count, [=](std::size_t i) { return first_difference(p + i, m); });
  }
  if (order == 2) {
    if (known) return {second_squares(p, count, m), count};
    return known_squares(count, [=](std::size_t i) { return second_difference(p + i, m); });
  }
  if (known) return {third_squares(p, count, m), count};
  return known_squares(count, [=](std::size_t i) { return third_difference(p + i, m); });
}

double squares_of_bows(const double* p, std::size_t count, std::size_t h, std::size_t d) {
  return bow_squares(p, count, h, d);
}

} // namespace goingrate
