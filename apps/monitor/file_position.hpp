// The position up to which a log file, perhaps rotated since, was read.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace goingrate::apps {

/// DIR/.position: the file that was read last, by its inode and its beginning, and how many of its
/// lines are in the archive (FilePositionTest).
class FilePosition {
public:
  /// Reads the position stored by an earlier run.
  explicit FilePosition(const std::string& folder);
  ~FilePosition();
  FilePosition(const FilePosition&) = delete;
  FilePosition& operator=(const FilePosition&) = delete;

  /// A file to be read, and how many of its lines are known.
  struct Part {
    std::string path;
    std::uint32_t known_lines = 0;
  };
  /// The files to read of the source `path`, the oldest first: where the file that was read last is
  /// PATH.1 … PATH.9 now, that one from its known line on, every later one, and `path`; otherwise
  /// `path` alone.
  [[nodiscard]] std::vector<Part> parts_of(const std::string& path) const;

  /// Notes that `line` of `path` was read. A number below the last means that another file is read.
  void took(const std::string& path, std::uint32_t line);
  /// Called when all events taken are safe: writes the position if it is new.
  void save();

private:
  struct Mark {
    std::uint64_t inode = 0, bytes = 0;          // of the file; the least it can have now
    std::uint64_t head_bytes = 0, head_hash = 0; // of its first bytes: how many, FNV-1a
    std::uint32_t lines = 0;
  };
  static bool fits(const Mark& mark, const std::string& path, bool with_inode);

  std::string path_;
  Mark saved_;
  int file_ = -1;           // descriptor of the file that is read; -1: none
  std::uint32_t lines_ = 0; // of that file, read so far
};

} // namespace goingrate::apps
