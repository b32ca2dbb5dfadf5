// Beats found in made-up recordings. Prints a table; arguments: recordings per scene, first seed.
#include "sound/tick_score.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

namespace {

using namespace goingrate::test;

struct Scene {
  const char* name;
  ClockSound clock;
};

std::vector<Scene> scenes() {
  const ClockSound plain{.triple = true};
  const auto with = [&](auto change) {
    ClockSound clock = plain;
    change(clock);
    return clock;
  };
  return {
      {"seconds pendulum, 48 kHz", with([](ClockSound& c) { c.period_s = 2.0; })},
      {"one click, 44.1 kHz", with([](ClockSound& c) { c.triple = false, c.rate_hz = 44100.0; })},
      {"0.3 s, 22 kHz", with([](ClockSound& c) { c.period_s = 0.3, c.rate_hz = 22050.0; })},
      {"3 s, out of beat, 96 kHz", with([](ClockSound& c) {
         c.period_s = 3.0, c.rate_hz = 96000.0, c.tick_minus_tock_s = 0.1, c.seconds = 120.0;
       })},
      {"1 s, 8 kHz", with([](ClockSound& c) { c.rate_hz = 8000.0; })},
      {"watch, 18,000 an hour", with([](ClockSound& c) { c.period_s = 0.4; })},
      {"watch, 36,000 an hour", with([](ClockSound& c) { c.period_s = 0.2; })},
      {"mains hum", with([](ClockSound& c) { c.noise = Noise::hum; })},
      {"speech", with([](ClockSound& c) { c.noise = Noise::speech; })},
      {"music", with([](ClockSound& c) { c.noise = Noise::music; })},
      {"wind", with([](ClockSound& c) { c.noise = Noise::wind; })},
      {"clipped", with([](ClockSound& c) { c.clip_at = 0.3; })},
      {"gap of 5 s", with([](ClockSound& c) { c.gap_s = 5.0; })},
      {"jitter 0.2 ms", with([](ClockSound& c) { c.jitter_s = 2e-4; })},
  };
}

double middle(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void print_row(const Scene& scene, double loudness_db, std::uint64_t recordings,
               std::uint64_t first) {
  double beats = 0.0, found = 0.0, false_beats = 0.0, in68 = 0.0, in95 = 0.0, lost = 0.0;
  std::vector<double> scatter, bias, between;
  for (std::uint64_t seed = first; seed < first + recordings; ++seed) {
    ClockSound clock = scene.clock;
    clock.loudness_db = loudness_db;
    clock.seed = seed;
    const TickScore result = score(clock);
    beats += static_cast<double>(result.beats);
    found += static_cast<double>(result.found);
    false_beats += static_cast<double>(result.false_beats);
    in68 += static_cast<double>(result.within68);
    in95 += static_cast<double>(result.within95);
    lost += std::abs(result.period_s / clock.period_s - 1.0) > 1e-3 ? 1.0 : 0.0;
    scatter.push_back(1e6 * result.scatter_s);
    bias.push_back(1e6 * 0.5 * (result.bias_s[0] + result.bias_s[1]));
    between.push_back(1e6 * std::abs(result.bias_s[0] - result.bias_s[1]));
  }
  std::printf("%-26s %5.0f %7.2f%% %8.2f%% %7.1f%% %9.0f %9.0f %9.1f %6.1f%% %6.1f%%\n", scene.name,
              loudness_db, 100.0 * found / beats, 100.0 * false_beats / beats,
              100.0 * lost / static_cast<double>(recordings), middle(bias), middle(between),
              middle(scatter), 100.0 * in68 / std::max(1.0, found),
              100.0 * in95 / std::max(1.0, found));
  std::fflush(stdout);
}

} // namespace

int main(int count, char** words) {
  const std::uint64_t recordings = count > 1 ? std::strtoull(words[1], nullptr, 10) : 10;
  const std::uint64_t first = count > 2 ? std::strtoull(words[2], nullptr, 10) : 1;
  std::printf("%-26s %5s %8s %9s %8s %9s %9s %9s %7s %7s\n", "recording", "dB", "found", "false",
              "lost", "bias/us", "t-t/us", "rms/us", "in 68 %", "in 95 %");
  for (const Scene& scene : scenes())
    for (const double loudness_db : {40.0, 30.0, 20.0, 10.0, 5.0, 0.0})
      print_row(scene, loudness_db, recordings, first);
}
