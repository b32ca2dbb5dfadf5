#include "base/printable.hpp"

#include <fmt/format.h>
#include <iterator>

namespace goingrate {

namespace {

bool continues(char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; }

// Whether a character is invisible itself but changes how others are shown.
bool steers(std::string_view character) {
  if (character.size() == 1) return character[0] < 0x20 || character[0] == 0x7F;
  const bool control = character[0] == '\xC2' && character[1] < '\xA0'; // U+0080 to U+009F
  const bool direction =
      character >= "\u200E" && character <= "\u200F"; // a mark, left to right or right to left
  const bool separator_or_embedding = character >= "\u2028" && character <= "\u202E";
  const bool isolate = character >= "\u2066" && character <= "\u2069";
  return control || direction || separator_or_embedding || isolate;
}

} // namespace

std::size_t character_length(std::string_view text) {
  const auto first = static_cast<unsigned char>(text[0]);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xC2 && first < 0xE0   ? 2
                             : first >= 0xE0 && first < 0xF0 ? 3
                             : first >= 0xF0 && first < 0xF5 ? 4
                                                             : 0;
  if (length == 0 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if (!continues(text[i])) return 0;
  const auto second = static_cast<unsigned char>(text[1]);
  const bool overlong = (first == 0xE0 && second < 0xA0) || (first == 0xF0 && second < 0x90);
  const bool no_character = (first == 0xED && second >= 0xA0) ||
                            (first == 0xF4 && second >= 0x90) ||
                            (first == 0xEF && second == 0xBF && // U+FFFE and U+FFFF
                             static_cast<unsigned char>(text[2]) >= 0xBE);
  return overlong || no_character ? 0 : length;
}

std::string printable(std::string_view text) {
  std::string shown;
  while (!text.empty()) {
    const std::size_t length = character_length(text);
    const std::string_view character = text.substr(0, length == 0 ? 1 : length);
    if (length > 0 && !steers(character))
      shown += character;
    else
      for (const char c : character)
        fmt::format_to(std::back_inserter(shown), "\\x{:02x}", static_cast<unsigned char>(c));
    text.remove_prefix(character.size());
  }
  return shown;
}

} // namespace goingrate
