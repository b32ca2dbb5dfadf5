// What can be seen of a log without a model of its rate: displaced times, missing beats, lines, a
// rough drive. Private to the causes room.
#pragma once

#include "goingrate/causes/diagnosis.hpp"

namespace goingrate::timing_model {

/// From one beat on all times are late by so much, and the clock goes on as before.
struct Displacement {
  std::size_t beat = 0; ///< the first that is late
  double late_s = 0.0;
  double gain = 0.0;
};

/// The displacements of the times, the greatest gain first, at most `most`; each is taken off
/// `data` before the next is looked for.
std::vector<Displacement> take_displacements(TimingData& data, std::size_t most);

/// The suspicions that rest on these, each if its gain is above `believed`.
std::vector<Suspicion> suspicions_of_facts(const DiagnosisInput& input,
                                           const std::vector<Displacement>& displaced);

} // namespace goingrate::timing_model
