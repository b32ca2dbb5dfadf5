// What a clock's rate suffers from, from its log alone.
//
// Each cause makes its own course of rate and amplitude: a step that the amplitude does not follow,
// a step with a return, an approach, a ramp, a day's wave, an answer to a thermometer or barometer.
// They are taken one after the other, each time the one that raises the likelihood of both series
// most above that of a healthy clock, less log(blocks) for each number it brings (Schwarz) and as
// much again for a date, until none gains 6 (the second 12, the third 18). A wander that no course
// explains is slow drive where the amplitude goes with it, and unknown where the amplitude does
// not. Facts of the numbering (beats missed, a displaced time, a stop), lines of the spectrum and a
// rough drive are judged on the same scale.
//
// Where this means little: causes with one course, such as a ramp of the pendulum's length and one
// of the logger's own clock, cannot be told apart by any log; each suspicion lists them as
// alternatives.
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
  double at_s = unknown;    ///< after the first beat: when it came, if it was sudden
  double until_s = unknown; ///< when it went, if it was a visit
  /// What it does. For a step, a visit, a wheel or the day: relative rate; for temperature or
  /// pressure, that per K or mbar; for a drift, that per day; for a displaced time: s; for missed
  /// beats, their share of all.
  double size = unknown, sigma = unknown;
  double amplitude_rad = unknown, amplitude_sigma_rad = unknown; ///< the same of the amplitude
  double period_s = unknown;                                     ///< of a wheel
  std::size_t places = 0; ///< where times are displaced or beats are missing
};

/// One suspicion.
struct Suspicion {
  Cause cause{};
  double gain = 0.0;    ///< 2 log L over what was known before, less its price; 6 is 20 to 1
  std::string evidence; ///< what speaks for it, in words with numbers
  std::vector<Cause> alternatives{}; ///< what this log cannot tell from it
  std::string advice{};              ///< what would tell, or what to do: a sentence; may be empty
  CauseNumbers numbers{};
};

/// The evidence by which causes are judged.
struct DiagnosisInput {
  const TimingData* data = nullptr; ///< with the terms temperature and pressure if the log has them
  double nominal_period_s = 0.0;
  std::vector<Change> changes{}; ///< dated ones, in order of time
  /// The changes that the fit follows: `data` is then what the fit leaves, and they count as causes
  /// as they are.
  std::vector<Change> explained{};
  std::vector<SpectralLine> lines{};       ///< of the rate
  std::optional<double> relaxation_s{};    ///< T0/(4 pi epsilon), if epsilon is known
  std::optional<RmsEstimate> fast_drive{}; ///< relative, if the clock's gains are known
  std::optional<double> stopped_s{};       ///< after the first beat: a stop split the log
};

/// In a log of fewer beats the courses of a rate cannot be told from each other.
inline constexpr std::size_t least_diagnosed_beats = 400;

/// Suspicions, the greatest gain first; none for a healthy clock. For a log of fewer than
/// least_diagnosed_beats, the explained changes alone.
/// tests/studies/diagnosis.txt holds the confusion of causes, through analyse(), on simulated
/// clocks; DiagnosisTest.NamesTheCause a part of it. Cost: some seconds, whatever the length.
std::vector<Suspicion> diagnose(const DiagnosisInput& input);

/// Gives suspicions of temperature and pressure the value of covariate_effects(), so that one log
/// states one. A daily swing that a column of the log explains, also in the half in which its
/// coefficient was not found, is not weather that the log lacks: it is named after that column.
void name_weather(std::span<const CovariateEffect> effects, std::vector<Suspicion>& suspicions);

/// Adds the steps, and the visits' ends, that diagnose() would name and that are not among
/// `diary.changes`, which are also `input.changes`: those too small to stand out from the beats
/// next to them. `beats` are those of the data. Nothing for a log of fewer than
/// least_diagnosed_beats. Cost: that of diagnose().
void add_small_changes(const DiagnosisInput& input, std::span<const Beat> beats, Diary& diary);

} // namespace goingrate
