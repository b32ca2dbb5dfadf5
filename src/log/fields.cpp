#include "fields.hpp"

#include "base/printable.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fast_float/fast_float.h>
#include <fmt/format.h>

namespace goingrate {

namespace {

bool is_blank(char c) { return c == ' ' || c == '\t'; }
bool is_key_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

// "t=12.5": the number after a key.
std::size_t key_length(std::string_view text) {
  std::size_t length = 0;
  while (length < text.size() && is_key_letter(text[length]))
    ++length;
  return length > 0 && length + 1 < text.size() && text[length] == '=' ? length + 1 : 0;
}

Field trimmed(std::string_view text, std::size_t column) {
  while (!text.empty() && is_blank(text.front())) {
    text.remove_prefix(1);
    ++column;
  }
  while (!text.empty() && is_blank(text.back()))
    text.remove_suffix(1);
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"')
    return {text.substr(1, text.size() - 2), column + 1};
  return {text, column};
}

// The first field has no key: "SampleRate=1000" is a line of settings.
Field without_key(Field field, bool is_first) {
  const std::size_t key = is_first ? 0 : key_length(field.text);
  return {field.text.substr(key), field.column + key};
}

// Where a field that begins with a quotation mark at `begin` ends: behind the mark that closes it
// before a blank or the line's end. 0 if there is none.
std::size_t quoted_end(std::string_view line, std::size_t begin) {
  if (begin >= line.size() || line[begin] != '"') return 0;
  for (std::size_t at = line.find('"', begin + 1); at != std::string_view::npos;
       at = line.find('"', at + 1))
    if (at + 1 == line.size() || is_blank(line[at + 1])) return at + 1;
  return 0;
}

void split_at_blanks(std::string_view line, std::vector<Field>& fields) {
  std::size_t i = 0;
  while (i < line.size() && fields.size() <= most_fields) {
    while (i < line.size() && is_blank(line[i]))
      ++i;
    const std::size_t begin = i;
    if (const std::size_t end = quoted_end(line, begin)) i = end;
    while (i < line.size() && !is_blank(line[i]))
      ++i;
    if (i == begin) continue;
    const Field field = trimmed(line.substr(begin, i - begin), begin + 1);
    fields.push_back(without_key(field, fields.empty()));
  }
}

} // namespace

void split_fields(std::string_view line, char separator, std::vector<Field>& fields) {
  fields.clear();
  if (separator == ' ') {
    split_at_blanks(line, fields);
    return;
  }
  std::size_t begin = 0;
  bool quoted = false;
  for (std::size_t i = 0; i <= line.size() && fields.size() <= most_fields; ++i) {
    if (i < line.size() && line[i] == '"') quoted = !quoted;
    if (i < line.size() && (quoted || line[i] != separator)) continue;
    const Field field = trimmed(line.substr(begin, i - begin), begin + 1);
    fields.push_back(without_key(field, fields.empty()));
    begin = i + 1;
  }
}

std::optional<double> parse_number(std::string_view text, char point) {
  if (!text.empty() && text.front() == '+') {
    text.remove_prefix(1);
    if (!text.empty() && text.front() == '-') return {};
  }
  double value = 0.0;
  const char* const end = text.data() + text.size();
  if (text.empty() || number_in(text.data(), end, point, value) != end) return {};
  if (!std::isfinite(value)) return {};
  return value;
}

const char* number_in(const char* begin, const char* end, char point, double& value) {
  const fast_float::parse_options options{fast_float::chars_format::general, point};
  const auto [stop, error] = fast_float::from_chars_advanced(begin, end, value, options);
  return error == std::errc() ? stop : begin;
}

bool says_nothing(std::string_view text) {
  constexpr std::array<std::string_view, 8> words{"nan",  "na", "n/a", "null",
                                                  "none", "-",  "--",  "inf"};
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  if (lower == "-nan" || lower == "-inf" || lower == "+inf") return true;
  return lower.empty() || std::find(words.begin(), words.end(), lower) != words.end();
}

bool all_nines(std::string_view text) {
  if (!text.empty() && text.front() == '-') text.remove_prefix(1);
  std::size_t nines = 0, others = 0;
  for (const char c : text)
    ++(c == '9' ? nines : others);
  const bool one_point = others == 0 || (others == 1 && text.find_first_of(".,") != text.npos);
  return nines >= 4 && one_point;
}

std::string shown(std::string_view text) {
  constexpr std::size_t most_characters =
      40; // enough to recognise the place, short enough for one line
  return fmt::format("'{}{}'", printable(text.substr(0, most_characters)),
                     text.size() > most_characters ? "..." : "");
}

bool is_binary(char c) {
  return static_cast<unsigned char>(c) < 0x20 && c != '\t' && c != '\f' && c != '\r' && c != '\n';
}

bool has_binary(std::string_view line) { return std::any_of(line.begin(), line.end(), is_binary); }

} // namespace goingrate
