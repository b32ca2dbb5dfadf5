#include "fault_counts.hpp"

#include "goingrate/fit/timing_data.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <optional>
#include <vector>

namespace goingrate {

namespace {

struct Counts {
  std::int64_t missed = 0, missed_downward = 0, spurious = 0, bounces = 0, displaced = 0;
};

// Whether the stray event between two beats is the one beat that is missing there, too early or too
// late by less than a quarter of a period.
bool is_displaced(const Beat& before, const Beat& stray, const Beat& after) {
  constexpr double largest_displacement = 0.25; // of the period
  if (after.cycle - before.cycle != 2) return false;
  const double period_s = 0.5 * (after.time - before.time);
  return std::abs((stray.time - before.time) - period_s) < largest_displacement * period_s;
}

// Of a log that is split, the part that is analysed; nothing of one that is whole.
std::optional<std::uint16_t> analysed_part(const Beats& numbered) {
  if (numbered.segments < 2) return {};
  const std::vector<Beat> longest = numbered.longest_segment();
  return longest.empty() ? std::nullopt : std::optional(longest.front().segment);
}

// For a log of both directions, `missed_downward`: the cycles within a segment whose downward
// passage is missing. If most are missing, the log has one direction only, and none is counted.
Counts counts_of(const Beats& numbered) {
  const auto part = analysed_part(numbered);
  Counts counts;
  if (!part) counts = {numbered.missed, 0, numbered.spurious, numbered.bounces};
  if (!part && numbered.spurious == 0 && !numbered.has_downward) return counts;
  std::int64_t seen = 0, all = 0; // downward passages
  const Beat* last = nullptr;
  const Beat* stray = nullptr; // since the last good beat, if there is one only
  int strays = 0;
  for (const Beat& beat : numbered.beats) {
    if (part && beat.segment != *part) continue;
    if (beat.flag == BeatFlag::spurious) stray = &beat, ++strays;
    seen += beat.flag == BeatFlag::down ? 1 : 0;
    counts.spurious += part && beat.flag == BeatFlag::spurious ? 1 : 0;
    counts.bounces += part && beat.flag == BeatFlag::bounce ? 1 : 0;
    if (beat.flag != BeatFlag::good) continue;
    if (last != nullptr && last->segment == beat.segment) {
      counts.missed += part ? (beat.cycle - last->cycle) / numbered.step - 1 : 0;
      counts.missed_downward += std::max<std::int64_t>(0, beat.cycle - last->cycle - seen);
      counts.displaced += strays == 1 && is_displaced(*last, *stray, beat) ? 1 : 0;
    }
    all += seen;
    seen = 0;
    strays = 0;
    last = &beat;
  }
  if (counts.missed_downward >= all) counts.missed_downward = 0;
  return counts;
}

} // namespace

bool has_no_period(const ClockLog& log) { return log.grid && !log.nominal_period_s; }

std::string event_word(bool no_period, double nominal_period_s) {
  if (no_period) return "values";
  return nominal_period_s > longest_swing_s ? "readings" : "beats";
}

std::string fault_counts(const Beats& beats) {
  const Counts counts = counts_of(beats);
  std::string text = fmt::format("{} missed", counts.missed - counts.displaced);
  if (counts.missed_downward > 0)
    text += fmt::format(" (and {} of the other direction)", counts.missed_downward);
  text += fmt::format(", {} spurious", counts.spurious - counts.displaced);
  if (counts.displaced > 0) text += fmt::format(", {} displaced", counts.displaced);
  if (counts.bounces > 0)
    text += fmt::format(", {} bounce{}", counts.bounces, counts.bounces == 1 ? "" : "s");
  return text;
}

} // namespace goingrate
