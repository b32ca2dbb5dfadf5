#include "clock_watch.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace goingrate::apps {

namespace {

constexpr std::size_t most_records = 500; // alarms and breaks that are remembered in memory
constexpr std::size_t tail_beats = 200;   // that tell how the count goes on

constexpr std::size_t learnt_days = 14; // that alarms are learnt from again after a start

constexpr double sync_every_s = 1.0; // so that every line is safe within two

template <class T> void remember(std::deque<T>& records, const T& record) {
  records.push_back(record);
  if (records.size() > most_records) records.pop_front();
}

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
      numbers_(options_.log), alarms_(options_.patience_s) {
  log_.source = options_.folder;
  if (options_.log.nominal_period_s > 0.0) log_.nominal_period_s = options_.log.nominal_period_s;
  restore();
}

// Days of the index but the last fourteen are taken from it; those are read again with the ones
// that the index does not have: for the minutes, to count on, and for alarms to learn the clock.
void ClockWatch::restore() {
  const auto days = archive_.days(), indexed = index_.days();
  const bool agrees =
      indexed.size() <= days.size() && std::equal(indexed.begin(), indexed.end(), days.begin());
  if (!agrees) index_.clear();
  const std::size_t taken = agrees ? indexed.size() - std::min(indexed.size(), learnt_days) : 0;
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
  const auto alarms = index_.alarms();
  alarm_records_.assign(alarms.rbegin(), alarms.rend());
  replay({days.begin() + static_cast<std::ptrdiff_t>(taken), days.end()});
}

void ClockWatch::replay(const std::vector<std::string>& days) {
  for (const std::string& day : days) {
    for (const Beat& event : archive_.events_of(day))
      take(event, true);
    number(numbers_.numbered(log_), true);
  }
  last_stored_ = archive_.last_time();
}

// Times without a date count from where they began: as noted, while they go on from there; else
// from `start`, or so that this event is now. A source that begins again gets a new origin.
Instant ClockWatch::absolute(const Beat& event, const ClockLog& log, const Instant& now) {
  if (log.origin != TimeOrigin::none)
    return {event.time.seconds - seconds_before_1970(log.origin), event.time.fraction};
  const auto from = [&](const Instant& origin) {
    return Instant{event.time.seconds + origin.seconds, event.time.fraction} + origin.fraction;
  };
  constexpr double steps_back_s = 1.0;       // an event out of order, not a new beginning
  constexpr double longest_drift_s = 3600.0; // of the source's clock since it began
  const auto goes_on = [&](const Instant& at) {
    return !last_stored_ || at - *last_stored_ > -steps_back_s;
  };
  if (const auto origin = archive_.origin()) {
    const Instant at = from(*origin);
    const bool is_now =
        !is_first_ || !options_.source_is_live || std::abs(now - at) < longest_drift_s;
    if (goes_on(at) && is_now) return at;
  }
  Instant origin = now + -event.time.to_double();
  if (!archive_.origin() && options_.start) origin = *options_.start;
  if (last_stored_ && *last_stored_ - from(origin) > 0.0)
    origin = *last_stored_ + (numbers_.period_s() - event.time.to_double());
  try {
    archive_.set_origin(origin);
  } catch (const OutputError& error) { // the next day's header has it
    alarms_.archive_fails(now, error.what());
  }
  return from(origin);
}

void ClockWatch::add(const Beat& event, const ClockLog& log, const Instant& now) {
  has_edges_ = has_edges_ || event.edge == Edge::down;
  if (!log_.nominal_period_s) log_.nominal_period_s = log.nominal_period_s;
  archive_.describe(has_edges_ || !log.directions_are_open, log_.nominal_period_s);
  Beat stored = event;
  stored.time = absolute(event, log, now);
  stored = as_stored(stored); // what is used is what is kept
  is_first_ = false;
  ++heard_;
  last_heard_at_ = now;
  pending_.push_back(stored);
  store_pending(now);
  if (numbers_.is_full()) number(numbers_.numbered(log_), false);
  sync(now);
}

// Stored first, used then. What cannot be stored waits.
void ClockWatch::store_pending(const Instant& now) {
  try {
    while (!pending_.empty()) {
      archive_.append(pending_.front());
      ++stored_;
      last_stored_ = pending_.front().time;
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
  if (archive_.is_synced() || (last_sync_ && now - *last_sync_ < sync_every_s)) return;
  last_sync_ = now;
  try {
    archive_.sync();
    acknowledged_ = stored_;
  } catch (const OutputError& error) {
    alarms_.archive_fails(now, error.what());
  }
}

void ClockWatch::take(const Beat& event, bool is_replay) {
  for (const auto& [arrived, begins_anew] : arrivals_.add(event)) {
    if (begins_anew) {
      number(numbers_.rest(log_), is_replay);
      numbers_.begin_anew();
      going_.break_count();
    }
    numbers_.add(arrived);
  }
  (void)arrivals_.take_left_out(); // they are in the archive
  if (is_replay && numbers_.is_full()) number(numbers_.numbered(log_), true);
}

void ClockWatch::number(std::vector<Beat> beats, bool is_replay) {
  gaps_ = numbers_.take_gaps();
  for (const Beat& beat : beats)
    take_beat(beat, is_replay);
  remember_alarms();
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
        remember(breaks_, found);
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

void ClockWatch::remember_alarms() {
  for (const AlarmChange& change : alarms_.take_changes()) {
    const AlarmRecord record{change.at.to_double(), std::string(name_of(change.kind)), change.text,
                             change.is_raised};
    remember(alarm_records_, record);
    index_.put_alarm(record);
    try {
      archive_.note(fmt::format("alarm {} {} {}: {}", change.is_raised ? "begins" : "ends",
                                record.kind, format_instant(change.at, 3), change.text));
    } catch (const OutputError&) { // a full disk is one of the alarms
    }
    fresh_alarms_.push_back(change);
  }
}

void ClockWatch::idle(const ClockLog& log, const Instant& now) {
  if (!log_.nominal_period_s) log_.nominal_period_s = log.nominal_period_s;
  store_pending(now);
  number(numbers_.numbered(log_), false);
  sync(now);
  if (last_heard_at_) alarms_.silent(now - *last_heard_at_, period_s(), now);
  remember_alarms();
}

void ClockWatch::end(const ClockLog& log, const Instant& now) {
  for (const auto& [arrived, begins_anew] : arrivals_.rest())
    numbers_.add(arrived);
  number(numbers_.rest(log_), false);
  last_sync_.reset();
  idle(log, now);
}

} // namespace goingrate::apps
