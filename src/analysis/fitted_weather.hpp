// Weather that the rate alone hides and the fit sees. Private to the analysis room.
#pragma once

#include "goingrate/causes/diagnosis.hpp"
#include "goingrate/fit/clock_fit.hpp"

#include <span>
#include <vector>

namespace goingrate {

/// Temperature and pressure as causes, by the fit's own coefficients, as far as these gain as much
/// as diagnose() asks of a cause and it is not `named` with a coefficient that is known better. A
/// drive that varies, or a step, hides them in the rate; a fit knows what these do.
std::vector<Suspicion> weather_seen_by_fit(const FitSummary& fit, std::span<const Suspicion> named);

/// The times without what those suspicions do.
void take_off(std::span<const Suspicion> weather, TimingData& times);

} // namespace goingrate
