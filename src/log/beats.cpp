#include "goingrate/log/beats.hpp"

#include "goingrate/base/errors.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace goingrate {

namespace {

constexpr double normal_from_mad = 1.4826; // standard deviation over median absolute deviation

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<double> differences(const std::vector<Beat>& beats) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < beats.size(); ++i)
    steps.push_back(beats[i].time - beats[i - 1].time);
  return steps;
}

struct TypicalPeriod {
  double mean = 0.0;
  double scatter = 0.0;
  double gain = 1.0; // how far the foreseen time should follow one beat, see follower_gain
};

// A jittery sensor asks for an average over many beats, a wandering clock for the last beat alone.
// Jitter j makes neighbouring periods anticorrelated (covariance -j^2), wander w adds w^2 to their
// variance; from both comes the steady gain of the Kalman filter of a random walk seen through
// jitter.
double follower_gain(double variance, double covariance) {
  const double j2 = std::max(0.0, -covariance);
  const double w2 = std::max(0.0, variance - 2.0 * j2);
  const double predicted = 0.5 * (w2 + std::sqrt(w2 * w2 + 4.0 * w2 * j2));
  if (!(predicted + j2 > 0.0)) return 1.0;            // no noise at all
  return std::max(0.1, predicted / (predicted + j2)); // never so lazy that a change of rate is lost
}

// Missed and spurious events put differences far from the bulk; the median sits inside it.
TypicalPeriod typical_period(const std::vector<Beat>& beats, const std::string& source) {
  auto steps = differences(beats);
  std::vector<double> sorted = steps;
  const double centre = median(sorted);
  if (!(centre > 0.0))
    throw InputError({source, beats[1].line, 1}, "two events at one time in most places",
                     "times that increase");
  const double widest = 0.1 * centre; // 2 % jitter, five times over
  double sum = 0.0, variance = 0.0, covariance = 0.0;
  double pairs = 0.0;
  std::vector<double> deviations;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const double deviation = steps[i] - centre;
    if (std::abs(deviation) > widest) continue;
    sum += deviation;
    variance += deviation * deviation;
    deviations.push_back(std::abs(deviation));
    if (i == 0 || std::abs(steps[i - 1] - centre) > widest) continue;
    covariance += deviation * (steps[i - 1] - centre);
    ++pairs;
  }
  const auto count = static_cast<double>(deviations.size());
  const double gain = follower_gain(variance / count, pairs > 0.0 ? covariance / pairs : 0.0);
  return {centre + sum / count, normal_from_mad * median(deviations), gain};
}

// Foresees crossings from the beats so far.
class Tracker {
public:
  Tracker(const TypicalPeriod& typical, double tolerance)
      : period_(typical.mean), tolerance_(tolerance), least_gain_(typical.gain) {}

  struct Guess {
    std::int64_t cycles; // since the last beat
    double error;        // s, observed minus foreseen
  };

  void start(const Instant& time, std::int64_t cycle) {
    anchor_ = time;
    cycle_ = cycle;
    since_start_ = 0;
  }

  [[nodiscard]] Guess guess(const Instant& time) const {
    const double elapsed = time - anchor_;
    const double periods = elapsed / period_;
    if (!(std::abs(periods) < 1e15)) return {0, elapsed}; // no count a double could hold
    const auto cycles = static_cast<std::int64_t>(std::llround(periods));
    return {cycles, elapsed - static_cast<double>(cycles) * period_};
  }

  // Over a long absence the period may have changed: allow the tolerance to grow to a quarter beat.
  [[nodiscard]] bool fits(const Guess& guess) const {
    const double growth = std::sqrt(static_cast<double>(std::max<std::int64_t>(guess.cycles, 1)));
    return std::abs(guess.error) <= std::min(tolerance_ * growth, 0.25 * period_);
  }

