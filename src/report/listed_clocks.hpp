// The clocks that a log may be of if there are two or more, in words. Private to the report.
#pragma once

#include "goingrate/fit/clock_fit.hpp"

#include "wording.hpp"

#include <string>
#include <vector>

namespace goingrate {

/// One of them. `odds` says how likely it is against the first; empty for that one.
struct ListedClock {
  std::string odds, parameters;
};

/// The likeliest first; none if only one clock explains the log, or the fit does not know.
std::vector<ListedClock> listed_clocks(const FitSummary& fit, const DisplayUnit& angle);

} // namespace goingrate
