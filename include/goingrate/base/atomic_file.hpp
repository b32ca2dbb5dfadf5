// Output files that are either whole or absent.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace goingrate {

/// Writes `text` to `path` ("-" is standard output). The text goes to a file beside the target,
/// which is renamed over it only when every byte is on disk, so a failure leaves the old file.
/// Throws OutputError; the temporary file is removed then.
void write_whole_file(const std::string& path, std::string_view text);

/// Several outputs of one command, (path, text): all are on disk before the first old file is
/// replaced. An empty path is an output nobody asked for. Throws OutputError, and ArgumentError if
/// two of them are standard output.
void write_whole_files(const std::vector<std::pair<std::string, std::string>>& outputs);

} // namespace goingrate
