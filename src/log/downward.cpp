#include "downward.hpp"

#include "goingrate/log/beats.hpp"
#include "typical_period.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace goingrate {

namespace {

constexpr double widest_gate = 0.25;      // periods about the usual place: less than half-way to up
constexpr double decisive_log_odds = 4.6; // a hundred to one
constexpr double follow_share = 0.02; // over fifty cycles: a falling swing shifts the place slowly
constexpr std::size_t fewest_misfits = 7; // in a row

// Usual place of downward crossings, as a fraction of a period after the upward one.
struct Middle {
  double at = 0.5;
  double sigma = 0.01;
  double tolerance = 0.05;
};

double fraction_of(double periods) { return periods - std::floor(periods); }

Middle typical_middle(std::span<const Beat> beats, double period_s) {
  std::vector<double> fractions;
  for (const Stretch& stretch : sample_stretches(beats.size())) {
    const Beat* last = nullptr;
    for (const Beat& beat : beats.subspan(stretch.first, stretch.size())) {
      if (beat.flag == BeatFlag::good) last = &beat;
      if (beat.flag == BeatFlag::down && last != nullptr)
        fractions.push_back(fraction_of((beat.time - last->time) / period_s));
    }
  }
  if (fractions.empty()) return {};
  Middle middle;
  middle.at = median(fractions);
  for (double& fraction : fractions)
    fraction = std::abs(fraction - middle.at);
  const double half = median(fractions);
  constexpr double finest_share = 1e-9; // of a period, as for upward crossings
  middle.sigma = std::max(1.4826 * half, finest_share);
  // Eight standard deviations (12 median deviations), at least 1 % of a period and always less than
  // a quarter: an upward crossing taken for a downward one is off by half a period.
  middle.tolerance = std::clamp(12.0 * half, 0.01, 0.2);
  return middle;
}

class DownwardNumbering {
public:
  DownwardNumbering(std::span<Beat> beats, double period_s)
      : beats_(beats), period_(period_s), swing_s_(period_s),
        middle_(typical_middle(beats, period_s)) {
    for (std::size_t i = 0; i < beats.size() && up_ == none; ++i)
      if (beats[i].flag == BeatFlag::good) up_ = i;
  }

  void run() {
    for (std::size_t i = 0; i < beats_.size() && up_ != none; ++i) {
      if (beats_[i].flag == BeatFlag::good) begin_swing(i);
      const bool bounces = beats_[i].flag == BeatFlag::bounce;
      if (!bounces) edge_ = i;
      if (beats_[i].edge == Edge::down && !bounces) place(i);
      // An event marked as a bounce may be the crossing, if the edge before it was a false event.
      if (beats_[i].edge == Edge::down && bounces && edge_ != none &&
          beats_[edge_].flag == BeatFlag::spurious) {
        place(i);
        if (beats_[i].flag == BeatFlag::spurious) beats_[i].flag = BeatFlag::bounce;
      }
    }
  }

private:
  static constexpr std::size_t none = static_cast<std::size_t>(-1);

  // The swings of a ring-down from a wide angle begin some per cent longer than the usual one.
  void begin_swing(std::size_t i) {
    constexpr double largest_difference = 0.1; // of the period: beyond, the times were displaced
    up_ = i;
    swing_s_ = period_;
    std::size_t next = i + 1;
    while (next < beats_.size() && beats_[next].flag != BeatFlag::good)
      ++next;
    if (next == beats_.size()) return;
    const double swing_s = (beats_[next].time - beats_[i].time) /
                           static_cast<double>(beats_[next].cycle - beats_[i].cycle);
    if (std::abs(swing_s / period_ - 1.0) < largest_difference) swing_s_ = swing_s;
  }

  void place(std::size_t i) {
    Beat& beat = beats_[i];
    const double since = (beat.time - beats_[up_].time) / swing_s_ - middle_.at;
    const double whole = std::round(since);
    const double off = since - whole;
    beat.cycle = beats_[up_].cycle + static_cast<std::int64_t>(std::clamp(whole, -1e15, 1e15));
    beat.segment = beats_[up_].segment;
    // Where upward crossings are missing, the predicted place is less certain.
    const double allowed =
        std::min(widest_gate, middle_.tolerance * std::sqrt(std::max(1.0, whole + 1.0)));
    if (std::abs(off) > allowed) return misfit(i, off);
    misfits_.clear();
    settle(i, off);
  }

