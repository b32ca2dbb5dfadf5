// A file that is being written beside the file it is to replace.
#pragma once

#include <atomic>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace goingrate {

/// Owns a temporary file beside its target until it is committed by a rename. As long as it lives
/// its file is locked, so that other processes can tell it from the leftovers of a dead process,
/// which are removed when the next draft of the same target is opened.
class Draft {
public:
  /// Throws OutputError if no such file can be made, or a folder stands in its place; and
  /// ArgumentError if the file is one that is read, or has a draft already.
  explicit Draft(const std::string& path);
  Draft(const Draft&) = delete;
  Draft& operator=(const Draft&) = delete;
  ~Draft();

  void write(std::string_view text);
  /// Writes everything to disk.
  void finish();

  /// Each finished draft takes the place of its target; if one cannot, all targets are as they
  /// were, and OutputError is thrown. Signals wait until it is over.
  static void commit(std::span<Draft* const> drafts);

  /// The number of drafts in this process.
  static std::size_t alive();

private:
  void open();
  void keep_mode() const;
  void close();
  void set_old_aside();
  void replace();
  void put_back();
  void settle();

  // The file to be replaced, links followed, which may have one draft only.
  struct Claim {
    explicit Claim(const std::string& path);
    Claim(const Claim&) = delete;
    Claim& operator=(const Claim&) = delete;
    ~Claim();
    std::string target;
  };

  std::string path_; // as the user wrote it, for messages
  Claim claim_;
  std::string name_; // of the draft; never moves, since a signal handler may read it
  std::string old_;  // name of the target's old file during a commit
  std::atomic<const char*>* remembered_ = nullptr;
  int file_ = -1;
  int old_file_ = -1; // locked as the draft is
  bool finished_ = false;
  bool replaced_ = false;
};

/// Removes all drafts of this process; safe in a signal handler that ends it.
void unlink_drafts() noexcept;

/// The file that writing to `path` would change: links are followed, also those to files that are
/// not there yet.
std::string followed(const std::string& path);

} // namespace goingrate
