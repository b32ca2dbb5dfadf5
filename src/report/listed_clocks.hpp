// Describes the clocks that explain a log, if there are two or more. Private to the report.
#pragma once

#include "goingrate/fit/clock_fit.hpp"

#include "wording.hpp"

#include <string>
#include <vector>

namespace goingrate {

/// One of the clocks. `odds` says how likely it is compared with the first; empty for the first.
struct ListedClock {
  std::string odds, parameters;
};

/// The clocks, likeliest first; empty if only one explains the log, or the fit does not know.
std::vector<ListedClock> listed_clocks(const FitSummary& fit, const DisplayUnit& angle);

} // namespace goingrate
