#include "goingrate/log/beats.hpp"

#include "downward.hpp"
#include "gap_judge.hpp"
#include "goingrate/base/errors.hpp"
#include "numbering.hpp"

#include "base/robust.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace goingrate {

namespace {

// A gap of no more cycles is missed beats: nobody restarts a stopped clock so fast.
constexpr std::int64_t shortest_stop_cycles = 20;

void add_runs(SecondDifferences& differences, std::span<const Beat> beats,
              std::span<const std::size_t> resumed) {
  std::size_t from = 0;
  for (const std::size_t next : resumed) {
    differences.add(beats.subspan(from, next - from));
    from = next;
  }
  differences.add(beats.subspan(from));
}

// The places in a log where the numbering had to search for the beats again.
struct Resumed {
  std::vector<std::size_t> at; // first beats after such places, and of later blocks
  bool has_downward = false;
};

// The stretches in which time does not go back. A step back by less than half a period is left to
// the numbering: two events may be interchanged by jitter, or the reference was set.
std::vector<Stretch> blocks_of(std::span<const Beat> beats, double period_s) {
  std::vector<Stretch> blocks{{0, 0}};
  for (std::size_t i = 1; i < beats.size(); ++i)
    if (beats[i].time < beats[i - 1].time && beats[i - 1].time - beats[i].time > 0.5 * period_s) {
      blocks.back().last = i;
      blocks.push_back({i, i});
    }
  blocks.back().last = beats.size();
  return blocks;
}

Resumed number_blocks(std::span<Beat> beats, const TypicalPeriod& typical, const BeatNoise& noise,
                      double own_step_s = 0.0) {
  Resumed resumed;
  std::int64_t next_cycle = 0;
  for (const Stretch& block : blocks_of(beats, typical.mean_s)) {
    const std::span<Beat> part = beats.subspan(block.first, block.size());
    Numbering numbering(part, typical, noise, own_step_s);
    numbering.run();
    resumed.has_downward = resumed.has_downward || numbering.has_downward();
    const auto good = std::find_if(part.begin(), part.end(),
                                   [](const Beat& beat) { return beat.flag == BeatFlag::good; });
    if (next_cycle > 0 && good != part.end())
      resumed.at.push_back(block.first + static_cast<std::size_t>(good - part.begin()));
    for (const std::size_t i : numbering.resumed())
      resumed.at.push_back(block.first + i);
    if (next_cycle > 0)
      for (Beat& beat : part)
        beat.cycle += next_cycle;
    next_cycle = part.back().cycle + 1;
  }
  return resumed;
}

// The size of a step of the times that recurs: pushes of the clock's own, once in many swings. 0 if
// the beats were lost seldom, or by steps that differ.
double recurring_step(std::span<const Beat> beats, std::span<const std::size_t> resumed,
                      double period_s) {
  constexpr std::size_t fewest = 8;
  constexpr double most_scatter = 0.1; // of the step
  std::vector<double> steps;
  for (const std::size_t at : resumed) {
    std::size_t before = at;
    while (before > 0 && beats[--before].flag != BeatFlag::good) {
    }
    const double elapsed = beats[at].time - beats[before].time;
    steps.push_back(elapsed - period_s * std::round(elapsed / period_s));
  }
  if (steps.size() < fewest) return 0.0;
  const double usual = median(steps);
  return robust_sigma(steps) < most_scatter * std::abs(usual) ? std::abs(usual) : 0.0;
}

// The noise found from a first numbering of a bounded sample. The sample is numbered in place, and
// again later with the whole log.
BeatNoise sampled_noise(std::vector<Beat>& beats, const TypicalPeriod& typical) {
  SecondDifferences differences;
  for (const Stretch& stretch : sample_stretches(beats.size())) {
    const std::span<Beat> part(beats.data() + stretch.first, stretch.size());
    add_runs(differences, part, number_blocks(part, typical, rough_noise(typical)).at);
  }
  return at_least_finest(differences.fit(), typical);
}

std::int64_t longest_run(std::span<const Beat> beats, std::span<const std::size_t> resumed) {
  std::int64_t longest = 1;
  std::size_t from = 0;
  const auto take = [&](std::size_t to) {
    longest = std::max(longest, beats[to - 1].cycle - beats[from].cycle + 1);
    from = to;
  };
  for (const std::size_t next : resumed)
    take(next);
  take(beats.size());
  return longest;
}

// Second pass over a numbered log: counts the cycles in its gaps, and writes the segments and
// cycles that follow from the counts.
class GapPass {
public:
  GapPass(Beats& result, const std::vector<std::size_t>& resumed, const GapJudge& judge,
          double least_probability, double longest_absence, const std::string& source)
      : result_(result), resumed_(resumed), judge_(judge), least_probability_(least_probability),
        longest_absence_(longest_absence), source_(source),
        reach_(resumed.empty() ? result.beats.size() : resumed.front()) {}