  // The anchor follows the beats with a gain that begins as an average and settles at the least
  // one.
  void follow(const Instant& time, const Guess& guess) {
    ++since_start_;
    const double gain = std::max(least_gain_, 1.0 / static_cast<double>(since_start_ + 1));
    anchor_ = time + -(1.0 - gain) * guess.error;
    cycle_ += guess.cycles;
    const double rate_gain = std::min(gain * gain, 0.01);
    period_ +=
        rate_gain * guess.error / static_cast<double>(std::max<std::int64_t>(guess.cycles, 1));
  }

  [[nodiscard]] std::int64_t cycle() const { return cycle_; }
  [[nodiscard]] double period() const { return period_; }

private:
  double period_;
  double tolerance_;
  double least_gain_;
  Instant anchor_;
  std::int64_t cycle_ = 0;
  int since_start_ = 0;
};

// The first event that begins a run of three consecutive periods; events before it are spurious.
std::size_t first_steady(const std::vector<Beat>& beats, std::size_t from, double period,
                         double tolerance) {
  for (std::size_t i = from; i + 3 < beats.size(); ++i) {
    bool steady = true;
    for (std::size_t k = i; k < i + 3 && steady; ++k)
      steady = std::abs(beats[k + 1].time - beats[k].time - period) < tolerance;
    if (steady) return i;
  }
  return beats.size();
}

class Numbering {
public:
  Numbering(std::vector<Beat>& beats, const TypicalPeriod& typical)
      : beats_(beats), typical_(typical),
        // Ten standard deviations of a period, at least 1 % (a fraction of any beat error), never
        // so much that a double trigger could pass.
        tolerance_(std::clamp(10.0 * typical.scatter, 0.01 * typical.mean, 0.2 * typical.mean)),
        tracker_(typical, tolerance_) {}

  void run() {
    std::size_t i = first_steady(beats_, 0, typical_.mean, tolerance_);
    if (i == beats_.size()) i = 0; // too few for a run: trust the first event
    for (std::size_t k = 0; k < i; ++k)
      mark_spurious(k);
    begin_segment(i, 0);
    for (++i; i < beats_.size(); ++i)
      i = place(i);
  }

private:
  void mark_spurious(std::size_t i) { beats_[i].flag = BeatFlag::spurious; }

  void begin_segment(std::size_t i, std::int64_t cycle) {
    tracker_.start(beats_[i].time, cycle);
    accept(i, cycle);
  }

  void accept(std::size_t i, std::int64_t cycle) {
    beats_[i].flag = BeatFlag::good;
    beats_[i].cycle = cycle;
    beats_[i].segment = segment_;
    last_good_ = i;
  }

  // Settles event i and returns the last event settled.
  std::size_t place(std::size_t i) {
    const auto guess = tracker_.guess(beats_[i].time);
    if (guess.cycles < 1 || !tracker_.fits(guess)) {
      mark_spurious(i);
      if (++misfits_ >= 6) return resynchronise(i); // about two periods of doubled triggers
      return i;
    }
    const std::size_t best = nearest_rival(i, guess);
    for (std::size_t k = i; k < best; ++k)
      mark_spurious(k);
    const auto chosen = tracker_.guess(beats_[best].time);
    tracker_.follow(beats_[best].time, chosen);
    accept(best, tracker_.cycle());
    misfits_ = 0;
    return best;
  }

  // Of the coming events that claim the same cycle as event i, the one nearest the foreseen time.
  [[nodiscard]] std::size_t nearest_rival(std::size_t i, Tracker::Guess guess) const {
    std::size_t best = i;
    for (std::size_t k = i + 1; k < beats_.size(); ++k) {
      const auto other = tracker_.guess(beats_[k].time);
      if (other.cycles != guess.cycles || !tracker_.fits(other)) break;
      if (std::abs(other.error) < std::abs(guess.error)) {
        best = k;
        guess = other;
      }
    }
    return best;
  }

