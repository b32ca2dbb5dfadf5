// A cause that was found in a log, and the words for it. Private to the causes room.
#pragma once

#include "account.hpp"

#include "goingrate/causes/diagnosis.hpp"

#include <string>
#include <vector>

namespace goingrate::timing_model {

/// A cause under consideration: its effect on rate and amplitude, and other causes with the same
/// effect.
struct Candidate {
  Cause cause{};
  Courses courses{};
  std::vector<Cause> alternatives{};
  double at_s = 0.0;    ///< when it begins; 0 for what lasts throughout the log
  double time_s = 0.0;  ///< time constant of the relaxation; for a temporary change, its end
  bool is_fault = true; ///< false: the settling of a clock after it was started
  double gain = 0.0;
  Sizes sizes{};
  bool is_dated = false; ///< at_s is known to within some beats, not only to a block
};

bool is_step(Cause cause);

std::string daily(double rate);
/// A time in the unit that suits it, to `digits` digits: "300 s", "2.5 h", "4.63 days".
std::string time_words(double seconds, int digits = 3);

/// The sizes and the date of the cause.
CauseNumbers numbers_of(const Candidate& found);

/// The evidence in words. `sees_amplitude`: the log has amplitudes.
std::string evidence_of(const Candidate& found, bool sees_amplitude);
std::string advice_on_grown_friction();
/// Advice on what to log or to do about a cause of this size.
std::string advice_on(Cause cause, bool sees_amplitude, const CauseNumbers& numbers);

} // namespace goingrate::timing_model
