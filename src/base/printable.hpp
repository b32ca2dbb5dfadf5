// Text from outside that is to be shown: on a terminal, in a message.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace goingrate {

/// Length of the well-formed UTF-8 character that `text` begins with; 0 if it begins with none.
std::size_t character_length(std::string_view text);

/// The text on one line, with nothing in it that steers a terminal: control characters, characters
/// that turn the direction of writing, and bytes that are not UTF-8 become \\x1b and the like.
std::string printable(std::string_view text);

} // namespace goingrate
