#include "unwrapper.hpp"

#include <algorithm>
#include <cmath>

namespace goingrate {

namespace {

// Values at which counters and timers are known to wrap, in the unit of the column.
std::vector<double> wrap_candidates(const Layout& layout, TimeUnit unit) {
  const double unit_s = unit.seconds * std::pow(10.0, unit.power);
  std::vector<double> candidates{65536.0 * unit_s, 4294967296.0 * unit_s, 86400.0};
  if (layout.format == LogFormat::ticc) candidates.insert(candidates.end(), {10.0, 100.0, 1000.0});
  std::sort(candidates.begin(), candidates.end());
  return candidates;
}

} // namespace

Unwrapper::Settings unwrapping(const Layout& layout, std::optional<double> nominal_period_s) {
  const auto time = layout.find(ColumnRole::time);
  Unwrapper::Settings settings;
  settings.unit = time ? layout.columns[*time].unit : TimeUnit{};
  settings.wrap_s = layout.wrap_s;
  settings.candidates_s = wrap_candidates(layout, settings.unit);
  settings.step_s = layout.wrap_s ? nominal_period_s : std::nullopt;
  if (layout.newest_first) settings.wrap_s = 0.0; // once it is turned round
  return settings;
}

Instant Unwrapper::placed(const Instant& raw, double typical_step_s) {
  if (settings_.wrap_s == 0.0) return raw;
  if (last_raw_) {
    const double step = raw - *last_raw_;
    if (!settings_.wrap_s && step < 0.0)
      guess(last_raw_->to_double(), raw.to_double(), typical_step_s);
    if (settings_.wrap_s) count_wraps(step);
  }
  last_raw_ = raw;
  if (wraps_ == 0) return raw;
  const Instant sum = raw + offset_.fraction;
  return {sum.seconds + offset_.seconds, sum.fraction};
}

// A step back is a wrap if the next reading then follows as soon as the ones before did. Across
// midnight a gap of any length is accepted, unless the times began at zero and do so again: then
// the logger was restarted.
void Unwrapper::guess(double before_s, double after_s, double typical_step_s) {
  constexpr double patience = 20.0; // steps: a short gap may hide the wrap itself
  for (const double wrap : settings_.candidates_s) {
    if (before_s >= wrap || after_s < 0.0 || before_s - after_s < 0.5 * wrap) continue;
    const bool midnight = wrap == 86400.0;
    const double soon_s = patience * typical_step_s;
    const bool follows = after_s + wrap - before_s <= soon_s;
    const bool begins_again = first_s_ < soon_s && after_s < soon_s;
    if (!follows && (!midnight || begins_again)) continue;
    settings_.wrap_s = wrap;
    return;
  }
}

// How many wraps belong to a step if whole beats are expected: the number for the fewest beats that
// fit to 1/64 of the wrap, as a wrong number of beats does by chance in one case of 32.
std::int64_t Unwrapper::wraps_for_beats(double step_s) const {
  constexpr int most_beats = 8;
  const double wrap = *settings_.wrap_s, beat = *settings_.step_s;
  const auto wraps_of = [&](int beats) {
    return std::round(std::clamp((beats * beat - step_s) / wrap, 0.0, 1e18));
  };
  for (int beats = 1; beats <= most_beats; ++beats) {
    const double misfit = step_s + wraps_of(beats) * wrap - beats * beat;
    if (std::abs(misfit) < wrap / 64.0) return static_cast<std::int64_t>(wraps_of(beats));
  }
  return static_cast<std::int64_t>(wraps_of(1));
}

void Unwrapper::count_wraps(double step_s) {
  const double wrap = *settings_.wrap_s;
  std::int64_t more = 0;
  if (settings_.step_s)
    more = wraps_for_beats(step_s);
  else if (step_s < -0.5 * wrap)
    more = 1;
  // Beyond, a time and its offset would not fit together; no counter runs so long.
  constexpr double longest_s = 1e18;
  if (more == 0 || !((static_cast<double>(wraps_) + static_cast<double>(more)) * wrap <= longest_s))
    return;
  wraps_ += more;
  const double unit_s = settings_.unit.seconds * std::pow(10.0, settings_.unit.power);
  const double units = std::round(wrap / unit_s);
  const bool whole = std::abs(units * unit_s - wrap) < 1e-9 * wrap &&
                     units * static_cast<double>(wraps_) < 9e18; // what 64 bits hold
  const auto exact =
      whole ? whole_units(static_cast<std::int64_t>(units) * wraps_, settings_.unit) : std::nullopt;
  offset_ = exact ? *exact : Instant::from_seconds(static_cast<double>(wraps_) * wrap);
}

} // namespace goingrate
