// Output files that are either whole or absent.
#pragma once

#include <string>
#include <string_view>

namespace goingrate {

/// Writes `text` to `path` ("-" is standard output). The text goes to a file beside the target,
/// which is renamed over it only when every byte is on disk, so a failure leaves the old file.
/// Throws OutputError; the temporary file is removed then.
void write_whole_file(const std::string& path, std::string_view text);

} // namespace goingrate