  void run() {
    auto& beats = result_.beats;
    auto next_resumed = resumed_.begin();
    bool lost = false;
    for (std::size_t i = 0; i < beats.size(); ++i) {
      if (next_resumed != resumed_.end() && *next_resumed == i) {
        lost = true;
        ++next_resumed;
        reach_ = next_resumed == resumed_.end() ? beats.size() : *next_resumed;
      }
      Beat& beat = beats[i];
      if (beat.flag == BeatFlag::good) {
        if (last_ != none && (lost || beat.cycle + shift_ - beats[last_].cycle != 1))
          settle(i, lost);
        lost = false;
        last_ = i;
      }
      if (shift_ != 0) beat.cycle += shift_;
      beat.segment = segment_;
      result_.spurious += beat.flag == BeatFlag::spurious ? 1 : 0;
      result_.rivals += beat.flag == BeatFlag::rival ? 1 : 0;
      result_.bounces += beat.flag == BeatFlag::bounce ? 1 : 0;
    }
    result_.segments = segment_ + 1u;
  }

private:
  static constexpr std::size_t none = static_cast<std::size_t>(-1);

  void settle(std::size_t i, bool lost) {
    const Beat& before = result_.beats[last_];
    const std::int64_t guess = result_.beats[i].cycle + shift_ - before.cycle;
    const Gap gap = result_.beats[i].time < before.time
                        ? Gap{before.cycle, 0, 0.0, false, GapKind::restart}
                        : judged(i, lost || static_cast<double>(guess) > longest_absence_);
    shift_ += std::max<std::int64_t>(1, gap.length + 1) - guess;
    if (gap.bridged) {
      result_.missed += gap.length;
    } else {
      begin_segment(i);
    }
    result_.gaps.push_back(gap);
  }

  Gap judged(std::size_t i, bool lost) const {
    const auto& beats = result_.beats;
    const Beat& before = beats[last_];
    const GapCount count = judge_.count(beats, first_, last_, i, reach_, lost);
    if (count.reference_set) return {before.cycle, 0, 0.0, false, GapKind::step};
    Gap gap;
    gap.after_cycle = before.cycle;
    gap.probability = count.probability;
    const bool displaced = count.displaced;
    const double periods = (beats[i].time - before.time) / result_.typical_period_s;
    gap.length = displaced && periods < 2.0 ? 0 : count.cycles - 1;
    gap.kind = gap.length > shortest_stop_cycles ? (displaced ? GapKind::stop : GapKind::gap)
                                                 : (displaced ? GapKind::step : GapKind::missed);
    gap.bridged = gap.probability >= least_probability_ &&
                  (!lost || gap.length <= result_.longest_countable_gap);
    if (lost && gap.length == 0) gap.kind = GapKind::step;
    return gap;
  }

  void begin_segment(std::size_t i) {
    if (segment_ == std::numeric_limits<std::uint16_t>::max())
      throw InputError({source_, result_.beats[i].line, 1},
                       "more than 65536 segments: the beats cannot be followed",
                       "a log with longer steady stretches");
    ++segment_;
    first_ = i;
  }

  Beats& result_;
  const std::vector<std::size_t>& resumed_;
  const GapJudge& judge_;
  double least_probability_;
  double longest_absence_; // cycles
  const std::string& source_;
  std::size_t last_ = none;
  std::size_t first_ = 0; // beat of the segment
  std::size_t reach_;     // beats before this index are numbered consistently with the present one
  std::int64_t shift_ = 0;
  std::uint16_t segment_ = 0;
};

} // namespace

std::vector<Beat> Beats::longest_segment() const {
  std::vector<std::size_t> sizes(segments, 0);
  for (const Beat& beat : beats)
    if (beat.flag == BeatFlag::good) ++sizes[beat.segment];
  const auto best = std::max_element(sizes.begin(), sizes.end()) - sizes.begin();
  std::vector<Beat> chosen;
  chosen.reserve(sizes[static_cast<std::size_t>(best)]);
  for (const Beat& beat : beats)
    if (beat.flag == BeatFlag::good && beat.segment == best) chosen.push_back(beat);
  return chosen;
}

Beats number_beats(const ClockLog& log, const NumberingOptions& options) {
  return number_beats(std::vector<Beat>(log.events), log.source, options);
}

