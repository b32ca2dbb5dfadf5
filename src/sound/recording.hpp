// Files of sound: WAV, RF64, AIFF, FLAC and OGG, by libsndfile.
#pragma once

#include "goingrate/sound/ticks.hpp"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace goingrate {

/// Whether a file whose first bytes are `beginning` holds sound.
bool is_sound(std::string_view beginning);

/// Whether a regular file, neither packed nor in a ZIP, holds sound.
bool is_sound_on_disk(const std::string& path);

/// An open file of sound, on disk or in memory.
class Recording {
public:
  /// Throws InputError if it is damaged, holds no sample, or has more than 64 channels.
  static Recording on_disk(const std::string& path);
  /// Opens a file of sound from its bytes, which must outlive the object; `name` is for messages.
  static Recording in_memory(std::string_view bytes, const std::string& name);
  Recording(Recording&&) noexcept;
  Recording& operator=(Recording&&) noexcept;
  ~Recording();

  [[nodiscard]] double rate_hz() const;
  [[nodiscard]] std::size_t channels() const;
  /// Bytes that a WAV or AIFF states but does not have, because its recorder or a copy was
  /// interrupted. 0 for other kinds, and if the head states no length.
  [[nodiscard]] std::uint64_t missing_bytes() const;
  /// One of the channels, counted from 1, for as long as the recording lives. Reading throws
  /// InputError where the file is damaged or holds NaN or infinity. What cannot be read in pieces
  /// (OGG, packed samples in a WAV, a head that does not state its length) is unpacked as a whole,
  /// to `unpacked_limit` bytes at most.
  [[nodiscard]] SoundSamples channel(std::size_t number, std::uint64_t unpacked_limit);

private:
  struct File;
  explicit Recording(std::unique_ptr<File> file);
  std::unique_ptr<File> file_;
};

} // namespace goingrate
