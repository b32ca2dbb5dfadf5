#include "numbering.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace goingrate {

namespace {

// A beat is further off than six sigmas once in 5e8 events, if the noise is as estimated.
constexpr double gate_sigmas2 = 36.0;
// Without noise a beat may still be off by a step of the rate: 1 %, a fraction of any beat error.
constexpr double gate_floor = 0.01;
// Successive periods of a swing that dies away from 140 degrees at Q = 300 differ by 1.5 %; the
// start of the filter needs as much again.
constexpr double course_floor = 0.03;
// A beat after a step of the clock's own may be off by more than the step: the period is not known
// well after a few beats.
constexpr double step_reach = 1.5;
// Never so wide that an event half-way between two beats could count as a beat.
constexpr double gate_cap = 0.25;
// After this many events in a row that fit no beat, the search for beats starts again. With one
// event in ten false that happens by chance once in 1e6.
constexpr int most_misfits = 6;
// After a long absence the next beat is still predicted if six sigmas are at most this share of the
// period: an event at a random phase then fits in at most one case of ten.
constexpr double foreseen_share = 0.05;
// If two events fit one cycle, one is chosen if it is a hundred times likelier: exp(4.6).
constexpr double decisive_log_odds = 4.6;
// The relative error of the typical period at the first beats, and the relative change allowed
// after beats were lost.
constexpr double unknown_period_share = 0.01;
constexpr double changed_period_share = 1e-3;

} // namespace

Numbering::Numbering(std::span<Beat> beats, const TypicalPeriod& typical, const BeatNoise& noise,
                     double own_step_s)
    : beats_(beats), period_(typical.mean_s),
      search_{.period_s = period_,
              // Six sigmas of a difference over twelve periods, at least 1.5 % (the typical period
              // may be off by a thousandth), at most so much that false events seldom agree.
              .tolerance_s =
                  std::clamp(6.0 * std::sqrt(2.0 * noise.jitter2 + 12.0 * noise.walk2),
                             (typical.has_a_course ? 0.05 : 0.015) * period_, 0.1 * period_),
              .window = 12.5 * typical.mean_step,
              .absence = longest_absence(typical)},
      floor_(std::max((typical.has_a_course ? course_floor : gate_floor) * period_,
                      step_reach * own_step_s)),
      filter_(noise, typical.mean_s) {}

std::size_t Numbering::next_up(std::size_t i) {
  for (; i < beats_.size() && !may_be_up(beats_[i]); ++i) {
    beats_[i].cycle = beats_[last_].cycle;
    if (beats_[i].flag == BeatFlag::bounce) continue;
    beats_[i].flag = BeatFlag::down;
    has_downward_ = true;
  }
  return i;
}

void Numbering::mark_spurious(std::size_t i) {
  beats_[i].flag = BeatFlag::spurious;
  beats_[i].cycle = beats_[last_].cycle;
}

void Numbering::accept(std::size_t i, std::int64_t cycle) {
  beats_[i].flag = BeatFlag::good;
  beats_[i].cycle = cycle;
  last_ = i;
  misfits_ = 0;
}

bool Numbering::fits(double error_s, double variance) const {
  const double error2 = error_s * error_s;
  const double cap = gate_cap * period_;
  return error2 <= std::max(gate_sigmas2 * variance, floor_ * floor_) && error2 <= cap * cap;
}

void Numbering::run() {
  last_ = next_up(0);
  if (last_ == beats_.size()) return;
  beats_[last_].cycle = 0;
  double period = local_period(beats_, last_, search_);
  // Too few events for a vote: the first counts as a beat.
  const std::size_t start = looked_for(last_, period).value_or(last_);
  for (std::size_t i = last_; i < start; i = next_up(i + 1))
    mark_spurious(i);
  accept(start, 0);
  filter_.start(unknown_period_share * period_, period);
  for (std::size_t i = next_up(start + 1); i < beats_.size(); i = next_up(i + 1)) {
    i = run_on(i);
    i = place(i);
  }
  strike_lone_outliers();
}

// Settles events as place() would, as long as each is an upward beat, one cycle after the last and
// no surprise, and no other event is near: nearly all of nearly every log. Returns the first one that
// is not settled.
std::size_t Numbering::run_on(std::size_t i) {
  if (last_ + 1 != i) return i;
  ClockFilter filter = filter_;
  const double cap = gate_cap * period_, least = floor_ * floor_;
  std::int64_t cycle = beats_[last_].cycle;
  for (; i + 1 < beats_.size(); ++i) {
    Beat& beat = beats_[i];
    const Beat& next = beats_[i + 1];
    if (!may_be_up(beat) || !may_be_up(next)) break;
    const double until_next = next.time - beat.time;
    const auto is_clear = [&](double error_s, double variance) {
      const double gate2 = std::max(gate_sigmas2 * variance, least);
      const double error2 = error_s * error_s;
      return error2 <= gate2 && error2 <= cap * cap && until_next > 0.0 &&
             until_next * until_next > 4.0 * gate2;
    };
    if (!filter.follow_plainly(beat.time - beats_[i - 1].time, is_clear)) break;
    beat.flag = BeatFlag::good;
    beat.cycle = ++cycle;
  }
  filter_ = filter;
  if (i > last_ + 1) accept(i - 1, cycle);
  return i;
}

