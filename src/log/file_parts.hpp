// The files of one clock before they are read: what the first lines of each show, and their order.
#pragma once

#include "goingrate/log/clock_log.hpp"
#include "goingrate/log/reading.hpp"

#include <optional>
#include <string>
#include <vector>

namespace goingrate {

/// What the first lines of one file show.
struct FilePart {
  std::string path;
  Layout layout;
  ClockLog said; ///< what its head states and what was assumed of it
  std::size_t lines_expected = 0;
  bool is_recording = false;   ///< of sound, and has no layout; then it is the only part
  double step_s = 0.0;         ///< usual, between its first times
  std::optional<Instant> date; ///< a time among its first lines, where times tell the day
};

/// The files that `paths` name, folders and ZIPs opened, in the order in which they are to be read;
/// files of a folder that hold no log, or the weather among logs, are left out and listed in
/// `assumptions`. A file without a header, or too short to tell its layout, has that of the others
/// if it can be read so. Throws InputError for a file that is not a log, for a folder without one,
/// and where some files have dates and others have none, or another scale of time; ArgumentError
/// for a path that is given twice or is not a regular file.
std::vector<FilePart> file_parts(const std::vector<std::string>& paths,
                                 const ReadingOptions& options,
                                 std::vector<Assumption>& assumptions);

/// Whether a path is a folder or a ZIP.
bool holds_files(const std::string& path);

} // namespace goingrate
