// Ends of a search for clocks that swing far and clocks that swing little. Private to the fit room.
#pragma once

#include "search.hpp"

namespace goingrate::timing_model {

/// Where clocks of every size come to rest, found from the best end of a search. Where T0 is open,
/// times alone tell the size of a swing by its circular error only; under a drive that varies,
/// clocks of several sizes explain a change much alike, with hills between them that no search
/// crosses. So each is searched for, first with its size held. Empty where the log tells the size.
std::vector<Minimum> ends_of_every_size(const FitProblem& problem, const Minimum& best);

} // namespace goingrate::timing_model