// Settles event i and returns the last event settled.
std::size_t Numbering::place(std::size_t i) {
  const double since = beats_[i].time - beats_[last_].time - filter_.offset();
  const double period = filter_.period();
  const double cycles = std::abs(since - period) < 0.5 * period ? 1.0 : std::round(since / period);
  const auto foreseen = filter_.after(std::max(1.0, cycles));
  const double variance = cycles >= 1.0 ? filter_.error_variance(foreseen) : 0.0;
  const bool absent = cycles > search_.absence;
  const bool lost = absent && gate_sigmas2 * variance > std::pow(foreseen_share * period_, 2.0);
  if (lost) return resume(i, i, true);
  if (is_bounce(i + 1))
    if (const auto beat = beat_among_bounces(i)) {
      mark_spurious(i);
      beats_[*beat].flag = BeatFlag::good;
      return place(*beat);
    }
  if (cycles >= 1.0 && fits(since - cycles * period, variance)) return settle(i, cycles, foreseen);
  if (absent) return resume(i, i, false);
  mark_spurious(i);
  if (++misfits_ >= most_misfits) return resume(last_ + 1, i, true);
  return i;
}

// A false event shortly before a beat makes the beat look like its bounce: event i is off the
// predicted time, and one of its bounces is at that time.
std::optional<std::size_t> Numbering::beat_among_bounces(std::size_t i) const {
  // Twice the log of the odds needed: of events close together one in forty precedes the beat, and
  // odds of a hundred to one decide.
  constexpr double decisive_sigmas2 = 2.0 * (3.7 + decisive_log_odds);
  const auto squared_sigmas = [&](std::size_t k) {
    const double since = beats_[k].time - beats_[last_].time;
    const double cycles = std::max(1.0, std::round((since - filter_.offset()) / filter_.period()));
    const double error = filter_.error(since, cycles);
    return error * error / filter_.error_variance(filter_.after(cycles));
  };
  const double first = squared_sigmas(i);
  if (first < decisive_sigmas2) return {};
  for (std::size_t k = i + 1; is_bounce(k); ++k)
    if (beats_[k].edge == Edge::up && first - squared_sigmas(k) > decisive_sigmas2) return k;
  return {};
}

// If cycles are missing before event i: a bounce at the predicted time of one of the missing beats.
// A false event of either direction came shortly before it.
std::optional<std::size_t> Numbering::missing_among_bounces(std::size_t i) const {
  constexpr double near_sigmas2 = 9.0; // squared sigmas
  for (std::size_t k = last_ + 1; k < i; ++k) {
    if (beats_[k].flag != BeatFlag::bounce || beats_[k].edge != Edge::up) continue;
    const double since = beats_[k].time - beats_[last_].time;
    const double cycles = std::round((since - filter_.offset()) / filter_.period());
    if (cycles < 1.0) continue;
    const double error = filter_.error(since, cycles);
    if (error * error < near_sigmas2 * filter_.error_variance(filter_.after(cycles))) return k;
  }
  return {};
}

// Among event i and the following ones that fit the same cycle, the nearest is the beat. Another
// that is nearly as likely is a rival; the rest are spurious.
std::size_t Numbering::settle(std::size_t i, double cycles,
                              const ClockFilter::Covariance& foreseen) {
  if (cycles > 1.0)
    if (const auto beat = missing_among_bounces(i)) {
      beats_[*beat].flag = BeatFlag::good;
      (void)place(*beat);
      return place(i);
    }
  const std::size_t before = last_;
  const double variance = filter_.error_variance(foreseen);
  const auto error_of = [&](std::size_t k) {
    return filter_.error(beats_[k].time - beats_[before].time, cycles);
  };
  std::size_t best = i, last = i;
  double least = error_of(i);
  for (std::size_t k = next_up(i + 1); k < beats_.size(); k = next_up(k + 1)) {
    const double error = error_of(k);
    if (!fits(error, variance)) break;
    last = k;
    if (std::abs(error) >= std::abs(least)) continue;
    least = error;
    best = k;
  }
  const std::int64_t cycle = beats_[before].cycle + static_cast<std::int64_t>(cycles);
  for (std::size_t k = i; last != i && k <= last; ++k) {
    if (k == best || !may_be_up(beats_[k])) continue;
    const double error = error_of(k);
    const double log_odds = 0.5 * (error * error - least * least) / variance;
    beats_[k].flag = log_odds < decisive_log_odds ? BeatFlag::rival : BeatFlag::spurious;
    beats_[k].cycle =
        k < best && beats_[k].flag == BeatFlag::spurious ? beats_[before].cycle : cycle;
  }
  accept(best, cycle);
  if (filter_.follow(least, cycles, foreseen)) surprises_.push_back(best);
  return last;
}

