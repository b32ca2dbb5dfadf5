// The second half of the road that every log travels: from numbered beats to all that can be told.
#pragma once

#include "goingrate/analysis/load.hpp"
#include "goingrate/clock/rating_nut.hpp"
#include "goingrate/fit/clock_fit.hpp"
#include "goingrate/fit/covariates.hpp"
#include "goingrate/fit/diagnosis.hpp"
#include "goingrate/fit/diary.hpp"
#include "goingrate/fit/drive_history.hpp"
#include "goingrate/fit/drive_split.hpp"
#include "goingrate/log/rates.hpp"
#include "goingrate/spectra/stability.hpp"

#include <functional>
#include <optional>
#include <string_view>
#include <vector>

namespace goingrate {

/// All that was found out about a log. Vectors "per beat" have one entry for each of `beats`.
struct Analysis {
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

/// What a fit is made of: times and amplitudes of the good beats, with the temperature, the
/// pressure and the air's density where the log has them.
TimingData fit_data(const NumberedLog& loaded);

/// The changes that the diary of the log shows most plainly, at most four, as events of a fit: each
/// may move, and changes mu.
std::vector<FitEvent> events_of_diary(const NumberedLog& loaded);

/// All that a report shows of a log, by one fit with these options (profile likelihoods included);
/// `nut` is left to whoever knows it. `now` is told what is being done.
/// Throws ArgumentError for options that make no sense, as fit_clock does.
Analysis analyse(NumberedLog loaded, const FitOptions& fit,
                 const std::function<void(std::string_view)>& now = {});

} // namespace goingrate
