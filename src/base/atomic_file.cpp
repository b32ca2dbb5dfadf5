#include "goingrate/base/atomic_file.hpp"

#include "goingrate/base/errors.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fmt/format.h>
#include <unistd.h>
#include <utility>

namespace goingrate {

namespace {

void write_all(int file, std::string_view text, const std::string& path) {
  while (!text.empty()) {
    const ssize_t written = ::write(file, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) throw OutputError(path, std::strerror(errno));
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

// Owns a temporary file beside the target until it is committed by a rename.
class Draft {
public:
  explicit Draft(const std::string& target) : target_(target) {
    name_ = fmt::format("{}.part-{}", target, ::getpid());
    file_ = ::open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file_ < 0) throw OutputError(target, std::strerror(errno));
  }
  Draft(const Draft&) = delete;
  Draft& operator=(const Draft&) = delete;
  ~Draft() {
    if (file_ >= 0) ::close(file_);
    if (!committed_) ::unlink(name_.c_str());
  }

  void commit(std::string_view text) {
    write_all(file_, text, target_);
    const bool synced = ::fsync(file_) == 0 || errno == EINVAL;
    const bool closed = ::close(std::exchange(file_, -1)) == 0;
    if (!synced || !closed) throw OutputError(target_, std::strerror(errno));
    if (::rename(name_.c_str(), target_.c_str()) != 0)
      throw OutputError(target_, std::strerror(errno));
    committed_ = true;
  }

private:
  std::string target_;
  std::string name_;
  int file_ = -1;
  bool committed_ = false;
};

bool is_special_file(const std::string& path) {
  std::error_code unknown;
  const auto status = std::filesystem::status(path, unknown);
  return std::filesystem::exists(status) && !std::filesystem::is_regular_file(status) &&
         !std::filesystem::is_directory(status);
}

} // namespace

void write_whole_file(const std::string& path, std::string_view text) {
  if (path == "-") return write_all(STDOUT_FILENO, text, "standard output");
  if (is_special_file(path)) { // a pipe or /dev/null: renaming over it would replace the device
    const int file = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
    if (file < 0) throw OutputError(path, std::strerror(errno));
    write_all(file, text, path);
    ::close(file);
    return;
  }
  Draft(path).commit(text);
}

} // namespace goingrate
