// Where in the swing a push comes, by what it does to the times. Private to the fit room.
#pragma once

#include "goingrate/fit/timing_data.hpp"

#include <optional>

namespace goingrate::push_shapes {

/// The angle of an impulse that raises the amplitude and sets the clock back as the pushes of the
/// data do, rad: phi with
///   kick = T/(2 pi) (atan(phi/v) - atan(phi/v')),  v^2 = lambda^2 - phi^2,  v'^2 = v^2 + 2 J,
/// lambda being that of the swing before the push and 2 J what it adds to lambda^2. Of a push over
/// a range of angles, the angle of the impulse that does the same. Nothing where the log has no
/// regular pushes, once in three swings or more, or no amplitudes, or where the kick is more than
/// an impulse can do. ImpulseCycleTest.APushTellsItsAngle
std::optional<ImpulseCycle::Estimate> angle_of_pushes(const TimingData& data);

} // namespace goingrate::push_shapes
