// A fit with one coordinate held. Private to the fit room.
#pragma once

#include "likelihood.hpp"

namespace goingrate::timing_model {

/// The problem with one coordinate held; its priors on that coordinate are dropped.
FitProblem with_held(const FitProblem& problem, std::size_t index, double coordinate);

} // namespace goingrate::timing_model
