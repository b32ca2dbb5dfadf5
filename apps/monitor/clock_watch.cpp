#include "clock_watch.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace goingrate::apps {

namespace {

constexpr std::size_t most_breaks = 500; // that are remembered in memory
constexpr std::size_t tail_beats = 200;  // that tell how the count goes on

constexpr std::size_t learnt_days = 14; // that alarms are learnt from again after a start

constexpr double sync_every_s = 1.0; // so that every line is safe within two

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

ClockWatch::ClockWatch(WatchOptions options)
    : options_(std::move(options)), archive_(options_.folder), index_(options_.folder),
      unread_(options_.folder), places_(archive_, options_.place), numbers_(options_.log),
      alarms_(options_.patience_s), diary_(archive_, index_) {
  log_.source = options_.folder;
  if (options_.log.nominal_period_s > 0.0) log_.nominal_period_s = options_.log.nominal_period_s;
  restore();
}

// Days of the index but the last fourteen are taken from it; those are read again with the ones
// that the index does not have: for the minutes, to count on, and for alarms to learn the clock.
void ClockWatch::restore() {
  const auto days = archive_.days(), indexed = index_.days();
  const bool agrees = std::includes(days.begin(), days.end(), indexed.begin(), indexed.end());
  if (!agrees) index_.clear();
  const std::size_t known = agrees ? indexed.size() - std::min(indexed.size(), learnt_days) : 0;
  const std::string first = known > 0 ? indexed[known] : std::string();
  const auto taken =
      static_cast<std::size_t>(std::lower_bound(days.begin(), days.end(), first) - days.begin());
  if (!agrees || indexed.empty()) diary_.rebuild_index(days);
  if (taken > 0) {
    std::vector<GoingBlock> hours = index_.hours();
    std::erase_if(hours, [&](const GoingBlock& hour) {
      return day_of({hour.start_s, 0.0}) >= days[taken];
    });
    going_.restore(hours);
    if (!hours.empty())
      numbers_.go_on_from(numbered_tail(archive_.events_of(days[taken - 1]),
                                        hours.back().last_cycle, options_.log));
  }
  const auto breaks = index_.breaks();
  breaks_.assign(breaks.rbegin(), breaks.rend());
  diary_.restore();
  alarms_.restore({diary_.records().begin(), diary_.records().end()});
  replay({days.begin() + static_cast<std::ptrdiff_t>(taken), days.end()});
}

void ClockWatch::replay(const std::vector<std::string>& days) {
  Arrivals replayed;
  for (const std::string& day : days) {
    for (const Beat& event : archive_.events_of(day))
      for (const Arrivals::Arrival& arrival : replayed.add(event))
        take(arrival, true);
    number(numbers_.numbered(log_), true);
  }
  for (const Arrivals::Arrival& arrival : replayed.rest())
    take(arrival, true);
}

void ClockWatch::hold(std::string_view text, const Instant& now) {
  is_holding_ = true;
  try {
    if (options_.place.source_is_live) unread_.hold(text);
  } catch (const OutputError& error) {
    alarms_.archive_fails(now, error.what());
  }
}

void ClockWatch::add(const Beat& event, const ClockLog& log, const Instant& now) {
  has_edges_ = has_edges_ || event.edge == Edge::down;
  if (!log_.nominal_period_s) log_.nominal_period_s = log.nominal_period_s;
  archive_.describe(has_edges_ || !log.directions_are_open, log_.nominal_period_s);
  last_heard_at_ = now;
  is_holding_ = false;
  if (std::exchange(is_first_, false)) {
    const bool may_be_read_again = !options_.place.source_is_live || !unread_.text().empty();
    if (const auto last = places_.meet(event, log, may_be_read_again)) arrivals_.go_on_from(*last);
  }
  if (places_.is_stored(event, log)) return;
  ++heard_;
  for (const Arrivals::Arrival& arrival : arrivals_.add(event))
    places_.add(arrival, log, now);
  note_left_out(arrivals_.take_left_out(), now);
  if (!places_.is_in_burst(log, now)) place(log, now);
  if (numbers_.is_full()) number(numbers_.numbered(log_), false);
  sync(now);
}

void ClockWatch::note_left_out(const std::vector<Beat>& events, const Instant& now) {
  for (const Beat& event : events)
    try {
      archive_.note("left out, its time fits nothing: " + format_instant(event.time, 9), now);
    } catch (const OutputError&) { // it is no event
    }
}

// What was heard gets its place in time and waits to be stored.
void ClockWatch::place(const ClockLog& log, const Instant& now) {
  if (places_.is_empty()) return;
  const auto placed = places_.take(log, *last_heard_at_, numbers_.period_s());
  note_left_out(placed.left_out, now);
  pending_.insert(pending_.end(), placed.events.begin(), placed.events.end());
  store_pending(now);
}

// Stored first, used then. What cannot be stored waits.
void ClockWatch::store_pending(const Instant& now) {
  try {
    while (!pending_.empty()) {
      archive_.append(pending_.front().event);
      ++stored_;
      take(pending_.front(), false);
      pending_.pop_front();
      alarms_.archive_works(now);
    }
  } catch (const OutputError& error) {
    alarms_.archive_fails(now, error.what());
    constexpr std::size_t most_pending = 1'000'000; // of 40 bytes
    if (pending_.size() > most_pending) pending_.pop_front();
  }
}

void ClockWatch::sync(const Instant& now) {
  // The computer's clock may be set back.
  if (archive_.is_synced() || (last_sync_ && std::abs(now - *last_sync_) < sync_every_s)) return;
  last_sync_ = now;
  try {
    archive_.sync();
    acknowledged_ = stored_;
  } catch (const OutputError& error) {
    alarms_.archive_fails(now, error.what());
  }
}

void ClockWatch::take(const Arrivals::Arrival& arrived, bool is_replay) {
  if (arrived.begins_anew) {
    number(numbers_.rest(log_), is_replay);
    numbers_.begin_anew();
    going_.break_count();
  }
  numbers_.add(arrived.event);
  if (is_replay && numbers_.is_full()) number(numbers_.numbered(log_), true);
}

void ClockWatch::number(std::vector<Beat> beats, bool is_replay) {
  gaps_ = numbers_.take_gaps();
  for (const Beat& beat : beats)
    take_beat(beat, is_replay);
  diary_.add(alarms_.take_changes());
}

void ClockWatch::take_beat(const Beat& beat, bool is_replay) {
  std::int64_t missed = 0;
  if (beat.flag == BeatFlag::good && going_.last()) {
    missed = std::max<std::int64_t>(0, beat.cycle - going_.last()->cycle - 1);
    constexpr std::int64_t told_gap = 20; // cycles; shorter ones are missed beats
    const auto gap = std::find_if(gaps_.begin(), gaps_.end(), [&](const Gap& g) {
      return g.after_cycle == going_.last()->cycle && (g.length > told_gap || !g.bridged);
    });
    if (gap != gaps_.end()) {
      const CountBreak found{beat.time, gap->after_cycle, gap->length, gap->probability};
      if (breaks_.empty() || breaks_.back().after_cycle < found.after_cycle) {
        breaks_.push_back(found);
        if (breaks_.size() > most_breaks) breaks_.pop_front();
        index_.put_break(found);
      }
      if (!gap->bridged) going_.break_count();
      missed = 0; // nothing was heard, so no beat was missed by a sensor that listens
    }
    complete_day(beat);
  }
  going_.add(beat, missed);
  if (beat.flag == BeatFlag::good) alarms_.heard(going_, nominal_period_s(), is_replay);
}

// The first beat of a new day completes the one before.
void ClockWatch::complete_day(const Beat& beat) {
  const std::string day = day_of(going_.last()->time);
  if (day == day_of(beat.time)) return;
  std::vector<GoingBlock> hours;
  for (const GoingBlock& hour : going_.hours().all())
    if (day_of({hour.start_s, 0.0}) == day) hours.push_back(hour);
  try {
    index_.put_day(day, hours);
  } catch (const OutputError&) { // it is made again from the files
  }
}

void ClockWatch::idle(const ClockLog& log, const Instant& now) {
  if (!log_.nominal_period_s) log_.nominal_period_s = log.nominal_period_s;
  place(log, now);
  store_pending(now);
  number(numbers_.numbered(log_), false);
  sync(now);
  if (!is_holding_ && places_.is_empty() && pending_.empty() && archive_.is_synced())
    unread_.clear();
  if (!last_heard_at_) last_heard_at_ = now; // a clock that stopped before this began
  alarms_.silent(now - *last_heard_at_, period_s(), now);
  diary_.add(alarms_.take_changes());
}

void ClockWatch::end(const ClockLog& log, const Instant& now) {
  for (const Arrivals::Arrival& arrival : arrivals_.rest())
    places_.add(arrival, log, now);
  place(log, now);
  number(numbers_.rest(log_), false);
  last_sync_.reset();
  idle(log, now);
}

} // namespace goingrate::apps
