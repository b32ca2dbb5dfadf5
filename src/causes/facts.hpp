// Causes that show in a log without a model of its rate: displaced times, missing beats, spectral
// lines, a rough drive. Private to the causes room.
#pragma once

#include "goingrate/causes/diagnosis.hpp"

namespace goingrate::timing_model {

/// All times from one beat on are late by the same amount; the rate stays as it was.
struct Displacement {
  std::size_t beat = 0; ///< the first that is late
  double late_s = 0.0;
  double gain = 0.0;
};

/// At most `most` displacements of the times, the greatest gain first. Each is removed from `data`
/// before the next is searched for.
std::vector<Displacement> take_displacements(TimingData& data, std::size_t most);

/// The suspicions that follow from these, each with a gain above `believed`.
std::vector<Suspicion> suspicions_of_facts(const DiagnosisInput& input,
                                           const std::vector<Displacement>& displaced);

} // namespace goingrate::timing_model
