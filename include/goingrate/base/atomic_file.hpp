// Output files that are either whole or absent.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace goingrate {

/// Whether the path names standard output: "-", "/dev/stdout" and the like.
bool is_standard_output(std::string_view path);

/// Writes `text` to `path` ("-" is standard output). The text goes to a file beside the target,
/// which is renamed over it only when every byte is on disk, so a failure leaves the old file.
/// Throws OutputError; the temporary file is removed then.
void write_whole_file(const std::string& path, std::string_view text);

/// Removes all temporary files. Safe in a signal handler that ends the program; nothing may be
/// written afterwards. Temporary files of a process that was killed are removed when the same file
/// is written again.
void discard_drafts() noexcept;

/// Protects an input: from now on no output of this process can replace it. Writing to it under
/// any name throws ArgumentError("output", ...). "-" is standard input, if that is a file. No
/// effect for pipes and files that do not exist. (AtomicFileTest.WhatIsReadIsNotReplaced)
void keep_input(const std::string& path);

/// From now on every file that this library reads is protected as by keep_input().
void keep_all_inputs();

/// Must be called by functions that read a file for the user, so that keep_all_inputs() works.
void note_input(const std::string& path);

/// Several outputs of one command, (path, text): all are on disk before the first old file is
/// replaced, and if one cannot be replaced all are left as they were. An empty path means that
/// nothing is to be written. Throws OutputError, and ArgumentError if two of them are the same file
/// or standard output. (AtomicFileTest.OfSeveralFilesNoneIsReplacedIfOneFails)
void write_whole_files(const std::vector<std::pair<std::string, std::string>>& outputs);

/// Throws now what write_whole_files() would throw if one of these files cannot be written, so that
/// nobody waits for a result that cannot be saved. Changes nothing, and does not check streams.
/// (AtomicFileTest.WhatCannotBeWrittenIsKnownBeforehand)
void check_writable(const std::vector<std::string>& paths);

/// An output that is too long to be held in memory: written piece by piece, in constant memory, to
/// a file beside the target (or straight to standard output or a pipe), and renamed over the target
/// by commit_all(). Without that the old file stays and nothing is left behind. If the reader of
/// standard output goes away, other files are still completed; if there are none, ClosedPipe is
/// thrown.
class StreamedFile {
public:
  /// "-" is standard output; an empty path means that nothing is to be written. Throws OutputError,
  /// and ArgumentError if the file is one that is read or has another such writer.
  explicit StreamedFile(const std::string& path);
  StreamedFile(StreamedFile&&) noexcept;
  ~StreamedFile();

  /// Whether it is standard output, a pipe or a device.
  [[nodiscard]] bool is_stream() const;
  /// Writes the contents of text(), then this text.
  void write(std::string_view text);
  /// Whether the output is kept: false without a path, and for the null device.
  [[nodiscard]] bool wanted() const;
  /// Text to append to; hand it over with flush_if_large() now and then.
  [[nodiscard]] std::string& text() { return text_; }
  /// Writes text() and empties it, once it has grown large enough.
  void flush_if_large();
  /// Completes the temporary file on disk; commit_all() then only renames it.
  void finish();

private:
  friend void commit_all(const std::vector<StreamedFile*>& files);
  void put(std::string_view text);
  void flush();
  struct Target;
  std::string text_;
  std::unique_ptr<Target> target_;
};

/// Finishes all, then renames all over their targets; if one cannot be renamed, all targets are as
/// they were.
void commit_all(const std::vector<StreamedFile*>& files);
/// The same for a vector of files.
void commit_all(std::vector<StreamedFile>& files);

} // namespace goingrate
