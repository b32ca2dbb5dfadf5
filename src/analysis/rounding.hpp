// What a logger that rounds its times makes of a steady clock. Private to the analysis room.
#pragma once

#include "goingrate/fit/timing_data.hpp"
#include "goingrate/spectra/lines.hpp"

#include <vector>

namespace goingrate {

/// Whether one steady rate explains all times to within the steps of the logger: then the
/// log shows no change, no line and no noise, whatever pattern the rounding makes
/// (AnalyseTest.ACoarseLoggerShowsNoChange).
bool rounding_explains(const TimingData& times);

/// The lines less those that rounding can make. Its pattern comes round with the fraction by which
/// a period differs from whole steps, and with multiples of it; none of them moves the rate by
/// more than a step in a period.
std::vector<SpectralLine> without_rounding(std::vector<SpectralLine> lines,
                                           const TimingData& times);

} // namespace goingrate
