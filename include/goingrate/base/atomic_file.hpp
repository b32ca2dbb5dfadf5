// Output files that are either whole or absent.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace goingrate {

/// Writes `text` to `path` ("-" is standard output). The text goes to a file beside the target,
/// which is renamed over it only when every byte is on disk, so a failure leaves the old file.
/// Throws OutputError; the temporary file is removed then.
void write_whole_file(const std::string& path, std::string_view text);

/// Removes what is half written, of the first 256 files in the making. Safe in a signal handler
/// that ends the program; nothing may be written after it.
void discard_drafts() noexcept;

/// What is being read: from now on no output of this process may take its place. Writing to it by
/// any name throws ArgumentError("output", ...). Nothing for standard input and files that are not
/// there. (AtomicFileTest.WhatIsReadIsNotReplaced)
void keep_input(const std::string& path);

/// Several outputs of one command, (path, text): all are on disk before the first old file is
/// replaced. An empty path is an output nobody asked for. Throws OutputError, and ArgumentError if
/// two of them are standard output.
void write_whole_files(const std::vector<std::pair<std::string, std::string>>& outputs);

/// An output that is too long to be held in memory: written piece by piece, in constant memory, to
/// a file beside the target (or straight to standard output or a pipe), and renamed over the target
/// by commit(). Without commit() the old file stays and nothing is left behind.
class StreamedFile {
public:
  /// "-" is standard output; an empty path is an output nobody asked for. Throws OutputError.
  explicit StreamedFile(const std::string& path);
  StreamedFile(StreamedFile&&) noexcept;
  ~StreamedFile();

  /// Whether anybody asked for it.
  [[nodiscard]] bool wanted() const { return !path_.empty(); }
  /// Text to append to; hand it over with flush_if_large() now and then.
  [[nodiscard]] std::string& text() { return text_; }
  /// Writes text() out and empties it once there is enough to be worth it.
  void flush_if_large();
  /// Everything is put on disk; commit() then only renames.
  void finish();
  /// Renames the file over the target; nothing is done for a stream.
  void commit();

private:
  void flush();
  struct Target;
  std::string path_;
  std::string text_;
  std::unique_ptr<Target> target_;
};

/// Finishes all, then commits all.
void commit_all(std::vector<StreamedFile>& files);

} // namespace goingrate
