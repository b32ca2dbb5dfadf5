#include "base/readable.hpp"

#include <cmath>
#include <cstdlib>
#include <fmt/format.h>

namespace goingrate {

std::string readable(double value, int digits) {
  constexpr double longest = 1e9; // longer numbers are hard to read
  std::string text = fmt::format("{:.{}g}", value, digits);
  const double size = std::abs(std::strtod(text.c_str(), nullptr)); // rounded
  if (size > 1.0 && size < longest && text.find('e') != std::string::npos)
    return fmt::format("{:.0f}", std::copysign(size, value));
  return text;
}

std::string readable_signed(double value, int digits) {
  return fmt::format("{}{}", std::signbit(value) ? "" : "+", readable(value, digits));
}

} // namespace goingrate
