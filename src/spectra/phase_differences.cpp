// Differences of single phases: ADEV, OADEV, HDEV, OHDEV, TIErms, TOTDEV.
#include "mean_squares.hpp"
#include "square_sums.hpp"

#include <algorithm>
#include <utility>

namespace goingrate {

namespace {

MeanSquare mean_of(const SquareSum& total, double divisor) {
  if (total.n == 0) return {};
  return {total.sum / (divisor * static_cast<double>(total.n)), total.n};
}

// Squares of the differences of `order` that start at p[0] .. p[count-1].
SquareSum squares_of_differences(const double* p, std::size_t count, std::size_t m,
                                 std::size_t order, bool known) {
  const auto at = [=](std::size_t k) { return stretch_of(p, k * m, count); };
  if (order == 1) return sum_of_squares(at(1) - at(0), known);
  if (order == 2) return sum_of_squares((at(2) - at(1)) - (at(1) - at(0)), known);
  return sum_of_squares((at(3) - at(0)) - 3.0 * (at(2) - at(1)), known);
}

constexpr double divisors[] = {1.0, 1.0, 2.0, 6.0}; // by order
constexpr std::size_t block = 2048;                 // what is summed at a time: a few roundings

// All factors in one walk over x: of long rows each phase then comes from memory once or twice for
// each factor, and the two factors of an octave share what they fetch.
std::vector<MeanSquare> overlapped(std::span<const double> x, bool known, std::size_t order,
                                   std::span<const std::size_t> factors) {
  std::vector<SquareSum> sums(factors.size());
  for (std::size_t begin = 0; begin < x.size(); begin += block)
    for (std::size_t k = 0; k < factors.size(); ++k) {
      const std::size_t m = factors[k];
      if (begin + order * m >= x.size()) break; // and so will all longer ones
      const std::size_t end = std::min(block, x.size() - order * m - begin);
      sums[k] += squares_of_differences(x.data() + begin, end, m, order, known);
    }
  std::vector<MeanSquare> means;
  for (const SquareSum& sum : sums)
    means.push_back(mean_of(sum, divisors[order]));
  return means;
}

// Every m-th phase. A factor that is a multiple of the one before is taken from what that left,
// which lies closer together: an octave then fetches each row of memory twice, not at every factor.
class EveryNth {
public:
  explicit EveryNth(std::span<const double> x) : all_(x) {}

  std::span<const double> operator()(std::size_t m) {
    if (m == 1) return all_;
    const bool onwards = !kept_.empty() && m % stride_ == 0;
    const std::span<const double> from = onwards ? kept_ : all_;
    const std::size_t step = onwards ? m / stride_ : m, count = (from.size() - 1) / step + 1;
    if (!onwards) kept_.resize(count);
    for (std::size_t k = 0; k < count; ++k)
      kept_[k] = from[k * step];
    kept_.resize(count);
    stride_ = m;
    return kept_;
  }

private:
  std::span<const double> all_;
  std::vector<double> kept_;
  std::size_t stride_ = 1;
};

// Starts a factor apart.
std::vector<MeanSquare> strided(std::span<const double> x, bool known, std::size_t order,
                                std::span<const std::size_t> factors) {
  EveryNth every(x);
  std::vector<MeanSquare> means;
  for (const std::size_t m : factors) {
    if (order * m >= x.size()) {
      means.emplace_back();
      continue;
    }
    const auto phases = every(m);
    const std::size_t starts = phases.size() - order;
    SquareSum sum;
    for (std::size_t begin = 0; begin < starts; begin += block)
      sum += squares_of_differences(phases.data() + begin, std::min(block, starts - begin), 1,
                                    order, known);
    means.push_back(mean_of(sum, divisors[order]));
  }
  return means;
}

// Second differences centred on x[1] .. x[last-1]. Where they reach over an end, the phase there is
// that of the mirror: 2 x[0] - x[k] at -k, and 2 x[last] - x[last-k] at last + k.
SquareSum reflected_squares(std::span<const double> x, bool known, std::size_t m) {
  const std::size_t last = x.size() - 1;
  const double* p = x.data();
  const double left = 2.0 * p[0], right = 2.0 * p[last];
  const auto down_from = [=](std::size_t highest, std::size_t count) {
    return stretch_of(p, highest + 1 - count, count).reverse();
  };
  // Centres below m reach over the left end, those above last - m over the right one.
  const std::size_t first = std::min(m, last - m + 1), second = std::max(m, last - m + 1);
  const std::size_t before = first - 1, between = second - first, behind = last - second;
  const auto centre = stretch_of(p, 1, before), last_centre = stretch_of(p, second, behind);
  SquareSum sum = sum_of_squares((stretch_of(p, 1 + m, before) - centre) -
                                     (centre - (left - down_from(m - 1, before))),
                                 known);
  if (2 * m <= last) {
    sum += squares_of_differences(p, between, m, 2, known);
  } else {
    const auto middle = stretch_of(p, first, between);
    sum += sum_of_squares(((right - down_from(2 * last - m - first, between)) - middle) -
                              (middle - (left - down_from(m - first, between))),
                          known);
  }
  sum += sum_of_squares(((right - down_from(2 * last - m - second, behind)) - last_centre) -
                            (last_centre - stretch_of(p, second - m, behind)),
                        known);
  return sum;
}

} // namespace

MeanSquares one_by_one(MeanSquareAt at) {
  return [at = std::move(at)](std::span<const std::size_t> factors) {
    std::vector<MeanSquare> means;
    for (std::size_t m : factors)
      means.push_back(at(m));
    return means;
  };
}

MeanSquares phase_differences(std::span<const double> x, bool known, std::size_t order,
                              bool overlap) {
  return [=](std::span<const std::size_t> factors) {
    return overlap ? overlapped(x, known, order, factors) : strided(x, known, order, factors);
  };
}

MeanSquares reflected_differences(std::span<const double> x, bool known) {
  return one_by_one([=](std::size_t m) {
    return m < x.size() ? mean_of(reflected_squares(x, known, m), divisors[2]) : MeanSquare{};
  });
}

} // namespace goingrate
