// Looks for other minima that explain the log as well, or better. Private to the fit room.
#pragma once

#include "fitted.hpp"

namespace goingrate::timing_model {

/// Searches again on at most a few thousand beats, from other points and, if a parameter is poorly
/// known, from points along the valley; moves to a better minimum if there is one, and keeps others
/// that are nearly as good. True if it moved.
bool find_rivals(Fitted& fitted, const std::vector<std::vector<double>>& others);

/// The same fit at its minimum on fewer beats that represent its own; not usable if there is no
/// minimum.
Fitted on_few_beats(const Fitted& fitted, const FewBeats& few);

/// Adds the twins (twin.hpp) as rivals; the best takes the fit's place if it is better. In a long
/// log a few beats are used first: if they distinguish two clocks, all beats do.
void look_at_the_twins(Fitted& fitted);

} // namespace goingrate::timing_model