  // Takes a downward crossing that fits. If there are two in one cycle, the one nearer to the usual
  // place is kept; the other is a rival, or spurious if a hundred times less likely, as with upward
  // crossings.
  void settle(std::size_t i, double off) {
    beats_[i].flag = BeatFlag::down;
    if (down_ != none && beats_[down_].cycle == beats_[i].cycle) {
      const bool nearer = std::abs(off) < std::abs(off_);
      const double log_odds =
          0.5 * std::abs(off * off - off_ * off_) / (middle_.sigma * middle_.sigma);
      beats_[nearer ? down_ : i].flag =
          log_odds < decisive_log_odds ? BeatFlag::rival : BeatFlag::spurious;
      if (!nearer) return;
    }
    down_ = i;
    off_ = off;
    middle_.at += follow_share * off;
  }

  // Successive misfits that agree with each other mean that the beat error has changed.
  void misfit(std::size_t i, double off) {
    beats_[i].flag = BeatFlag::spurious;
    misfits_.push_back({i, off});
    if (misfits_.size() < fewest_misfits) return;
    const auto [low, high] =
        std::minmax_element(misfits_.begin(), misfits_.end(),
                            [](const Misfit& a, const Misfit& b) { return a.off < b.off; });
    if (high->off - low->off > middle_.tolerance) {
      misfits_.erase(misfits_.begin());
      return;
    }
    middle_.at = fraction_of(middle_.at + 0.5 * (low->off + high->off));
    for (const Misfit& one : misfits_)
      beats_[one.index].flag = BeatFlag::down;
    misfits_.clear();
  }

  struct Misfit {
    std::size_t index;
    double off;
  };

  std::span<Beat> beats_;
  double period_;  // the usual one
  double swing_s_; // of the swing at hand
  Middle middle_;
  std::size_t up_ = none, down_ = none; // the last upward and downward crossings
  std::size_t edge_ = none;             // the last event that is not a bounce
  double off_ = 0.0;                    // of the last downward crossing
  std::vector<Misfit> misfits_;
};

// Whether intervals alternate: successive ones lie on opposite sides of the median, every other one
// on the same side, at nearly the same distance. Jitter alone gives correlations of -1/2 and 0. A
// NaN separates stretches.
bool intervals_alternate(const std::vector<double>& steps, double centre) {
  const double widest = 0.45 * centre; // a clock further out of beat than this does not run
  std::vector<double> sizes;
  for (const double step : steps)
    if (std::abs(step - centre) <= widest) sizes.push_back(std::abs(step - centre));
  if (sizes.empty()) return false;
  // A false event makes steps of any size, so deviations are limited to twice the usual one.
  const double most = 2.0 * median(sizes);
  const auto off = [&](std::size_t i) { return std::clamp(steps[i] - centre, -most, most); };
  double variance = 0.0, next = 0.0, second = 0.0;
  for (std::size_t i = 0; i + 2 < steps.size(); ++i) {
    const auto is_step = [&](std::size_t k) { return std::abs(steps[k] - centre) <= widest; };
    if (!(is_step(i) && is_step(i + 1) && is_step(i + 2))) continue;
    variance += off(i) * off(i);
    next += off(i) * off(i + 1);
    second += off(i) * off(i + 2);
  }
  return variance > 0.0 && next < -0.75 * variance && second > 0.75 * variance;
}

// Steps from one event to the next, and sums of two successive steps; bounces are skipped. `single`
// has a NaN where a stretch of the sample ends.
struct Steps {
  std::vector<double> single, pairs;
};

Steps steps_of(std::span<const Beat> events) {
  Steps steps;
  for (const Stretch& stretch : sample_stretches(events.size())) {
    const Beat *before = nullptr, *last = nullptr;
    for (const Beat& event : events.subspan(stretch.first, stretch.size())) {
      if (event.flag == BeatFlag::bounce) continue;
      if (last != nullptr) steps.single.push_back(event.time - last->time);
      if (before != nullptr) steps.pairs.push_back(event.time - before->time);
      before = std::exchange(last, &event);
    }
    steps.single.push_back(std::numeric_limits<double>::quiet_NaN());
  }
  return steps;
}

// Half the period, if the steps show that both directions are in the log: many are an odd number of
// half periods, and nearly all are a whole number of them, even where events are missing. The mean
// is taken from the log itself, as a beat error cancels in it.
std::optional<double> half_period(const std::vector<double>& steps, double period_s) {
  double all = 0.0, odd = 0.0, whole = 0.0, sum = 0.0, single = 0.0;
  constexpr double largest_beat_error = 0.1; // periods; larger ones are not considered
  for (const double step : steps) {
    if (!(step >= 0.0)) continue;
    const double halves = std::round(2.0 * step / period_s);
    ++all;
    if (halves < 1.0 || std::abs(step / period_s - 0.5 * halves) > largest_beat_error) continue;
    ++whole;
    if (std::fmod(halves, 2.0) == 1.0) ++odd;
    if (halves == 1.0) {
      sum += step;
      ++single;
    }
  }
  if (!(odd > 0.25 * all && whole > 0.7 * all)) return {}; // random steps give 0.2 and 0.4
  constexpr double fewest_singles = 20.0;
  const double mean = single > fewest_singles ? sum / single : 0.5 * period_s;
  return std::abs(2.0 * mean / period_s - 1.0) < 0.02 ? mean : 0.5 * period_s;
}

// Counts half swings. An event in the midst of one is a false one, from which the next is counted
// only if that does not fit the event before either: the times may have been displaced.
class HalfSwings {
public:
  explicit HalfSwings(double half_s) : half_s_(half_s) {}

