#include "base/readable.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>

namespace goingrate {

std::string readable(double value, int digits) {
  constexpr double first_with_commas = 1e4, longest = 1e9; // longer numbers are hard to read
  std::string text = fmt::format("{:.{}g}", value, digits);
  const double size = std::abs(std::strtod(text.c_str(), nullptr)); // rounded
  if (!(size < longest)) return text;
  if (size > 1.0 && text.find('e') != std::string::npos)
    text = fmt::format("{:.0f}", std::copysign(size, value));
  if (size < first_with_commas) return text;
  std::size_t at = std::min(text.find('.'), text.size());
  for (const std::size_t first = value < 0.0 ? 1 : 0; at > first + 3;)
    text.insert(at -= 3, 1, ',');
  return text;
}

std::string readable_signed(double value, int digits) {
  return fmt::format("{}{}", std::signbit(value) ? "" : "+", readable(value, digits));
}

} // namespace goingrate
