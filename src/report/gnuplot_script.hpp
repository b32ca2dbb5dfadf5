// Figures as text that gnuplot understands.
#pragma once

#include "goingrate/report/figure.hpp"

#include <string>
#include <vector>

namespace goingrate {

/// Scripts that write to standard output.
std::string script_for_pdf(const std::vector<Figure>& figures);
std::string script_for_png(const std::vector<Figure>& figures);

} // namespace goingrate
