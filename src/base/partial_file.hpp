// A file whose lines survive the end of the process that writes it.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace goingrate {

/// A text file to which whole lines are appended. Whatever ends the process, at most the last line
/// is incomplete; it is cut off when the file is opened again. While it is open the file is locked
/// against other processes.
class PartialFile {
public:
  /// The place of a line in the file, without its end.
  struct Line {
    std::int64_t offset;
    std::size_t size;
  };

  /// Opens the file, or creates it. Throws OutputError, also if another process has it open.
  explicit PartialFile(std::string path);
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;
  ~PartialFile();

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] const std::vector<Line>& lines() const { return lines_; }
  [[nodiscard]] std::string read(const Line& line) const;
  /// Appends a line and its end. From time to time everything is written to disk. Throws
  /// OutputError.
  void append(std::string_view line);
  /// Removes the file.
  void discard();

private:
  void find_lines();
  void put_on_disk();
  [[noreturn]] void fail() const;

  std::string path_;
  int file_ = -1;
  std::int64_t end_ = 0; // of the last whole line
  std::vector<Line> lines_;
  std::chrono::steady_clock::time_point on_disk_;
};

} // namespace goingrate
