// The report: everything about one log, as a page for the eye and a summary for the terminal.
#pragma once

#include "goingrate/fit/clock_fit.hpp"
#include "goingrate/fit/covariates.hpp"
#include "goingrate/fit/diagnosis.hpp"
#include "goingrate/fit/diary.hpp"
#include "goingrate/fit/drive_split.hpp"
#include "goingrate/log/rates.hpp"
#include "goingrate/spectra/stability.hpp"

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
  std::vector<Suspicion> suspicions; ///< strongest first
  std::vector<CovariateEffect> covariates; ///< of the temperature and pressure the log has
  DeviationTable deviation{};              ///< overlapping Allan deviation of the clock's error
};

/// The summary for the terminal: at most 40 lines of at most 100 characters, in plain words.
std::string report_text(const ReportData& data);

/// One self-contained HTML page: summary, tables and figures; opens from disk without a network.
std::string report_html(const ReportData& data);

} // namespace goingrate
