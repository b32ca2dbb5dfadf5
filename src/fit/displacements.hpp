// Displaced times: a sensor that was moved, a knock. Private to the fit room and those above.
#pragma once

#include "goingrate/fit/timing_data.hpp"

#include <optional>

namespace goingrate::timing_model {

/// The displacement that gains most, if it is sudden and stands out from the scatter of the times.
std::optional<Displacement> greatest_displacement(const TimingData& data);

/// Subtracts the displacement from the times, and notes it.
void take_off(const Displacement& displacement, TimingData& data);

} // namespace goingrate::timing_model
