#include "mean_squares.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "goingrate/base/sums.hpp"

namespace goingrate {
namespace {

struct SquareSum {
  double sum = 0.0;
  std::size_t n = 0;
};

MeanSquare mean_of(const SquareSum& total, double divisor) {
  if (total.n == 0) return {};
  return {total.sum / (divisor * static_cast<double>(total.n)), total.n};
}

bool is_whole(std::span<const double> x) {
  return std::none_of(x.begin(), x.end(), [](double v) { return std::isnan(v); });
}

// Squares of term(i), i = 0, stride, ... below `end`, NaN left out.
template <class Term>
SquareSum sum_of_known_squares(std::size_t end, std::size_t stride, const Term& term) {
  SquareSum total;
  for (std::size_t i = 0; i < end; i += stride) {
    const double value = term(i);
    if (std::isnan(value)) continue;
    total.sum += value * value;
    ++total.n;
  }
  return total;
}

// The same where none is NaN and the stride is 1. Eight sums, so that one addition need not wait
// for the one before and the compiler may pair them.
template <class Term> SquareSum sum_of_squares(std::size_t end, const Term& term) {
  constexpr std::size_t lanes = 8;
  std::array<double, lanes> sums{};
  std::size_t i = 0;
  for (; i + lanes <= end; i += lanes)
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const double value = term(i + lane);
      sums[lane] += value * value;
    }
  SquareSum total{0.0, end};
  for (; i < end; ++i)
    total.sum += term(i) * term(i);
  for (double sum : sums)
    total.sum += sum;
  return total;
}

template <class Term>
MeanSquare mean_square(std::size_t end, std::size_t stride, bool whole, double divisor,
                       const Term& term) {
  return mean_of(whole && stride == 1 ? sum_of_squares(end, term)
                                      : sum_of_known_squares(end, stride, term),
                 divisor);
}

// Sums of the first k values in two parts: a difference of two neighbouring sums keeps all digits.
struct PrefixSums {
  std::vector<double> hi, lo;

  explicit PrefixSums(std::span<const double> values) {
    hi.reserve(values.size() + 1);
    lo.reserve(values.size() + 1);
    TwoPart<double> sum;
    hi.push_back(0.0);
    lo.push_back(0.0);
    for (double v : values) {
      sum += v;
      hi.push_back(sum.hi);
      lo.push_back(sum.lo);
    }
  }

  double between(std::size_t from, std::size_t to) const {
    return (hi[to] - hi[from]) + (lo[to] - lo[from]);
  }
};

// Means over windows of m samples that start at i, from prefix sums of the known values and of
// their number.
struct WindowMeans {
  PrefixSums sums;
  std::vector<std::size_t> known;

  explicit WindowMeans(std::span<const double> x)
      : sums(zero_for_gaps(x)), known(x.size() + 1, std::size_t{0}) {
    for (std::size_t i = 0; i < x.size(); ++i)
      known[i + 1] = known[i] + (std::isnan(x[i]) ? 0 : 1);
  }

  double mean(std::size_t i, std::size_t m) const {
    const std::size_t count = known[i + m] - known[i];
    if (2 * count < m) return std::numeric_limits<double>::quiet_NaN();
    return sums.between(i, i + m) / static_cast<double>(count);
  }

  static std::vector<double> zero_for_gaps(std::span<const double> x) {
    std::vector<double> filled(x.begin(), x.end());
    for (double& v : filled)
      if (std::isnan(v)) v = 0.0;
    return filled;
  }
};

// Largest and smallest so far; a NaN compares as neither.
struct Range {
  double high = -std::numeric_limits<double>::infinity();
  double low = std::numeric_limits<double>::infinity();

  void include(double v) {
    high = v > high ? v : high;
    low = v < low ? v : low;
  }
};

// The largest range within `width` neighbours, and how many windows hold a known value. Block by
// block: a window is the tail of one block and the head of the next (M. van Herk 1992).
MeanSquare largest_range(std::span<const double> x, std::size_t width) {
  const std::size_t windows = x.size() + 1 - width;
  std::vector<Range> tail(width);
  MeanSquare largest{-1.0, 0};
  for (std::size_t block = 0; block < windows; block += width) {
    Range range;
    for (std::size_t k = width; k-- > 0;) {
      range.include(x[block + k]);
      tail[k] = range;
    }
    Range head;
    for (std::size_t k = 0; k < width && block + k < windows; ++k) {
      if (k > 0) head.include(x[block + k + width - 1]);
      const double high = std::max(tail[k].high, head.high);
      const double extent = high - std::min(tail[k].low, head.low);
      largest.value = std::max(largest.value, extent);
      largest.n += extent >= 0.0 ? 1 : 0;
    }
  }
  return largest;
}

} // namespace