// The first steady beat from event i on, by `period` or, since the filter may have gone astray
// after a false start, by the period of the beats there, which `period` is then set to.
std::optional<std::size_t> Numbering::looked_for(std::size_t i, double& period) const {
  PhaseSearch search = search_;
  search.period_s = period;
  if (const auto found = find_steady_beat(beats_, i, search)) return found;
  period = local_period(beats_, i, search_);
  search.period_s = period;
  return find_steady_beat(beats_, i, search);
}

// After the beats were lost, searches for them from event i on. If there are none, the events up to
// `seen` are spurious. Fewer than four before the next absence are accepted if nothing contradicts
// them.
std::size_t Numbering::resume(std::size_t i, std::size_t seen, bool few_will_do) {
  misfits_ = 0;
  double period = filter_.period();
  auto found = looked_for(i, period);
  if (found && !few_will_do && events_before_absence(beats_, i, search_) < 4) found.reset();
  const std::size_t start = found.value_or(seen + 1);
  for (std::size_t k = next_up(i); k < start; k = next_up(k + 1))
    mark_spurious(k);
  if (!found) return seen;
  const double elapsed = beats_[start].time - beats_[last_].time;
  constexpr double most_cycles = 1e15; // cycles, which a double still counts
  const double periods = (elapsed - filter_.offset()) / period;
  const double cycles = std::clamp(std::round(periods), 1.0, most_cycles);
  const auto foreseen = filter_.after(cycles);
  if (cycles <= search_.absence &&
      fits(filter_.error(elapsed, cycles), filter_.error_variance(foreseen)))
    return settle(start, cycles, foreseen); // the lost events were a run of false ones
  accept(start, beats_[last_].cycle + static_cast<std::int64_t>(cycles));
  resumed_.push_back(start);
  filter_.start(changed_period_share * period_, period);
  return start;
}

// A false event near a missed beat was taken for the beat and misled the filter.
void Numbering::strike_lone_outliers() {
  for (const std::size_t i : surprises_)
    if (stands_alone(i)) beats_[i].flag = BeatFlag::spurious;
}

// Whether the beat's own error against the straight line through its neighbours is large and theirs
// are minus half of it, unlike at a change of the rate, where the neighbours lie on their lines.
bool Numbering::stands_alone(std::size_t i) const {
  constexpr std::size_t reach = 20, most_neighbours = 2 * reach + 1;
  // The good beats from near[first] to before near[end]; near[reach] is the beat itself.
  std::array<std::size_t, most_neighbours> near{};
  std::size_t first = reach, end = reach + 1;
  near[reach] = i;
  const auto look = [&](std::size_t away) {
    const auto good = [&](std::size_t k) { return beats_[k].flag == BeatFlag::good; };
    for (std::size_t k = near[first]; k-- > 0 && first > reach - away;)
      if (good(k)) near[--first] = k;
    for (std::size_t k = near[end - 1] + 1; k < beats_.size() && end < reach + 1 + away; ++k)
      if (good(k)) near[end++] = k;
  };
  const auto error_at = [&](std::size_t k) {
    const Beat &a = beats_[near[k - 1]], &b = beats_[near[k]], &c = beats_[near[k + 1]];
    if (c.cycle - a.cycle != 2) return 0.0;
    return 0.5 * ((b.time - a.time) - (c.time - b.time));
  };
  look(2);
  if (first + 2 > reach || end < reach + 3) return false;
  if (beats_[near[reach + 2]].cycle - beats_[near[reach - 2]].cycle != 4) return false;
  const double own = error_at(reach);
  const double least = 1e-4 * period_; // in a log without noise
  if (std::abs(own) < least) return false;
  look(reach);
  std::array<double, most_neighbours> sizes{};
  std::size_t count = 0;
  for (std::size_t k = first + 1; k + 1 < end; ++k)
    sizes[count++] = std::abs(error_at(k));
  // Twelve standard deviations of the errors nearby (a stretch may be noisier than the rest) are 18
  // of their median.
  if (std::abs(own) < 18.0 * median(std::span(sizes).first(count))) return false;
  const auto mirrored = [&](double neighbour) { return std::abs(neighbour / own + 0.5) < 0.2; };
  return mirrored(error_at(reach - 1)) && mirrored(error_at(reach + 1));
}

} // namespace goingrate