Beats number_beats(std::vector<Beat>&& events, const std::string& source,
                   const NumberingOptions& options) {
  Beats result;
  result.beats = std::move(events);
  const TypicalPeriod typical = typical_period(result.beats, source, options.nominal_period_s);
  result.typical_period_s = typical.mean_s;
  result.scatter_s = typical.scatter_s;
  const BeatNoise sampled = sampled_noise(result.beats, typical);
  Resumed resumed = number_blocks(result.beats, typical, sampled);
  const double own_step_s = recurring_step(result.beats, resumed.at, typical.mean_s);
  if (own_step_s > 0.0) resumed = number_blocks(result.beats, typical, sampled, own_step_s);
  SecondDifferences differences;
  add_runs(differences, result.beats, resumed.at);
  const BeatNoise noise = at_least_finest(differences.cautious_fit(), typical);
  const GapJudge judge(noise, typical.mean_s, longest_run(result.beats, resumed.at));
  result.longest_countable_gap = judge.longest_countable(options.least_probability);
  GapPass pass(result, resumed.at, judge, options.least_probability, longest_absence(typical),
               source);
  pass.run();
  result.has_downward = resumed.has_downward;
  if (resumed.has_downward) {
    for (const Stretch& block : blocks_of(result.beats, typical.mean_s))
      place_downward(std::span(result.beats).subspan(block.first, block.size()), typical.mean_s);
    const auto count = [&](BeatFlag flag) {
      return std::count_if(result.beats.begin(), result.beats.end(),
                           [flag](const Beat& beat) { return beat.flag == flag; });
    };
    result.spurious = count(BeatFlag::spurious);
    result.rivals = count(BeatFlag::rival);
  }
  return result;
}

Beats beats_on_grid(std::vector<Beat>&& events, const std::string& source) {
  constexpr std::size_t fewest_values = 3;
  if (events.size() < fewest_values)
    throw InputError({source, 1, 1}, fmt::format("{} values", events.size()),
                     fmt::format("at least {}", fewest_values));
  Beats result;
  result.beats = std::move(events);
  const auto& beats = result.beats;
  std::vector<double> periods;
  for (std::size_t i = 1; i < beats.size(); ++i) {
    const double elapsed = beats[i].time - beats[i - 1].time;
    if (!(elapsed > 0.0))
      throw InputError(
          {source, beats[i].line, 1},
          "a clock error that grows by more than the interval, so that the clock goes back",
          "errors of a clock that goes forward");
    const std::int64_t cycles = beats[i].cycle - beats[i - 1].cycle;
    periods.push_back(elapsed / static_cast<double>(cycles));
    if (cycles == 1) continue;
    const GapKind kind = cycles - 1 > shortest_stop_cycles ? GapKind::gap : GapKind::missed;
    result.gaps.push_back({beats[i - 1].cycle, cycles - 1, 1.0, true, kind});
    result.missed += cycles - 1;
  }
  result.typical_period_s = (beats.back().time - beats.front().time) /
                            static_cast<double>(beats.back().cycle - beats.front().cycle);
  for (double& period : periods)
    period = std::abs(period - result.typical_period_s);
  result.scatter_s = 1.4826 * median(periods); // sigma of a normal deviate with this median
  return result;
}

void count_swings(std::int64_t step, Beats& numbered) {
  numbered.step = step;
  if (step == 1) return;
  for (Beat& beat : numbered.beats)
    beat.cycle *= step;
  for (Gap& gap : numbered.gaps) {
    gap.after_cycle *= step;
    gap.length *= step;
  }
  numbered.typical_period_s /= static_cast<double>(step);
  numbered.scatter_s /= static_cast<double>(step);
}

std::int64_t cycle_at(std::span<const Beat> beats, double time_s) {
  for (const Beat& beat : beats)
    if (beat.time - beats.front().time >= time_s) return beat.cycle - beats.front().cycle;
  return beats.back().cycle - beats.front().cycle;
}

std::string_view name_of(BeatFlag flag) {
  switch (flag) {
  case BeatFlag::spurious:
    return "spurious";
  case BeatFlag::down:
    return "down";
  case BeatFlag::rival:
    return "rival";
  case BeatFlag::bounce:
    return "bounce";
  case BeatFlag::good:
    break;
  }
  return "";
}

std::string_view name_of(GapKind kind) {
  switch (kind) {
  case GapKind::missed:
    return "missed";
  case GapKind::gap:
    return "gap";
  case GapKind::step:
    return "step";
  case GapKind::restart:
    return "restart";
  case GapKind::stop:
    break;
  }
  return "stop";
}

} // namespace goingrate
