#include "goingrate/report/tables.hpp"

#include "base/scaled_time.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <iterator>

namespace goingrate {

std::string with_sigma(double value, double sigma, int digits) {
  if (!std::isfinite(value)) return "not known";
  if (!(sigma > 0.0) || !std::isfinite(sigma)) return fmt::format("{:.{}g}", value, digits);
  const int first = static_cast<int>(std::floor(std::log10(sigma))); // place of sigma's first digit
  const double size = std::max(std::abs(value), sigma);
  const int top = static_cast<int>(std::floor(std::log10(size)));
  if (top < -3 || top > 6) { // in powers of ten, one exponent for both
    const double unit = std::pow(10.0, top);
    const int decimals = std::max(0, top - first + 1);
    return fmt::format("({:.{}f} +- {:.{}f})e{}", value / unit, decimals, sigma / unit, decimals,
                       top);
  }
  const int decimals = std::max(0, 1 - first);
  return fmt::format("{:.{}f} +- {:.{}f}", value, decimals, sigma, decimals);
}

} // namespace goingrate
