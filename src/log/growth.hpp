// A file that is read while it grows.
#pragma once

#include <cstdint>
#include <string>

namespace goingrate {

/// Notices if a file that was read to its end starts over: it was cut off and written again, or
/// another file has taken its name.
class Growth {
public:
  /// `count` bytes were read, up to `end` in the file.
  void took(const char* bytes, std::size_t count, std::uint64_t end);
  /// Whether the bytes read last are no longer in the file, or `path` is another file.
  [[nodiscard]] bool begins_anew(int descriptor, const std::string& path) const;
  /// Whether `path` is another file but the open one is unchanged, so that it may still be written.
  [[nodiscard]] static bool is_replaced(int descriptor, const std::string& path);

private:
  std::string last_; // bytes read
  std::uint64_t end_ = 0;
};

} // namespace goingrate
