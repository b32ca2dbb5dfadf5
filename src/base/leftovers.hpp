// Drafts that a process which is dead, by `kill -9` or a power cut, left behind.
#pragma once

#include <string>

namespace goingrate {

/// What the name of a draft of `target` begins with; six letters follow.
std::string draft_prefix(const std::string& target);

/// Suffix of the name of a draft under which the target's old file is kept for a moment.
inline constexpr const char* old_suffix = "-old";

/// Removes the leftovers of `target`: its drafts whose lock nobody holds. The folder is looked
/// through once until forget_folders() is called.
void sweep(const std::string& target);

/// The folders that were looked through may have changed.
void forget_folders();

} // namespace goingrate
