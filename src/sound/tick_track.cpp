#include "tick_track.hpp"

#include "base/robust.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

namespace goingrate {

namespace {

constexpr std::ptrdiff_t lead = 12, tail = 24; // bins before and after a beat begins
constexpr auto shape_size = static_cast<std::size_t>(lead + tail);

using Shape = std::vector<double>; // mean loudness around a beat, from `lead` bins before it

/// The loudness between beats.
struct Background {
  double mean = 0.0, sigma = 1.0;
};
constexpr double correlated_bins = 2.0; // as far as a sound lasts

// A burst that dies away within some milliseconds, until the recording's own is known.
Shape first_shape() {
  Shape shape(shape_size, 0.0);
  for (std::ptrdiff_t k = 0; k < tail; ++k)
    shape[static_cast<std::size_t>(lead + k)] = std::exp(-static_cast<double>(k) / 6.0);
  return shape;
}

/// ln(likelihood of the loudness with a beat that begins in a bin / without), for every bin.
class Scores {
public:
  Scores(std::span<const float> above, const Background& background)
      : above_(above), background_(background),
        variance_(correlated_bins * background.sigma * background.sigma) {}

  // Score at each bin of a beat whose mean loudness is known.
  [[nodiscard]] std::vector<float> of_known(const Shape& shape) const {
    auto score = matched(shape);
    const auto without = static_cast<float>(0.5 * energy(shape));
    for (float& value : score)
      value = bounded(value - without);
    return score;
  }

  // Score at each bin of a beat that is as loud as fits best.
  [[nodiscard]] std::vector<float> of_unknown(const Shape& shape) const {
    auto score = matched(shape);
    const auto twice_energy = static_cast<float>(2.0 * energy(shape));
    for (float& value : score)
      value = bounded(value > 0.0F ? value * value / twice_energy : 0.0F);
    return score;
  }

private:
  [[nodiscard]] double energy(const Shape& shape) const {
    double sum = 0.0;
    for (const double value : shape)
      sum += value * value / variance_;
    return sum;
  }

  [[nodiscard]] std::vector<float> matched(const Shape& shape) const {
    std::vector<float> score(above_.size(), 0.0F);
    const std::size_t end = above_.size() < shape_size ? 0 : above_.size() - shape_size;
    double by_background = 0.0;
    for (std::size_t k = 0; k < shape_size; ++k) {
      const auto weight = static_cast<float>(shape[k] / variance_);
      by_background += shape[k] * background_.mean / variance_;
      for (std::size_t i = 0; i < end; ++i)
        score[i + lead] += weight * above_[i + k];
    }
    for (float& value : score)
      value -= static_cast<float>(by_background);
    return score;
  }

  // Beats may be drowned by noise, so silence says little. The bound is twice the score of a
  // certain beat, so that a loud bang does not count as many beats.
  static float bounded(float value) {
    constexpr float least_excess = -4.0F, knee_excess = 12.0F;
    if (value > knee_excess) return knee_excess * (2.0F - knee_excess / value);
    return std::max(value, least_excess);
  }

  std::span<const float> above_;
  const Background& background_;
  double variance_;
};

/// The phase, in bins of a grid of periods, from period to period.
class Phases {
public:
  Phases(std::span<const float> ticks, std::span<const float> tocks, const TickPattern& pattern)
      : ticks_(ticks), tocks_(tocks), pattern_(pattern),
        size_(static_cast<std::size_t>(std::lround(pattern.period))),
        periods_(static_cast<std::size_t>(
            std::max(0.0, static_cast<double>(ticks.size()) - after()) / pattern.period)) {}

  // The bin where each period's tick begins; increasing.
  [[nodiscard]] std::vector<double> best() const {
    if (periods_ == 0) return {};
    std::vector<double> value(size_), next(size_);
    std::vector<std::int8_t> step(periods_ * size_, 0);
    std::vector<std::size_t> jumps_from(periods_, 0);
    for (std::size_t f = 0; f < size_; ++f)
      value[f] = emission(0, f);
    for (std::size_t n = 1; n < periods_; ++n) {
      const auto top =
          static_cast<std::size_t>(std::max_element(value.begin(), value.end()) - value.begin());
      jumps_from[n] = top;
      for (std::size_t f = 0; f < size_; ++f)
        next[f] = choose(value, f, value[top] - jump_cost, step[n * size_ + f]) + emission(n, f);
      value.swap(next);
    }
    std::vector<double> bins(periods_);
    auto f = static_cast<std::size_t>(std::max_element(value.begin(), value.end()) - value.begin());
    for (std::size_t n = periods_; n-- > 0;) {
      bins[n] = bin_of(n, f);
      const std::int8_t taken = step[n * size_ + f];
      const auto size = static_cast<int>(size_);
      f = taken == jump ? jumps_from[n]
                        : static_cast<std::size_t>((static_cast<int>(f) - taken + size) % size);
    }
    return bins;
  }

private:
  // Nats: for a bin per period; for any jump, which two periods of the clearest beats cannot pay.
  static constexpr double step_cost = 3.0, jump_cost = 100.0;
  static constexpr std::int8_t jump = 2;

