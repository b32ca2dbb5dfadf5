// The mean amplitude at either end of a log. Private to the report.
#pragma once

#include "goingrate/log/beats.hpp"

#include <limits>
#include <vector>

namespace goingrate {

/// A mean of amplitudes, with the standard error of that mean; NaN where unknown.
struct MeanAmplitude {
  double rad = std::numeric_limits<double>::quiet_NaN();
  double sigma_rad = std::numeric_limits<double>::quiet_NaN();
  int beats = 0;
};

/// The mean amplitude of the first quarter of the beats, or with `end` of the last, but of no more
/// than twenty.
MeanAmplitude amplitude_at(const std::vector<Beat>& beats, bool end);

} // namespace goingrate
