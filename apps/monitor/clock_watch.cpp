#include "clock_watch.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <sstream>

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

constexpr std::string_view alarm_words = "alarm ";

AlarmRecord record_of(const AlarmChange& change) {
  return {change.at.to_double(), std::string(name_of(change.kind)), change.text, change.is_raised};
}

Instant as_stored_at(const Instant& time) { return as_stored(event_at(time)).time; }

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
  const bool agrees = std::includes(days.begin(), days.end(), indexed.begin(), indexed.end());
  if (!agrees) index_.clear();
  const std::size_t known = agrees ? indexed.size() - std::min(indexed.size(), learnt_days) : 0;
  const std::string first = known > 0 ? indexed[known] : std::string();
  const auto taken =
      static_cast<std::size_t>(std::lower_bound(days.begin(), days.end(), first) - days.begin());
  if (!agrees || indexed.empty()) index_alarms(days);
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
  alarms_.restore({alarm_records_.begin(), alarm_records_.end()});
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
  last_stored_ = archive_.last_time();
}

// Times without a date count from the origin that is noted.
Instant ClockWatch::absolute(const Beat& event, const ClockLog& log) const {
  if (log.origin != TimeOrigin::none)
    return {event.time.seconds - seconds_before_1970(log.origin), event.time.fraction};
  const Instant origin = *archive_.origin();
  return Instant{event.time.seconds + origin.seconds, event.time.fraction} + origin.fraction;
}

// The first event of this run: whether it goes on from what is stored, is stored already, or has
// nothing to do with it.
void ClockWatch::meet_source(const Beat& event, const ClockLog& log) {
  is_first_ = false;
  const bool is_dated = log.origin != TimeOrigin::none;
  if (!last_stored_ || (!is_dated && !archive_.origin())) return;
  const Instant at = as_stored_at(absolute(event, log));
  origin_holds_ = true;
  is_unsure_ = !is_dated && options_.source_is_live;
  skips_known_ = !options_.source_is_live && !(at > *last_stored_) && archive_.holds(at);
  Beat last = event;
  last.time = event.time + (*last_stored_ - at);
  arrivals_.go_on_from(last);
}

// Where a source's own second 0 was: its last event is heard now, or its first one is at `start`;
// but not before what is stored.
void ClockWatch::choose_origin(const Instant& now) {
  const auto at_zero = [](const Beat& event, const Instant& at) {
    return Instant{at.seconds - event.time.seconds, 0.0} + (at.fraction - event.time.fraction);
  };
  Instant origin = at_zero(unplaced_.back().event, now);
  if (!archive_.origin() && options_.start) origin = *options_.start;
  const Beat& first = unplaced_.front().event;
  if (last_stored_ && !(at_zero(first, *last_stored_) < origin))
    origin = at_zero(first, *last_stored_ + numbers_.period_s());
  archive_.set_origin(origin);
  origin_holds_ = true;
}

void ClockWatch::add(const Beat& event, const ClockLog& log, const Instant& now) {
  has_edges_ = has_edges_ || event.edge == Edge::down;
  if (!log_.nominal_period_s) log_.nominal_period_s = log.nominal_period_s;
  archive_.describe(has_edges_ || !log.directions_are_open, log_.nominal_period_s);
  last_heard_at_ = now;
  if (is_first_) meet_source(event, log);
  if (skips_known_) {
    if (!(as_stored_at(absolute(event, log)) > *last_stored_)) return;
    skips_known_ = false;
  }
  ++heard_;
  for (const Arrivals::Arrival& arrival : arrivals_.add(event)) {
    // Began again while nobody listened, or its clock would be an hour off since it began.
    constexpr double longest_drift_s = 3600.0;
    const bool is_elsewhere = std::exchange(is_unsure_, false) &&
                              std::abs(now - absolute(arrival.event, log)) > longest_drift_s;
    if (arrival.begins_anew || is_elsewhere) origin_holds_ = false;
    if (unplaced_.empty()) unplaced_since_ = now;
    unplaced_.push_back(arrival);
  }
  note_left_out(arrivals_.take_left_out(), now);
  constexpr double longest_burst_s = 0.2; // of lines that a source wrote before it was listened to
  const bool is_burst = options_.source_is_live && !options_.start &&
                        std::abs(now - unplaced_since_) < longest_burst_s;
  const bool has_place = log.origin != TimeOrigin::none || origin_holds_;
  if (has_place || !is_burst) place(log, now);
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
  if (unplaced_.empty()) return;
  const bool is_dated = log.origin != TimeOrigin::none;
  if (!is_dated && !origin_holds_) choose_origin(*last_heard_at_);
  for (const Arrivals::Arrival& arrival : unplaced_) {
    Beat stored = arrival.event;
    stored.time = absolute(arrival.event, log);
    constexpr std::int64_t latest_s = 9'223'372'036; // in the year 2262
    if (stored.time.seconds < 0 || stored.time.seconds > latest_s)
      note_left_out({arrival.event}, now);
    else
      pending_.push_back({as_stored(stored), is_dated && arrival.begins_anew});
  }
  unplaced_.clear();
  store_pending(now);
}

// Stored first, used then. What cannot be stored waits.
void ClockWatch::store_pending(const Instant& now) {
  try {
    while (!pending_.empty()) {
      archive_.append(pending_.front().event);
      ++stored_;
      last_stored_ = pending_.front().event.time;
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

// What was not written because the disk was full is written later.
void ClockWatch::remember_alarms() {
  for (const AlarmChange& change : alarms_.take_changes()) {
    remember(alarm_records_, record_of(change));
    fresh_alarms_.push_back(change);
    if (unnoted_.size() < most_records) unnoted_.push_back(change);
  }
  while (!unnoted_.empty()) {
    try {
      const AlarmChange& change = unnoted_.front();
      archive_.note(fmt::format("{}{} {} {}: {}", alarm_words, change.is_raised ? "begins" : "ends",
                                name_of(change.kind), format_instant(change.at, 3), change.text),
                    change.at);
      index_.put_alarm(record_of(change));
      unnoted_.pop_front();
    } catch (const OutputError&) {
      return;
    }
  }
}

// An index that was lost has them again from the days' comments.
void ClockWatch::index_alarms(const std::vector<std::string>& days) {
  for (const std::string& day : days)
    for (const std::string& note : archive_.notes_of(day)) {
      if (!note.starts_with(alarm_words)) continue;
      std::istringstream words(note.substr(alarm_words.size()));
      AlarmRecord record;
      std::string change, time;
      words >> change >> record.kind >> time >> std::ws;
      std::getline(words, record.text);
      const auto at = parse_instant(std::string_view(time).substr(0, time.find(':')));
      if (!at) continue;
      record.is_raised = change == "begins";
      record.at_s = at->to_double();
      index_.put_alarm(record);
    }
}

void ClockWatch::idle(const ClockLog& log, const Instant& now) {
  if (!log_.nominal_period_s) log_.nominal_period_s = log.nominal_period_s;
  place(log, now);
  store_pending(now);
  number(numbers_.numbered(log_), false);
  sync(now);
  if (!last_heard_at_) last_heard_at_ = now; // a clock that stopped before this began
  alarms_.silent(now - *last_heard_at_, period_s(), now);
  remember_alarms();
}

void ClockWatch::end(const ClockLog& log, const Instant& now) {
  for (const Arrivals::Arrival& arrival : arrivals_.rest())
    unplaced_.push_back(arrival);
  place(log, now);
  number(numbers_.rest(log_), false);
  last_sync_.reset();
  idle(log, now);
}

} // namespace goingrate::apps
