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

/// Removes what is half written. Safe in a signal handler that ends the program; nothing may be
/// written after it. What a process that was killed left behind goes when the same file is next
/// written.
void discard_drafts() noexcept;

/// What is being read: from now on no output of this process may take its place. Writing to it by
/// any name throws ArgumentError("output", ...). "-" is standard input, if that is a file. Nothing
/// for pipes and files that are not there. (AtomicFileTest.WhatIsReadIsNotReplaced)
void keep_input(const std::string& path);

/// From now on every file that this library reads is kept as by keep_input().
void keep_all_inputs();

/// What reads a file for the user names it here, for keep_all_inputs().
void note_input(const std::string& path);

/// Several outputs of one command, (path, text): all are on disk before the first old file is
/// replaced, and if one cannot be replaced all are as they were. An empty path is an output nobody
/// asked for. Throws OutputError, and ArgumentError if two of them are the same file or standard
/// output. (AtomicFileTest.OfSeveralFilesNoneIsReplacedIfOneFails)
void write_whole_files(const std::vector<std::pair<std::string, std::string>>& outputs);

/// An output that is too long to be held in memory: written piece by piece, in constant memory, to
/// a file beside the target (or straight to standard output or a pipe), and renamed over the target
/// by commit_all(). Without that the old file stays and nothing is left behind. Where the reader of
/// standard output goes away, the files that are being written are written all the same; without
/// any, ClosedPipe is thrown.
class StreamedFile {
public:
  /// "-" is standard output; an empty path is an output nobody asked for. Throws OutputError, and
  /// ArgumentError if the file is one that is read or has another such writer.
  explicit StreamedFile(const std::string& path);
  StreamedFile(StreamedFile&&) noexcept;
  ~StreamedFile();

  /// Whether it is standard output, a pipe or a device.
  [[nodiscard]] bool is_stream() const;
  /// Writes what is in text(), then this.
  void write(std::string_view text);
  /// Whether anybody asked for it.
  [[nodiscard]] bool wanted() const { return !path_.empty(); }
  /// Text to append to; hand it over with flush_if_large() now and then.
  [[nodiscard]] std::string& text() { return text_; }
  /// Writes text() out and empties it once there is enough to be worth it.
  void flush_if_large();
  /// Everything is put on disk; commit_all() then only renames.
  void finish();

private:
  friend void commit_all(const std::vector<StreamedFile*>& files);
  void flush();
  struct Target;
  std::string path_;
  std::string text_;
  std::unique_ptr<Target> target_;
};

/// Finishes all, then renames all over their targets; if one cannot be renamed, all targets are as
/// they were.
void commit_all(const std::vector<StreamedFile*>& files);
/// The same.
void commit_all(std::vector<StreamedFile>& files);

} // namespace goingrate
