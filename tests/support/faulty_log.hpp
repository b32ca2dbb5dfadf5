// Logs with faults whose truth is known event by event, and the score of their numbering.
#pragma once

#include "goingrate/base/random.hpp"
#include "goingrate/log/beats.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace goingrate::test {

/// What an event is in truth.
struct TrueEvent {
  std::int64_t cycle = 0; ///< -1 - cycle for a false event in that cycle
  int epoch = 0;          ///< grows by one where the count is not defined: at a stop
  bool unseen = false;    ///< false event in a cycle whose own crossing was missed
};

struct FaultyLog {
  ClockLog log;
  std::vector<TrueEvent> truth; ///< one for each event
  double jitter = 0.0;          ///< of the period
};

/// A random log of 800 to 12,000 periods. Missed U(0, 10 %), false U(0, 10 %) (half of them within
/// 2 % of a period after a beat that was seen), jitter log-uniform 1e-7 to 1e-2 of the period,
/// noise of the rate log-uniform 1e-8 to 1e-3, its random walk 1e-10 to 1e-6 per cycle; up to three
/// gaps of 1 to 5000 periods (log-uniform); in three logs of ten a ramp of the rate of up to 1e-3
/// over the log, a step of the rate of up to 1e-3, a stop of 20 to 5000 periods that ends at any
/// phase, a step of the reference by up to half a period; in one of four both directions.
class FaultyLogMaker {
public:
  explicit FaultyLogMaker(std::uint64_t seed)
      : noise_(seed, StreamPurpose::jitter), faults_(seed, StreamPurpose::missed) {}

  FaultyLog make() {
    draw_clock();
    double time = 0.0, walk = 0.0;
    for (std::int64_t n = 0; n < periods_; ++n) {
      const double share = static_cast<double>(n) / static_cast<double>(periods_);
      if (n == stop_at_) {
        time += log_uniform(20.0, 5000.0) * period_ + faults_.uniform() * period_;
        ++epoch_;
      }
      if (n == reference_at_) time += (faults_.uniform() - 0.5) * period_;
      walk += rate_walk_ * noise_.normal();
      const double rate =
          walk + ramp_ * share + (n >= rate_at_ ? rate_step_ : 0.0) + rate_noise_ * noise_.normal();
      cycle(n, time, period_ * (1.0 + rate));
      time += period_ * (1.0 + rate);
    }
    return finished();
  }

private:
  struct Event {
    double time;
    Edge edge;
    TrueEvent truth;
  };

  double log_uniform(double low, double high) {
    return low * std::exp(std::log(high / low) * faults_.uniform());
  }
  bool with_chance(double chance) { return faults_.uniform() < chance; }
  std::int64_t somewhere() {
    return static_cast<std::int64_t>((0.05 + 0.9 * faults_.uniform()) *
                                     static_cast<double>(periods_));
  }

  void draw_clock() {
    periods_ = static_cast<std::int64_t>(log_uniform(800.0, 12000.0));
    period_ = log_uniform(0.5, 4.0);
    missed_ = 0.1 * faults_.uniform();
    false_ = 0.1 * faults_.uniform();
    jitter_ = log_uniform(1e-7, 1e-2);
    rate_noise_ = log_uniform(1e-8, 1e-3);
    rate_walk_ = log_uniform(1e-10, 1e-6);
    both_ = with_chance(0.25);
    middle_ = 0.5 + 0.1 * (faults_.uniform() - 0.5);
    if (with_chance(0.3)) ramp_ = 2e-3 * (faults_.uniform() - 0.5);
    if (with_chance(0.3)) {
      rate_at_ = somewhere();
      rate_step_ = 2e-3 * (faults_.uniform() - 0.5);
    }
    if (with_chance(0.3)) stop_at_ = somewhere();
    if (with_chance(0.3)) reference_at_ = somewhere();
    const auto gaps = static_cast<std::size_t>(4.0 * faults_.uniform());
    for (std::size_t k = 0; k < gaps; ++k) {
      const std::int64_t from = somewhere();
      gaps_.push_back({from, from + static_cast<std::int64_t>(log_uniform(1.0, 5000.0))});
      periods_ += gaps_.back()[1] - from; // the gap does not eat the log
    }
  }

