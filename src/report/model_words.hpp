// Describes how well the fitted model explains a log. Private to the report.
#pragma once

#include "goingrate/analysis/analyse.hpp"

#include <string>

namespace goingrate {

/// One sentence: whether the model explains the log, which noise of the clock it needs to do so,
/// and which parameters it leaves open. `sees_amplitude`: the log has amplitudes; `told_a_change`:
/// an earlier sentence dates a change of the rate.
std::string model_sentence(const Analysis& data, bool sees_amplitude, bool told_a_change);

} // namespace goingrate
