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
                                     : "of a size that the log leaves open";
  const std::string interval = std::isfinite(rms.high68)
                                   ? fmt::format("{} to {}", of(rms.low68), of(rms.high68))
                                   : fmt::format("{} or more", of(rms.low68));
  return fmt::format("{} {} ({})", of(rms.rms), unit, interval);
}

} // namespace goingrate
