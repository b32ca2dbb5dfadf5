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
  double gain = 0.0;                     ///< over no change, 2 log L less the price
  double ahead = 0.0;                    ///< of the second best, in the mean over block lengths
  double at_s = 0.0;
  double doubt_s = 0.0;    ///< by how much that may be off, were it of another kind
  double jump = 0.0;       ///< of the rate, at once; of friction in the end
  double jump_sigma = 0.0; ///< of a regulation
};

/// The kind of a change at `at_s`, which may be off by `doubt_s`. The change is looked at in blocks
/// of 4, 16, 64 ... beats, up to 96 on each side: what dies away in seconds does not show in coarse
/// blocks, nor what takes hours in fine ones. The kind is the one that gains most in the mean over
/// these (a composite likelihood). A large doubt allows only coarse blocks; as these narrow it,
/// finer ones follow.
Judgement judge_kind(const TimingData& data, const Stretch& stretch, double at_s, double doubt_s);

/// Fills in the kinds of changes in order of time. `data` are those of the beats, without
/// displacements.
void judge_changes(std::span<const Beat> beats, const TimingData& data,
                   std::vector<Change>& changes);

/// Whether the log tells the kind of a change at about `at_s`, besides others.
bool has_kind(const TimingData& data, double at_s, const std::vector<Change>& others);

/// Adds the change at about `at_s`, which may be off by `doubt_s`, where the log tells its kind.
void add_change(const TimingData& data, double at_s, double doubt_s, std::span<const Beat> beats,
                std::vector<Change>& changes);

/// Fills in the rates before and after changes in order of time.
void put_rates(std::span<const Beat> beats, double nominal_period_s, std::vector<Change>& changes);

} // namespace goingrate::timing_model
