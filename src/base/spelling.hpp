// Guesses what a misspelt word was meant to be.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace goingrate {

/// The word of `known` that `word` was probably meant to be; nullopt if none is close.
///
/// Capitals count as small letters. A word is close if it differs by at most one error for every
/// three letters, three at most (a letter too many, too few or wrong, or two neighbours exchanged),
/// or if `word`, of three letters or more, is its beginning or that of a part of it behind _ or -.
/// Of several close words the closest is taken, and the first of equally close ones. Cost: the
/// product of the lengths, for each word. (SpellingTest.FindsTheWordThatWasMeant)
std::optional<std::string> nearest_word(std::string_view word, std::span<const std::string> known);

/// " (did you mean X?)" with that word, for the end of a message; empty if none is close.
std::string meant_instead(std::string_view word, std::span<const std::string> known);

} // namespace goingrate
