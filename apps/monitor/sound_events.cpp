#include "sound_events.hpp"

#include "goingrate/sound/ticks.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <fmt/format.h>
#include <unistd.h>
#include <vector>

namespace goingrate::apps {

namespace {

constexpr double rate_hz = 48000.0;
constexpr std::int64_t window_samples = 60 * 48000, step_samples = window_samples / 2;

bool write_all(int to, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const auto count = ::write(to, text.data() + done, text.size() - done);
    if (count <= 0) return false;
    done += static_cast<std::size_t>(count);
  }
  return true;
}

// A device's name as one word of the shell.
std::string quoted(const std::string& word) {
  std::string text = "'";
  for (const char c : word)
    text += c == '\'' ? "'\\''" : std::string(1, c);
  return text + "'";
}

std::string lines_of(const std::vector<float>& window, std::int64_t first, bool is_first,
                     std::optional<double>& period_s) {
  const SoundSamples samples{rate_hz, static_cast<std::int64_t>(window.size()),
                             [&](std::int64_t from, std::span<float> to) {
                               for (std::size_t i = 0; i < to.size(); ++i) {
                                 const auto at = from + static_cast<std::int64_t>(i);
                                 const bool inside =
                                     at >= 0 && at < static_cast<std::int64_t>(window.size());
                                 to[i] = inside ? window[static_cast<std::size_t>(at)] : 0.0F;
                               }
                             }};
  const TickTrain train = find_ticks(samples, period_s);
  if (train.ticks.empty()) return {};
  period_s = train.period / rate_hz;
  // The middle half of the window is told, of the first one its beginning too.
  const double from = is_first ? 0.0 : 0.25 * static_cast<double>(window.size());
  const double to = 0.75 * static_cast<double>(window.size());
  std::string text;
  for (const Tick& tick : train.ticks)
    if (tick.at >= from && tick.at < to)
      text += fmt::format("{:.9f},{}\n", (static_cast<double>(first) + tick.at) / rate_hz,
                          tick.is_tock ? "down" : "up");
  return text;
}

} // namespace

int write_sound_events(const std::string& device, int to) {
  const std::string command =
      fmt::format("exec arecord -q -t raw -f S16_LE -c 1 -r 48000 -D {}", quoted(device));
  std::FILE* sound = ::popen(command.c_str(), "r");
  if (sound == nullptr || !write_all(to, "# goingrate log: 1\ntime_s,edge\n")) return 1;
  std::vector<float> window;
  std::vector<std::int16_t> piece(4800);
  std::optional<double> period_s;
  std::int64_t first = 0;
  bool is_first = true;
  for (std::size_t count; (count = std::fread(piece.data(), 2, piece.size(), sound)) > 0;) {
    for (std::size_t i = 0; i < count; ++i)
      window.push_back(static_cast<float>(piece[i]) / 32768.0F);
    if (static_cast<std::int64_t>(window.size()) < window_samples) continue;
    if (!write_all(to, lines_of(window, first, is_first, period_s))) break;
    is_first = false;
    window.erase(window.begin(), window.begin() + step_samples);
    first += step_samples;
  }
  return ::pclose(sound) == 0 ? 0 : 1;
}

} // namespace goingrate::apps
