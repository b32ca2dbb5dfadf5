#include "goingrate/report/tables.hpp"

#include <algorithm>

namespace goingrate {

namespace {

bool begins_character(char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }

// The number of bytes in the first `width` characters of a line.
std::size_t bytes_of(std::string_view line, std::size_t width) {
  std::size_t seen = 0;
  for (std::size_t i = 0; i < line.size(); ++i)
    if (begins_character(line[i]) && seen++ == width) return i;
  return line.size();
}

// The place at which a line that is too long is broken: before the last blank that fits, or after
// the last comma if the line is one long word; its end if it cannot be broken.
std::size_t break_of(std::string_view line, std::size_t width) {
  const std::size_t indent = line.find_first_not_of(' ');
  const std::size_t room = bytes_of(line, width);
  const std::size_t blank = line.rfind(' ', room);
  if (blank != std::string_view::npos && blank > indent) return blank;
  const std::size_t comma = line.rfind(',', room - 1);
  if (comma != std::string_view::npos && comma > indent) return comma + 1;
  const std::size_t later = line.find(' ', room);
  return later == std::string_view::npos ? line.size() : later;
}

void wrap_line(std::string_view line, std::size_t width, std::size_t hanging, std::string& text) {
  const std::size_t first = line.find_first_not_of(' ');
  const std::string indent((first == std::string_view::npos ? 0 : first) + hanging, ' ');
  std::string rest(line);
  while (bytes_of(rest, width) < rest.size()) {
    const std::size_t end = break_of(rest, width);
    const std::size_t next = rest.find_first_not_of(' ', end);
    if (next == std::string::npos) break;
    text += rest.substr(0, end) + '\n';
    rest = indent + rest.substr(next);
  }
  text += rest;
}

} // namespace

std::string wrapped(std::string_view text, std::size_t width, std::size_t hanging) {
  std::string result;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    if (begin > 0) result += '\n';
    wrap_line(text.substr(begin, end - begin), width, hanging, result);
    begin = end + 1;
  }
  return result;
}

} // namespace goingrate
