// Writes the figures of a page as JSON, from which page.js draws them.
#pragma once

#include "goingrate/report/figure.hpp"

#include <string>
#include <vector>

namespace goingrate {

/// {"arrays": [...], "plots": [{"panels": [...]}]}: one plot for each figure, or for each run of
/// figures of one group, whose panels share an x axis. A series refers to its arrays by number, so
/// that equal arrays are stored once; an array is a list, or {"count", "packed"} (packed.hpp).
/// Lines and bands of more than 20,000 values are thinned to the extremes of stretches, and so are
/// other series if all together hold more than 800,000 numbers; "stretch" is the number of values
/// in a stretch. A panel whose y axis is set by the bulk of its values has the ends of that axis
/// ("bulk"). The text contains no "<", so that it is safe inside <script>.
std::string page_data(const std::vector<Figure>& figures);

/// The index at which each run of figures of one group begins, and the end of the last run.
std::vector<std::size_t> plot_begins(const std::vector<Figure>& figures);

} // namespace goingrate