  // The best path to the phase f comes from f - taken.
  [[nodiscard]] double choose(const std::vector<double>& value, std::size_t f, double jumped,
                              std::int8_t& taken) const {
    double best = value[f];
    taken = 0;
    const double below = value[(f + size_ - 1) % size_] - step_cost;
    const double above = value[(f + 1) % size_] - step_cost;
    if (below > best) best = below, taken = 1;
    if (above > best) best = above, taken = -1;
    if (jumped > best) best = jumped, taken = jump;
    return best;
  }

  // Time from a tick to the last sound of its period. All periods hold both, or one with both would
  // be worth a jump.
  [[nodiscard]] double after() const { return pattern_.has_tocks ? pattern_.tock_after : 0.0; }

  [[nodiscard]] double bin_of(std::size_t n, std::size_t f) const {
    return std::floor(static_cast<double>(n) * pattern_.period) + static_cast<double>(f);
  }

  [[nodiscard]] double emission(std::size_t n, std::size_t f) const {
    const auto bin = static_cast<std::size_t>(bin_of(n, f));
    double sum = bin < ticks_.size() ? static_cast<double>(ticks_[bin]) : 0.0;
    if (!pattern_.has_tocks) return sum;
    const std::size_t later = bin + static_cast<std::size_t>(std::lround(pattern_.tock_after));
    return later < tocks_.size() ? sum + static_cast<double>(tocks_[later]) : sum;
  }

