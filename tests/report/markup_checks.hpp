// Checks of markup for the tests of figures and pages: whether tags are closed, and whether it
// holds a NaN.
#pragma once

#include <cctype>
#include <string>
#include <string_view>
#include <vector>

namespace goingrate::test {

/// The first fault in the nesting of tags and the quoting of attributes; empty if there is none.
inline std::string tag_fault(std::string_view text) {
  std::vector<std::string> open;
  for (std::size_t at = text.find('<'); at != std::string_view::npos; at = text.find('<', at)) {
    const std::size_t end = text.find('>', at);
    if (end == std::string_view::npos) return "a tag without end";
    const std::string tag(text.substr(at + 1, end - at - 1));
    at = end + 1;
    if (tag.empty() || tag.find('<') != std::string::npos) return "< inside " + tag;
    std::size_t quotes = 0;
    for (const char c : tag)
      quotes += c == '"' ? 1U : 0U;
    if (quotes % 2 != 0) return "an open quotation in " + tag;
    const std::string name = tag.substr(0, tag.find_first_of(" \n/", 1));
    if (tag[0] == '!' || tag.back() == '/' || name == "meta" || name == "br") continue;
    if (tag[0] != '/') {
      open.push_back(name);
      if (name == "style" || name == "script") // these may hold < and >
        at = text.find("</" + name + ">", at);
    } else if (open.empty() || open.back() != tag.substr(1)) {
      return "<" + tag + "> closes " + (open.empty() ? "nothing" : open.back());
    } else {
      open.pop_back();
    }
  }
  return open.empty() ? "" : open.back() + " is never closed";
}

/// Whether `word` stands in the text with no letter beside it, in any case.
inline bool has_word(std::string_view text, std::string_view word) {
  const auto letter = [&](std::size_t i) {
    return i < text.size() && std::isalpha(static_cast<unsigned char>(text[i])) != 0;
  };
  for (std::size_t at = 0; at + word.size() <= text.size(); ++at) {
    std::size_t same = 0;
    while (same < word.size() &&
           std::tolower(static_cast<unsigned char>(text[at + same])) == word[same])
      ++same;
    if (same == word.size() && !letter(at + same) && (at == 0 || !letter(at - 1))) return true;
  }
  return false;
}

/// The text without what stands between <script ...> and </script>.
inline std::string without_scripts(std::string_view text) {
  std::string rest;
  for (;;) {
    const std::size_t begin = text.find("<script");
    const std::size_t end = begin == std::string_view::npos ? begin : text.find("</script>", begin);
    if (end == std::string_view::npos) return rest.append(text);
    rest.append(text.substr(0, begin));
    text.remove_prefix(end + 9);
  }
}

inline std::size_t count_of(std::string_view text, std::string_view part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string_view::npos; at = text.find(part, at + 1))
    ++count;
  return count;
}

} // namespace goingrate::test
