// The causes that may explain what is left of a rate: what is tried next. Private to the causes
// room.
#pragma once

#include "evidence.hpp"

#include <span>

namespace goingrate::timing_model {

/// The cause that a change of this kind is.
Cause cause_of(ChangeKind kind);
/// Other causes with the same course of the rate.
std::vector<Cause> same_course_as(ChangeKind kind);

/// A change of a kind near a place in blocks, besides what the account has taken.
Candidate step_candidate(ChangeKind kind, double place, const Account& account,
                         const RateBlocks& blocks);

/// The cause of the greatest gain besides what the account has taken: weather, a step, a temporary
/// disturbance, a drift, or how a clock settles. `taken`: the causes found before it.
Candidate best_candidate(const DiagnosisInput& input, const RateBlocks& blocks,
                         const Account& account, std::span<const Candidate> taken);

} // namespace goingrate::timing_model
