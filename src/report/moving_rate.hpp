// Whether the rate moves one way through a log of few beats. Private to the report room.
#pragma once

#include "wording.hpp"

namespace goingrate {

/// "the rate has moved in one direction throughout this log, from ... in its first quarter to ...
/// in its last", where the rates of the four quarters rise or fall, each by more than three sigma
/// of the difference; empty otherwise, and for fewer than 32 beats.
std::string moving_rate(const Analysis& data, const Wording& words);

} // namespace goingrate
