// A comparison of clocks as text, JSON, CSV and figures.
#pragma once

#include "goingrate/analysis/compare.hpp"
#include "goingrate/report/figure.hpp"

#include <string>
#include <vector>

namespace goingrate {

/// Rates and weather of each clock, deviations of each and of the differences, and what each clock
/// does alone.
std::string compare_text(const Comparison& comparison);

/// All of it with keys; schema goingrate.compare.
std::string compare_json(const Comparison& comparison);

/// Rates on one time axis: time_s after the first common time, then a column of s/day a clock.
std::string compare_table(const Comparison& comparison);

/// "compare-rates" and "compare-deviation".
std::vector<Figure> compare_figures(const Comparison& comparison);

} // namespace goingrate
