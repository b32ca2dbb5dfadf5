#include "goingrate/sound/ticks.hpp"

#include "loudness.hpp"
#include "tick_band.hpp"
#include "tick_period.hpp"
#include "tick_times.hpp"
#include "tick_track.hpp"
#include "whitening.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>

namespace goingrate {

namespace {

/// Listens to a recording, first to all of it and then in the band of the beats.
class Listening {
public:
  using Part = std::function<void(double)>;

  Listening(const SoundSamples& samples, std::optional<double> nominal_period_s,
            std::function<Part(double, double)> tell)
      : samples_(samples), nominal_s_(nominal_period_s), tell_(std::move(tell)), sound_(samples) {}

  TickTrain run() {
    if (!hears_a_clock()) return {};
    sound_.follow_by(band_of_ticks(sound_, loudness_, track_ticks(loudness_, pattern_)));
    (void)hears(tell_(listened_share, share_again)); // else the period is that heard before
    return time_ticks(sound_, loudness_, track_ticks(loudness_, pattern_), samples_.rate_hz,
                      tell_(share_again, 1.0));
  }

private:
  static constexpr double listened_share = 0.3, share_again = 0.8; // shares of the time

  // Listens to the whole sound, or to one of the bands in which clocks are heard.
  bool hears_a_clock() {
    if (hears(tell_(0.0, listened_share))) return true;
    for (const double frequency_hz : {3000.0, 1500.0, 6000.0}) {
      if (2.0 * frequency_hz > 0.5 * samples_.rate_hz) continue;
      sound_.follow_by(band_around(frequency_hz, samples_.rate_hz));
      if (hears(tell_(listened_share, listened_share))) return true;
    }
    return false;
  }

  bool hears(const Part& progress) {
    constexpr std::size_t fewest_bins = 256; // a quarter of a second
    loudness_ = measure_loudness(sound_, samples_.count, samples_.rate_hz, progress);
    if (loudness_.above.size() < fewest_bins) return false;
    const double bins_a_second = samples_.rate_hz / static_cast<double>(loudness_.hop);
    const auto nominal = nominal_s_ ? std::optional(*nominal_s_ * bins_a_second) : std::nullopt;
    const auto pattern = find_pattern(loudness_, bins_a_second, nominal);
    if (pattern) pattern_ = *pattern;
    return pattern.has_value();
  }

  const SoundSamples& samples_;
  std::optional<double> nominal_s_;
  std::function<Part(double, double)> tell_;
  Whitening sound_;
  Loudness loudness_;
  TickPattern pattern_;
};

} // namespace

TickTrain find_ticks(const SoundSamples& samples, std::optional<double> nominal_period_s,
                     const std::function<void(double)>& progress) {
  if (!(samples.rate_hz >= 4e3 && samples.rate_hz <= 4e5))
    throw ArgumentError("sampling rate", samples.rate_hz, "between 4 kHz and 400 kHz");
  if (nominal_period_s && !(*nominal_period_s >= 0.15 && *nominal_period_s <= 3.6))
    throw ArgumentError("nominal-period", *nominal_period_s,
                        "between 0.15 and 3.6 s, of what is heard");
  const auto tell = [&](double from, double to) -> std::function<void(double)> {
    if (!progress) return nullptr;
    return [&progress, from, to](double part) { progress(from + (to - from) * part); };
  };
  return Listening(samples, nominal_period_s, tell).run();
}

} // namespace goingrate
