#include "lines.hpp"

#include "growth.hpp"
#include "labx.hpp"
#include "zip.hpp"

#include "goingrate/base/atomic_file.hpp"
#include "goingrate/base/errors.hpp"
#include "goingrate/log/reading.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

namespace goingrate {

namespace {

constexpr std::size_t chunk = 1 << 18;         // stays in the second-level cache
constexpr std::size_t longest_line = 16 << 20; // no log has one, but a file without line ends does

// The reason why a file cannot be opened, in words for what was found.
std::string found_instead(int error) {
  if (error == ENOENT || error == ENOTDIR) return "no file of that name";
  if (error == EACCES || error == EPERM) return "a file that you may not read";
  return std::strerror(error);
}

// A file descriptor, read as it comes.
class FileSource : public ByteSource {
public:
  FileSource(const std::string& path, std::function<bool()> wait)
      : path_(path), wait_(std::move(wait)) {
    note_input(path);
    if (path == "-") {
      descriptor_ = STDIN_FILENO;
      return;
    }
    descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    struct stat status {};
    if (descriptor_ < 0 || ::fstat(descriptor_, &status) != 0)
      throw InputError({path}, found_instead(errno), "a readable file");
    if (S_ISDIR(status.st_mode)) {
      ::close(descriptor_);
      throw InputError({path}, "a folder", "a readable file");
    }
    if (S_ISREG(status.st_mode)) size_ = static_cast<std::uint64_t>(status.st_size);
  }
  FileSource(const FileSource&) = delete;
  FileSource& operator=(const FileSource&) = delete;
  ~FileSource() override {
    if (descriptor_ != STDIN_FILENO) ::close(descriptor_);
  }

  std::size_t read(char* to, std::size_t size) override {
    while (!wait_ || size_ ? !has_begun_anew() : something_comes()) {
      const ssize_t count = ::read(descriptor_, to, size);
      if (count > 0) {
        taken_ += static_cast<std::uint64_t>(count);
        if (wait_ && size_) growth_.took(to, static_cast<std::size_t>(count), taken_);
        was_at_end_ = false;
        waits_at_end_ = 0;
        return static_cast<std::size_t>(count);
      }
      if (count < 0 && errno != EINTR) throw InputError({path_}, std::strerror(errno), "more text");
      if (count < 0) continue;
      was_at_end_ = true;
      if (!wait_ || !size_ || !wait_()) break; // a closed pipe does not grow
      ::poll(nullptr, 0, wait_ms);
    }
    return 0;
  }
  [[nodiscard]] std::optional<std::uint64_t> size() const override { return size_; }
  [[nodiscard]] std::uint64_t taken() const override { return taken_; }

private:
  static constexpr int wait_ms =
      100; // a tenth of a second: shorter than a beat, long for a computer

  // Waits for input from a pipe or a terminal. True at its end too, which read() then reports;
  // false if the caller stopped waiting.
  [[nodiscard]] bool something_comes() const {
    pollfd descriptor{descriptor_, POLLIN, 0};
    const auto comes = [&](int ms) { // not where a signal ended the wait
      const int ready = ::poll(&descriptor, 1, ms);
      return ready > 0 || (ready < 0 && errno != EINTR);
    };
    if (comes(0)) return true;
    while (wait_())
      if (comes(wait_ms)) return true;
    return false;
  }
  // Whether a followed file has started over, so that what comes next does not continue it. A file
  // that was replaced by another is first read to its end, which may still be being written.
  [[nodiscard]] bool has_begun_anew() {
    if (!was_at_end_ || !growth_.begins_anew(descriptor_, path_)) return false;
    constexpr int quiet_waits = 10; // a second
    if (!Growth::is_replaced(descriptor_, path_)) return true;
    return ++waits_at_end_ > quiet_waits;
  }

  std::string path_;
  std::function<bool()> wait_;
  int descriptor_ = -1;
  std::optional<std::uint64_t> size_;
  std::uint64_t taken_ = 0;
  Growth growth_;
  bool was_at_end_ = false;
  int waits_at_end_ = 0; // since the last byte, of a file that was replaced
};

// Hands out first the bytes that were already taken from a source to look at.
class PeekedSource : public ByteSource {
public:
  PeekedSource(std::unique_ptr<ByteSource> source, std::string peeked)
      : source_(std::move(source)), peeked_(std::move(peeked)) {}
  std::size_t read(char* to, std::size_t size) override {
    if (peeked_.empty()) return source_->read(to, size);
    const std::size_t count = std::min(size, peeked_.size());
    std::copy_n(peeked_.begin(), count, to);
    peeked_.erase(0, count);
    return count;
  }
  [[nodiscard]] std::optional<std::uint64_t> size() const override { return source_->size(); }
  [[nodiscard]] std::uint64_t taken() const override { return source_->taken(); }

private:
  std::unique_ptr<ByteSource> source_;
  std::string peeked_;
};

// Unpacks gzip, also several members one after the other.
class GzipSource : public ByteSource {
public:
  GzipSource(std::unique_ptr<ByteSource> packed, std::string path, std::uint64_t limit)
      : packed_(std::move(packed)), path_(std::move(path)), limit_(limit) {
    constexpr int gzip_only = 16 + MAX_WBITS;
    if (inflateInit2(&stream_, gzip_only) != Z_OK) throw std::bad_alloc();
  }
  GzipSource(const GzipSource&) = delete;
  GzipSource& operator=(const GzipSource&) = delete;
  ~GzipSource() override { inflateEnd(&stream_); }

