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

std::int64_t seconds_before_1970(TimeOrigin origin) {
  constexpr std::int64_t days = 40587, day_s = 86400; // MJD of 1970-01-01
  return origin == TimeOrigin::mjd ? days * day_s : 0;
}

std::string_view times_of(TimeOrigin origin) {
  return origin == TimeOrigin::none ? "times without a date" : "dates";
}

} // namespace goingrate
