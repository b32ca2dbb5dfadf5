// The report: everything about one log, as a page for the eye and a summary for the terminal.
#pragma once

#include "goingrate/analysis/analyse.hpp"
#include "goingrate/report/figure.hpp"

#include <string>
#include <vector>

namespace goingrate {

/// The summary for the terminal: at most 40 lines or so, of at most 80 characters, in plain words.
std::string report_text(const Analysis& data);

/// Those figures for which there are data, in the order of the page: rate, amplitude and residuals
/// (one group), clock error, rate against amplitude, drive, spectrum, deviation, correlation,
/// intervals and profile likelihoods of the parameters. What rests on the fit is left out unless
/// the fit converged.
std::vector<Figure> report_figures(const Analysis& data);

/// One self-contained HTML page: summary, tables and figures; opens from disk without a network.
/// plotly.js, if the build had it, draws the figures so that they can be zoomed; without scripts
/// and on paper they are the still ones. Below 4 MB for any log: what a long log has beyond the
/// 800,000 numbers kept for zooming is thinned to the extremes of stretches
/// (HtmlReportTest.AMonthOfBeats).
std::string report_html(const Analysis& data);

} // namespace goingrate