  std::size_t read(char* to, std::size_t size) override {
    stream_.next_out = reinterpret_cast<Bytef*>(to);
    stream_.avail_out = static_cast<uInt>(size);
    while (stream_.avail_out == size) {
      if (stream_.avail_in == 0 && !refill()) {
        if (inside_) throw InputError({path_}, "gzip data that end early", "a whole .gz file");
        return 0;
      }
      inside_ = true;
      const int code = inflate(&stream_, Z_NO_FLUSH);
      if (code == Z_STREAM_END) {
        inside_ = false;
        inflateReset(&stream_);
      } else if (code != Z_OK && code != Z_BUF_ERROR) {
        throw InputError({path_}, "damaged gzip data", "a .gz file that unpacks");
      }
    }
    const std::size_t count = size - stream_.avail_out;
    unpacked_ += count;
    if (unpacked_ > limit_)
      throw InputError({path_}, fmt::format("gzip data that unpack to more than {} bytes", limit_),
                       "no more, or a higher limit for what may be unpacked");
    return count;
  }
  [[nodiscard]] std::optional<std::uint64_t> size() const override { return packed_->size(); }
  [[nodiscard]] std::uint64_t taken() const override { return packed_->taken(); }

private:
  bool refill() {
    const std::size_t count = packed_->read(input_.data(), input_.size());
    stream_.next_in = reinterpret_cast<Bytef*>(input_.data());
    stream_.avail_in = static_cast<uInt>(count);
    return count > 0;
  }

