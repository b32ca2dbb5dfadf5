#include "file_position.hpp"

#include <algorithm>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <optional>
#include <sys/stat.h>
#include <unistd.h>

namespace goingrate::apps {

namespace {

constexpr std::size_t head_bytes = 4096; // a hundred lines, which no other log begins with

// FNV-1a of the first `bytes` of a file; nullopt if it has fewer.
std::optional<std::uint64_t> hash_of_head(int file, std::size_t bytes) {
  std::string head(bytes, '\0');
  if (::pread(file, head.data(), bytes, 0) != static_cast<ssize_t>(bytes)) return {};
  std::uint64_t hash = 14695981039346656037U;
  for (const char c : head)
    hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211U;
  return hash;
}

} // namespace

FilePosition::FilePosition(const std::string& folder) : path_(folder + "/.position") {
  std::ifstream file(path_);
  Mark mark;
  if (file >> mark.inode >> mark.bytes >> mark.head_bytes >> mark.head_hash >> mark.lines)
    saved_ = mark;
}

FilePosition::~FilePosition() {
  if (file_ >= 0) ::close(file_);
}

bool FilePosition::fits(const Mark& mark, const std::string& path, bool with_inode) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return false;
  struct stat found {};
  const bool fits =
      ::fstat(file, &found) == 0 && static_cast<std::uint64_t>(found.st_size) >= mark.bytes &&
      (!with_inode || found.st_ino == mark.inode) &&
      hash_of_head(file, std::min(mark.head_bytes, std::uint64_t{head_bytes})) == mark.head_hash;
  ::close(file);
  return fits;
}

std::vector<FilePosition::Part> FilePosition::parts_of(const std::string& path) const {
  constexpr int most_rotations = 9;
  const auto name = [&](int k) { return k == 0 ? path : fmt::format("{}.{}", path, k); };
  if (saved_.lines > 0)
    for (const bool with_inode : {true, false}) // without: a copy made before a truncation
      for (int k = 0; k <= most_rotations; ++k)
        if (fits(saved_, name(k), with_inode)) {
          std::vector<Part> parts{{name(k), saved_.lines}};
          while (k > 0)
            parts.push_back({name(--k)});
          return parts;
        }
  return {{path}};
}

void FilePosition::took(const std::string& path, std::uint32_t line) {
  if (file_ < 0 || line < lines_) {
    if (file_ >= 0) ::close(file_);
    file_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  }
  lines_ = line;
}

// Not synced: a lost position is found again by the stored times.
void FilePosition::save() {
  struct stat found {};
  if (file_ < 0 || ::fstat(file_, &found) != 0) return;
  Mark mark;
  mark.inode = found.st_ino;
  mark.bytes = static_cast<std::uint64_t>(found.st_size);
  mark.lines = lines_;
  if (mark.lines == saved_.lines && mark.inode == saved_.inode) return;
  mark.head_bytes = std::min(mark.bytes, std::uint64_t{head_bytes});
  const auto hash = hash_of_head(file_, mark.head_bytes);
  if (!hash) return;
  mark.head_hash = *hash;
  const std::string fresh = path_ + ".new";
  {
    std::ofstream file(fresh);
    file << mark.inode << ' ' << mark.bytes << ' ' << mark.head_bytes << ' ' << mark.head_hash
         << ' ' << mark.lines << '\n';
    if (!file.flush()) return;
  }
  if (::rename(fresh.c_str(), path_.c_str()) == 0) saved_ = mark;
}

} // namespace goingrate::apps
