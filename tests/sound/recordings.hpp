// Made-up recordings of clocks whose beats are known.
#pragma once

#include "goingrate/sound/ticks.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace goingrate::test {

enum class Noise { white, hum, speech, music, wind };

struct ClockSound {
  double rate_hz = 48000.0;
  double period_s = 1.0;
  double tick_minus_tock_s = 0.0; ///< what the half period after a tick is longer than the other
  double seconds = 60.0;
  double loudness_db = 20.0; ///< power at the peak of the loudest click over that of the noise
  Noise noise = Noise::white;
  bool triple = false; ///< three clicks, of which the first is the weakest; else one
  double jitter_s = 0.0;
  double clip_at = 0.0;    ///< in units of the loudest click; 0: nowhere
  double gap_s = 0.0;      ///< in the middle, of digital silence
  double stops_at_s = 1e9; ///< nothing but noise from then on
  bool tocks_are_ticks = false;
  bool silent_tocks = false;
  bool is_silent = false; ///< the clock stands still
  std::uint64_t seed = 1;
};

struct Recorded {
  std::vector<float> samples;
  std::vector<Tick> truth; ///< where the first click of each beat begins, in samples
  [[nodiscard]] SoundSamples sound(double rate_hz) const;
};

Recorded record(const ClockSound& clock);

/// What a reference sends into a recorder that is fast by `fast`: a square pulse of 0.1 s each
/// second but those that are missing, through the capacitor of a sound card. The first is at 0.4 s.
std::vector<float> pulses(double rate_hz, double fast, double seconds,
                          const std::vector<int>& missing = {});

/// Writes channels of one length as WAV or FLAC of 16 bits, or as OGG; by the name's extension.
void write_sound(const std::string& path, const std::vector<std::vector<float>>& channels,
                 double rate_hz);

} // namespace goingrate::test
