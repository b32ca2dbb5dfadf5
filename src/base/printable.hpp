// Makes text from outside safe to show on a terminal or in a message.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace goingrate {

/// Length of the well-formed UTF-8 character at the beginning of `text`; 0 if there is none.
std::size_t character_length(std::string_view text);

/// The text on one line, with nothing that controls a terminal: control characters, characters that
/// change the direction of writing, and bytes that are not UTF-8 become \\x1b and the like.
std::string printable(std::string_view text);

} // namespace goingrate