  std::span<const float> ticks_, tocks_;
  const TickPattern& pattern_;
  std::size_t size_, periods_;
};

// A phase that wraps gives one beat twice, or none: beats are a period apart.
std::vector<double> one_a_period(const std::vector<double>& bins, double period) {
  std::vector<double> result;
  for (const double bin : bins) {
    if (!result.empty() && bin - result.back() < 0.5 * period) continue;
    if (!result.empty()) {
      const double missing = std::round((bin - result.back()) / period) - 1.0;
      const double from = result.back();
      for (double k = 1.0; k <= missing; k += 1.0)
        result.push_back(from + k * (bin - from) / (missing + 1.0));
    }
    result.push_back(bin);
  }
  return result;
}

// The best place near an expected one.
RoughTick place_near(std::span<const float> score, double bin, bool is_tock) {
  constexpr std::ptrdiff_t reach = 3;
  constexpr double usual_wander_bins = 1.5; // bins that beats are off the smooth course
  RoughTick tick{bin, is_tock, -std::numeric_limits<double>::infinity()};
  const auto middle = static_cast<std::ptrdiff_t>(std::lround(bin));
  for (std::ptrdiff_t i = middle - reach; i <= middle + reach; ++i) {
    if (i < 0 || i >= static_cast<std::ptrdiff_t>(score.size())) continue;
    const double off = (static_cast<double>(i) - bin) / usual_wander_bins;
    const double value = static_cast<double>(score[static_cast<std::size_t>(i)]) - 0.5 * off * off;
    if (value > tick.score) tick.score = value, tick.bin = static_cast<double>(i);
  }
  return tick;
}

// Judges beats by the scores of places without a beat. The clock goes where many of the beats
// around score better than nearly all such places. There a beat is expected, and is accepted unless
// it is no better than most of them.
void judge(std::vector<RoughTick>& ticks, std::vector<double> control) {
  if (control.empty()) return;
  const auto quantile = [&](double share) {
    const auto at = control.begin() +
                    static_cast<std::ptrdiff_t>(share * static_cast<double>(control.size() - 1));
    std::nth_element(control.begin(), at, control.end());
    return *at;
  };
  constexpr double nearly_all_share = 0.98, most_share = 0.8;
  const double clear = std::max(0.0, quantile(nearly_all_share)),
               least = std::max(0.0, quantile(most_share));
  constexpr std::size_t beats_on_either_side = 10;
  constexpr double going_share = 0.25; // of the beats: noise alone reaches a fiftieth
  std::vector<double> sums{0.0};
  for (const RoughTick& tick : ticks)
    sums.push_back(sums.back() + (tick.score > clear ? 1.0 : 0.0));
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    const std::size_t from = i < beats_on_either_side ? 0 : i - beats_on_either_side;
    const std::size_t to = std::min(ticks.size(), i + beats_on_either_side + 1);
    ticks[i].clock_goes = sums[to] - sums[from] >= going_share * static_cast<double>(to - from);
    ticks[i].stands_out = ticks[i].clock_goes && ticks[i].score > least;
  }
}

// The loudness halfway between beats.
Background between_beats(std::span<const float> above, std::span<const RoughTick> ticks) {
  constexpr std::ptrdiff_t reach = 5; // bins
  double sum = 0.0, sum2 = 0.0, count = 0.0;
  for (std::size_t t = 0; t + 1 < ticks.size(); ++t) {
    const auto middle = static_cast<std::ptrdiff_t>(0.5 * (ticks[t].bin + ticks[t + 1].bin));
    for (std::ptrdiff_t i = middle - reach; i <= middle + reach; ++i) {
      if (i < 0 || i >= static_cast<std::ptrdiff_t>(above.size())) continue;
      const auto value = static_cast<double>(above[static_cast<std::size_t>(i)]);
      sum += value, sum2 += value * value, count += 1.0;
    }
  }
  if (count < 2.0) return {};
  const double mean = sum / count;
  return {mean, std::sqrt(std::max(1e-6, sum2 / count - mean * mean))};
}

// The mean loudness around beats of one kind, relative to that between beats, while the clock goes;
// faint beats are included, because a faint clock has no others. `count` is the number of beats.
Shape mean_shape(std::span<const float> above, std::span<const RoughTick> ticks, bool tocks,
                 double background, double& count) {
  std::vector<std::size_t> firsts;
  const bool goes = std::any_of(ticks.begin(), ticks.end(),
                                [](const RoughTick& tick) { return tick.clock_goes; });
  for (const RoughTick& tick : ticks) {
    if (goes && !tick.clock_goes) continue;
    const auto first = static_cast<std::ptrdiff_t>(tick.bin) - lead;
    if (tick.is_tock == tocks && first >= 0 &&
        first + lead + tail < static_cast<std::ptrdiff_t>(above.size()))
      firsts.push_back(static_cast<std::size_t>(first));
  }
  Shape shape(shape_size, 0.0);
  std::vector<double> values(firsts.size());
  for (std::size_t k = 0; k < shape_size && !firsts.empty(); ++k) {
    for (std::size_t i = 0; i < firsts.size(); ++i)
      values[i] = static_cast<double>(above[firsts[i] + k]);
    shape[k] = trimmed_mean(values) - background;
  }
  count = static_cast<double>(firsts.size());
  return shape;
}

// Bins from the nominal to the true beginning of a shape, at which it rises above its noise and
// above the blur of imperfect alignment.
std::ptrdiff_t onset_shift(const Shape& shape, double noise) {
  constexpr double begun_share = 0.1; // of the logarithm
  constexpr double noise_factor = 6.0;
  const double level =
      std::max(begun_share * *std::max_element(shape.begin(), shape.end()), noise_factor * noise);
  for (std::size_t k = 0; k < shape.size(); ++k)
    if (shape[k] > level) return static_cast<std::ptrdiff_t>(k) - lead;
  return 0;
}

void shift(Shape& shape, std::ptrdiff_t by) {
  Shape moved(shape.size(), 0.0);
  for (std::ptrdiff_t k = 0; k < static_cast<std::ptrdiff_t>(shape.size()); ++k)
    if (k + by >= 0 && k + by < static_cast<std::ptrdiff_t>(shape.size()))
      moved[static_cast<std::size_t>(k)] = shape[static_cast<std::size_t>(k + by)];
  shape = moved;
}

class Tracking {
public:
  Tracking(const Loudness& loudness, const TickPattern& pattern) : loudness_(loudness) {
    track_.pattern = pattern;
    tick_ = tock_ = first_shape();
    double sum = 0.0, sum2 = 0.0;
    for (const float value : loudness.above)
      sum += static_cast<double>(value), sum2 += static_cast<double>(value * value);
    const auto count = static_cast<double>(loudness.above.size());
    background_ = {sum / count,
                   std::sqrt(std::max(1e-6, sum2 / count - sum * sum / count / count))};
  }

