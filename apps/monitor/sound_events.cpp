#include "sound_events.hpp"

#include "goingrate/sound/ticks.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fmt/format.h>
#include <optional>
#include <span>
#include <unistd.h>
#include <vector>

namespace goingrate::apps {

namespace {

constexpr double rate_hz = 48000.0;
constexpr std::int64_t window_samples = static_cast<std::int64_t>(sound_lateness_s * rate_hz),
                       step_samples = window_samples / 2;

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

SoundSamples samples_of(const std::vector<float>& window) {
  const auto size = static_cast<std::int64_t>(window.size());
  return {rate_hz, size, [&window, size](std::int64_t from, std::span<float> to) {
            for (std::size_t i = 0; i < to.size(); ++i) {
              const std::int64_t at = from + static_cast<std::int64_t>(i);
              to[i] = at >= 0 && at < size ? window[static_cast<std::size_t>(at)] : 0.0F;
            }
          }};
}

// Hears one window after the other as one clock.
class Listener {
public:
  // Lines of the beats in the first three quarters of a window that begins at sample `first`; the
  // later ones are heard again, with sound on both sides, in the next window.
  std::string lines_of(const std::vector<float>& window, std::int64_t first) {
    TickTrain train = find_ticks(samples_of(window), period_s_);
    if (train.ticks.empty()) return {};
    period_s_ = train.period / rate_hz;
    const auto begin = static_cast<double>(first);
    for (Tick& tick : train.ticks)
      tick.at += begin;
    if (is_swapped(train))
      for (Tick& tick : train.ticks)
        tick.is_tock = !tick.is_tock;
    const double end = begin + 0.75 * static_cast<double>(window.size());
    std::string text;
    for (const Tick& tick : train.ticks)
      if (tick.at < end && (!last_ || tick.at > last_->at + 0.1 * train.period)) {
        text += fmt::format("{:.9f},{}\n", tick.at / rate_hz, tick.is_tock ? "down" : "up");
        last_ = tick;
      }
    return text;
  }

private:
  // Which of two sounds is the tick is arbitrary, but must agree with the window before.
  [[nodiscard]] bool is_swapped(const TickTrain& train) const {
    if (!last_ || !train.has_tocks) return false;
    const auto nearest =
        std::min_element(train.ticks.begin(), train.ticks.end(), [&](const Tick& a, const Tick& b) {
          return std::abs(a.at - last_->at) < std::abs(b.at - last_->at);
        });
    const bool half_apart = std::lround(2.0 * (nearest->at - last_->at) / train.period) % 2 != 0;
    return (nearest->is_tock != last_->is_tock) != half_apart;
  }

  std::optional<double> period_s_;
  std::optional<Tick> last_; // passed on, in samples since the beginning
};

} // namespace

int write_sound_events(const std::string& device, int to) {
  const std::string command =
      fmt::format("exec arecord -q -t raw -f S16_LE -c 1 -r 48000 -D {}", quoted(device));
  std::FILE* sound = ::popen(command.c_str(), "r");
  if (sound == nullptr || !write_all(to, "# goingrate log: 1\ntime_s,edge\n")) return 1;
  std::vector<float> window;
  std::vector<std::int16_t> piece(4800);
  Listener listener;
  std::int64_t first = 0;
  for (std::size_t count; (count = std::fread(piece.data(), 2, piece.size(), sound)) > 0;) {
    for (std::size_t i = 0; i < count; ++i)
      window.push_back(static_cast<float>(piece[i]) / 32768.0F);
    if (static_cast<std::int64_t>(window.size()) < window_samples) continue;
    if (!write_all(to, listener.lines_of(window, first))) break;
    window.erase(window.begin(), window.begin() + step_samples);
    first += step_samples;
  }
  return ::pclose(sound) == 0 ? 0 : 1;
}

} // namespace goingrate::apps
