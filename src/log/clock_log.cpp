#include "goingrate/log/clock_log.hpp"

#include <algorithm>

namespace goingrate {

TextPlace ClockLog::place(std::size_t line, std::size_t column) const {
  const auto after = std::find_if(files.begin(), files.end(), [&](const LogFile& file) {
    return file.lines_before >= std::max<std::size_t>(line, 1);
  });
  if (after == files.begin()) return {source, line, column};
  const LogFile& file = *std::prev(after);
  return {file.name, line - file.lines_before, column};
}

} // namespace goingrate
