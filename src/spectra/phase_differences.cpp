// Differences of single phases: ADEV, OADEV, HDEV, OHDEV, TIErms, TOTDEV.
#include "mean_squares.hpp"
#include "square_sums.hpp"

#include <algorithm>
#include <memory>
#include <utility>

namespace goingrate {

namespace {

MeanSquare mean_of(const SquareSum& total, double divisor) {
  if (total.n == 0) return {};
  return {total.sum / (divisor * static_cast<double>(total.n)), total.n};
}

constexpr double divisors[] = {1.0, 1.0, 2.0, 6.0}; // by order
constexpr std::size_t block = 2048;                 // what is summed at a time: a few roundings

// Where the differences at one factor begin, and how many there are.
struct Starts {
  std::size_t first, count;
};

// All factors in one pass over x, block by block: of a long series each phase then comes from memory
// once or twice for each factor, and the factors m and 2m share what they read.
template <class StartsAt>
std::vector<MeanSquare> overlapped(std::span<const double> x, bool known, std::size_t order,
                                   std::span<const std::size_t> factors,
                                   const StartsAt& starts_at) {
  std::vector<SquareSum> sums(factors.size());
  bool more = true;
  for (std::size_t begin = 0; more; begin += block) {
    more = false;
    for (std::size_t k = 0; k < factors.size(); ++k) {
      const auto [first, count] = starts_at(factors[k]);
      if (begin >= count) continue;
      more = true;
      sums[k] += squares_of_differences(x.data() + first + begin, std::min(block, count - begin),
                                        factors[k], order, known);
    }
  }
  std::vector<MeanSquare> means;
  for (const SquareSum& sum : sums)
    means.push_back(mean_of(sum, divisors[order]));
  return means;
}

// Every m-th phase, gathered a block at a time. Where m is a multiple of the factor before, it is
// gathered from the phases of that one, which lie next to each other: factors that double then do
// not read the whole series again each time.
class EveryNth {
public:
  explicit EveryNth(std::span<const double> x) : all_(x), phases_(x) {}

  // Returns how many there are.
  std::size_t take(std::size_t m) {
    const bool onwards = kept_ != nullptr && m % stride_ == 0;
    from_ = onwards ? phases_ : all_;
    step_ = onwards ? m / stride_ : m;
    const std::size_t count = (from_.size() - 1) / step_ + 1;
    if (m > 1 && !onwards) kept_ = std::make_unique_for_overwrite<double[]>(count);
    phases_ = m > 1 ? std::span<const double>(kept_.get(), count) : all_;
    fetched_ = m > 1 ? 0 : count;
    stride_ = m;
    return count;
  }

  // The phases from `begin` on, of which those before `end` are fetched.
  const double* up_to(std::size_t begin, std::size_t end) {
    for (; fetched_ < end; ++fetched_)
      kept_[fetched_] = from_[fetched_ * step_]; // in place: never behind what is read next
    return phases_.data() + begin;
  }

private:
  std::span<const double> all_, phases_, from_{};
  std::unique_ptr<double[]> kept_;
  std::size_t stride_ = 1, step_ = 1, fetched_ = 0;
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
    const std::size_t starts = every.take(m) - order;
    SquareSum sum;
    for (std::size_t begin = 0; begin < starts; begin += block) {
      const std::size_t count = std::min(block, starts - begin);
      const double* phases = every.up_to(begin, begin + count + order);
      sum += squares_of_differences(phases, count, 1, order, known);
    }
    means.push_back(mean_of(sum, divisors[order]));
  }
  return means;
}

// x reflected through its first and its last value: 2 x[0] - x[k] for k = last .. 1, x, and
// 2 x[last] - x[last-k] for k = 1 .. last.
Eigen::ArrayXd with_reflections(std::span<const double> x) {
  const auto last = static_cast<Eigen::Index>(x.size()) - 1;
  const auto inner = stretch_of(x.data(), 0, x.size());
  Eigen::ArrayXd all(3 * last + 1);
  all << 2.0 * x.front() - inner.tail(last).reverse(), inner,
      2.0 * x.back() - inner.head(last).reverse();
  return all;
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
    if (!overlap) return strided(x, known, order, factors);
    return overlapped(x, known, order, factors, [=](std::size_t m) {
      return Starts{0, order * m < x.size() ? x.size() - order * m : 0};
    });
  };
}

MeanSquares reflected_differences(std::span<const double> x, bool known) {
  return [=, all = std::make_shared<const Eigen::ArrayXd>(with_reflections(x))](
             std::span<const std::size_t> factors) {
    return overlapped({all->data(), all->data() + all->size()}, known, 2, factors,
                      [=](std::size_t m) {
                        return m < x.size() ? Starts{x.size() - m, x.size() - 2} : Starts{0, 0};
                      });
  };
}

} // namespace goingrate