  bool in_gap(std::int64_t n) const {
    return std::any_of(gaps_.begin(), gaps_.end(),
                       [&](const auto& gap) { return n >= gap[0] && n < gap[1]; });
  }

  void crossing(std::int64_t n, double time, Edge edge) {
    const bool seen = !with_chance(missed_);
    if (seen) add(time + jitter_ * period_ * noise_.normal(), edge, {n, epoch_, false});
    if (!with_chance(false_)) return;
    const bool bounce = with_chance(0.5);
    if (bounce && !seen) return; // what was not seen does not bounce
    const double delay = bounce ? 0.02 * faults_.uniform() : faults_.uniform();
    add(time + delay * period_, edge, {-1 - n, epoch_, !seen});
  }

  void cycle(std::int64_t n, double time, double period) {
    if (in_gap(n)) return;
    crossing(n, time, Edge::up);
    if (both_) crossing(n, time + middle_ * period, Edge::down);
  }

  void add(double time, Edge edge, const TrueEvent& truth) {
    events_.push_back({time, edge, truth});
  }

  FaultyLog finished() {
    std::stable_sort(events_.begin(), events_.end(),
                     [](const Event& a, const Event& b) { return a.time < b.time; });
    FaultyLog result;
    result.log.source = "faulty";
    result.jitter = jitter_;
    for (const Event& event : events_) {
      const auto line = static_cast<std::uint32_t>(result.truth.size() + 1);
      result.log.events.push_back(event_at(Instant::from_seconds(event.time), event.edge, line));
      result.truth.push_back(event.truth);
    }
    return result;
  }

  RandomStream noise_, faults_;
  std::int64_t periods_ = 0, stop_at_ = -1, reference_at_ = -1, rate_at_ = 0;
  double period_ = 2.0, missed_ = 0.0, false_ = 0.0, jitter_ = 0.0, rate_noise_ = 0.0,
         rate_walk_ = 0.0, middle_ = 0.5, ramp_ = 0.0, rate_step_ = 0.0;
  bool both_ = false;
  int epoch_ = 0;
  std::vector<std::array<std::int64_t, 2>> gaps_;
  std::vector<Event> events_;
};

/// Counts over many logs.
struct NumberingScore {
  std::int64_t logs = 0, events = 0, good = 0, right = 0, wrong = 0, bad = 0, rival = 0;
  std::int64_t false_events = 0, accepted = 0, missed_accepted = 0;
  std::int64_t downs = 0, downs_right = 0, downs_bad = 0;
  std::int64_t logs_wrong = 0, segments = 0, breaks = 0, stops_bridged = 0;
  struct Bin {
    std::int64_t gaps = 0, right = 0, stops = 0;
    double claimed = 0.0;
  };
  /// Gaps longer than 8 cycles by claimed probability: < 0.5, < 0.9, < 0.99, < 0.999, up to 1.
  std::array<Bin, 5> bins{};
};

/// Compares a numbering with the truth. A crossing is numbered right if its cycle differs from the
/// truth by what most of its segment's beats do; across a stop no count is right.
class NumberingJudge {
public:
  void add(const FaultyLog& made, const Beats& numbered) {
    ++score_.logs;
    score_.segments += numbered.segments;
    const auto offsets = usual_offsets(made, numbered);
    const std::int64_t wrong_before = score_.wrong;
    for (std::size_t i = 0; i < made.truth.size(); ++i)
      event(made.truth[i], numbered.beats[i], offsets[numbered.beats[i].segment]);
    if (score_.wrong > wrong_before) ++score_.logs_wrong;
    gaps(made, numbered);
  }

