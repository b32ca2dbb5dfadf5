#include "rms_words.hpp"

#include <cmath>
#include <fmt/format.h>

namespace goingrate {

std::string rms_words(const RmsEstimate& rms, double factor, std::string_view unit,
                      const std::function<std::string(double)>& number) {
  const auto of = [&](double value) { return number(factor * value); };
  if (!std::isfinite(rms.rms)) return "not known";
  if (rms.low68 == 0.0)
    return std::isfinite(rms.high68) ? fmt::format("at most {} {}", of(rms.high68), unit)
                                     : "of any size, as far as the log tells";
  return fmt::format("{} {} ({} to {})", of(rms.rms), unit, of(rms.low68),
                     std::isfinite(rms.high68) ? of(rms.high68) : "any size");
}

} // namespace goingrate
