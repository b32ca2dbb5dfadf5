#include "goingrate/log/beats.hpp"

#include "downward.hpp"
#include "gap_judge.hpp"
#include "goingrate/base/errors.hpp"
#include "numbering.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace goingrate {

namespace {

// No one notices that a clock stopped and sets it going again within so many beats.
constexpr std::int64_t shortest_stop = 20;

void add_runs(SecondDifferences& differences, std::span<const Beat> beats,
              std::span<const std::size_t> resumed) {
  std::size_t from = 0;
  for (const std::size_t next : resumed) {
    differences.add(beats.subspan(from, next - from));
    from = next;
  }
  differences.add(beats.subspan(from));
}

// The noise as a first numbering of a bounded sample shows it. A log that is its own sample is
// numbered in place, and again later.
BeatNoise sampled_noise(std::vector<Beat>& beats, const TypicalPeriod& typical) {
  SecondDifferences differences;
  for (const Stretch& stretch : sample_stretches(beats.size())) {
    const std::span<Beat> part(beats.data() + stretch.first, stretch.size());
    Numbering numbering(part, typical, rough_noise(typical));
    numbering.run();
    add_runs(differences, part, numbering.resumed());
  }
  return at_least_finest(differences.fit(), typical.mean_s);
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

// Second pass over a numbered log: counts its gaps, and writes the segments and the cycles that
// follow from the counts.
class GapPass {
public:
  GapPass(Beats& result, const std::vector<std::size_t>& resumed, const GapJudge& judge,
          double least_probability, const std::string& source)
      : result_(result), resumed_(resumed), judge_(judge), least_probability_(least_probability),
        source_(source), reach_(resumed.empty() ? result.beats.size() : resumed.front()) {}

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
    }
    result_.segments = segment_ + 1u;
  }

private:
  static constexpr std::size_t none = static_cast<std::size_t>(-1);

  void settle(std::size_t i, bool lost) {
    auto& beats = result_.beats;
    const Beat& before = beats[last_];
    const std::int64_t guess = beats[i].cycle + shift_ - before.cycle;
    const GapCount count = judge_.count(beats, first_, last_, i, reach_, lost);
    Gap gap;
    gap.after_cycle = before.cycle;
    gap.probability = count.probability;
    gap.bridged = gap.probability >= least_probability_;
    const bool displaced = count.displaced;
    const double periods = (beats[i].time - before.time) / result_.typical_period_s;
    gap.length = displaced && periods < 2.0 ? 0 : count.cycles - 1;
    gap.kind = gap.length > shortest_stop ? (displaced ? GapKind::stop : GapKind::gap)
                                          : (displaced ? GapKind::step : GapKind::missed);
    if (lost && gap.length == 0) gap.kind = GapKind::step;
    shift_ += std::max<std::int64_t>(1, gap.length + 1) - guess;
    if (gap.bridged) {
      result_.missed += gap.length;
    } else {
      begin_segment(i);
    }
    result_.gaps.push_back(gap);
  }

  void begin_segment(std::size_t i) {
    if (segment_ == std::numeric_limits<std::uint16_t>::max())
      throw InputError({source_, result_.beats[i].line, 1},
                       "more than 65536 segments: the beats are lost again and again",
                       "a log that is steady for some beats in most places");
    ++segment_;
    first_ = i;
  }

  Beats& result_;
  const std::vector<std::size_t>& resumed_;
  const GapJudge& judge_;
  double least_probability_;
  const std::string& source_;
  std::size_t last_ = none;
  std::size_t first_ = 0; // of the segment
  std::size_t reach_;     // beats before this index are on one numbering with the present one
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
  const TypicalPeriod typical = typical_period(result.beats, source);
  result.typical_period_s = typical.mean_s;
  result.scatter_s = typical.scatter_s;
  Numbering numbering(result.beats, typical, sampled_noise(result.beats, typical));
  numbering.run();
  SecondDifferences differences;
  add_runs(differences, result.beats, numbering.resumed());
  const BeatNoise noise = at_least_finest(differences.cautious_fit(), typical.mean_s);
  const GapJudge judge(noise, typical.mean_s, longest_run(result.beats, numbering.resumed()));
  result.longest_countable_gap = judge.longest_countable(options.least_probability);
  GapPass pass(result, numbering.resumed(), judge, options.least_probability, source);
  pass.run();
  if (numbering.has_downward()) {
    place_downward(result.beats, typical.mean_s);
    const auto count = [&](BeatFlag flag) {
      return std::count_if(result.beats.begin(), result.beats.end(),
                           [flag](const Beat& beat) { return beat.flag == flag; });
    };
    result.spurious = count(BeatFlag::spurious);
    result.rivals = count(BeatFlag::rival);
  }
  return result;
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
  case GapKind::stop:
    break;
  }
  return "stop";
}

} // namespace goingrate
