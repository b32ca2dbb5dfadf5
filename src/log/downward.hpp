// Numbers downward crossings by the upward ones.
#pragma once

#include "goingrate/log/clock_log.hpp"

#include <span>

namespace goingrate {

/// Gives each downward crossing of `beats`, whose upward crossings are numbered, the cycle and
/// segment of the upward crossing before it, even if that one was missed. A downward crossing that
/// is not at the usual place between two upward crossings is spurious; of two in one cycle the less
/// likely is spurious or a rival. A permanent change of the beat error is followed.
void place_downward(std::span<Beat> beats, double period_s);

} // namespace goingrate
