// Gnuplot scripts that draw figures.
#pragma once

#include "goingrate/report/figure.hpp"

#include <string>
#include <vector>

namespace goingrate {

/// A script that makes gnuplot draw the figures, one above the other, and write the PDF or PNG file
/// to its standard output.
std::string script_for_pdf(const std::vector<Figure>& figures);
std::string script_for_png(const std::vector<Figure>& figures);

} // namespace goingrate
