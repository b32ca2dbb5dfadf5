#include "fault_counts.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace goingrate {

namespace {

// The number of cycles, within segments of a log of both directions, whose downward passage is
// missing. If most are missing, the log has only one direction, and none is counted.
std::int64_t missed_downward(const Beats& numbered) {
  std::int64_t missing = 0, seen = 0, all = 0; // downward passages
  const Beat* last = nullptr;
  for (const Beat& beat : numbered.beats) {
    seen += beat.flag == BeatFlag::down ? 1 : 0;
    if (beat.flag != BeatFlag::good) continue;
    if (last != nullptr && last->segment == beat.segment)
      missing += std::max<std::int64_t>(0, beat.cycle - last->cycle - seen);
    all += seen;
    seen = 0;
    last = &beat;
  }
  return missing < all ? missing : 0;
}

} // namespace

std::string fault_counts(const Beats& beats) {
  std::string text = fmt::format("{} missed", beats.missed);
  if (const std::int64_t other = missed_downward(beats); other > 0)
    text += fmt::format(" (and {} of the other direction)", other);
  text += fmt::format(", {} spurious", beats.spurious);
  if (beats.bounces > 0)
    text += fmt::format(", {} bounce{}", beats.bounces, beats.bounces == 1 ? "" : "s");
  return text;
}

} // namespace goingrate
