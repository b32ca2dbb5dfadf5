// Lines of a text that may be a string, a file or a pipe, plain or compressed by gzip.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace goingrate {

/// A source of bytes.
class ByteSource {
public:
  virtual ~ByteSource() = default;
  /// Reads up to `size` bytes into `to`; 0 at the end. Throws InputError if reading fails.
  virtual std::size_t read(char* to, std::size_t size) = 0;
  /// Bytes in all, if that is known, and bytes taken so far: for progress.
  [[nodiscard]] virtual std::optional<std::uint64_t> size() const { return {}; }
  [[nodiscard]] virtual std::uint64_t taken() const = 0;
};

/// A file, standard input for "-", or a file inside a ZIP, "archive.zip/name"; gzip is recognised
/// by its first two bytes. With `wait`, reading waits at the end of a regular file for it to grow;
/// `wait` is called every tenth of a second until more comes, and returns false to give up. Such a
/// file also ends if it starts over: cut off and written again, or replaced by another file. Throws
/// InputError if it cannot be opened or is a directory; reading throws it if a packed file unpacks
/// to more than `unpacked_limit` bytes.
std::unique_ptr<ByteSource> open_source(const std::string& path, std::uint64_t unpacked_limit,
                                        std::function<bool()> wait = nullptr);

/// One line without its end.
struct Line {
  std::string_view text; ///< valid until the next call of the reader
  std::uint32_t number = 0;
  bool ended = true; ///< false for a last line without a line end
};

/// Cuts a text into lines: LF, CR LF, or CR alone if the text's head has no LF. A byte-order mark
/// is skipped. A text in memory is not copied; a source is held one buffer at a time.
class LineReader {
public:
  LineReader(std::string_view text, std::string name);
  /// `before` is text that comes before that of the source.
  LineReader(std::unique_ptr<ByteSource> source, std::string name, std::string_view before = {});

  /// The beginning of the text, for recognising its format: at least `lines` lines if it has them,
  /// and no more than ten times as many, or 16 MiB. Only before the first next().
  std::string_view head(std::size_t lines);

  /// All bytes, if the source is not text after all. Only before the first next().
  std::string all();

  /// Whether `head` was the whole text.
  [[nodiscard]] bool whole_is_in_head() const { return whole_is_in_head_; }

  /// From now on a line of more than 16 MiB is returned as its beginning and its end, with words in
  /// between that do not occur in a field.
  void cut_long_lines() { cuts_long_lines_ = true; }
  /// The next line. Throws InputError for a line of more than 16 MiB, if it is not to be cut.
  std::optional<Line> next();

  /// The text from the next line on, as far as it is at hand, for those who cut lines themselves;
  /// empty where lines end with CR alone.
  [[nodiscard]] std::string_view at_hand() const {
    return line_end_ == '\n' ? rest_ : std::string_view();
  }
  /// Makes the reader continue after `bytes` bytes of at_hand(), which were `lines` whole lines.
  void skip(std::size_t bytes, std::uint32_t lines) {
    rest_.remove_prefix(bytes);
    number_ += lines;
  }
  /// Lines so far.
  [[nodiscard]] std::uint32_t number() const { return number_; }
  /// Lines are counted on from those of another text. Only before the first next().
  void count_from(std::uint32_t lines) { number_ = counted_from_ = lines; }

  [[nodiscard]] const std::string& name() const { return name_; }
  /// Share of the source that has been read, 0 to 1; nullopt if its size is not known.
  [[nodiscard]] std::optional<double> fraction_read() const;
  /// The number of lines to reserve room for: those in `head`, and for the rest the source's size
  /// over their mean length (at least 8 bytes).
  [[nodiscard]] std::size_t lines_expected() const { return lines_expected_; }

private:
  bool refill();
  void cut_rest(std::size_t begin);
  void cut_last_line();
  void settle_line_end();

  std::unique_ptr<ByteSource> source_; // none for a text in memory
  std::string name_;
  std::vector<char> buffer_;
  std::string_view rest_; // of the buffer, or of the text
  char line_end_ = '\n';
  std::uint32_t number_ = 0, counted_from_ = 0;
  std::size_t lines_expected_ = 0;
  bool at_end_ = false;
  bool whole_is_in_head_ = false;
  bool started_ = false;
  bool cuts_long_lines_ = false;
};

} // namespace goingrate
