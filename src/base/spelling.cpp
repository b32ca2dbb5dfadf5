#include "base/spelling.hpp"

#include <algorithm>
#include <vector>

namespace goingrate {

namespace {

// The smallest number of errors that turn one word into the other: Levenshtein's distance, in which
// an exchange of neighbours counts as one error.
std::size_t slips_between(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), now(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j)
    last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    now[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      now[j] =
          std::min({last[j] + 1, now[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        now[j] = std::min(now[j], before[j - 2] + 1);
    }
    before.swap(last);
    last.swap(now);
  }
  return last[b.size()];
}

std::string in_small_letters(std::string_view word) {
  std::string small(word);
  for (char& c : small)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return small;
}

// Whether the name, or a part of it behind _ or -, begins with the word.
bool begins_a_part(std::string_view name, std::string_view word) {
  if (name.starts_with(word)) return true;
  for (std::size_t at = name.find_first_of("_-"); at != std::string_view::npos;
       at = name.find_first_of("_-", at + 1))
    if (name.substr(at + 1).starts_with(word)) return true;
  return false;
}

} // namespace

std::optional<std::string> nearest_word(std::string_view typed,
                                        std::span<const std::string> known) {
  const std::string word = in_small_letters(typed);
  constexpr std::size_t letters_a_slip = 3, most_slips = 3;
  const std::size_t allowed = std::min(word.size() / letters_a_slip, most_slips);
  std::optional<std::string> nearest;
  std::size_t fewest = allowed + 1;
  for (const std::string& candidate : known) {
    const std::string small = in_small_letters(candidate);
    const bool begun = word.size() >= letters_a_slip && begins_a_part(small, word);
    const std::size_t slips = begun ? allowed : slips_between(word, small);
    if (slips >= fewest) continue;
    fewest = slips;
    nearest = candidate;
  }
  return nearest;
}

std::string meant_instead(std::string_view word, std::span<const std::string> known) {
  const auto meant = nearest_word(word, known);
  return meant ? " (did you mean " + *meant + "?)" : "";
}

} // namespace goingrate
