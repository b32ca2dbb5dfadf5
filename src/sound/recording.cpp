#include "recording.hpp"

#include "base/inputs.hpp"

#include "goingrate/base/atomic_file.hpp"
#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <sndfile.h>
#include <vector>

namespace goingrate {

namespace {

constexpr int most_channels = 64;

// Bytes in memory, as libsndfile asks for them.
struct Bytes {
  std::string_view all;
  sf_count_t at = 0;
};

sf_count_t length_of(void* user) {
  return static_cast<sf_count_t>(static_cast<Bytes*>(user)->all.size());
}

sf_count_t seek_in(sf_count_t offset, int whence, void* user) {
  auto& bytes = *static_cast<Bytes*>(user);
  const sf_count_t size = length_of(user);
  const sf_count_t from = whence == SEEK_SET ? 0 : whence == SEEK_CUR ? bytes.at : size;
  bytes.at = std::clamp<sf_count_t>(from + offset, 0, size);
  return bytes.at;
}

sf_count_t read_from(void* to, sf_count_t count, void* user) {
  auto& bytes = *static_cast<Bytes*>(user);
  const sf_count_t taken = std::clamp<sf_count_t>(count, 0, length_of(user) - bytes.at);
  std::memcpy(to, bytes.all.data() + bytes.at, static_cast<std::size_t>(taken));
  bytes.at += taken;
  return taken;
}

sf_count_t write_nothing(const void*, sf_count_t, void*) { return 0; }
sf_count_t place_in(void* user) { return static_cast<Bytes*>(user)->at; }

struct Close {
  void operator()(SNDFILE* file) const { sf_close(file); }
};

} // namespace

struct Recording::File {
  std::string name;
  Bytes bytes;
  SF_INFO info{};
  std::unique_ptr<SNDFILE, Close> sound;
  sf_count_t at = 0;           // frame that is read next
  std::vector<float> frames{}; // of all channels

  void check() const {
    if (!sound)
      throw InputError({name}, fmt::format("a recording that cannot be read: {}",
                                           sf_strerror(nullptr)),
                       "sound as WAV, FLAC or OGG");
    if (info.frames < 1 || info.samplerate < 1 || info.channels < 1 ||
        info.channels > most_channels)
      throw InputError({name},
                       fmt::format("{} samples of {} channels at {} Hz", info.frames,
                                   info.channels, info.samplerate),
                       fmt::format("a recording of 1 to {} channels", most_channels));
  }

  // Lossy codecs do not come to the same samples after a jump as on the way.
  [[nodiscard]] bool jumps_badly() const {
    const int type = info.format & SF_FORMAT_TYPEMASK;
    return type != SF_FORMAT_WAV && type != SF_FORMAT_WAVEX && type != SF_FORMAT_RF64 &&
           type != SF_FORMAT_AIFF && type != SF_FORMAT_FLAC;
  }

  // A channel as a whole, 16 bits a sample.
  std::vector<std::int16_t> unpacked(std::size_t channel) {
    constexpr std::int64_t at_once = 1 << 16;
    constexpr std::int64_t most = std::int64_t{1} << 31; // 4 GiB: 12 hours at 48 kHz
    if (info.frames > most)
      throw InputError({name}, fmt::format("{} samples that must be unpacked to be read",
                                           info.frames),
                       fmt::format("at most {}, or a WAV or FLAC, which are read in pieces", most));
    std::vector<std::int16_t> all;
    std::vector<float> some;
    while (static_cast<std::int64_t>(all.size()) < info.frames) {
      const auto first = static_cast<std::int64_t>(all.size());
      some.resize(static_cast<std::size_t>(std::min(at_once, info.frames - first)));
      read(channel, first, some);
      for (const float value : some)
        all.push_back(static_cast<std::int16_t>(std::lround(loudest * std::clamp(value, -1.0F, 1.0F))));
    }
    return all;
  }
  static constexpr float loudest = 32767.0F; // of 16 bits