  // The events no longer fit: look for a steady run after the last good beat and start afresh
  // there.
  std::size_t resynchronise(std::size_t i) {
    const std::size_t from = last_good_ + 1;
    const std::size_t start = first_steady(beats_, from, typical_.mean, tolerance_);
    misfits_ = 0;
    if (start == beats_.size() || start > i) return i;
    for (std::size_t k = from; k < start; ++k)
      mark_spurious(k);
    const double periods = (beats_[start].time - beats_[last_good_].time) / typical_.mean;
    const auto cycles = static_cast<std::int64_t>(std::clamp(std::round(periods), 1.0, 1e15));
    const std::int64_t cycle = beats_[last_good_].cycle + cycles;
    ++segment_;
    begin_segment(start, cycle);
    return start;
  }

  std::vector<Beat>& beats_;
  TypicalPeriod typical_;
  double tolerance_;
  Tracker tracker_;
  std::size_t last_good_ = 0;
  std::uint16_t segment_ = 0;
  int misfits_ = 0;
};

// Rms error of foreseeing m cycles ahead from the mean rate of the m before, in an unbroken run.
double foresight_error(const std::vector<double>& times, std::size_t m) {
  double sum = 0.0;
  std::size_t n = 0;
  for (std::size_t i = 0; i + 2 * m < times.size(); ++i, ++n) {
    const double error = times[i + 2 * m] - 2.0 * times[i + m] + times[i];
    sum += error * error;
  }
  return n == 0 ? 0.0 : std::sqrt(sum / static_cast<double>(n));
}

// The longest run of consecutive cycles, as times less the typical period's grid.
std::vector<double> longest_run(const std::vector<Beat>& good, double period) {
  std::size_t best = 0;
  std::size_t best_length = 0;
  std::size_t start = 0;
  for (std::size_t i = 0; i < good.size(); ++i) {
    if (i > 0 && good[i].cycle != good[i - 1].cycle + 1) start = i;
    if (i - start + 1 > best_length) {
      best_length = i - start + 1;
      best = start;
    }
  }
  std::vector<double> times;
  for (std::size_t i = best; i < best + best_length; ++i)
    times.push_back(residual_from_grid(good[i].time, good[best].time,
                                       good[i].cycle - good[best].cycle, period));
  return times;
}

// Probability that the nearest integer is the right one for an error of standard deviation sigma
// (in periods) when the observed misfit is `misfit` periods: its likelihood among its neighbours'.
double count_probability(double misfit, double sigma) {
  if (!(sigma < 100.0)) return 0.0; // a hundred counts are as likely as the right one
  double all = 0.0;
  const auto reach = static_cast<int>(std::ceil(8.0 * sigma)) + 1; // beyond, nothing adds 1e-14
  for (int k = -reach; k <= reach; ++k) {
    const double z = (misfit + k) / sigma;
    const double z0 = misfit / sigma;
    all += std::exp(-0.5 * (z * z - z0 * z0));
  }
  return 1.0 / all;
}

// A false event that came near a missed beat was taken for it. It stands alone: its own error
// against the straight line through its neighbours is large and theirs are minus half of it, unlike
// at a change of the rate, where the neighbours lie on their lines.
void strike_lone_outliers(Beats& result, const TypicalPeriod& typical) {
  std::vector<Beat*> good;
  for (Beat& beat : result.beats)
    if (beat.flag == BeatFlag::good) good.push_back(&beat);
  const std::size_t n = good.size();
  std::vector<double> error(n, 0.0);
  const auto consecutive = [&](std::size_t i, std::size_t k) {
    return good[k]->cycle - good[i]->cycle == static_cast<std::int64_t>(k - i);
  };
  for (std::size_t i = 1; i + 1 < n; ++i) {
    if (!consecutive(i - 1, i + 1)) continue;
    error[i] = 0.5 * ((good[i]->time - good[i - 1]->time) - (good[i + 1]->time - good[i]->time));
  }
  // Twelve standard deviations of the errors nearby (a stretch may be noisier than the rest), and a
  // ten-thousandth of a period in a log without noise.
  const auto limit_at = [&](std::size_t i) {
    constexpr std::size_t reach = 20;
    std::vector<double> sizes;
    for (std::size_t k = i - std::min(i, reach); k < std::min(n, i + reach + 1); ++k)
      sizes.push_back(std::abs(error[k]));
    return std::max(12.0 * normal_from_mad * median(sizes), 1e-4 * typical.mean);
  };
  for (std::size_t i = 2; i + 2 < n; ++i) {
    if (std::abs(error[i]) < 1e-4 * typical.mean || !consecutive(i - 2, i + 2)) continue;
    if (std::abs(error[i]) < limit_at(i)) continue;
    const auto mirrored = [&](double neighbour) {
      return std::abs(neighbour / error[i] + 0.5) < 0.2;
    };
    if (mirrored(error[i - 1]) && mirrored(error[i + 1])) good[i]->flag = BeatFlag::spurious;
  }
}

