// Means over windows of any length, gaps or not. Private to the spectra room.
#pragma once

#include "goingrate/base/sums.hpp"

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
  explicit WindowMeans(std::span<const double> x)
      : known_(x.size() + 1, std::size_t{0}), sums_(x.size() + 1) {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const bool known = !std::isnan(x[i]);
      known_[i + 1] = known_[i] + (known ? 1 : 0);
      sums_[i + 1] = sums_[i];
      if (known) sums_[i + 1] += x[i];
    }
  }

  // NaN if less than half of the window is known.
  [[nodiscard]] double mean(std::size_t i, std::size_t m) const {
    const std::size_t count = known_[i + m] - known_[i];
    if (2 * count < m) return std::numeric_limits<double>::quiet_NaN();
    return ((sums_[i + m].hi - sums_[i].hi) + (sums_[i + m].lo - sums_[i].lo)) /
           static_cast<double>(count);
  }

private:
  std::vector<std::size_t> known_;
  std::vector<TwoPart<double>> sums_;
};

} // namespace goingrate
