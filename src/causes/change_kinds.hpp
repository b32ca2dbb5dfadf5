// The kind of a dated change. Private to the causes room.
#pragma once

#include "goingrate/causes/diary.hpp"
#include "goingrate/fit/timing_data.hpp"

namespace goingrate::timing_model {

/// The part of a log in which a change is judged: from the change before it to the next.
struct Stretch {
  double begin_s = 0.0, end_s = 0.0;
};

struct Judgement {
  ChangeKind kind = ChangeKind::unclear;
  ChangeKind next = ChangeKind::unclear; ///< the second best
  double gain = 0.0;                     ///< in 2 log L over no change, less the price
  double ahead = 0.0;                    ///< gain over the second best, mean over block lengths
  double at_s = 0.0;
  double doubt_s = 0.0;    ///< uncertainty of at_s, including that of the kind
  double jump = 0.0;       ///< of the rate, at the change; for friction, in the end
  double jump_sigma = 0.0; ///< for a regulation only
};

/// The kind of a change at `at_s`, a date with the uncertainty `doubt_s`. The change is examined in
/// blocks of 4, 16, 64 ... beats, up to 96 on each side: an effect that decays in seconds does not
/// show in coarse blocks, nor one that takes hours in fine ones. The kind is that of the largest
/// mean gain over block lengths (a composite likelihood). An uncertain date allows only coarse
/// blocks; as these narrow it down, finer ones follow.
Judgement judge_kind(const TimingData& data, const Stretch& stretch, double at_s, double doubt_s);

/// Fills in the kinds of changes in order of time. `data` are those of the beats, without
/// displacements.
void judge_changes(std::span<const Beat> beats, const TimingData& data,
                   std::vector<Change>& changes);

/// Whether the log shows the kind of a change at about `at_s`, given the other changes.
bool has_kind(const TimingData& data, double at_s, const std::vector<Change>& others);

/// Adds the change at about `at_s`, uncertain by `doubt_s`, if the log shows its kind.
void add_change(const TimingData& data, double at_s, double doubt_s, std::span<const Beat> beats,
                std::vector<Change>& changes);

/// Fills in the rates before and after changes in order of time.
void put_rates(std::span<const Beat> beats, double nominal_period_s, std::vector<Change>& changes);

} // namespace goingrate::timing_model
