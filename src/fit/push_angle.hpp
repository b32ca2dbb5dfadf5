// Finds the angle of a push in the swing from its effect on the times. Private to the fit room.
#pragma once

#include "goingrate/fit/timing_data.hpp"

#include <optional>

namespace goingrate::push_shapes {

/// The angle of an impulse that raises the amplitude and delays the clock as the pushes of the data
/// do, rad: phi with
///   kick = T/(2 pi) (atan(phi/v) - atan(phi/v')),  v^2 = lambda^2 - phi^2,  v'^2 = v^2 + 2 J,
/// where lambda belongs to the swing before the push and 2 J is the increase of lambda^2. For a
/// push over a range of angles, the angle of the impulse with the same effect. nullopt if the log
/// has no regular pushes, once in three swings or more, or no amplitudes, or if the kick is more
/// than an impulse can give. ImpulseCycleTest.APushTellsItsAngle
std::optional<ImpulseCycle::Estimate> angle_of_pushes(const TimingData& data);

} // namespace goingrate::push_shapes
