// Means over windows of any length, gaps or not. Private to the spectra room.
#pragma once

#include "goingrate/base/sums.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace goingrate {

// Means over windows of m samples that start at i, from sums of the known values and of their
// number.
class WindowMeans {
public:
  explicit WindowMeans(std::span<const double> x) {
    sums_.reserve(x.size() + 1);
    sums_.emplace_back();
    for (const double value : x) {
      sums_.push_back(sums_.back());
      if (!std::isnan(value)) sums_.back() += value;
    }
    if (std::none_of(x.begin(), x.end(), [](double value) { return std::isnan(value); })) return;
    known_.reserve(x.size() + 1);
    known_.push_back(0);
    for (const double value : x)
      known_.push_back(known_.back() + (std::isnan(value) ? 0 : 1));
  }

  // NaN if less than half of the window is known.
  [[nodiscard]] double mean(std::size_t i, std::size_t m) const {
    const std::size_t count = known_.empty() ? m : known_[i + m] - known_[i];
    if (2 * count < m) return std::numeric_limits<double>::quiet_NaN();
    return ((sums_[i + m].hi - sums_[i].hi) + (sums_[i + m].lo - sums_[i].lo)) /
           static_cast<double>(count);
  }

private:
  std::vector<std::size_t> known_; // of the values before each; empty if all are known
  std::vector<TwoPart<double>> sums_;
};

} // namespace goingrate
