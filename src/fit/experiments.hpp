// Experiments that would determine more. Private to the fit room.
#pragma once

#include "fitted.hpp"

namespace goingrate::timing_model {

/// The relative sigmas to be expected after each of a few experiments, from the information at the
/// present parameters: a known T0, an amplitude column good to 0.1 mrad, a drive raised by a fifth
/// halfway through a log of the same length. Only for clocks with constant torque; experiments that
/// do not help are left out.
std::vector<Experiment> suggest_experiments(const Fitted& fitted, const FitOptions& options);

} // namespace goingrate::timing_model
