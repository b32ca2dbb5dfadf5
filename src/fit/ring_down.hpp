// From the fit of a free pendulum to how its swing dies away. Private to the fit room.
#pragma once

#include "fitted.hpp"

#include "goingrate/fit/decay.hpp"

#include <optional>

namespace goingrate::timing_model {

/// What does not depend on which law of friction the fit has.
struct RingDown {
  Decay decay;
  DecayEstimate T0_s; ///< NaN where it is not determined
};

/// The decay, whichever law of friction the fit has; nothing for a driven clock, for a pendulum
/// whose friction changed, or where the model does not hold.
std::optional<RingDown> ring_down_of(const Fitted& fitted, const FitOptions& options);

} // namespace goingrate::timing_model
