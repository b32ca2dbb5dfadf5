// Other places that explain the log as well, or better. Private to the fit room.
#pragma once

#include "fitted.hpp"

namespace goingrate::timing_model {

/// Searches again on at most a few thousand beats, from other places and, where something is known
/// badly, from along the valley; moves to a better minimum if there is one and keeps the others
/// that are nearly as good. True if it moved.
bool find_rivals(Fitted& fitted, const std::vector<std::vector<double>>& others);

/// The same fit on beats that stand for its own, brought to their minimum; not usable if there is
/// none.
Fitted on_few_beats(const Fitted& fitted, const FewBeats& few);

/// The twins (twin.hpp) as rivals; the best takes the fit's place if it is better. A long log is
/// looked at by few beats first: where they tell two apart so do all.
void look_at_the_twins(Fitted& fitted);

} // namespace goingrate::timing_model
