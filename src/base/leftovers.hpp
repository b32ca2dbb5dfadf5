// Drafts left behind by a process that was killed (`kill -9`) or lost its power.
#pragma once

#include <string>

namespace goingrate {

/// The beginning of the name of a draft of `target`; six letters follow.
std::string draft_prefix(const std::string& target);

/// Suffix of the name of a draft under which the target's old file is kept for a moment.
inline constexpr const char* old_suffix = "-old";

/// Removes the leftovers of `target`: its drafts whose lock nobody holds. The folder is looked
/// through once until forget_folders() is called.
void sweep(const std::string& target);

/// Makes the folders be looked through again, because they may have changed.
void forget_folders();

} // namespace goingrate
