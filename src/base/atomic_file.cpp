#include "goingrate/base/atomic_file.hpp"

#include "draft.hpp"
#include "inputs.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <optional>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

namespace goingrate {

namespace {

bool is_special_file(const std::string& path) {
  std::error_code unknown;
  const auto status = std::filesystem::status(path, unknown);
  return std::filesystem::exists(status) && !std::filesystem::is_regular_file(status) &&
         !std::filesystem::is_directory(status);
}

// Standard output, a pipe or a device, which has no old content to keep.
class Stream {
public:
  explicit Stream(const std::string& path) : path_(path) {
    if (is_standard_output(path)) {
      refuse_input("-");
      if (taken_.exchange(true))
        throw ArgumentError("output", path, "given once: standard output holds one result");
      return;
    }
    file_ = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
    if (file_ < 0) throw OutputError(path, std::strerror(errno));
  }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
  ~Stream() {
    if (is_standard())
      taken_ = false;
    else
      ::close(file_);
  }

  // Whether it is the null device.
  [[nodiscard]] bool discards() const {
    struct stat status {
    }, null{};
    return ::fstat(file_, &status) == 0 && S_ISCHR(status.st_mode) &&
           ::stat("/dev/null", &null) == 0 && status.st_rdev == null.st_rdev;
  }

  void write(std::string_view text) {
    while (!text.empty() && !reader_has_gone_) {
      const ssize_t written = ::write(file_, text.data(), text.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0 && errno == EPIPE && is_standard()) return lose_reader();
      if (written <= 0)
        throw OutputError(is_standard() ? "standard output" : path_, std::strerror(errno));
      text.remove_prefix(static_cast<std::size_t>(written));
    }
  }

private:
  [[nodiscard]] bool is_standard() const { return file_ == STDOUT_FILENO; }

  // Other files that were asked for are written all the same.
  void lose_reader() {
    reader_has_gone_ = true;
    if (Draft::alive() == 0) throw ClosedPipe("standard output", std::strerror(EPIPE));
  }

  inline static std::atomic<bool> taken_{false}; // by a result
  std::string path_;
  int file_ = STDOUT_FILENO;
  bool reader_has_gone_ = false;
};

} // namespace

bool is_standard_output(std::string_view path) {
  static constexpr std::array<std::string_view, 4> names{"-", "/dev/stdout", "/dev/fd/1",
                                                         "/proc/self/fd/1"};
  return std::find(names.begin(), names.end(), path) != names.end();
}

void discard_drafts() noexcept { unlink_drafts(); }

void write_whole_file(const std::string& path, std::string_view text) {
  StreamedFile file(path);
  file.write(text);
  commit_all({&file});
}

void write_whole_files(const std::vector<std::pair<std::string, std::string>>& outputs) {
  std::vector<StreamedFile> files;
  for (const auto& output : outputs)
    files.emplace_back(output.first);
  for (const bool to_streams : {false, true}) // streams last: output to them cannot be taken back
    for (std::size_t i = 0; i < files.size(); ++i)
      if (files[i].is_stream() == to_streams) files[i].write(outputs[i].second);
  commit_all(files);
}

void check_writable(const std::vector<std::string>& paths) {
  std::vector<std::unique_ptr<Draft>> drafts; // alive together: two of one file are an error
  for (const std::string& path : paths)
    if (!path.empty() && !is_standard_output(path) && !is_special_file(path))
      drafts.push_back(std::make_unique<Draft>(path));
}

// ---- pieces

struct StreamedFile::Target {
  std::optional<Draft> draft; // one of the two, or none for an output nobody asked for
  std::optional<Stream> stream;
};

StreamedFile::StreamedFile(const std::string& path) : target_(std::make_unique<Target>()) {
  if (path.empty()) return;
  if (is_standard_output(path) || is_special_file(path))
    target_->stream.emplace(path);
  else
    target_->draft.emplace(path);
}

StreamedFile::StreamedFile(StreamedFile&&) noexcept = default;
StreamedFile::~StreamedFile() = default;

bool StreamedFile::wanted() const {
  return target_->draft || (target_->stream && !target_->stream->discards());
}

bool StreamedFile::is_stream() const { return target_->stream.has_value(); }

void StreamedFile::write(std::string_view text) {
  flush();
  put(text);
}

void StreamedFile::put(std::string_view text) {
  if (target_->draft) target_->draft->write(text);
  if (target_->stream) target_->stream->write(text);
}

// Keeps the memory for the next piece.
void StreamedFile::flush() {
  if (!text_.empty()) put(text_);
  text_.clear();
}

void StreamedFile::flush_if_large() {
  constexpr std::size_t flush_bytes =
      1 << 16; // few calls, and little even for a hundred files at once
  if (text_.size() >= flush_bytes) flush();
}

void StreamedFile::finish() {
  flush();
  if (target_->draft) target_->draft->finish();
}

void commit_all(const std::vector<StreamedFile*>& files) {
  std::vector<Draft*> drafts;
  for (const bool streams : {false, true})
    for (StreamedFile* file : files)
      if (file->is_stream() == streams) file->finish();
  for (const StreamedFile* file : files)
    if (file->target_->draft) drafts.push_back(&*file->target_->draft);
  Draft::commit(drafts);
}

void commit_all(std::vector<StreamedFile>& files) {
  std::vector<StreamedFile*> all;
  for (StreamedFile& file : files)
    all.push_back(&file);
  commit_all(all);
}

} // namespace goingrate
