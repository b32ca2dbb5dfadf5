// What the fitted model says of a log, in words. Private to the report.
#pragma once

#include "goingrate/analysis/analyse.hpp"

#include <string>

namespace goingrate {

/// One sentence: whether the model explains the log, which noise of the clock it needs for that,
/// and what it leaves open. `sees_amplitude`: the log has amplitudes; `told_a_change`: the
/// sentences before this one date a change of the rate.
std::string model_sentence(const Analysis& data, bool sees_amplitude, bool told_a_change);

} // namespace goingrate
