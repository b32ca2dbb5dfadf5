// Stretches without drive among the changes of a log, and how the amplitude decays in them and
// recovers. Private to the causes room.
#pragma once

#include "slope_jumps.hpp"

#include "goingrate/causes/diary.hpp"

namespace goingrate::timing_model {

/// The interruptions among the changes: a loss of drive and its return. `knots` are the indices of
/// the changes in the track of the amplitude.
std::vector<Interruption> interruptions_among(const std::vector<Change>& changes,
                                              const std::vector<std::size_t>& knots,
                                              const Track& amplitude, const DiaryOptions& options);

} // namespace goingrate::timing_model
