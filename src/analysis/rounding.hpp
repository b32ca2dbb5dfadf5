// The effect of a logger that rounds its times on the log of a steady clock. Private to the
// analysis room.
#pragma once

#include "goingrate/fit/timing_data.hpp"
#include "goingrate/spectra/lines.hpp"

#include <vector>

namespace goingrate {

/// Whether one steady rate explains all times to within the steps of the logger. The log then shows
/// no change, no line and no noise, whatever pattern the rounding causes
/// (AnalyseTest.ACoarseLoggerShowsNoChange).
bool rounding_explains(const TimingData& times);

/// The lines without those that rounding can cause. The pattern of rounding repeats at the
/// frequency given by the fraction of a step by which a period differs from whole steps, and at its
/// multiples k, as a wave of the times of 1/πk steps; where the rate varies, the pattern spreads
/// about these frequencies and its waves are smaller (AnalyseTest.ACoarseLoggerShowsNoWheel).
std::vector<SpectralLine> without_rounding(std::vector<SpectralLine> lines,
                                           const TimingData& times);

} // namespace goingrate
