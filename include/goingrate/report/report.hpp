// The report: everything about one log, as a page for the eye and a summary for the terminal.
#pragma once

#include "goingrate/clock/rating_nut.hpp"
#include "goingrate/fit/clock_fit.hpp"
#include "goingrate/fit/covariates.hpp"
#include "goingrate/fit/diagnosis.hpp"
#include "goingrate/fit/diary.hpp"
#include "goingrate/fit/drive_history.hpp"
#include "goingrate/fit/drive_split.hpp"
#include "goingrate/log/rates.hpp"
#include "goingrate/report/figure.hpp"
#include "goingrate/spectra/stability.hpp"

#include <optional>
#include <string>
#include <vector>

namespace goingrate {

/// All that was found out about a log. Vectors "per beat" have one entry for each of `beats`.
struct ReportData {
  ClockLog log;
  Beats numbered;
  std::vector<Beat> beats; ///< the segment that was analysed
  RateSummary rate;
  Diary diary;
  FitSummary fit;
  DriveAnalysis drive;
  std::vector<Suspicion> suspicions;       ///< strongest first
  std::vector<CovariateEffect> covariates; ///< of the temperature and pressure the log has
  DeviationTable deviation{};              ///< overlapping Allan deviation of the clock's error
  std::optional<DriveHistory> history{};   ///< of the drive, where the fit allows one
  std::optional<NutTurns> nut{};           ///< to bring the rate to zero, if the nut is known
};

/// The summary for the terminal: at most 40 lines or so, of at most 80 characters, in plain words.
std::string report_text(const ReportData& data);

/// Those figures for which there are data, in the order of the page: rate, amplitude and residuals
/// (one group), clock error, rate against amplitude, drive, spectrum, deviation, correlation,
/// intervals and profile likelihoods of the parameters. What rests on the fit is left out unless
/// the fit converged.
std::vector<Figure> report_figures(const ReportData& data);

/// One self-contained HTML page: summary, tables and figures; opens from disk without a network.
/// plotly.js, if the build had it, draws the figures so that they can be zoomed; without scripts
/// and on paper they are the still ones. Below 4 MB for any log: what a long log has beyond the
/// 800,000 numbers kept for zooming is thinned to the extremes of stretches
/// (HtmlReportTest.AMonthOfBeats).
std::string report_html(const ReportData& data);

} // namespace goingrate
