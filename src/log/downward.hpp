// Downward crossings: numbered by the upward ones.
#pragma once

#include "goingrate/log/clock_log.hpp"

#include <span>

namespace goingrate {

/// Gives each downward crossing of `beats`, whose upward ones are numbered, the cycle and segment
/// of the upward crossing before it, also where that one was missed. It must stand where the others
/// stand between two upward crossings; one that does not, or the second of a cycle, is spurious. A
/// beat error that changes for good is followed.
void place_downward(std::span<Beat> beats, double period_s);

} // namespace goingrate
