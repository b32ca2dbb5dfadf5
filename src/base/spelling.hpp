// What a misspelt word was meant to be.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace goingrate {

/// The word of `known` that `word` was probably meant to be; nothing if none is near.
///
/// Capitals count as small letters. Near: one slip of the pen for every three letters, three at
/// most (a letter too many, too few or wrong, or two neighbours exchanged), or the beginning of the
/// word, of three letters or more. If several are near, the nearest, and the first of equally near
/// ones. Cost: the product of the lengths, for each word. (SpellingTest.FindsTheWordThatWasMeant)
std::optional<std::string> nearest_word(std::string_view word, std::span<const std::string> known);

/// " (did you mean X?)" with that word, to end a message with; nothing if none is near.
std::string meant_instead(std::string_view word, std::span<const std::string> known);

} // namespace goingrate
