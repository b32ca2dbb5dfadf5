// Describes the pushes that keep a pendulum going. Private to the report.
#pragma once

#include "wording.hpp"

#include "goingrate/fit/impulse_cycle.hpp"

#include <string>

namespace goingrate {

/// "once every 15 swings" or "about every 39.3 swings, as if whenever its amplitude has fallen to a
/// limit".
std::string how_often(const ImpulseCycle& pushes);

/// The pushes as lines of a fit's text, with angles in the unit `angle`: how often they come, how
/// strong they are, and the friction and Q that they balance.
std::string impulse_text(const ImpulseCycle& pushes, const DisplayUnit& angle);

/// Q of the friction that these pushes alone would balance: "20,010 ± 16".
std::string quality_of(const ImpulseCycle& pushes);

} // namespace goingrate
