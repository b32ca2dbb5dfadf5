// A cause that was found in a log, and the words for it. Private to the causes room.
#pragma once

#include "account.hpp"

#include "goingrate/causes/diagnosis.hpp"

#include <string>
#include <vector>

namespace goingrate::timing_model {

/// A cause that may be taken: what it makes of rate and amplitude, and what else makes the same.
struct Candidate {
  Cause cause{};
  Courses courses{};
  std::vector<Cause> alternatives{};
  double at_s = 0.0;    ///< when it begins, if it is sudden
  double time_s = 0.0;  ///< the time constant of what follows; of a visit, when it ends
  bool is_fault = true; ///< false: how a clock settles after it was started
  double gain = 0.0;
  Sizes sizes{};
  bool is_dated = false; ///< at_s is good to some beats, not to a block
};

bool is_step(Cause cause);

std::string daily(double rate);
/// A time in the unit that suits it, to `digits` digits: "300 s", "2.5 h", "4.63 days".
std::string time_words(double seconds, int digits = 3);

/// The sizes of what was found, and when.
CauseNumbers numbers_of(const Candidate& found);

/// What speaks for it. `sees_amplitude`: the log has amplitudes.
std::string evidence_of(const Candidate& found, bool sees_amplitude);
/// What would tell, or what to do.
std::string advice_on(Cause cause, bool sees_amplitude);

} // namespace goingrate::timing_model
