// Continues a watch where an earlier one stopped.
#include "clock_watch.hpp"
#include "held_notes.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>

namespace goingrate::apps {

namespace {

constexpr std::size_t tail_beats = 200; // from which the count goes on
constexpr std::size_t reread_days = 3;  // for the minutes of two days, after a start

// The last beats of a day, numbered so that the last good one has a cycle that is known.
std::vector<Beat> numbered_tail(std::vector<Beat> events, std::int64_t last_cycle,
                                const LogOptions& options) {
  if (events.size() > tail_beats)
    events.erase(events.begin(), events.end() - static_cast<std::ptrdiff_t>(tail_beats));
  NumberingOptions numbering;
  numbering.least_probability = options.gap_probability;
  if (options.nominal_period_s > 0.0) numbering.nominal_period_s = options.nominal_period_s;
  std::vector<Beat> beats;
  try {
    beats = number_beats(std::move(events), "archive", numbering).beats;
  } catch (const InputError&) { // too few of them
    return {};
  }
  const auto last = std::find_if(beats.rbegin(), beats.rend(),
                                 [](const Beat& b) { return b.flag == BeatFlag::good; });
  if (last == beats.rend()) return {};
  const std::int64_t shift = last_cycle - last->cycle;
  for (Beat& beat : beats)
    beat.cycle += shift;
  return beats;
}

} // namespace

// Days of the index but the last three are taken from it, with what alarms had learnt by then;
// those three are read again, with the ones that the index does not have.
void ClockWatch::restore() {
  const auto days = archive_.days(), indexed = index_.days();
  const bool agrees = std::includes(days.begin(), days.end(), indexed.begin(), indexed.end()) &&
                      index_.is_of_the_files();
  if (!agrees) forget_index();
  // A day may be missing in the middle, because another program kept the index from being written.
  const auto unbroken =
      std::mismatch(indexed.begin(), indexed.end(), days.begin(), days.end()).first;
  const auto in_index = agrees ? static_cast<std::size_t>(unbroken - indexed.begin()) : 0;
  const std::size_t taken = in_index - std::min(in_index, reread_days);
  diary_.rebuild_index({days.begin() + static_cast<std::ptrdiff_t>(taken), days.end()});
  if (taken > 0) {
    std::vector<GoingBlock> hours = index_.hours();
    std::erase_if(hours, [&](const GoingBlock& hour) {
      return day_of({hour.start_s, 0.0}) >= days[taken];
    });
    going_.restore(hours, index_.first_of_run(days[taken - 1]));
    alarms_.take_learnt(index_.learnt(days[taken - 1]));
    if (!hours.empty())
      numbers_.go_on_from(numbered_tail(archive_.events_of(days[taken - 1]),
                                        hours.back().last_cycle, options_.log));
  }
  const auto breaks = index_.breaks();
  breaks_.assign(breaks.rbegin(), breaks.rend());
  diary_.restore();
  alarms_.restore({diary_.records().begin(), diary_.records().end()});
  replay({days.begin() + static_cast<std::ptrdiff_t>(taken), days.end()});
  if (options_.place.source_is_live) waited_ = still_waiting(archive_.last_notes());
}

void ClockWatch::forget_index() {
  try {
    index_.clear();
  } catch (const OutputError&) { // another program holds it: days are put again one by one
  }
}

void ClockWatch::replay(const std::vector<std::string>& days) {
  Arrivals replayed;
  for (const std::string& day : days) {
    for (const Beat& event : archive_.events_of(day))
      take(replayed.believe(event), true);
    number(numbers_.numbered(log_), true);
  }
}

} // namespace goingrate::apps
