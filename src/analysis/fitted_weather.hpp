// Effects of the weather that only the fit shows. Private to the analysis room.
#pragma once

#include "goingrate/causes/diagnosis.hpp"
#include "goingrate/fit/clock_fit.hpp"

#include <span>
#include <vector>

namespace goingrate {

/// Temperature and pressure as causes, with the fit's coefficients: each whose gain in likelihood
/// is as large as diagnose() demands of a cause, unless `named` holds it with a smaller sigma. In
/// the rate they may be hidden by a varying drive or a step, which the fit accounts for. None if
/// the fit leaves the size of the noise open.
std::vector<Suspicion> weather_seen_by_fit(const FitSummary& fit, std::span<const Suspicion> named);

/// Removes the effects of these suspicions from the times.
void take_off(std::span<const Suspicion> weather, TimingData& times);

} // namespace goingrate
