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

constexpr std::size_t head_size = 12; // bytes that tell the kind and the length

// Bytes that a WAV or AIFF states; 0 if it states none: in a stream the field is all ones or zero.
std::uint64_t stated_size(std::string_view head) {
  if (head.size() < head_size) return 0;
  const bool little = head.starts_with("RIFF"), big = head.starts_with("FORM");
  if (!little && !big) return 0;
  std::uint64_t size = 0;
  for (std::size_t i = 0; i < 4; ++i)
    size = size << 8U | static_cast<unsigned char>(head[little ? 7 - i : 4 + i]);
  constexpr std::uint64_t bytes_before = 8, stream_length = 0xFFFFFF00;
  return size == 0 || size >= stream_length ? 0 : size + bytes_before;
}

std::string head_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string head(head_size, '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  return head;
}

struct Close {
  void operator()(SNDFILE* file) const { sf_close(file); }
};

} // namespace

struct Recording::File {
  std::string name;
  Bytes bytes;
  std::uint64_t stated = 0, size = 0; // bytes, by its head and in truth
  SF_INFO info{};
  std::unique_ptr<SNDFILE, Close> sound;
  sf_count_t at = 0;           // frame that is read next
  std::vector<float> frames{}; // of all channels

  void check() const {
    if (!sound)
      throw InputError({name},
                       fmt::format("a recording that cannot be read: {}", sf_strerror(nullptr)),
                       "sound as WAV, FLAC or OGG");
    if (info.frames < 1)
      throw InputError({name}, "a recording without a sample",
                       "sound: where a recorder broke off, its program may mend the file");
    if (info.channels > most_channels)
      throw InputError({name}, fmt::format("{} channels", info.channels),
                       fmt::format("1 to {}", most_channels));
  }

  // After a jump, lossy codecs do not give the same samples as in reading on, and a stream does not
  // know its length.
  [[nodiscard]] bool is_read_as_a_whole() const {
    const int type = info.format & SF_FORMAT_TYPEMASK, packing = info.format & SF_FORMAT_SUBMASK;
    const bool plain = packing <= SF_FORMAT_PCM_32 || packing == SF_FORMAT_PCM_U8 ||
                       packing == SF_FORMAT_FLOAT || packing == SF_FORMAT_DOUBLE ||
                       packing == SF_FORMAT_ULAW || packing == SF_FORMAT_ALAW;
    constexpr sf_count_t longest = sf_count_t{1} << 40; // 200 days at 48 kHz
    return type == SF_FORMAT_OGG || !plain || info.seekable == 0 || info.frames > longest;
  }

  // A channel as a whole, 16 bits per sample.
  std::vector<std::int16_t> unpacked(std::size_t channel, std::uint64_t limit) {
    constexpr std::size_t block_bytes = 1 << 16;
    std::vector<std::int16_t> all;
    std::vector<float> some(block_bytes);
    while (const sf_count_t got = next(channel, some)) {
      for (const float value : std::span(some).first(static_cast<std::size_t>(got)))
        all.push_back(static_cast<std::int16_t>(
            std::lround(largest_sample * std::clamp(value, -1.0F, 1.0F))));
      if (sizeof(std::int16_t) * all.size() > limit)
        throw InputError(
            {name}, fmt::format("a channel of sound that unpacks to more than {} bytes", limit),
            "no more, or a higher limit for what may be unpacked");
    }
    at = 0;
    if (sf_seek(sound.get(), 0, SEEK_SET) != 0 && info.channels > 1) // for another of them
      throw InputError({name}, "a recording of several channels that cannot be read twice",
                       "a WAV or FLAC that states its length");
    return all;
  }
  static constexpr float largest_sample = 32767.0F; // of 16 bits

  // Reads the next samples of one channel; returns how many there were.
  sf_count_t next(std::size_t channel, std::span<float> to) {
    const auto channels = static_cast<std::size_t>(info.channels);
    frames.resize(to.size() * channels);
    const sf_count_t got =
        sf_readf_float(sound.get(), frames.data(), static_cast<sf_count_t>(to.size()));
    for (std::size_t i = 0; i < static_cast<std::size_t>(got); ++i) {
      to[i] = frames[i * channels + channel];
      constexpr float largest_squarable = 1e15F; // of which the square is a float
      if (!(std::abs(to[i]) < largest_squarable))
        throw InputError(
            {name},
            fmt::format("what is no number {:.6g} s from the beginning",
                        static_cast<double>(at + static_cast<sf_count_t>(i)) / info.samplerate),
            "a recording of finite samples");
    }
    at += got;
    return got;
  }

  // Samples of one channel that lie in the recording.
  void read(std::size_t channel, sf_count_t first, std::span<float> to) {
    const bool placed = at == first || sf_seek(sound.get(), first, SEEK_SET) == first;
    at = first;
    const sf_count_t got = placed ? next(channel, to) : 0;
    if (got < static_cast<sf_count_t>(to.size())) // or a head that states more than there is
      throw InputError({name},
                       fmt::format("a recording that cannot be read on {:.4g} s from its beginning",
                                   static_cast<double>(first + got) / info.samplerate),
                       fmt::format("sound to its end, after {:.4g} s",
                                   static_cast<double>(info.frames) / info.samplerate));
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
  return is_sound(head_of(path));
}

Recording::Recording(std::unique_ptr<File> file) : file_(std::move(file)) {}
Recording::Recording(Recording&&) noexcept = default;
Recording& Recording::operator=(Recording&&) noexcept = default;
Recording::~Recording() = default;

Recording Recording::on_disk(const std::string& path) {
  auto file = std::make_unique<File>();
  file->name = path;
  note_input(path);
  std::error_code ignored;
  file->stated = stated_size(head_of(path));
  file->size = std::filesystem::file_size(path, ignored);
  file->sound.reset(sf_open(path.c_str(), SFM_READ, &file->info));
  file->check();
  return Recording(std::move(file));
}

Recording Recording::in_memory(std::string_view bytes, const std::string& name) {
  auto file = std::make_unique<File>();
  file->name = name;
  file->bytes.all = bytes;
  file->stated = stated_size(bytes);
  file->size = bytes.size();
  SF_VIRTUAL_IO access{length_of, seek_in, read_from, write_nothing, place_in};
  file->sound.reset(sf_open_virtual(&access, SFM_READ, &file->info, &file->bytes));
  file->check();
  return Recording(std::move(file));
}

double Recording::rate_hz() const { return file_->info.samplerate; }
std::size_t Recording::channels() const { return static_cast<std::size_t>(file_->info.channels); }

std::uint64_t Recording::missing_bytes() const {
  constexpr std::uint64_t slack = 8; // some programs count the beginning of the head as well
  return file_->stated > file_->size + slack ? file_->stated - file_->size : 0;
}

SoundSamples Recording::channel(std::size_t number, std::uint64_t unpacked_limit) {
  SoundSamples samples{rate_hz(), file_->info.frames, nullptr};
  if (file_->is_read_as_a_whole()) {
    const auto all = std::make_shared<const std::vector<std::int16_t>>(
        file_->unpacked(number - 1, unpacked_limit));
    samples.count = static_cast<std::int64_t>(all->size());
    samples.read = [all](std::int64_t first, std::span<float> to) {
      for (std::size_t i = 0; i < to.size(); ++i) {
        const std::int64_t at = first + static_cast<std::int64_t>(i);
        const bool inside = at >= 0 && at < static_cast<std::int64_t>(all->size());
        to[i] =
            inside ? static_cast<float>((*all)[static_cast<std::size_t>(at)]) / File::largest_sample
                   : 0.0F;
      }
    };
    return samples;
  }
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
