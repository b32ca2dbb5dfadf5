#include "goingrate/base/atomic_file.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <memory>
#include <optional>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>
#include <vector>

namespace goingrate {

namespace {

void write_all(int file, std::string_view text, const std::string& path) {
  while (!text.empty()) {
    const ssize_t written = ::write(file, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0 && errno == EPIPE) throw ClosedPipe(path, std::strerror(errno));
    if (written <= 0) throw OutputError(path, std::strerror(errno));
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

// The names of the drafts that there are, for a signal handler: slots that hold a name or nothing.
std::array<std::atomic<const char*>, 256> draft_names{};
static_assert(std::atomic<const char*>::is_always_lock_free);

// One that finds no slot is not remembered.
void remember_draft(const char* name) {
  for (auto& slot : draft_names) {
    const char* none = nullptr;
    if (slot.compare_exchange_strong(none, name)) return;
  }
}

void forget_draft(const char* name) {
  for (auto& slot : draft_names) {
    const char* mine = name;
    if (slot.compare_exchange_strong(mine, nullptr)) return;
  }
}

// Files that are read and must stay.
std::vector<std::filesystem::path>& kept_inputs() {
  static std::vector<std::filesystem::path> paths;
  return paths;
}

void refuse_input(const std::string& path) {
  for (const auto& input : kept_inputs()) {
    std::error_code unknown;
    if (std::filesystem::equivalent(input, path, unknown))
      throw ArgumentError("output", path, "another file than the one that is read");
  }
}

// Owns a temporary file beside the target until it is committed by a rename.
class Draft {
public:
  explicit Draft(const std::string& path) : target_(path), path_(path) {
    refuse_input(path);
    std::error_code not_there; // a link is followed, so that the file it names is replaced
    if (std::filesystem::is_symlink(path, not_there))
      target_ = std::filesystem::weakly_canonical(path, not_there).string();
    name_ = std::make_unique<std::string>(target_ + ".part-XXXXXX");
    file_ = ::mkostemp(name_->data(), O_CLOEXEC);
    if (file_ < 0) throw OutputError(path, std::strerror(errno));
    remember_draft(name_->c_str());
    keep_mode();
  }
  Draft(const std::string& path, std::string_view text) : Draft(path) {
    write(text); // the destructor discards what is left if this throws
    finish();
  }
  Draft(Draft&& other) noexcept
      : target_(std::move(other.target_)), path_(std::move(other.path_)),
        name_(std::move(other.name_)), file_(std::exchange(other.file_, -1)) {}
  Draft& operator=(Draft&&) = delete;
  ~Draft() { discard(); }

  void write(std::string_view text) { write_all(file_, text, path_); }

  void finish() {
    const bool synced = ::fsync(file_) == 0 || errno == EINVAL;
    const bool closed = ::close(std::exchange(file_, -1)) == 0;
    if (!synced || !closed) throw OutputError(path_, std::strerror(errno));
  }

  void commit() {
    if (::rename(name_->c_str(), target_.c_str()) != 0)
      throw OutputError(target_, std::strerror(errno));
    forget_draft(name_->c_str());
    name_.reset();
  }

private:
  // A replaced file keeps its mode; a new one gets what the user's mask leaves.
  void keep_mode() const {
    struct stat old {};
    const mode_t mask = ::umask(0);
    ::umask(mask);
    const bool replaces = ::stat(target_.c_str(), &old) == 0;
    ::fchmod(file_, replaces ? old.st_mode & 07777 : 0666 & ~mask);
  }
  void discard() {
    if (file_ >= 0) ::close(std::exchange(file_, -1));
    if (!name_) return;
    ::unlink(name_->c_str());
    forget_draft(name_->c_str());
  }

  std::string target_;
  std::string path_;                  // as the user wrote it, for messages
  std::unique_ptr<std::string> name_; // stays where it is when the draft is moved
  int file_ = -1;
};

bool is_special_file(const std::string& path) {
  std::error_code unknown;
  const auto status = std::filesystem::status(path, unknown);
  return std::filesystem::exists(status) && !std::filesystem::is_regular_file(status) &&
         !std::filesystem::is_directory(status);
}

// A stream has no old content to keep: standard output, a pipe, a device.
bool is_stream(const std::string& path) { return path == "-" || is_special_file(path); }

void write_stream(const std::string& path, std::string_view text) {
  if (path == "-") return write_all(STDOUT_FILENO, text, "standard output");
  const int file = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (file < 0) throw OutputError(path, std::strerror(errno));
  try {
    write_all(file, text, path);
  } catch (...) {
    ::close(file);
    throw;
  }
  ::close(file);
}

} // namespace

void keep_input(const std::string& path) {
  if (!is_stream(path)) kept_inputs().emplace_back(path);
}

void discard_drafts() noexcept {
  for (const auto& slot : draft_names)
    if (const char* name = slot.load()) ::unlink(name);
}

void write_whole_file(const std::string& path, std::string_view text) {
  if (is_stream(path)) return write_stream(path, text);
  Draft(path, text).commit();
}

void write_whole_files(const std::vector<std::pair<std::string, std::string>>& outputs) {
  const auto to_stdout = std::count_if(outputs.begin(), outputs.end(),
                                       [](const auto& output) { return output.first == "-"; });
  if (to_stdout > 1)
    throw ArgumentError("output", "-", "given once: standard output holds one result");
  std::vector<Draft> drafts;
  for (const auto& [path, text] : outputs)
    if (!path.empty() && !is_stream(path)) drafts.emplace_back(path, text);
  for (const auto& [path, text] : outputs)
    if (!path.empty() && is_stream(path)) write_stream(path, text);
  for (Draft& draft : drafts)
    draft.commit();
}

// ---- pieces -------------------------------------------------------------------------------------

struct StreamedFile::Target {
  std::optional<Draft> draft; // none for a stream
  int stream = -1;
  bool opened = false; // the stream was opened here and is closed here
  ~Target() {
    if (opened) ::close(stream);
  }
};

StreamedFile::StreamedFile(const std::string& path)
    : path_(path), target_(std::make_unique<Target>()) {
  if (path.empty()) return;
  if (path == "-") {
    target_->stream = STDOUT_FILENO;
  } else if (is_stream(path)) {
    target_->stream = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
    if (target_->stream < 0) throw OutputError(path, std::strerror(errno));
    target_->opened = true;
  } else {
    target_->draft.emplace(path);
  }
}

StreamedFile::StreamedFile(StreamedFile&&) noexcept = default;
StreamedFile::~StreamedFile() = default;

void StreamedFile::flush() {
  if (target_->draft)
    target_->draft->write(text_);
  else if (wanted())
    write_all(target_->stream, text_, path_ == "-" ? "standard output" : path_);
  text_.clear();
}

void StreamedFile::flush_if_large() {
  constexpr std::size_t large = 1 << 16; // few calls, and little even for a hundred files at once
  if (text_.size() >= large) flush();
}

void StreamedFile::finish() {
  flush();
  if (target_->draft) target_->draft->finish();
}

void StreamedFile::commit() {
  if (target_->draft) target_->draft->commit();
}

void commit_all(std::vector<StreamedFile>& files) {
  for (StreamedFile& file : files)
    file.finish();
  for (StreamedFile& file : files)
    file.commit();
}

} // namespace goingrate
