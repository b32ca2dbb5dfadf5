// What a clock's rate suffers from, from its log alone.
//
// The rate is taken in blocks. Each cause makes its own course: a step, a step with a slow return,
// a ramp, an answer to a thermometer or barometer; each is fitted by generalised least squares with
// the noise sized along with it, and counts by how far it raises the likelihood above that of noise
// alone, less log(blocks) for each of its numbers (BIC). What no course explains is noise: wander
// that white noise does not account for is slow drive; a rate that is rough from beat to beat
// beyond what clocks show is a rough drive. Facts of the numbering (beats missed, a displaced time)
// stand for themselves. Where this means little: two causes with one course, such as a ramp of
// friction and one of length, cannot be told apart by times; the text then says what measurement
// would.
#pragma once

#include "goingrate/fit/timing_data.hpp"
#include "goingrate/spectra/lines.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace goingrate {

enum class Cause {
  slow_drive,
  drive_step,
  growing_friction, ///< or another ramp of the rate
  temperature,
  pressure,
  length_step,
  wheel,
  sensor_shift,
  missed_beats,
  rough_drive,
};
std::string_view name_of(Cause cause);

/// One suspicion.
struct Suspicion {
  Cause cause{};
  double strength = 0.0; ///< gain of -2 log L less its price; 6 is strong, 20 leaves no doubt
  std::string evidence;  ///< what speaks for it, in words with numbers
  std::string against;   ///< what else could look the same, and what would tell; may be empty
};

/// What the causes are judged by.
struct DiagnosisInput {
  const TimingData* data = nullptr; ///< with the terms temperature and pressure if the log has them
  double nominal_period_s = 0.0;
  double missed_share = 0.0;         ///< of the beats
  std::vector<SpectralLine> lines{}; ///< of the rate
};

/// Suspicions, strongest first; none for a healthy clock, or for a log below 2000 beats.
/// tests/studies/diagnosis.txt holds the confusion of ten causes on simulated weeks;
/// DiagnosisTest.NamesTheCause a part of it. Cost: about a second a week of 2 s beats.
std::vector<Suspicion> diagnose(const DiagnosisInput& input);

} // namespace goingrate
