// The causes that are tried next on a rate whose largest causes are known. Private to the causes
// room.
#pragma once

#include "evidence.hpp"

#include <span>

namespace goingrate::timing_model {

/// The cause named for a change of this kind.
Cause cause_of(ChangeKind kind);
/// Other causes that have the same effect on the rate over time.
std::vector<Cause> same_course_as(ChangeKind kind);

/// A change of a kind near `place` (in blocks), in addition to the causes the account has taken.
Candidate step_candidate(ChangeKind kind, double place, const Account& account,
                         const RateBlocks& blocks);

/// The cause with the greatest gain in addition to those the account has taken: weather, a step, a
/// temporary disturbance, a drift, or the settling of a clock. `taken`: the causes found before it.
Candidate best_candidate(const DiagnosisInput& input, const RateBlocks& blocks,
                         const Account& account, std::span<const Candidate> taken);

} // namespace goingrate::timing_model
