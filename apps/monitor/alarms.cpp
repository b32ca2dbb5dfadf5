#include "alarms.hpp"

#include <algorithm>
#include <boost/math/special_functions/beta.hpp>
#include <cmath>
#include <fmt/format.h>

namespace goingrate::apps {

namespace {

constexpr double seconds_a_day = 86400.0;
constexpr std::size_t looked_back_minutes = 10;
constexpr double tolerated_share = 0.05; // of events, missing or false, of a sensor that works
constexpr double faulty_clears = 0.03;   // below which one works again

} // namespace

// How many events of the last minutes were missing or false, and their beat error.
struct LastMinutes {
  std::int64_t events = 0, faults = 0;
  double beat_error_s = 0.0;
  bool has_beat_error = false;

  [[nodiscard]] double faulty_share() const {
    return events > 0 ? static_cast<double>(faults) / static_cast<double>(events) : 0.0;
  }
  // Whether a good sensor, whose faults come one by one, has this many less than once in five
  // years.
  [[nodiscard]] bool tells_of_failure() const {
    constexpr double false_alarms_a_year = 0.2;
    constexpr double tests_a_year = 525960.0 / static_cast<double>(looked_back_minutes);
    return faults > 0 &&
           boost::math::ibeta(static_cast<double>(faults), static_cast<double>(events - faults + 1),
                              tolerated_share) < false_alarms_a_year / tests_a_year;
  }
};

namespace {

LastMinutes last_minutes(const GoingBlocks& minutes, bool with_last,
                         std::size_t count = looked_back_minutes) {
  GoingBlock sum;
  const auto& all = minutes.all();
  const std::size_t end = all.size() - (with_last ? 0 : 1);
  for (std::size_t i = end - std::min(end, count); i < end; ++i) {
    sum.beats += all[i].beats;
    sum.missed += all[i].missed;
    sum.spurious += all[i].spurious;
    // Directions count only from a sensor that reports nearly every event, and hardly any false
    // one.
    const auto faults = static_cast<double>(all[i].missed + all[i].spurious);
    if (faults > tolerated_share * (static_cast<double>(all[i].beats) + faults)) continue;
    sum.beat_error_sum += all[i].beat_error_sum;
    sum.beat_errors += all[i].beat_errors;
  }
  LastMinutes last;
  last.faults = sum.missed + sum.spurious;
  last.events = sum.beats + last.faults;
  last.has_beat_error = sum.beat_errors > 0;
  last.beat_error_s = sum.beat_error_s().value_or(0.0);
  return last;
}

std::string duration(std::int64_t minutes) {
  const auto hours = static_cast<double>(minutes) / 60.0;
  if (minutes < 60) return fmt::format("{} min", minutes);
  return hours < 48.0 ? fmt::format("{:.2g} h", hours) : fmt::format("{:.0f} days", hours / 24.0);
}

} // namespace

std::string_view name_of(AlarmKind kind) {
  switch (kind) {
  case AlarmKind::stopped:
    return "stopped";
  case AlarmKind::out_of_beat:
    return "out-of-beat";
  case AlarmKind::rate_step:
    return "rate-step";
  case AlarmKind::amplitude_falling:
    return "amplitude-falling";
  case AlarmKind::sensor_failing:
    return "sensor-failing";
  case AlarmKind::archive_failing:
    return "archive-failing";
  }
  return "";
}

bool Alarms::is_raised(AlarmKind kind) const {
  return raised_[static_cast<std::size_t>(kind)].has_value();
}

void Alarms::set(AlarmKind kind, bool raised, const Instant& at, const std::string& text) {
  if (raised == is_raised(kind)) return;
  const AlarmChange change{kind, raised, at, text};
  raised_[static_cast<std::size_t>(kind)] = raised ? std::optional(change) : std::nullopt;
  changes_.push_back(change);
}

void Alarms::restore(const std::vector<AlarmRecord>& records) {
  for (const AlarmRecord& record : records)
    for (std::size_t k = 0; k < alarm_kinds; ++k) {
      const auto kind = static_cast<AlarmKind>(k);
      if (record.kind != name_of(kind)) continue;
      const AlarmChange change{kind, true, Instant::from_seconds(record.at_s), record.text};
      raised_[k] = record.is_raised ? std::optional(change) : std::nullopt;
    }
}

std::vector<AlarmChange> Alarms::raised() const {
  std::vector<AlarmChange> all;
  for (const auto& alarm : raised_)
    if (alarm) all.push_back(*alarm);
  return all;
}

void Alarms::heard(const Going& going, double nominal_period_s, bool is_replay) {
  if (!is_replay) goes(going.last()->time, going, nominal_period_s);
  if (!going.minute_is_new() || going.minutes().all().size() < 2) return;
  look_for_steps(going, nominal_period_s, is_replay);
  if (!is_replay) look_at_minutes(going, nominal_period_s);
}

// The clock counts as running again once it has run for as long as it may be silent.
void Alarms::goes(const Instant& at, const Going& going, double period_s) {
  if (!is_raised(AlarmKind::stopped)) return;
  if (!goes_since_) goes_since_ = at;
  if (at - *goes_since_ >= patience_of(going, period_s)) {
    set(AlarmKind::stopped, false, at, "the clock goes again");
    goes_since_.reset();
  }
}

// Five periods, or more if beats are missed so often that as many in a row would be missed by
// chance more than once in five years.
double Alarms::patience_of(const Going& going, double period_s) const {
  constexpr double fewest_periods = 5.0, false_alarms_a_year = 0.2, seconds_a_year = 31557600.0;
  if (patience_s_ > 0.0) return patience_s_;
  const double missed = going.missed_share();
  const double chance = false_alarms_a_year * period_s / seconds_a_year; // of each beat
  return period_s * std::max(fewest_periods, 1.0 + std::log(chance) / std::log(missed));
}

void Alarms::look_for_steps(const Going& going, double nominal_period_s, bool is_replay) {
  const GoingBlocks& minutes = going.minutes();
  const std::size_t complete = minutes.all().size() - 2;
  const Instant at = going.last()->time;
  const std::int64_t minute = minutes.all()[complete].start_s / 60;
  // If the sensor fails, its events do not show the behaviour of the clock.
  const LastMinutes last = last_minutes(minutes, false), alone = last_minutes(minutes, false, 1);
  is_faulty_ = last.tells_of_failure() || alone.tells_of_failure() ||
               (is_faulty_ && last.faulty_share() >= faulty_clears);
  using Mean = std::optional<double>;
  const auto rate = habits_.rate.add(
      is_faulty_ ? Mean()
                 : habits_.rate_wave.without(minute, minutes.rate_of(complete, nominal_period_s)));
  const auto fall =
      habits_.amplitude.add(minute, is_faulty_ ? Mean() : minutes.all()[complete].amplitude_rad());
  if (rate) habits_.rate_wave.stepped(rate->size);
  if (is_replay) return;
  if (rate)
    set(AlarmKind::rate_step, true, at,
        fmt::format("the rate changed by {:+.2g} ± {:.1g} s/day within the last {}",
                    rate->size * seconds_a_day, rate->sigma * seconds_a_day,
                    duration(2 * rate->minutes)));
  else if (!habits_.rate.is_raised())
    set(AlarmKind::rate_step, false, at, "the rate since the change is taken for the usual one");
  if (fall)
    set(AlarmKind::amplitude_falling, true, at,
        fmt::format("the amplitude fell by {:.2g} ± {:.1g} mrad within the last {}",
                    fall->size * 1e3, fall->sigma * 1e3, duration(fall->minutes)));
  else if (!habits_.amplitude.is_raised())
    set(AlarmKind::amplitude_falling, false, at, "the amplitude has come back, or holds");
}

void Alarms::tell_faults(const LastMinutes& last, const Instant& at) {
  if (last.tells_of_failure())
    set(AlarmKind::sensor_failing, true, at,
        fmt::format("{:.0f} % of the events of the last {} minutes were missing or false",
                    100.0 * last.faulty_share(), looked_back_minutes));
}

void Alarms::Habits::pass(Learnt& learnt) {
  rate_wave.pass(learnt);
  rate.pass(learnt);
  amplitude.pass(learnt);
}

std::vector<double> Alarms::learnt() const {
  Learnt learnt;
  Habits(habits_).pass(learnt);
  return learnt.numbers();
}

void Alarms::take_learnt(std::vector<double> numbers) {
  Learnt learnt(std::move(numbers));
  Habits habits;
  habits.pass(learnt);
  if (learnt.is_read_whole()) habits_ = std::move(habits);
}

void Alarms::look_at_minutes(const Going& going, double nominal_period_s) {
  const Instant at = going.last()->time;
  // Shares of the period at which an alarm is raised and cleared.
  constexpr double uneven_raises = 0.02, uneven_clears = 0.01;
  const LastMinutes last = last_minutes(going.minutes(), false); // the last one is not complete
  tell_faults(last, at);
  if (last.faulty_share() < faulty_clears)
    set(AlarmKind::sensor_failing, false, at, "the sensor tells nearly every beat again");
  if (is_faulty_ || is_raised(AlarmKind::sensor_failing)) return;
  const double uneven = std::abs(last.beat_error_s) / nominal_period_s;
  if (last.has_beat_error && uneven > uneven_raises)
    set(AlarmKind::out_of_beat, true, at,
        fmt::format("the clock is out of beat: tick and tock differ by {:.3g} ms",
                    1e3 * last.beat_error_s));
  else if (last.has_beat_error && uneven < uneven_clears)
    set(AlarmKind::out_of_beat, false, at, "the clock is in beat again");
}

void Alarms::silent(double silence_s, double period_s, const Going& going, const Moment& now) {
  // Only beats complete a minute.
  constexpr double minute_s = 60.0;
  if (silence_s > minute_s && !going.minutes().all().empty())
    tell_faults(last_minutes(going.minutes(), true), now.wall);
  const double patience = patience_of(going, period_s);
  if (!(patience > 0.0 && silence_s > patience + lateness_s_)) return;
  goes_since_.reset();
  set(AlarmKind::stopped, true, now.wall,
      fmt::format("no beat for {:.3g} s: has the clock stopped?", silence_s));
}

void Alarms::misdated(double error_s, const Moment& now) {
  set(AlarmKind::sensor_failing, true, now.wall,
      fmt::format("the source tells a date {:.0f} days {} this computer's",
                  std::abs(error_s) / seconds_a_day, error_s > 0.0 ? "after" : "before"));
}

void Alarms::no_beats(const std::string& why, const Moment& now) {
  set(AlarmKind::sensor_failing, true, now.wall,
      fmt::format("what the source tells is not numbered: {}; both directions without labels, or "
                  "another nominal period?",
                  why));
}

void Alarms::archive_fails(const Moment& now, const std::string& why) {
  archive_failed_s_ = now.steady_s;
  set(AlarmKind::archive_failing, true, now.wall, why);
}

void Alarms::archive_works(const Moment& now) {
  constexpr double quiet_s = 60.0; // a disk that fails again within it has not recovered
  if (archive_failed_s_ && now.steady_s - *archive_failed_s_ < quiet_s) return;
  set(AlarmKind::archive_failing, false, now.wall, "the archive is written again");
}

} // namespace goingrate::apps
