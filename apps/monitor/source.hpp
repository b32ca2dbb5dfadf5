// The source of the events of a watched clock.
#pragma once

#include <string>
#include <sys/types.h>

namespace goingrate::apps {

/// Whether the source is a file, whose events may be old when they are read.
bool is_file(const std::string& source);
/// The longest time from a beat to its line, s.
double lateness_of(const std::string& source);
/// Throws ArgumentError for a serial line with a speed that does not exist.
void check_source(const std::string& source);
/// Whether the source, once it has ended, will not come back: standard input and files.
bool ends_for_good(const std::string& source);

/// A source made ready to be read as a file: a serial line set to its speed, a sound card whose
/// beats another process writes into a pipe, a FIFO held open so that its writers may come and go.
class OpenSource {
public:
  /// Throws InputError if it cannot be opened, ArgumentError for a speed that serial lines do not
  /// have.
  explicit OpenSource(const std::string& source);
  ~OpenSource();
  OpenSource(const OpenSource&) = delete;
  OpenSource& operator=(const OpenSource&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }

private:
  void open_serial(const std::string& device, const std::string& speed);
  void open_sound(const std::string& device);

  std::string path_;
  int held_ = -1;      // keeps a serial line's settings, or a FIFO's writing end
  pid_t listener_ = 0; // of the sound
};

} // namespace goingrate::apps
