// Largest ranges in sliding windows: MTIE.
#include "base/special_values.hpp"
#include "mean_squares.hpp"
#include "square_sums.hpp"

#include <algorithm>
#include <cmath>

namespace goingrate {

namespace {

// Maximum and minimum of every window of 2^k samples. A window of another length is the union of
// two overlapping ones, so each factor, and each doubling between factors, costs one pass over the
// data.
class SlidingExtremes {
public:
  explicit SlidingExtremes(std::span<const double> x)
      : high_(x.begin(), x.end()), low_(high_), known_(is_finite(x)) {
    if (known_) return;
    std::replace_if(
        high_.begin(), high_.end(), [](double v) { return std::isnan(v); }, -infinite);
    std::replace_if(
        low_.begin(), low_.end(), [](double v) { return std::isnan(v); }, infinite);
  }

  // The largest range within `width` samples, not less than asked for before, and how many windows
  // hold a known value.
  MeanSquare largest(std::size_t width) {
    while (2 * width_ <= width)
      grow();
    const std::size_t windows = high_.size() + 1 - width, shift = width - width_;
    const auto range =
        stretch_of(high_.data(), 0, windows).max(stretch_of(high_.data(), shift, windows)) -
        stretch_of(low_.data(), 0, windows).min(stretch_of(low_.data(), shift, windows));
    const auto known = known_ ? range.size() : (range >= 0.0).count();
    return {range.maxCoeff(), static_cast<std::size_t>(known)};
  }

private:
  void grow() {
    const std::size_t windows = high_.size() + 1 - 2 * width_;
    const auto count = static_cast<Eigen::Index>(windows);
    Eigen::Map<Eigen::ArrayXd> high(high_.data(), count), low(low_.data(), count);
    high = high.max(stretch_of(high_.data(), width_, windows)); // from the front: reads what is new
    low = low.min(stretch_of(low_.data(), width_, windows));    // to it before that is written
    width_ *= 2;
  }

  std::vector<double> high_, low_; // of the windows of width_ that start at each sample
  std::size_t width_ = 1;
  bool known_;
};

} // namespace

MeanSquares largest_ranges(std::span<const double> x) {
  return [x](std::span<const std::size_t> factors) {
    std::vector<MeanSquare> squares(factors.size());
    SlidingExtremes extremes(x);
    for (std::size_t k = 0; k < factors.size() && factors[k] < x.size(); ++k) {
      const MeanSquare largest = extremes.largest(factors[k] + 1);
      if (largest.n > 0) squares[k] = {largest.value * largest.value, largest.n};
    }
    return squares;
  };
}

} // namespace goingrate
