// Weather that the rate alone hides and the fit sees. Private to the analysis room.
#pragma once

#include "goingrate/causes/diagnosis.hpp"
#include "goingrate/fit/clock_fit.hpp"

#include <span>
#include <vector>

namespace goingrate {

/// Temperature and pressure as causes, by the fit's own coefficients, as far as these gain as much
/// as diagnose() asks of a cause and it is not `named` already. A drive that varies hides them in
/// the rate; a fit that has amplitudes knows what the drive does.
std::vector<Suspicion> weather_seen_by_fit(const FitSummary& fit, std::span<const Suspicion> named);

/// The times without what those suspicions do.
void take_off(std::span<const Suspicion> weather, TimingData& times);

} // namespace goingrate
