#include "terminal.hpp"

#include <cstdlib>
#include <fmt/format.h>
#include <unistd.h>

namespace goingrate::apps {

namespace {

bool shows_colours() {
  const char* none = std::getenv("NO_COLOR");
  const char* terminal = std::getenv("TERM");
  const bool dumb = terminal == nullptr || std::string_view(terminal) == "dumb";
  return error_is_terminal() && (none == nullptr || *none == '\0') && !dumb;
}

// Select Graphic Rendition (ECMA-48): bold red, yellow, cyan.
std::string_view code_of(Paint paint) {
  switch (paint) {
  case Paint::error:
    return "1;31";
  case Paint::warning:
    return "33";
  case Paint::note:
    break;
  }
  return "36";
}

} // namespace

bool error_is_terminal() { return ::isatty(STDERR_FILENO) != 0; }

std::string painted(std::string_view text, Paint paint) {
  if (!shows_colours()) return std::string(text);
  return fmt::format("\x1b[{}m{}\x1b[0m", code_of(paint), text);
}

} // namespace goingrate::apps
