// A comparison of clocks as text, JSON, CSV and figures.
#pragma once

#include "goingrate/analysis/compare.hpp"
#include "goingrate/report/figure.hpp"

#include <string>
#include <vector>

namespace goingrate {

/// Rates and weather of each clock, deviations of each clock and of the differences, and the
/// deviation of each clock alone.
std::string compare_text(const Comparison& comparison);

/// The whole comparison as JSON, schema goingrate.compare.
std::string compare_json(const Comparison& comparison);

/// Rates on one time axis as CSV: time_s after the first common time, then one column in s/day for
/// each clock.
std::string compare_table(const Comparison& comparison);

/// "compare-rates" and "compare-deviation".
std::vector<Figure> compare_figures(const Comparison& comparison);

} // namespace goingrate
