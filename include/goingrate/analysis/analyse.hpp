// The second half of the road that every log travels: from numbered beats to all that can be told.
#pragma once

#include "goingrate/analysis/load.hpp"
#include "goingrate/causes/covariates.hpp"
#include "goingrate/causes/diagnosis.hpp"
#include "goingrate/causes/diary.hpp"
#include "goingrate/clock/rating_nut.hpp"
#include "goingrate/drive/drive_history.hpp"
#include "goingrate/drive/drive_split.hpp"
#include "goingrate/fit/clock_fit.hpp"
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
  std::vector<Beat> beats;         ///< the segment that was analysed
  RateSummary rate;                ///< of all of `beats`
  std::vector<PartRate> stretches; ///< of these, from one dated change to the next
  PartRate now; ///< as it goes in the end: the last stretch, or its last quarter if that differs
  Diary diary;
  FitSummary fit;
  DriveAnalysis drive;
  std::vector<Suspicion> suspicions;       ///< the greatest gain first
  std::vector<CovariateEffect> covariates; ///< of the temperature and pressure the log has
  DeviationTable deviation{};              ///< overlapping Allan deviation of the clock's error
  std::optional<DriveHistory> history{};   ///< of the drive, where the fit allows one
  std::optional<NutTurns> nut{};           ///< to bring the rate as it is now to zero
};

/// What a fit is made of: times and amplitudes of the good beats, with the temperature, the
/// pressure and the air's density where the log has them.
TimingData fit_data(const NumberedLog& loaded);

/// The changes that stand out of the beats next to them, and those that the course of the whole log
/// tells. `times` are fit_data(loaded).
Diary diary_of(const NumberedLog& loaded, const TimingData& times);

/// Has a fit look for the changes of a diary, each of which may move, and changes T0 (regulation),
/// epsilon (friction) or mu, which a free pendulum does not have: those that stand out, at most
/// four, as events; as many of the others as possible ones.
void ask_for_changes(const Diary& diary, std::int64_t first_cycle, FitOptions& options);

/// With the sensor's place among the free parameters where the beat error shows that the times are
/// not those of the vertical, unless the options speak of it; as amplitudes and both directions tell
/// it, where the log has them.
FitOptions with_seen_offset(FitOptions options, const NumberedLog& loaded);

/// What the causes are judged by. Points to `times`. The fit serves to tell a rough drive.
DiagnosisInput diagnosis_input(const TimingData& times, const NumberedLog& loaded,
                               const Diary& diary, const DriveAnalysis& drive,
                               const FitSummary& fit);

/// What is asked of analyse(); what is left empty it finds out.
struct AnalysisRequest {
  FitOptions fit{};
  bool finds_events = true;             ///< where `fit` names none: those of the diary
  bool traces_profiles = true;          ///< for figures: up to half as long again as all else
  std::optional<double> nut_pitch_m{};  ///< of the rating nut, if its turns are asked for
  std::optional<double> rod_length_m{}; ///< of the mathematical pendulum; that of the period if not
  std::function<void(std::string_view)> now{}; ///< "2 of 6: what is being done"
};

/// All that a report shows of a log, by one fit. Throws
/// ArgumentError for options that make no sense, as fit_clock does.
Analysis analyse(NumberedLog loaded, const AnalysisRequest& request = {});

} // namespace goingrate
