#include "inputs.hpp"

#include "goingrate/base/atomic_file.hpp"
#include "goingrate/base/errors.hpp"

#include <atomic>
#include <mutex>
#include <optional>
#include <set>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

namespace goingrate {

namespace {

// Identifies a file by device and inode: it may have several names.
using Identity = std::pair<dev_t, ino_t>;

std::atomic<bool> all_are_kept{false};
std::mutex keeping;

std::set<Identity>& kept() {
  static auto& files = *new std::set<Identity>;
  return files;
}

// The regular file that `path` names; nothing for a pipe or a device, which cannot be overwritten.
std::optional<Identity> identity_of(const std::string& path, int stream) {
  struct stat status {};
  const int failed = path == "-" ? ::fstat(stream, &status) : ::stat(path.c_str(), &status);
  if (failed != 0 || !S_ISREG(status.st_mode)) return {};
  return Identity{status.st_dev, status.st_ino};
}

} // namespace

void keep_input(const std::string& path) {
  const auto file = identity_of(path, STDIN_FILENO);
  const std::lock_guard lock(keeping);
  if (file) kept().insert(*file);
}

void keep_all_inputs() { all_are_kept = true; }

void note_input(const std::string& path) {
  if (all_are_kept) keep_input(path);
}

void refuse_input(const std::string& path) {
  const auto file = identity_of(path, STDOUT_FILENO);
  const std::lock_guard lock(keeping);
  if (file && kept().contains(*file))
    throw ArgumentError("output", path, "another file than the one that is read");
}

} // namespace goingrate