  // Samples of one channel that lie in the recording.
  void read(std::size_t channel, sf_count_t first, std::span<float> to) {
    const bool placed = at == first || sf_seek(sound.get(), first, SEEK_SET) == first;
    const auto channels = static_cast<std::size_t>(info.channels);
    frames.resize(to.size() * channels);
    const auto wanted = static_cast<sf_count_t>(to.size());
    const sf_count_t got = placed ? sf_readf_float(sound.get(), frames.data(), wanted) : 0;
    if (got < wanted) // or a head that states more than there is
      throw InputError({name},
                       fmt::format("a recording that cannot be read on {:.4g} s from its beginning",
                                   static_cast<double>(first + got) / info.samplerate),
                       fmt::format("sound to its end, after {:.4g} s",
                                   static_cast<double>(info.frames) / info.samplerate));
    at = first + got;
    for (std::size_t i = 0; i < to.size(); ++i) {
      const float value = frames[i * channels + channel];
      to[i] = value > -1e6F && value < 1e6F ? value : 0.0F; // no sound is so loud, or no number
    }
  }
};

bool is_sound(std::string_view beginning) {
  const auto has = [&](std::size_t at, std::string_view word) {
    return beginning.substr(std::min(at, beginning.size())).starts_with(word);
  };
  return ((has(0, "RIFF") || has(0, "RF64")) && has(8, "WAVE")) || has(0, "fLaC") ||
         has(0, "OggS") || (has(0, "FORM") && has(8, "AIF"));
}

bool is_sound_on_disk(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return false;
  std::ifstream file(path, std::ios::binary);
  std::string beginning(12, '\0');
  file.read(beginning.data(), static_cast<std::streamsize>(beginning.size()));
  return is_sound(beginning.substr(0, static_cast<std::size_t>(file.gcount())));
}

Recording::Recording(std::unique_ptr<File> file) : file_(std::move(file)) {}
Recording::Recording(Recording&&) noexcept = default;
Recording& Recording::operator=(Recording&&) noexcept = default;
Recording::~Recording() = default;

Recording Recording::on_disk(const std::string& path) {
  auto file = std::make_unique<File>();
  file->name = path;
  note_input(path);
  file->sound.reset(sf_open(path.c_str(), SFM_READ, &file->info));
  file->check();
  return Recording(std::move(file));
}

Recording Recording::in_memory(std::string_view bytes, const std::string& name) {
  auto file = std::make_unique<File>();
  file->name = name;
  file->bytes.all = bytes;
  SF_VIRTUAL_IO access{length_of, seek_in, read_from, write_nothing, place_in};
  file->sound.reset(sf_open_virtual(&access, SFM_READ, &file->info, &file->bytes));
  file->check();
  return Recording(std::move(file));
}

double Recording::rate_hz() const { return file_->info.samplerate; }
std::int64_t Recording::count() const { return file_->info.frames; }
std::size_t Recording::channels() const { return static_cast<std::size_t>(file_->info.channels); }

SoundSamples Recording::channel(std::size_t number) {
  if (file_->jumps_badly()) {
    SoundSamples samples{rate_hz(), count(), nullptr};
    samples.read = [all = std::make_shared<const std::vector<std::int16_t>>(
                        file_->unpacked(number - 1))](std::int64_t first, std::span<float> to) {
      for (std::size_t i = 0; i < to.size(); ++i) {
        const std::int64_t at = first + static_cast<std::int64_t>(i);
        const bool inside = at >= 0 && at < static_cast<std::int64_t>(all->size());
        to[i] = inside ? static_cast<float>((*all)[static_cast<std::size_t>(at)]) / File::loudest
                       : 0.0F;
      }
    };
    return samples;
  }
  SoundSamples samples{rate_hz(), count(), nullptr};
  samples.read = [file = file_.get(), number](std::int64_t first, std::span<float> to) {
    const auto size = static_cast<std::int64_t>(to.size());
    const std::int64_t from = std::clamp<std::int64_t>(-first, 0, size);
    const std::int64_t end = std::clamp<std::int64_t>(file->info.frames - first, from, size);
    std::fill(to.begin(), to.end(), 0.0F);
    if (from < end)
      file->read(number - 1, first + from,
                 to.subspan(static_cast<std::size_t>(from), static_cast<std::size_t>(end - from)));
  };
  return samples;
}

} // namespace goingrate
