// How far a file was read that may have been rotated since.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace goingrate::apps {

/// DIR/.position: the file that was read last, by its inode and its beginning, and how many of its
/// lines are in the archive (FilePositionTest).
class FilePosition {
public:
  /// Reads what an earlier run left.
  explicit FilePosition(const std::string& folder);
  ~FilePosition();
  FilePosition(const FilePosition&) = delete;
  FilePosition& operator=(const FilePosition&) = delete;

  /// A file to be read, and how many of its lines are known.
  struct Part {
    std::string path;
    std::uint32_t known_lines = 0;
  };
  /// What is to be read of the source `path`: itself alone, or first what it was when it was read
  /// last, if that is PATH.1 … PATH.9 now, and what came between.
  [[nodiscard]] std::vector<Part> parts_of(const std::string& path) const;

  /// A line of that file was read. Lines that begin again are those of another file of that name.
  void took(const std::string& path, std::uint32_t line);
  /// Called when all that was taken is safe: writes the position if it is new.
  void save();

private:
  struct Mark {
    std::uint64_t inode = 0, bytes = 0;          // of the file, and how long it was at least
    std::uint64_t head_bytes = 0, head_hash = 0; // of its beginning
    std::uint32_t lines = 0;
  };
  static bool fits(const Mark& mark, const std::string& path, bool with_inode);

  std::string path_;
  Mark saved_;
  int file_ = -1;           // the one being read
  std::uint32_t lines_ = 0; // of it
};

} // namespace goingrate::apps
