// The clocks that a log of two or more may be of, in words. Private to the report.
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

/// The likeliest first; none where the log is of one clock, or the fit does not know.
std::vector<ListedClock> listed_clocks(const FitSummary& fit, const DisplayUnit& angle);

} // namespace goingrate