  [[nodiscard]] const NumberingScore& score() const { return score_; }

private:
  struct Offset {
    int epoch = 0;
    std::int64_t cycles = 0;
    bool operator==(const Offset&) const = default;
    auto operator<=>(const Offset&) const = default;
  };

  static std::vector<Offset> usual_offsets(const FaultyLog& made, const Beats& numbered) {
    std::vector<std::vector<Offset>> all(numbered.segments);
    for (std::size_t i = 0; i < made.truth.size(); ++i)
      if (numbered.beats[i].flag == BeatFlag::good && made.truth[i].cycle >= 0)
        all[numbered.beats[i].segment].push_back(
            {made.truth[i].epoch, numbered.beats[i].cycle - made.truth[i].cycle});
    std::vector<Offset> usual(numbered.segments);
    for (std::size_t s = 0; s < all.size(); ++s) {
      std::sort(all[s].begin(), all[s].end());
      std::size_t most = 0;
      for (std::size_t from = 0; from < all[s].size();) {
        const auto to = static_cast<std::size_t>(
            std::upper_bound(all[s].begin(), all[s].end(), all[s][from]) - all[s].begin());
        if (to - from > most) {
          most = to - from;
          usual[s] = all[s][from];
        }
        from = to;
      }
    }
    return usual;
  }

  void event(const TrueEvent& truth, const Beat& beat, const Offset& usual) {
    ++score_.events;
    const bool down = beat.edge == Edge::down;
    const bool taken = beat.flag == BeatFlag::good || beat.flag == BeatFlag::down;
    if (truth.cycle < 0) {
      ++score_.false_events;
      if (taken && !down) (truth.unseen ? score_.missed_accepted : score_.accepted) += 1;
      return;
    }
    const bool right = Offset{truth.epoch, beat.cycle - truth.cycle} == usual;
    if (down) {
      ++score_.downs;
      score_.downs_right += taken && right ? 1 : 0;
      score_.downs_bad += beat.flag == BeatFlag::spurious || beat.flag == BeatFlag::bounce ? 1 : 0;
      return;
    }
    ++score_.good;
    if (beat.flag == BeatFlag::spurious || beat.flag == BeatFlag::bounce)
      ++score_.bad;
    else if (beat.flag == BeatFlag::rival)
      ++score_.rival;
    else
      (right ? score_.right : score_.wrong) += 1;
  }

  // Each gap of more than eight cycles: was the count right between the true beats around it?
  void gaps(const FaultyLog& made, const Beats& numbered) {
    std::size_t before = made.truth.size(), gap = 0;
    for (std::size_t i = 0; i < made.truth.size(); ++i) {
      if (numbered.beats[i].flag != BeatFlag::good) continue;
      const bool at_gap = before < i && gap < numbered.gaps.size() &&
                          numbered.gaps[gap].after_cycle == numbered.beats[before].cycle;
      if (at_gap) {
        const Gap& judged = numbered.gaps[gap++];
        if (judged.length > 8 && made.truth[i].cycle >= 0 && made.truth[before].cycle >= 0)
          judge(judged, made.truth[before], made.truth[i]);
      }
      before = i;
    }
  }

  void judge(const Gap& gap, const TrueEvent& before, const TrueEvent& after) {
    const bool right = before.epoch == after.epoch && after.cycle - before.cycle == gap.length + 1;
    const double p = gap.probability;
    auto& bin = score_.bins[p < 0.5 ? 0 : p < 0.9 ? 1 : p < 0.99 ? 2 : p < 0.999 ? 3 : 4];
    ++bin.gaps;
    bin.right += right ? 1 : 0;
    bin.claimed += p;
    if (before.epoch != after.epoch) {
      ++score_.breaks;
      ++bin.stops;
      score_.stops_bridged += gap.bridged ? 1 : 0;
    }
  }

  NumberingScore score_;
};

} // namespace goingrate::test
