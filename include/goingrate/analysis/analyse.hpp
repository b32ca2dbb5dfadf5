// The second half of every analysis: from numbered beats to everything a report shows.
#pragma once

#include "goingrate/analysis/load.hpp"
#include "goingrate/analysis/logbook_check.hpp"
#include "goingrate/causes/covariates.hpp"
#include "goingrate/causes/diagnosis.hpp"
#include "goingrate/causes/diary.hpp"
#include "goingrate/causes/isochronism.hpp"
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

/// The results for one log. A vector "per beat" has one entry for each of `beats`.
struct Analysis {
  ClockLog log;
  Beats numbered;
  std::vector<Beat> beats;         ///< the segment that was analysed
  RateSummary rate;                ///< of all of `beats`
  std::vector<PartRate> stretches; ///< of these, from one dated change to the next
  PartRate now; ///< at the end of the log: the last stretch, or its last quarter if that differs
  Diary diary;
  FitSummary fit;
  DriveAnalysis drive;
  std::vector<Suspicion> suspicions;       ///< the greatest gain first
  std::vector<CovariateEffect> covariates; ///< of the temperature and pressure the log has
  std::optional<Isochronism> isochronism{}; ///< rate against amplitude, if the log has amplitudes
  DeviationTable deviation{};              ///< overlapping Allan deviation of the clock's error
  std::optional<DriveHistory> history{};   ///< of the drive, where the fit allows one
  std::optional<NutTurns> nut{};           ///< turns that bring the rate `now` to zero
  std::optional<LogbookCheck> logbook{};   ///< the keeper's, if it was given
  SensorFindings sensor{};                 ///< beat error, and the sensor's offset
};

/// The data of a fit: times and amplitudes of the good beats, with temperature, pressure and air
/// density where the log has them. If the log shows the pushes of an escapement that rests, their
/// saw-tooth is subtracted.
TimingData fit_data(const NumberedLog& loaded);

/// The changes that stand out from neighbouring beats, and those that show only in the rate of the
/// whole log. `times` is fit_data(loaded).
Diary diary_of(const NumberedLog& loaded, const TimingData& times);

/// Turns the changes of a diary into events of a fit, whose dates the fit may move. An event
/// changes T0 (regulation), epsilon (friction) or mu (drive; not of a free pendulum). These become
/// events: of the changes that the keeper noted, at most four that stand out and four others whose
/// size was planned; of the rest, at most four that stand out. At most four further ones of each
/// group become possible events, which the fit includes if the likelihood gains enough by them.
void ask_for_changes(const Diary& diary, std::int64_t first_cycle, FitOptions& options);

/// The options with the sensor's `offset` free, if the beat error shows that the sensor is off the
/// vertical and the options do not mention the offset. If the log has amplitudes and both
/// directions, the offset that they give becomes its prior.
FitOptions with_seen_offset(FitOptions options, const NumberedLog& loaded);

/// The options with temperature, pressure and humidity free, as far as the log has them
/// (weather_parts()). Without this, the fit would take their effect for one of the drive or of an
/// amplitude that settles. They are freed even if the rate alone does not show them, since the
/// drive or a settling amplitude may hide them. Not freed: those that the options mention, all if
/// the options mention density, weather that is constant or a straight line, and any in a log of
/// fewer than 256 beats.
FitOptions with_seen_weather(FitOptions options, const NumberedLog& loaded);

/// The evidence by which causes are judged. It points to `times`, which must outlive it. The only
/// part that comes from the fit is the size of the fast drive.
DiagnosisInput diagnosis_input(const TimingData& times, const NumberedLog& loaded,
                               const Diary& diary, const DriveAnalysis& drive,
                               const FitSummary& fit);

/// Options of analyse(); what is left empty is found from the log.
struct AnalysisRequest {
  FitOptions fit{};
  bool finds_events = true;    ///< if `fit` names no events, use those of the diary
  std::optional<Logbook> logbook{}; ///< what the keeper of the clock wrote down
  bool traces_profiles = true; ///< for the figures; adds up to half of the time of all the rest
  std::optional<double> nut_pitch_m{};  ///< of the rating nut; if given, `nut` has the turns
  std::optional<double> rod_length_m{}; ///< of the equivalent simple pendulum; else from the period
  std::function<void(std::string_view)> now{}; ///< "2 of 6: what is being done"
};

/// Everything a report shows about a log, from one fit. Throws ArgumentError for invalid options,
/// as fit_clock() does.
Analysis analyse(NumberedLog loaded, const AnalysisRequest& request = {});

} // namespace goingrate
