// The report: everything about one log, as an HTML page and as a summary for the terminal.
#pragma once

#include "goingrate/analysis/analyse.hpp"
#include "goingrate/report/figure.hpp"

#include <string>
#include <vector>

namespace goingrate {

/// What the log shows, in three to six sentences, each of which is true by itself: the rate of the
/// clock now, whether it is getting worse and since when, the most likely explanation, what to do,
/// and whether the model of the pendulum explains the log.
std::vector<std::string> report_sentences(const Analysis& data);

/// One number of the summary, in words: "rate over the whole log", "+18.42 ± 0.85 s/day".
struct SummaryNumber {
  std::string quantity; ///< with its symbol, if it has one
  std::string value;    ///< with its uncertainty and its unit
};

/// The numbers of the summary: rates before and after each dated change, period, amplitude, the
/// parameters that the log determines, the drive, the effects of temperature and pressure, the
/// deviation. A quantity has one unit throughout, chosen by its size.
std::vector<SummaryNumber> summary_numbers(const Analysis& data);

/// The summary for the terminal: the name of the log's file, the sentences, and the numbers as one
/// table; at most 50 lines or so, of at most 80 characters, UTF-8.
std::string report_text(const Analysis& data);

/// The figures for which there are data, in the order of the page: rate, amplitude and residuals
/// (one group), clock error, rate against amplitude, drive, spectrum, deviation, correlation,
/// intervals and profile likelihoods of the parameters. Figures that rest on the fit are left out
/// unless the fit converged.
std::vector<Figure> report_figures(const Analysis& data);

/// One self-contained HTML page with summary, tables and figures; it opens from disk without a
/// network. plotly.js, if the build had it, draws the figures so that they can be zoomed; without
/// scripts and on paper they are static. The page contains the result of report_json. It stays
/// below 5 MB for a log of a month: it holds at most 800,000 numbers for zooming, and the series of
/// a longer log are thinned to the extremes of stretches (HtmlReportTest.AMonthOfBeats).
std::string report_html(const Analysis& data);

} // namespace goingrate
