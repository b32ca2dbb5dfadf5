// libFuzzer target: any bytes as a file of sound, or as samples, in which beats are looked for.
#include "memory.hpp"

#include "log/sound_log.hpp"
#include "sound/pulses.hpp"

#include "goingrate/base/errors.hpp"

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

namespace {

using namespace goingrate;

void demand(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "violated: %s\n", what);
  std::abort();
}

void demand_finite(const TickTrain& train, std::int64_t count) {
  double before = -1e300;
  for (const Tick& tick : train.ticks) {
    demand(tick.at > before, "ticks in order");
    demand(tick.at > -1e5 && tick.at < static_cast<double>(count) + 1e5, "a tick in the recording");
    demand(tick.sigma > 0.0 && std::isfinite(tick.sigma), "a sigma");
    before = tick.at;
  }
  for (const MeanBeat* beat : {&train.tick, &train.tock})
    for (const double power : beat->power)
      demand(std::isfinite(power) && power > 0.0, "a power");
}

// The bytes over and over, each a sample, as loud as they get: three seconds of 4 kHz.
void listen_to_samples(const std::uint8_t* data, std::size_t size, bool nominal) {
  SoundSamples samples{4000.0, 12000, nullptr};
  samples.read = [=](std::int64_t first, std::span<float> to) {
    for (std::size_t i = 0; i < to.size(); ++i) {
      const std::int64_t at = first + static_cast<std::int64_t>(i);
      const bool inside = at >= 0 && at < 12000;
      to[i] =
          inside ? (static_cast<float>(data[static_cast<std::size_t>(at) % size]) - 128.0F) / 128.0F
                 : 0.0F;
    }
  };
  demand_finite(find_ticks(samples, nominal ? std::optional(0.5) : std::nullopt), samples.count);
  const SecondPulses seconds(samples);
  if (seconds.count() > 2) demand(std::isfinite(seconds.time_at(6000.0)), "a time");
}

void read_file(const std::uint8_t* data, std::size_t size, std::uint8_t choice) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  if (!is_sound(bytes)) return;
  ReadingOptions options;
  if ((choice & 2) != 0) options.nominal_period_s = 1.0;
  if ((choice & 4) != 0) options.pps_channel = 2;
  try {
    const ClockLog log = read_recording(Recording::in_memory(bytes, "fuzz"), "fuzz", options);
    demand(log.events.size() == log.columns.sigma_s.size(), "a sigma for every beat");
  } catch (const InputError&) {
  } catch (const ArgumentError&) {
  }
}

} // namespace

// What the codecs do not free of a damaged file is not ours to free.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libsndfile\nleak:libvorbis\nleak:libFLAC\nleak:libogg\nleak:libopus\n";
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  fuzz::reset_peak();
  if ((data[0] & 1) != 0)
    listen_to_samples(data + 1, size - 1, (data[0] & 2) != 0);
  else
    read_file(data + 1, size - 1, data[0]);
  // A lossless codec packs silence a thousand times; the loudness is a twelfth of the samples.
  constexpr std::size_t base = 64 << 20, factor = 20000;
  demand(fuzz::peak_bytes() <= base + factor * size, "memory in proportion");
  return 0;
}
