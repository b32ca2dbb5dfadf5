// The figures of a page as JSON, for page.js to draw.
#pragma once

#include "goingrate/report/figure.hpp"

#include <string>
#include <vector>

namespace goingrate {

/// {"arrays": [...], "plots": [{"panels": [...]}]}: one plot for each figure, or for each run of
/// figures of one group, whose panels share an x axis. A series names its arrays by number, so that
/// those that are the same are held once; an array is a list, or {"count", "packed"} (packed.hpp).
/// Lines and bands of more than 20,000 values, and all series that together hold more than 800,000
/// numbers, are thinned to the extremes of stretches; each says of how many values ("stretch").
/// A panel whose y axis is set by the bulk of its values has its ends ("bulk"). The
/// text may stand inside <script>: it has no "<".
std::string page_data(const std::vector<Figure>& figures);

/// Where the runs of one group begin, and the end of the last.
std::vector<std::size_t> plot_begins(const std::vector<Figure>& figures);

} // namespace goingrate
