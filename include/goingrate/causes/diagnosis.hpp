// The likely causes of a clock's rate errors, from its log alone.
//
// Each cause has its own effect on rate and amplitude over time: a step with a steady amplitude, a
// step with a return, an exponential approach, a ramp, a daily wave, a response to a thermometer or
// barometer. Causes are added one by one, each time the one with the largest gain: the increase of
// 2 log L of both series over a healthy clock, less log(blocks) for each number the cause brings
// (Schwarz) and as much again for a date. The first needs a gain of 6, the second of 12, the third
// of 18. Wander that no cause explains is slow drive if the amplitude follows it, and unknown if it
// does not. Facts of the numbering (missed beats, displaced times, a stop), lines of the spectrum
// and a rough drive are judged on the same scale.
//
// Limit: no log can tell causes with the same effect apart, such as a ramp of the pendulum's length
// and one of the logger's own clock. Each suspicion lists them as alternatives.
#pragma once

#include "goingrate/causes/covariates.hpp"
#include "goingrate/causes/diary.hpp"
#include "goingrate/drive/drive_split.hpp"
#include "goingrate/fit/timing_data.hpp"
#include "goingrate/spectra/lines.hpp"

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace goingrate {

enum class Cause {
  slow_drive,
  drive_step,
  friction_step,
  growing_friction, ///< or a drive that fades
  temperature,      ///< by the log's own thermometer
  pressure,         ///< by the log's own barometer
  length_step,      ///< or a change of the regulation
  wheel,
  sensor_shift,
  missed_beats,
  rough_drive,
  length_drift,     ///< creep of the suspension, a rod that dries
  log_clock,        ///< the clock of the logger
  unlogged_weather, ///< temperature or pressure that the log does not hold
  knock,
  magnet,
  stop,
  unknown,
};
std::string_view name_of(Cause cause);

/// The numbers of a suspicion, in SI units; NaN where it has none.
struct CauseNumbers {
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  double at_s = unknown;    ///< beginning, after the first beat, if it was sudden
  double until_s = unknown; ///< end, if it was temporary
  /// The size of the effect. Relative rate for a step, a temporary change, a wheel or a daily wave;
  /// relative rate per K or mbar for temperature or pressure, per day for a drift; s for displaced
  /// times; the share of all beats for missed ones.
  double size = unknown, sigma = unknown;
  double amplitude_rad = unknown, amplitude_sigma_rad = unknown; ///< the same of the amplitude
  double period_s = unknown;                                     ///< of a wheel
  std::size_t places = 0; ///< number of displacements, or of holes with missing beats
};

/// One suspicion.
struct Suspicion {
  Cause cause{};
  double gain = 0.0;    ///< increase of 2 log L by this cause less its price; 6 is odds of 20 to 1
  std::string evidence; ///< in words with numbers
  std::vector<Cause> alternatives{}; ///< causes that this log cannot distinguish from it
  std::string advice{};              ///< a sentence on what to log or to do; may be empty
  CauseNumbers numbers{};
};

/// The evidence by which causes are judged.
struct DiagnosisInput {
  const TimingData* data = nullptr; ///< with the terms temperature and pressure if the log has them
  double nominal_period_s = 0.0;
  std::vector<Change> changes{}; ///< dated ones, in order of time
  /// The changes that the fit models. `data` are then the residuals of the fit, and these changes
  /// count as causes without further examination.
  std::vector<Change> explained{};
  std::vector<SpectralLine> lines{};       ///< of the rate
  std::optional<double> relaxation_s{};    ///< T0/(4 pi epsilon), if epsilon is known
  std::optional<RmsEstimate> fast_drive{}; ///< relative, if the clock's gains are known
  std::optional<double> stopped_s{};       ///< after the first beat: a stop split the log
};

/// With fewer beats, different causes cannot be distinguished.
inline constexpr std::size_t least_diagnosed_beats = 400;

/// Suspicions, the greatest gain first; none for a healthy clock. For a log of fewer than
/// least_diagnosed_beats, the explained changes alone.
/// tests/studies/diagnosis.txt has the confusion matrix of causes, through analyse(), on simulated
/// clocks; DiagnosisTest.NamesTheCause checks a part of it. Cost: some seconds for any length.
std::vector<Suspicion> diagnose(const DiagnosisInput& input);

/// Gives suspicions of temperature and pressure the coefficients of those covariate_effects() that
/// help, so that the results for a log agree. A daily wave that a column of the log explains, also
/// in the half that its coefficient was not fitted to, is named after that column and not unlogged
/// weather.
void name_weather(std::span<const CovariateEffect> effects, std::vector<Suspicion>& suspicions);

/// Adds to `diary.changes` (which are also `input.changes`) the steps, and the ends of temporary
/// changes, that diagnose() finds but that are too small to stand out from the beats next to them.
/// `beats` are those of the data. Does nothing for fewer than least_diagnosed_beats. Cost: that of
/// diagnose().
void add_small_changes(const DiagnosisInput& input, std::span<const Beat> beats, Diary& diary);

} // namespace goingrate