class GapJudge {
public:
  GapJudge(const std::vector<Beat>& good, const TypicalPeriod& typical)
      : typical_(typical), run_(longest_run(good, typical.mean)) {}

  [[nodiscard]] double probability(std::int64_t length, double misfit_s) const {
    // However steady the log, it is not believed over ten times its own length.
    if (length > 10 * static_cast<std::int64_t>(run_.size())) return 0.0;
    const auto span = static_cast<std::size_t>(length) + 1;
    const std::size_t longest = std::max<std::size_t>(run_.size() / 3, 1);
    const std::size_t m = std::min(span, longest);
    double sigma = std::max(foresight_error(run_, m), typical_.scatter);
    // Beyond what the log shows, a random walk of rate: error growing as the 3/2 power.
    if (span > m) sigma *= std::pow(static_cast<double>(span) / static_cast<double>(m), 1.5);
    // Nor is any clock trusted to keep its rate over a gap to better than 1e-6, a tenth of a second
    // a day, even if the log is too short or too coarse to show its wander.
    sigma = std::max(sigma, 1e-6 * static_cast<double>(span) * typical_.mean);
    // No whole number of periods fits: the clock stood still, or the reference jumped. (In a short
    // gap it is rather a false event beside it that misleads.)
    constexpr std::int64_t stop = 20;
    if (length >= stop && std::abs(misfit_s) > 6.0 * sigma) return 0.0;
    return count_probability(misfit_s / typical_.mean, sigma / typical_.mean);
  }

private:
  TypicalPeriod typical_;
  std::vector<double> run_;
};

void find_gaps(Beats& result, const TypicalPeriod& typical, double least_probability) {
  std::vector<Beat> good;
  for (const Beat& beat : result.beats)
    if (beat.flag == BeatFlag::good) good.push_back(beat);
  const GapJudge judge(good, typical);
  std::uint16_t split = 0;
  std::vector<std::uint16_t> segment_of(good.size(), 0);
  for (std::size_t i = 1; i < good.size(); ++i) {
    const bool step = good[i].segment != good[i - 1].segment;
    const std::int64_t length = good[i].cycle - good[i - 1].cycle - 1;
    if (length > 0 || step) {
      const double misfit =
          good[i].time - good[i - 1].time - static_cast<double>(length + 1) * typical.mean;
      const double probability = step ? 0.0 : judge.probability(length, misfit);
      const bool bridged = probability >= least_probability;
      result.gaps.push_back({good[i - 1].cycle, length, probability, bridged});
      if (bridged) result.missed += length;
      if (!bridged) ++split;
    }
    segment_of[i] = split;
  }
  std::size_t k = 0;
  for (Beat& beat : result.beats) {
    if (beat.flag == BeatFlag::good) beat.segment = segment_of[k++];
  }
  result.segments = split + 1u;
}

