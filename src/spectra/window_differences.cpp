// Differences of sums over windows: MDEV, TDEV, PDEV.
#include "mean_squares.hpp"
#include "square_sums.hpp"
#include "window_means.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

namespace goingrate {

namespace {

using Eigen::ArrayXd;
using Eigen::Index;

// Sums over the windows of one width that start at each phase, and, if asked for, their slopes: the
// sums of (k - h) x[i+k], k < width, h = (width - 1)/2. Windows of a and b phases side by side join
// to
//   S = S_a + S_b,   W = W_a + W_b + (a S_b - b S_a)/2,
// so all are widened in a few walks over the data, and each sum is one of sums of similar size.
class Windows {
public:
  Windows(std::span<const double> x, bool with_slopes)
      : x_(x), sum_(stretch_of(x.data(), 0, x.size())),
        slope_(ArrayXd::Zero(with_slopes ? sum_.size() : 0)), count_(sum_.size()) {}

  void widen_to(Index width) {
    while (2 * width_ <= width)
      join(*this);
    if (width_ == width) return;
    Windows rest(x_, slope_.size() > 0);
    rest.widen_to(width - width_);
    join(rest);
  }

  // Shows look(from, number) all windows, a stretch at a time, and makes each stretch twice as wide
  // once it has been seen, if `doubling`: then long rows come from memory once for both.
  template <class Look> void walk(bool doubling, const Look& look) {
    constexpr Index stretch = 1024;
    const Index doubled = doubling ? count_ - width_ : 0;
    for (Index from = 0; from < count_; from += stretch) {
      look(from, std::min(stretch, count_ - from));
      if (from < doubled) join(*this, from, std::min(stretch, doubled - from));
    }
    if (!doubling) return;
    count_ = doubled;
    width_ *= 2;
  }

  // Sums and slopes of the `number` windows that start at x[from], x[from + 1] and so on.
  [[nodiscard]] auto sums(Index from, Index number) const { return sum_.segment(from, number); }
  [[nodiscard]] auto slopes(Index from, Index number) const { return slope_.segment(from, number); }

private:
  // Appends to each window the one of `next` that begins where it ends.
  void join(const Windows& next) {
    count_ = std::min(count_, next.count_ - width_);
    join(next, 0, count_);
    width_ += next.width_;
  }

  // The same for some of them; `next` may be these: from the front in place, as what is read lies
  // at or behind what is written.
  void join(const Windows& next, Index from, Index number) {
    const double half = 0.5 * static_cast<double>(width_);
    const double half_of_next = 0.5 * static_cast<double>(next.width_);
    if (slope_.size() > 0)
      slope_.segment(from, number) +=
          next.slopes(from + width_, number) +
          (half * next.sums(from + width_, number) - half_of_next * sums(from, number));
    sum_.segment(from, number) += next.sums(from + width_, number);
  }

  std::span<const double> x_;
  ArrayXd sum_, slope_;
  Index count_, width_ = 1;
};

MeanSquares differences_of_known_means(std::span<const double> x) {
  return one_by_one([means = std::make_shared<const WindowMeans>(x),
                     points = x.size()](std::size_t m) -> MeanSquare {
    if (3 * m > points) return {};
    SquareSum total;
    for (std::size_t i = 0; i + 3 * m <= points; ++i) {
      const double middle = means->mean(i + m, m);
      const double bend = (means->mean(i + 2 * m, m) - middle) - (middle - means->mean(i, m));
      if (!std::isnan(bend)) total += {bend * bend, 1};
    }
    if (total.n == 0) return {};
    return {total.sum / (2.0 * static_cast<double>(total.n)), total.n};
  });
}

// The mean squares at all factors; squares(windows, m, from, number) is the sum of those that start
// at x[from] and on, and each factor has starts(m) of them.
template <class Squares, class Starts>
std::vector<MeanSquare> of_windows(Windows windows, std::span<const std::size_t> factors,
                                   const Squares& squares, const Starts& starts) {
  std::vector<MeanSquare> means(factors.size());
  for (std::size_t k = 0; k < factors.size() && starts(factors[k]) > 0; ++k) {
    const auto m = static_cast<Index>(factors[k]);
    const auto end = static_cast<Index>(starts(factors[k]));
    const bool doubling = k + 1 < factors.size() && factors[k + 1] == 2 * factors[k];
    double sum = 0.0;
    windows.widen_to(m);
    windows.walk(doubling, [&](Index from, Index number) {
      if (from < end) sum += squares(windows, m, from, std::min(number, end - from));
    });
    means[k] = {sum / static_cast<double>(end), static_cast<std::size_t>(end)};
  }
  return means;
}

} // namespace

MeanSquares mean_phase_differences(std::span<const double> x, bool known) {
  if (!known) return differences_of_known_means(x);
  return [x](std::span<const std::size_t> factors) {
    const auto starts = [&](std::size_t m) { return 3 * m > x.size() ? 0 : x.size() + 1 - 3 * m; };
    const auto squares = [](const Windows& windows, Index m, Index from, Index number) {
      const auto at = [&](Index k) { return windows.sums(from + k * m, number); };
      return ((at(2) - at(1)) - (at(1) - at(0))).square().sum();
    };
    std::vector<MeanSquare> means = of_windows({x, false}, factors, squares, starts);
    for (std::size_t k = 0; k < factors.size(); ++k)
      means[k].value /= 2.0 * std::pow(static_cast<double>(factors[k]), 2);
    return means;
  };
}

MeanSquares slope_differences(std::span<const double> x) {
  return [x](std::span<const std::size_t> factors) {
    const auto starts = [&](std::size_t m) { return 2 * m > x.size() ? 0 : x.size() - 2 * m; };
    const auto squares = [](const Windows& windows, Index m, Index from, Index number) {
      return (windows.slopes(from + m, number) - windows.slopes(from, number)).square().sum();
    };
    std::vector<MeanSquare> means = of_windows({x, true}, factors, squares, starts);
    for (std::size_t k = 0; k < factors.size(); ++k)
      means[k].value *= 72.0 / std::pow(static_cast<double>(factors[k]), 4);
    if (factors[0] == 1)
      means[0] = at_one(phase_differences(x, true, 2, true), 1); // no line through one
    return means;
  };
}

} // namespace goingrate
