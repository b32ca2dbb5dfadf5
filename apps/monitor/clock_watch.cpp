#include "clock_watch.hpp"

#include "held_notes.hpp"

#include "goingrate/base/errors.hpp"
#include "goingrate/log/amplitude.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace goingrate::apps {

namespace {

constexpr std::size_t most_breaks = 500; // kept in memory
constexpr double sync_every_s = 1.0;     // so that every line is safe within two seconds

} // namespace

ClockWatch::ClockWatch(WatchOptions options)
    : options_(std::move(options)), archive_(options_.folder), index_(options_.folder),
      unread_(options_.folder), places_(archive_, options_.place), numbers_(options_.log),
      alarms_(options_.patience_s, options_.lateness_s), diary_(archive_, index_) {
  goes_on_from_unread_ = !unread_.text().empty();
  log_.source = options_.folder;
  // Stored events are numbered before anything is read from the source.
  log_.nominal_period_s = options_.log.nominal_period_s > 0.0
                              ? std::optional(options_.log.nominal_period_s)
                              : archive_.nominal_period_s();
  restore();
}

void ClockWatch::hold(std::string_view text, const Moment& now) {
  // Up to this many lines may be beats of a log that is not recognised yet; more are not.
  constexpr std::ptrdiff_t most_lines = 30;
  is_holding_ = true;
  const auto lines = std::count(text.begin(), text.end(), '\n');
  if (lines > std::exchange(held_lines_, lines) && lines <= most_lines) may_beat(now);
  try {
    if (options_.place.source_is_live) unread_.hold(text);
  } catch (const OutputError& error) {
    alarms_.archive_fails(now, error.what());
  }
}

// The latest event is not judged yet: it may be a beat.
void ClockWatch::may_beat(const Moment& now) {
  last_good_s_ = std::max(last_good_s_.value_or(now.steady_s), now.steady_s);
}

// A quantity that the source has given once keeps its column.
void ClockWatch::describe(const HeardEvent& event, const ClockLog& log) {
  if (!log_.nominal_period_s) log_.nominal_period_s = log.nominal_period_s;
  const auto tells = [](bool& column, const std::vector<double>& of_log, double value) {
    column = column || !of_log.empty() || !std::isnan(value);
  };
  columns_.edge = columns_.edge || options_.log.both_edges || event.edge == Edge::down ||
                  !log.directions_are_open;
  tells(columns_.width, log.columns.width_s, event.values.width_s);
  tells(columns_.temperature, log.columns.temperature_c, event.values.temperature_c);
  tells(columns_.pressure, log.columns.pressure_mbar, event.values.pressure_mbar);
  tells(columns_.humidity, log.columns.humidity_percent, event.values.humidity_percent);
  columns_.nominal_period_s = log_.nominal_period_s;
  columns_.flag_width_rad = options_.log.flag_width_rad > 0.0
                                ? std::optional(options_.log.flag_width_rad)
                                : log.flag_width_rad;
  columns_.gravity_share =
      options_.log.gravity_share ? options_.log.gravity_share : log.gravity_share;
  archive_.describe(columns_);
}

void ClockWatch::add(const HeardEvent& event, const ClockLog& log, const Moment& now) {
  describe(event, log);
  last_heard_ = now;
  is_holding_ = false;
  if (const auto error_s = places_.date_error_s(event, log, now))
    return keep_misdated(event, *error_s, now);
  meet(waited_.empty() ? event : waited_.front(), log, now);
  for (const HeardEvent& before : std::exchange(waited_, {}))
    offer(before, log, now);
  if (places_.is_stored(event, log)) return;
  ++heard_;
  offer(event, log, now);
  if (!places_.is_in_burst(log, now)) place(log, now);
  if (numbers_.is_full()) number(numbers_.numbered(log_), false);
  sync(now);
}