  TickTrack run() {
    constexpr int rounds = 4;
    for (int round = 0; round < rounds; ++round) {
      follow();
      if (round + 1 < rounds) learn();
    }
    return std::move(track_);
  }

private:
  void follow() {
    const Scores scores(loudness_.above, background_);
    const auto ticks = learnt_ ? scores.of_known(tick_) : scores.of_unknown(tick_);
    const auto tocks = learnt_ ? scores.of_known(tock_) : scores.of_unknown(tock_);
    TickPattern& pattern = track_.pattern;
    const auto bins = one_a_period(Phases(ticks, tocks, pattern).best(), pattern.period);
    track_.ticks.clear();
    if (bins.empty()) return;
    const auto end = static_cast<double>(loudness_.above.size() - shape_size);
    const auto take = [&](std::span<const float> score, double bin, bool is_tock) {
      if (bin >= lead && bin < end) track_.ticks.push_back(place_near(score, bin, is_tock));
    };
    // A recording may begin with a tock, and ends within a period.
    if (pattern.has_tocks) take(tocks, bins.front() - pattern.period + pattern.tock_after, true);
    for (const double bin : bins) {
      take(ticks, bin, false);
      if (pattern.has_tocks) take(tocks, bin + pattern.tock_after, true);
    }
    for (double bin = bins.back() + pattern.period; bin < end; bin += pattern.period) {
      take(ticks, bin, false);
      if (pattern.has_tocks) take(tocks, bin + pattern.tock_after, true);
    }
    std::vector<double> control;
    for (std::size_t i = 0; i + 1 < track_.ticks.size(); ++i) {
      const double between = 0.5 * (track_.ticks[i].bin + track_.ticks[i + 1].bin);
      control.push_back(place_near(track_.ticks[i].is_tock ? tocks : ticks, between, false).score);
    }
    judge(track_.ticks, std::move(control));
    refine(bins);
    background_ = between_beats(loudness_.above, track_.ticks);
  }

  // The median period over a hundred, which jumps do not change.
  void refine(const std::vector<double>& bins) {
    const std::size_t span = std::min<std::size_t>(100, bins.size() / 2);
    if (span < 2) return;
    std::vector<double> periods;
    for (std::size_t i = span; i < bins.size(); ++i)
      periods.push_back((bins[i] - bins[i - span]) / static_cast<double>(span));
    const double period = median(periods);
    constexpr double largest_error = 0.002; // relative: the pattern's is better than that
    if (std::abs(period / track_.pattern.period - 1.0) < largest_error)
      track_.pattern.period = period;
  }

  void learn() {
    learnt_ = true;
    const std::ptrdiff_t moved = learn(tick_, false);
    if (!track_.pattern.has_tocks) return;
    const std::ptrdiff_t moved_tock = learn(tock_, true);
    std::vector<double> after;
    for (std::size_t i = 0; i + 1 < track_.ticks.size(); ++i)
      if (track_.ticks[i].stands_out && track_.ticks[i + 1].stands_out &&
          track_.ticks[i + 1].is_tock)
        after.push_back(track_.ticks[i + 1].bin - track_.ticks[i].bin);
    if (!after.empty())
      track_.pattern.tock_after = median(after) + static_cast<double>(moved_tock - moved);
  }

  // Learns the mean shape of ticks or tocks; returns by how many bins it now begins later.
  std::ptrdiff_t learn(Shape& shape, bool tocks) {
    double count = 0.0;
    Shape mean = mean_shape(loudness_.above, track_.ticks, tocks, background_.mean, count);
    if (count == 0.0) return 0;
    const std::ptrdiff_t moved = onset_shift(mean, background_.sigma / std::sqrt(count));
    shift(mean, moved);
    shape = mean;
    return moved;
  }

  const Loudness& loudness_;
  TickTrack track_;
  Shape tick_, tock_;
  Background background_;
  bool learnt_ = false; // the shapes are the recording's own
};

} // namespace

TickTrack track_ticks(const Loudness& loudness, TickPattern pattern) {
  return Tracking(loudness, pattern).run();
}

} // namespace goingrate