MeanSquareAt phase_differences(std::span<const double> x, std::size_t order, bool overlapped) {
  return [x, order, overlapped, whole = is_whole(x)](std::size_t m) -> MeanSquare {
    if (order * m >= x.size()) return {};
    const std::size_t end = x.size() - order * m, stride = overlapped ? 1 : m;
    const double* p = x.data();
    if (order == 1)
      return mean_square(end, stride, whole, 1.0, [=](std::size_t i) { return p[i + m] - p[i]; });
    if (order == 2)
      return mean_square(end, stride, whole, 2.0, [=](std::size_t i) {
        return (p[i + 2 * m] - p[i + m]) - (p[i + m] - p[i]);
      });
    return mean_square(end, stride, whole, 6.0, [=](std::size_t i) {
      return (p[i + 3 * m] - p[i]) - 3.0 * (p[i + 2 * m] - p[i + m]);
    });
  };
}

MeanSquareAt mean_phase_differences(std::span<const double> x) {
  if (!is_whole(x)) {
    return [means = std::make_shared<const WindowMeans>(x), points = x.size()](std::size_t m) {
      if (3 * m > points) return MeanSquare{};
      return mean_square(points - 3 * m + 1, 1, false, 2.0, [&](std::size_t i) {
        const double middle = means->mean(i + m, m);
        return (means->mean(i + 2 * m, m) - middle) - (middle - means->mean(i, m));
      });
    };
  }
  return [sums = std::make_shared<const PrefixSums>(x), points = x.size()](std::size_t m) {
    if (3 * m > points) return MeanSquare{};
    const double* hi = sums->hi.data();
    const double* lo = sums->lo.data();
    const double size = static_cast<double>(m);
    return mean_square(points - 3 * m + 1, 1, true, 2.0 * size * size, [=](std::size_t i) {
      const double first = hi[i + m] - hi[i], middle = hi[i + 2 * m] - hi[i + m];
      const double last = hi[i + 3 * m] - hi[i + 2 * m];
      const double rest = (lo[i + 3 * m] - lo[i]) - 3.0 * (lo[i + 2 * m] - lo[i + m]);
      return ((last - middle) - (middle - first)) + rest;
    });
  };
}

MeanSquareAt slope_differences(std::span<const double> x) {
  // long double: the second prefix sums grow like N^2 x, and what is wanted like m^2 x
  auto once = std::make_shared<std::vector<long double>>(1, 0.0L);
  for (double v : x)
    once->push_back(once->back() + static_cast<long double>(v));
  auto twice = std::make_shared<std::vector<long double>>(1, 0.0L);
  for (long double v : *once)
    twice->push_back(twice->back() + v);
  return [x, once, twice](std::size_t m) -> MeanSquare {
    if (m == 1) return phase_differences(x, 2, true)(1);
    if (2 * m >= x.size()) return {};
    const long double* p = once->data();  // p[j]: the sum of x[0 .. j-1]
    const long double* q = twice->data(); // q[j]: the sum of p[0 .. j-1]
    const long double half = 0.5L * static_cast<long double>(m - 1);
    // sum_{k<m} k x[i+k] = (m-1) p[i+m] - (p[i+1] + ... + p[i+m-1])
    const auto weighted = [=](std::size_t i) {
      return half * (p[i + m] + p[i]) - (q[i + m] - q[i + 1]);
    };
    const double size = static_cast<double>(m);
    MeanSquare mean = mean_square(x.size() - 2 * m, 1, true, 1.0, [=](std::size_t i) {
      return static_cast<double>(weighted(i + m) - weighted(i));
    });
    mean.value *= 72.0 / (size * size * size * size);
    return mean;
  };
}

MeanSquareAt largest_ranges(std::span<const double> x) {
  return [x](std::size_t m) -> MeanSquare {
    if (m >= x.size()) return {};
    const MeanSquare largest = largest_range(x, m + 1);
    if (largest.n == 0) return {};
    return {largest.value * largest.value, largest.n};
  };
}

} // namespace goingrate
