// How many events were not one beat each. Private to the report.
#pragma once

#include "goingrate/log/beats.hpp"

#include <fmt/format.h>
#include <string>

namespace goingrate {

/// "3 missed, 0 spurious", and bounces where there are any.
inline std::string fault_counts(const Beats& beats) {
  std::string text = fmt::format("{} missed, {} spurious", beats.missed, beats.spurious);
  if (beats.bounces > 0)
    text += fmt::format(", {} bounce{}", beats.bounces, beats.bounces == 1 ? "" : "s");
  return text;
}

} // namespace goingrate
