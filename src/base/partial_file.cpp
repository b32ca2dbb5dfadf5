#include "partial_file.hpp"

#include "goingrate/base/errors.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>
#include <utility>

namespace goingrate {

PartialFile::PartialFile(std::string path)
    : path_(std::move(path)), on_disk_(std::chrono::steady_clock::now()) {
  constexpr mode_t mode = 0666; // less the umask
  file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, mode);
  if (file_ < 0) fail();
  try {
    if (::flock(file_, LOCK_EX | LOCK_NB) != 0) {
      if (errno == EWOULDBLOCK) throw OutputError(path_, "another process is writing it");
      // A file system without locks: other processes are not kept out, as with any file there.
    }
    find_lines();
  } catch (...) {
    ::close(file_);
    throw;
  }
}

PartialFile::~PartialFile() { ::close(file_); }

void PartialFile::fail() const { throw OutputError(path_, std::strerror(errno)); }

void PartialFile::find_lines() {
  std::string piece(std::size_t{1} << 16, '\0');
  std::int64_t at = 0;
  while (true) {
    const ssize_t count = ::pread(file_, piece.data(), piece.size(), at);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail();
    if (count == 0) break;
    for (std::int64_t i = 0; i < count; ++i) {
      if (piece[static_cast<std::size_t>(i)] != '\n') continue;
      lines_.push_back({end_, static_cast<std::size_t>(at + i - end_)});
      end_ = at + i + 1;
    }
    at += count;
  }
  if (::ftruncate(file_, end_) != 0) fail();
}

std::string PartialFile::read(const Line& line) const {
  std::string text(line.size, '\0');
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t count = ::pread(file_, text.data() + done, text.size() - done,
                                  line.offset + static_cast<std::int64_t>(done));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail();
    if (count == 0) throw OutputError(path_, "was cut off by another process");
    done += static_cast<std::size_t>(count);
  }
  return text;
}

void PartialFile::append(std::string_view line) {
  const std::string text = std::string(line) + '\n';
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t count = ::pwrite(file_, text.data() + done, text.size() - done,
                                   end_ + static_cast<std::int64_t>(done));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail();
    done += static_cast<std::size_t>(count);
  }
  lines_.push_back({end_, line.size()});
  end_ += static_cast<std::int64_t>(text.size());
  constexpr std::chrono::seconds at_risk{1}; // of work that a machine may lose with its power
  if (std::chrono::steady_clock::now() - on_disk_ > at_risk) put_on_disk();
}

void PartialFile::put_on_disk() {
  if (::fdatasync(file_) != 0 && errno != EINVAL && errno != EROFS) fail();
  on_disk_ = std::chrono::steady_clock::now();
}

void PartialFile::discard() { ::unlink(path_.c_str()); }

} // namespace goingrate