// Downward crossings take the cycle and segment of the upward crossing before them.
void place_downward(Beats& result, const std::vector<Beat>& downward) {
  if (downward.empty()) return;
  std::vector<Beat> merged;
  merged.reserve(result.beats.size() + downward.size());
  std::merge(result.beats.begin(), result.beats.end(), downward.begin(), downward.end(),
             std::back_inserter(merged),
             [](const Beat& a, const Beat& b) { return a.time < b.time; });
  const Beat* last = nullptr;
  for (Beat& beat : merged) {
    if (beat.flag == BeatFlag::good) last = &beat;
    if (beat.flag == BeatFlag::down) {
      beat.cycle = last != nullptr ? last->cycle : -1;
      beat.segment = last != nullptr ? last->segment : 0;
    }
  }
  result.beats = std::move(merged);
}

} // namespace

std::vector<Beat> Beats::longest_segment() const {
  std::vector<std::size_t> sizes(segments, 0);
  for (const Beat& beat : beats)
    if (beat.flag == BeatFlag::good) ++sizes[beat.segment];
  const auto best = std::max_element(sizes.begin(), sizes.end()) - sizes.begin();
  std::vector<Beat> chosen;
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
  std::vector<Beat> downward;
  for (Beat& beat : events)
    if (beat.edge == Edge::down) {
      beat.flag = BeatFlag::down;
      downward.push_back(beat);
    }
  std::erase_if(events, [](const Beat& beat) { return beat.edge == Edge::down; });
  result.beats = std::move(events);
  if (result.beats.size() < 3)
    throw InputError({source, 1, 1}, fmt::format("{} upward crossings", result.beats.size()),
                     "at least 3");
  const TypicalPeriod typical = typical_period(result.beats, source);
  result.typical_period_s = typical.mean;
  result.scatter_s = typical.scatter;
  Numbering(result.beats, typical).run();
  strike_lone_outliers(result, typical);
  for (const Beat& beat : result.beats)
    result.spurious += beat.flag == BeatFlag::spurious ? 1 : 0;
  find_gaps(result, typical, options.least_probability);
  place_downward(result, downward);
  return result;
}

namespace {

// Whether intervals alternate: neighbours on opposite sides of the median, next neighbours on the
// same, and both much alike. Jitter alone gives correlations of -1/2 and 0.
bool intervals_alternate(const std::vector<double>& steps, double centre) {
  double variance = 0.0, next = 0.0, second = 0.0;
  for (std::size_t i = 0; i + 2 < steps.size(); ++i) {
    const auto off = [&](std::size_t k) { return steps[k] - centre; };
    const double widest = 0.45 * centre; // a clock further out of beat than this does not go
    if (std::max({std::abs(off(i)), std::abs(off(i + 1)), std::abs(off(i + 2))}) > widest) continue;
    variance += off(i) * off(i);
    next += off(i) * off(i + 1);
    second += off(i) * off(i + 2);
  }
  return variance > 0.0 && next < -0.75 * variance && second > 0.75 * variance;
}

} // namespace

bool label_alternate_edges(ClockLog& log, bool certain) {
  const bool labelled = std::any_of(log.events.begin(), log.events.end(),
                                    [](const Beat& e) { return e.edge == Edge::down; });
  if (labelled || log.events.size() < 8) return false;
  std::vector<double> steps, pairs;
  for (std::size_t i = 1; i < log.events.size(); ++i)
    steps.push_back(log.events[i].time - log.events[i - 1].time);
  for (std::size_t i = 1; i < steps.size(); ++i)
    pairs.push_back(steps[i] + steps[i - 1]);
  const double half = 0.5 * median(pairs); // the beat error cancels in a pair
  if (!(half > 0.0) || (!certain && !intervals_alternate(steps, half))) return false;
  std::int64_t beat = 0;
  for (std::size_t i = 1; i < log.events.size(); ++i) {
    const double beats = steps[i - 1] / half;
    if (beats < 1e15) beat += std::llround(beats);
    log.events[i].edge = beat % 2 == 0 ? Edge::up : Edge::down;
  }
  log.assumptions.push_back(
      certain ? "both directions are in the log: every other event is a downward crossing"
              : "the intervals alternate, so both directions are in the log: every other event is "
                "taken "
                "as a downward crossing");
  return true;
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
  case BeatFlag::good:
    break;
  }
  return "";
}

} // namespace goingrate