// The first event of a run may continue from the stored events.
void ClockWatch::meet(const HeardEvent& event, const ClockLog& log, const Moment& now) {
  if (!std::exchange(is_first_, false)) return;
  const bool may_be_read_again = !options_.place.source_is_live || goes_on_from_unread_;
  if (const auto last = places_.meet(event, log, may_be_read_again)) {
    last_directed_ = last;
    arrivals_.go_on_from(*last,
                         options_.place.source_is_live
                             ? std::optional(now.steady_s - (now.wall - *archive_.last_time()))
                             : std::nullopt);
  }
}

// Adds what follows from the options and is not in the line: the direction, which alternates every
// half period, and the amplitude.
HeardEvent ClockWatch::completed(HeardEvent event, const ClockLog& log) {
  const LogOptions& asked = options_.log;
  if (asked.both_edges) {
    const double halves =
        last_directed_ ? (event.time - last_directed_->time) / (0.5 * asked.nominal_period_s) : 0.0;
    const bool turns = std::abs(std::remainder(std::round(halves), 2.0)) > 0.5;
    const bool was_down = last_directed_ && last_directed_->edge == Edge::down;
    event.edge = was_down != turns ? Edge::down : Edge::up;
    last_directed_ = event;
  }
  const double flag_rad =
      asked.flag_width_rad > 0.0 ? asked.flag_width_rad : log.flag_width_rad.value_or(0.0);
  const double period_s = log_.nominal_period_s.value_or(nominal_period_s());
  if (std::isnan(event.amplitude_rad) && flag_rad > 0.0 && period_s > 0.0)
    event.amplitude_rad =
        amplitude_from_width(event.values.width_s, flag_rad, period_s,
                             asked.gravity_share.value_or(log.gravity_share.value_or(1.0)));
  return event;
}

// An event that waits for others is kept as a comment until they come.
void ClockWatch::offer(const HeardEvent& event, const ClockLog& log, const Moment& now) {
  const auto heard_s = options_.place.source_is_live ? std::optional(now.steady_s) : std::nullopt;
  for (const Arrivals::Arrival& arrival : arrivals_.add(completed(event, log), heard_s))
    places_.add(arrival, log, now);
  note_left_out(arrivals_.take_left_out(), now);
  if (arrivals_.held().size() > 1) may_beat(now); // they go on from each other
  if (!arrivals_.held().empty() && options_.place.source_is_live) note(waiting_note(event), now);
}

void ClockWatch::keep_misdated(const HeardEvent& event, double error_s, const Moment& now) {
  ++heard_;
  note(misdated_note(event, error_s), now);
  going_.add_spurious();
  alarms_.misdated(error_s, now);
  sync(now);
}

void ClockWatch::note(const std::string& text, const Moment& now) {
  try {
    archive_.note(text, now.wall);
  } catch (const OutputError& error) { // no event is lost with it
    alarms_.archive_fails(now, error.what());
  }
}

void ClockWatch::note_left_out(const std::vector<HeardEvent>& events, const Moment& now) {
  for (const HeardEvent& event : events)
    note(left_out_note(event), now);
}

// The events heard get their places in time and wait to be stored.
void ClockWatch::place(const ClockLog& log, const Moment& now) {
  if (places_.is_empty()) return;
  const auto placed = places_.take(log, last_heard_->wall, numbers_.period_s());
  note_left_out(placed.left_out, now);
  pending_.insert(pending_.end(), placed.events.begin(), placed.events.end());
  store_pending(now);
}

// Events are stored first, then used. Events that cannot be stored wait.
void ClockWatch::store_pending(const Moment& now) {
  try {
    while (!pending_.empty()) {
      archive_.append(pending_.front().event);
      ++stored_;
      take(pending_.front(), false);
      pending_.pop_front();
    }
  } catch (const OutputError& error) {
    alarms_.archive_fails(now, error.what());
    for (; pending_.size() > options_.most_pending; ++lost_)
      pending_.pop_front();
    return;
  }
  tell_lost(now);
}

