// The versions of the software that made a result.
#pragma once

#include <span>
#include <string_view>
#include <utility>

namespace goingrate {

/// The versions of goingrate and of the libraries that its numbers depend on, by name.
std::span<const std::pair<std::string_view, std::string_view>> versions();

} // namespace goingrate