  std::int64_t at(const Beat& event) {
    if (event.flag == BeatFlag::bounce) return last_.count;
    const Place from_last = place(event, last_);
    if (from_last.fits) return accept(event, from_last.count);
    const Place from_stray = place(event, stray_);
    if (stray_.event != nullptr && from_stray.fits) return accept(event, from_stray.count);
    stray_ = {&event, from_last.count};
    return from_last.count;
  }

private:
  struct Counted {
    const Beat* event = nullptr;
    std::int64_t count = 0;
  };
  struct Place {
    std::int64_t count;
    bool fits;
  };

  [[nodiscard]] Place place(const Beat& event, const Counted& from) const {
    const double halves = from.event == nullptr ? 0.0 : (event.time - from.event->time) / half_s_;
    if (!(std::abs(halves) < 1e15)) return {from.count, true};
    constexpr double largest_beat_error = 0.3; // half swings; a clock runs with less
    const double whole = std::round(halves);
    return {from.count + static_cast<std::int64_t>(whole),
            std::abs(halves - whole) <= largest_beat_error};
  }

  std::int64_t accept(const Beat& event, std::int64_t count) {
    last_ = {&event, count};
    stray_ = {};
    return count;
  }

  double half_s_;
  Counted last_, stray_;
};

} // namespace

void place_downward(std::span<Beat> beats, double period_s) {
  DownwardNumbering(beats, period_s).run();
}

bool label_alternate_edges(ClockLog& log, bool certain, std::optional<double> nominal_period_s) {
  const auto is_down = [](const Beat& event) { return event.edge == Edge::down; };
  if (std::any_of(log.events.begin(), log.events.end(), is_down) || log.events.size() < 8)
    return false;
  Steps steps = steps_of(log.events);
  if (steps.pairs.empty()) return false;
  const auto given = nominal_period_s ? half_period(steps.single, *nominal_period_s) : std::nullopt;
  const double half =
      given ? *given : 0.5 * median(steps.pairs); // the beat error cancels in a pair
  const bool known = certain || given;
  if (!(half > 0.0) || !(known || intervals_alternate(steps.single, half))) return false;
  constexpr double least_whole = 0.75; // of a period: nearer to one than to the half
  if (!known && nominal_period_s && half > least_whole * *nominal_period_s) {
    // As with an impulse every second swing, which displaces the crossings after it.
    log.assumptions.push_back(
        {"the intervals alternate, but each is about a whole number of nominal periods, so every "
         "event is taken as a crossing in the same direction; if both directions are in the log, "
         "the nominal period is twice as long"});
    return false;
  }
  HalfSwings count(half);
  for (Beat& event : log.events)
    event.edge = count.at(event) % 2 == 0 ? Edge::up : Edge::down;
  log.assumptions.push_back(
      {known ? "both directions are in the log: every other event is a downward crossing"
             : "the intervals alternate, so both directions are in the log: every other event is "
               "taken as a downward crossing"});
  return true;
}

} // namespace goingrate