// Notes a loss where it happened, after the last event that could be kept.
void ClockWatch::tell_lost(const Moment& now) {
  const auto fresh = lost_ - std::exchange(told_lost_, lost_);
  if (fresh > 0)
    note(fmt::format("{} events were lost: the archive could not be written for too long", fresh),
         now);
}

void ClockWatch::sync(const Moment& now) {
  if (archive_.is_synced() || (last_sync_s_ && now.steady_s - *last_sync_s_ < sync_every_s)) return;
  last_sync_s_ = now.steady_s;
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
  if (beat.flag != BeatFlag::good) return;
  if (!is_replay) last_good_s_ = last_heard_->steady_s; // at most one beat after this one
  alarms_.heard(going_, nominal_period_s(), is_replay);
}

// Days up to that of a beat whose file has comments but no good beat. If one day follows the other,
// the folder is not searched.
std::vector<std::string> ClockWatch::silent_days(const Beat& beat) const {
  constexpr std::int64_t day_s = 86400;
  const bool is_first = going_.days().all().size() == 1;
  if (!is_first && going_.last()->time.seconds / day_s + 1 == beat.time.seconds / day_s) return {};
  return archive_.days_between(is_first ? "" : day_of(going_.last()->time), day_of(beat.time));
}

// The first beat of a new day completes the one before.
void ClockWatch::complete_day(const Beat& beat) {
  const std::string day = day_of(going_.last()->time);
  if (day == day_of(beat.time)) return;
  std::vector<GoingBlock> hours;
  for (const GoingBlock& hour : going_.hours().all())
    if (day_of({hour.start_s, 0.0}) == day) hours.push_back(hour);
  const auto learnt = alarms_.learnt();
  const auto put = [&](const std::string& name, const std::vector<GoingBlock>& its_hours) {
    index_.put_day(name, its_hours, going_.first_of_run());
    index_.put_learnt(name, learnt);
  };
  try {
    for (const std::string& silent : silent_days(beat))
      put(silent, {});
    put(day, hours);
  } catch (const OutputError&) { // the index is made again from the files
  }
}

void ClockWatch::idle(const ClockLog& log, const Moment& now) {
  if (!log_.nominal_period_s) log_.nominal_period_s = log.nominal_period_s;
  place(log, now);
  store_pending(now);
  number(numbers_.numbered(log_), false);
  sync(now);
  if (!is_holding_ && places_.is_empty() && pending_.empty() && archive_.is_synced())
    unread_.clear();
  if (archive_.is_synced() && pending_.empty()) alarms_.archive_works(now);
  if (!last_good_s_) last_good_s_ = now.steady_s; // a clock that stopped before this began
  // Events that are not judged yet may be beats.
  const bool may_be_beats = numbers_.is_settling() || !places_.is_empty() || !pending_.empty();
  if (may_be_beats && last_heard_) may_beat(*last_heard_);
  if (!numbers_.failure().empty()) alarms_.no_beats(numbers_.failure(), now);
  const double silence_s = now.steady_s - *last_good_s_;
  silence_s_ = heard_ > 0 || !going_.last() || !options_.place.source_is_live
                   ? silence_s
                   : std::max(silence_s, now.wall - going_.last()->time);
  alarms_.silent(silence_s, period_s(), going_, now);
  diary_.add(alarms_.take_changes());
}

bool ClockWatch::is_all_stored() const {
  return places_.is_empty() && pending_.empty() && arrivals_.held().empty() && archive_.is_synced();
}

void ClockWatch::end(const ClockLog& log, const Moment& now) {
  for (const Arrivals::Arrival& arrival : arrivals_.rest())
    places_.add(arrival, log, now);
  place(log, now);
  number(numbers_.rest(log_), false);
  last_sync_s_.reset();
  idle(log, now);
}

} // namespace goingrate::apps
