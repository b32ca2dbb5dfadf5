#include "draft.hpp"

#include "inputs.hpp"
#include "leftovers.hpp"

#include "goingrate/base/errors.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fcntl.h>
#include <filesystem>
#include <mutex>
#include <set>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>
#include <vector>

namespace goingrate {

namespace {

namespace fs = std::filesystem;

// ---- the drafts of this process

using Slot = std::atomic<const char*>;
static_assert(Slot::is_always_lock_free); // a signal handler reads them

// Slots that hold the name of a draft or nothing; slots are added but never removed.
struct Slots {
  std::array<Slot, 256> names{};
  std::atomic<Slots*> next{nullptr};
};
constinit Slots first_slots{};

// Whether files are being replaced; whatever ends the program waits until that is over.
constinit std::atomic<int> commits{0};

// Members that no signal handler uses.
struct Register {
  std::mutex mutex;
  std::vector<Slot*> free;
  Slots* last = nullptr;
  std::set<std::string> targets; // of the drafts there are
};

Register& registered() {
  static Register& one = *new Register; // outlives every draft
  return one;
}

Slot* remember(const std::string& name) {
  Register& all = registered();
  const std::lock_guard lock(all.mutex);
  if (all.free.empty()) {
    Slots* more = all.last == nullptr ? &first_slots : new Slots;
    for (Slot& slot : more->names)
      all.free.push_back(&slot);
    if (all.last != nullptr) all.last->next = more;
    all.last = more;
  }
  Slot* slot = all.free.back();
  all.free.pop_back();
  *slot = name.c_str();
  return slot;
}

void forget(Slot* slot) {
  *slot = nullptr;
  Register& all = registered();
  const std::lock_guard lock(all.mutex);
  all.free.push_back(slot);
}

// Holds signals back from this thread while files are replaced.
class Uninterrupted {
public:
  Uninterrupted() {
    sigset_t all;
    sigfillset(&all);
    ::pthread_sigmask(SIG_SETMASK, &all, &before_);
    ++commits;
  }
  Uninterrupted(const Uninterrupted&) = delete;
  Uninterrupted& operator=(const Uninterrupted&) = delete;
  ~Uninterrupted() {
    --commits;
    ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }

private:
  sigset_t before_{};
};

void close_file(int& file) {
  if (file >= 0) ::close(std::exchange(file, -1));
}

// Half of the files that may be open stay free for others. A further draft is closed once it is
// finished, and is then no longer locked.
bool too_many_are_open(int file) {
  rlimit limit{};
  return ::getrlimit(RLIMIT_NOFILE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY &&
         static_cast<rlim_t>(file) > limit.rlim_cur / 2;
}

// Locked, unless a sweeper was faster and has removed it.
bool is_ours(int file) {
  if (::flock(file, LOCK_EX | LOCK_NB) != 0) return errno != EWOULDBLOCK; // or none can be had here
  struct stat status {};
  return ::fstat(file, &status) == 0 && status.st_nlink > 0;
}

} // namespace

std::string followed(const std::string& path) {
  constexpr int most_links = 40; // as the kernel follows
  fs::path place(path);
  std::error_code no_link;
  for (int i = 0; i < most_links; ++i) {
    const fs::path next = fs::read_symlink(place, no_link);
    if (no_link) break;
    place = place.parent_path() / next;
  }
  std::error_code unknown;
  const fs::path folder =
      fs::canonical(place.has_parent_path() ? place.parent_path() : ".", unknown);
  return unknown ? place.string() : (folder / place.filename()).string();
}

// ---- one draft

// Also removes what dead processes left of the same target.
Draft::Claim::Claim(const std::string& path) : target(followed(path)) {
  refuse_input(path);
  std::error_code not_there;
  if (fs::is_directory(target, not_there)) throw OutputError(path, std::strerror(EISDIR));
  Register& all = registered();
  const std::lock_guard lock(all.mutex);
  if (all.targets.contains(target))
    throw ArgumentError("output", path, "another file than that of another output");
  sweep(target);
  all.targets.insert(target);
}

Draft::Claim::~Claim() {
  Register& all = registered();
  const std::lock_guard lock(all.mutex);
  all.targets.erase(target);
  if (all.targets.empty()) forget_folders();
}

Draft::Draft(const std::string& path) : path_(path), claim_(path) {
  open();
  keep_mode();
}

Draft::~Draft() {
  if (!replaced_) ::unlink(name_.c_str());
  close();
  forget(remembered_);
}

void Draft::open() {
  const std::string pattern = draft_prefix(claim_.target) + "XXXXXX";
  name_ = pattern;
  remembered_ = remember(name_); // before the file exists, so that no signal comes in between
  do {
    close_file(file_);
    name_.replace(0, name_.size(), pattern);
    file_ = ::mkostemp(name_.data(), O_CLOEXEC);
    if (file_ < 0) {
      const int reason = errno;
      forget(remembered_);
      throw OutputError(path_, std::strerror(reason));
    }
  } while (!is_ours(file_));
}

void Draft::close() {
  close_file(file_);
  close_file(old_file_);
}

// A replaced file keeps its mode; a new one gets what the user's mask leaves.
void Draft::keep_mode() const {
  struct stat old {};
  const mode_t mask = ::umask(0);
  ::umask(mask);
  const bool replaces = ::stat(claim_.target.c_str(), &old) == 0;
  ::fchmod(file_, replaces ? old.st_mode & 07777 : 0666 & ~mask);
}

void Draft::write(std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(file_, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) throw OutputError(path_, std::strerror(errno));
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

void Draft::finish() {
  if (finished_) return;
  if (::fsync(file_) != 0 && errno != EINVAL) throw OutputError(path_, std::strerror(errno));
  finished_ = true;
  if (too_many_are_open(file_)) close_file(file_);
}

// ---- taking the target's place

// The old file gets a second name; where there are no hard links it is moved.
void Draft::set_old_aside() {
  struct stat status {};
  if (::lstat(claim_.target.c_str(), &status) != 0) return; // there is none
  if (!S_ISREG(status.st_mode)) throw OutputError(path_, "something else has taken its place");
  old_ = name_ + old_suffix;
  old_file_ = ::open(claim_.target.c_str(), O_RDONLY | O_CLOEXEC);
  if (old_file_ >= 0) ::flock(old_file_, LOCK_SH | LOCK_NB);
  if (::link(claim_.target.c_str(), old_.c_str()) == 0) return;
  if (::rename(claim_.target.c_str(), old_.c_str()) != 0) old_.clear();
}

void Draft::replace() {
  if (::rename(name_.c_str(), claim_.target.c_str()) != 0)
    throw OutputError(path_, std::strerror(errno));
  replaced_ = true;
}

void Draft::put_back() {
  if (!old_.empty()) {
    ::rename(old_.c_str(), claim_.target.c_str());
    ::unlink(old_.c_str()); // a rename to another name of the same file does nothing
  } else if (replaced_) {
    ::unlink(claim_.target.c_str());
  }
}

void Draft::settle() {
  if (!old_.empty()) ::unlink(old_.c_str());
  close();
}

void Draft::commit(std::span<Draft* const> drafts) {
  const Uninterrupted until_all_are_in;
  const bool alone = drafts.size() == 1; // a rename by itself is all or nothing
  std::size_t begun = 0;
  try {
    for (; begun < drafts.size(); ++begun) {
      if (!alone) drafts[begun]->set_old_aside();
      drafts[begun]->replace();
    }
  } catch (...) {
    for (std::size_t i = 0; i <= begun; ++i)
      drafts[i]->put_back();
    throw;
  }
  for (Draft* draft : drafts)
    draft->settle();
}

std::size_t Draft::alive() {
  Register& all = registered();
  const std::lock_guard lock(all.mutex);
  return all.targets.size();
}

void unlink_drafts() noexcept {
  constexpr timespec a_moment{0, 1'000'000};
  while (commits > 0) // in another thread: this one takes no signal meanwhile
    ::nanosleep(&a_moment, nullptr);
  for (const Slots* slots = &first_slots; slots != nullptr; slots = slots->next)
    for (const Slot& slot : slots->names)
      if (const char* name = slot.load()) ::unlink(name);
}

} // namespace goingrate
