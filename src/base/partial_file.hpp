// The lines of a file in the making that outlive the process.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace goingrate {

/// A text file to which whole lines are appended: whatever ends the process, the lines it has are
/// whole, but perhaps the last, which is cut off when the file is opened again. While it is open it
/// is locked against other processes.
class PartialFile {
public:
  /// Where a line is, without its end.
  struct Line {
    std::int64_t offset;
    std::size_t size;
  };

  /// Opens it, or makes it. Throws OutputError, also where another process has it open.
  explicit PartialFile(std::string path);
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;
  ~PartialFile();

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] const std::vector<Line>& lines() const { return lines_; }
  [[nodiscard]] std::string read(const Line& line) const;
  /// Appends a line and its end. From time to time all is put on disk. Throws OutputError.
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