  std::unique_ptr<ByteSource> packed_;
  std::string path_;
  z_stream stream_{};
  std::array<char, 1 << 16> input_{};
  std::uint64_t limit_, unpacked_ = 0;
  bool inside_ = false;
};

// Takes up to `size` bytes.
std::string taken_from(ByteSource& source, std::size_t size) {
  std::string bytes(size, '\0');
  std::size_t count = 0;
  while (count < size) {
    const std::size_t more = source.read(bytes.data() + count, size - count);
    if (more == 0) break;
    count += more;
  }
  bytes.resize(count);
  return bytes;
}

// A measurement that is not lines of text becomes a table; any other source stays as it is.
std::unique_ptr<ByteSource> as_table(std::unique_ptr<ByteSource> source, const std::string& path) {
  std::string beginning = taken_from(*source, 2);
  if (beginning != "<?" && beginning != "<c")
    return std::make_unique<PeekedSource>(std::move(source), std::move(beginning));
  constexpr std::size_t head_bytes = 1024;      // tell a measurement
  constexpr std::size_t most_bytes = 256 << 20; // of a measurement
  beginning += taken_from(*source, head_bytes);
  if (!is_labx(beginning))
    return std::make_unique<PeekedSource>(std::move(source), std::move(beginning));
  while (beginning.size() < most_bytes) {
    const std::string more = taken_from(*source, chunk);
    beginning += more;
    if (more.size() < chunk) break;
  }
  return std::make_unique<PeekedSource>(std::move(source), table_of_labx(beginning, path));
}

} // namespace

std::unique_ptr<ByteSource> open_source(const std::string& path, std::uint64_t unpacked_limit,
                                        std::function<bool()> wait) {
  if (auto entry = open_in_zip(path, unpacked_limit)) return as_table(std::move(entry), path);
  const bool is_followed = wait != nullptr;
  std::unique_ptr<ByteSource> source = std::make_unique<FileSource>(path, std::move(wait));
  std::string first = taken_from(*source, 2);
  const bool packed = first == "\x1f\x8b";
  source = std::make_unique<PeekedSource>(std::move(source), std::move(first));
  if (packed) source = std::make_unique<GzipSource>(std::move(source), path, unpacked_limit);
  return is_followed ? std::move(source) : as_table(std::move(source), path);
}

LineReader::LineReader(std::string_view text, std::string name)
    : name_(std::move(name)), rest_(text), at_end_(true) {}

LineReader::LineReader(std::unique_ptr<ByteSource> source, std::string name,
                       std::string_view before)
    : source_(std::move(source)), name_(std::move(name)), buffer_(before.begin(), before.end()),
      rest_(buffer_.data(), buffer_.size()) {}

// Appends what comes next to what is left; false at the end.
bool LineReader::refill() {
  if (at_end_) return false;
  if (rest_.size() > longest_line)
    throw InputError({name_, number_ - counted_from_ + 1, 1},
                     fmt::format("a line of more than {} bytes", longest_line),
                     "a log in lines of text");
  std::copy(rest_.begin(), rest_.end(), buffer_.begin()); // moves towards the front
  const std::size_t kept = rest_.size();
  if (buffer_.size() < kept + chunk) buffer_.resize(std::max(kept + chunk, kept * 2));
  rest_ = {buffer_.data(), kept}; // at hand while the source is waited for
  const std::size_t count = source_->read(buffer_.data() + kept, buffer_.size() - kept);
  at_end_ = count == 0;
  rest_ = {buffer_.data(), kept + count};
  return count > 0;
}

// From `begin` on, the rest is the beginning of one very long line.
void LineReader::cut_rest(std::size_t begin) {
  constexpr std::size_t most_told_bytes = 64; // bytes of it
  constexpr std::string_view words = " … line cut … ";
  const auto kept = static_cast<std::ptrdiff_t>(begin + most_told_bytes);
  std::copy(rest_.begin(), rest_.begin() + kept, buffer_.begin()); // moves towards the front
  std::copy(words.begin(), words.end(), buffer_.begin() + kept);
  rest_ = {buffer_.data(), begin + most_told_bytes + words.size()};
}

// Cuts the last line at hand, which has no end yet, if it is longer than any line of a log.
void LineReader::cut_last_line() {
  constexpr std::size_t most_bytes_of_a_line = 1 << 16; // of a log
  const std::size_t begin = rest_.rfind('\n') + 1; // npos + 1 is 0
  if (cuts_long_lines_ && rest_.size() - begin > most_bytes_of_a_line) cut_rest(begin);
}

void LineReader::settle_line_end() {
  constexpr std::string_view mark = "\xef\xbb\xbf";
  if (rest_.starts_with(mark)) rest_.remove_prefix(mark.size());
  const bool has_lf = rest_.find('\n') != std::string_view::npos;
  line_end_ = !has_lf && rest_.find('\r') != std::string_view::npos ? '\r' : '\n';
  started_ = true;
}

std::string_view LineReader::head(std::size_t lines) {
  const auto enough = [&] {
    return static_cast<std::size_t>(std::count(rest_.begin(), rest_.end(), '\n')) >= lines;
  };
  while (!enough() && rest_.size() < longest_line && refill())
    cut_last_line();
  settle_line_end();
  const auto count = static_cast<double>(std::count(rest_.begin(), rest_.end(), line_end_)) + 1.0;
  const double seen = static_cast<double>(rest_.size());
  double all = seen;
  if (source_ && source_->size() && source_->taken() > 0) // of a packed file in proportion
    all *= static_cast<double>(*source_->size()) / static_cast<double>(source_->taken());
  // Short lines in the head may be followed by long ones: no more than one in eight bytes is
  // promised beyond what was seen.
  constexpr double shortest_expected = 8.0;
  const double mean = seen / count;
  const double more = std::max(0.0, all - seen) / std::max(mean, shortest_expected);
  lines_expected_ = seen > 0.0 ? static_cast<std::size_t>(count + more) : 0;
  constexpr std::size_t most_lines_ratio =
      10; // times the lines asked for: a buffer may hold many more
  std::size_t end = 0;
  for (std::size_t line = 0; line < most_lines_ratio * lines && end < rest_.size(); ++line)
    end = std::min(rest_.find(line_end_, end), rest_.size() - 1) + 1;
  whole_is_in_head_ = at_end_ && end == rest_.size();
  return rest_.substr(0, end);
}

std::optional<Line> LineReader::next() {
  if (!started_) {
    while (rest_.size() < 3 && refill()) {
    }
    settle_line_end();
  }
  std::size_t searched = 0;
  while (true) {
    const std::size_t end = rest_.find(line_end_, searched);
    if (end != std::string_view::npos) {
      std::string_view text = rest_.substr(0, end);
      rest_.remove_prefix(end + 1);
      while (!text.empty() && text.back() == '\r')
        text.remove_suffix(1);
      return Line{text, ++number_, true};
    }
    if (rest_.size() > longest_line && cuts_long_lines_) cut_rest(0);
    searched = rest_.size();
    if (refill()) continue;
    if (rest_.empty()) return {};
    const Line last{rest_, ++number_, false};
    rest_ = {};
    return last;
  }
}

std::string read_text(const std::string& path, std::uint64_t unpacked_limit) {
  const auto source = open_source(path, unpacked_limit);
  std::string text;
  constexpr std::size_t chunk = 1 << 16;
  while (true) {
    const std::size_t kept = text.size();
    text.resize(kept + chunk);
    const std::size_t count = source->read(text.data() + kept, chunk);
    text.resize(kept + count);
    if (count == 0) return text;
  }
}

std::string LineReader::all() {
  std::string bytes(rest_);
  rest_ = {};
  if (!source_ || at_end_) return bytes;
  at_end_ = true;
  while (true) {
    std::string more = taken_from(*source_, std::max(chunk, bytes.size()));
    if (more.empty()) return bytes;
    bytes += more;
  }
}

std::optional<double> LineReader::fraction_read() const {
  if (!source_ || !source_->size() || *source_->size() == 0) return {};
  return static_cast<double>(source_->taken()) / static_cast<double>(*source_->size());
}

} // namespace goingrate
