// The place of third-party measurements for tests, which are not part of the project.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string_view>
#include <system_error>

namespace goingrate::test {

/// The path of `relative` inside the folder named by the environment variable
/// GOINGRATE_SHARED_DATA; nothing if the variable is unset or there is no such file, in which case
/// a test skips itself and says so.
inline std::optional<std::filesystem::path> real_data(std::string_view relative) {
  const char* folder = std::getenv("GOINGRATE_SHARED_DATA");
  if (folder == nullptr || *folder == '\0') return std::nullopt;
  const std::filesystem::path path = std::filesystem::path(folder) / relative;
  std::error_code ignored; // an unreadable folder counts as absent
  if (!std::filesystem::exists(path, ignored)) return std::nullopt;
  return path;
}

} // namespace goingrate::test
