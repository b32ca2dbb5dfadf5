// Finds pushes that wait for the swing to fall (Hipp) where none stands out by itself. Without
// noise of the drive the j-th comes in the swing in which a wait of j x periods ends: intervals are
// the two whole numbers around x, and the saw-tooth has the overtones of 1/x. From there each push
// is moved to the swing where it fits best.
#include "goingrate/fit/impulse_cycle.hpp"

#include "push_candidate.hpp"
#include "push_friction.hpp"

#include "goingrate/fit/timing_data.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

namespace goingrate {

namespace {

using namespace push_shapes;

constexpr double longest_wait = 60.0;       // periods
constexpr double longest_looked_at = 300.0; // periods: what is found may be an overtone of these
constexpr double bins_per_swing = 4.0;

/// The j-th push comes first + j periods after the first cycle, rounded down.
struct Waits {
  double periods, first;
};

std::vector<double> pushes_after(const Waits& waits, double last) {
  std::vector<double> at;
  for (double wait = waits.first - waits.periods; wait <= last + waits.periods;
       wait += waits.periods)
    at.push_back(std::floor(wait));
  return at;
}

// Means of values folded at a period that need not be a whole number.
std::vector<double> folded_at(const Grid& values, double periods, std::size_t bins) {
  std::vector<double> sums(bins, 0.0), counts(bins, 0.0);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) continue;
    const double turns = static_cast<double>(i) / periods;
    const double share = turns - std::floor(turns);
    const auto bin =
        std::min(bins - 1, static_cast<std::size_t>(share * static_cast<double>(bins)));
    sums[bin] += values[i];
    counts[bin] += 1.0;
  }
  for (std::size_t k = 0; k < bins; ++k)
    sums[k] /= std::max(counts[k], 1.0);
  return sums;
}

// Looks for the interval near another one, to half a turn over the log, and for the first push, by
// folding.
class WaitingSearch {
public:
  WaitingSearch(const Sight& sight, double near, std::size_t cycles, std::size_t bins)
      : sight_(sight), bins_(bins) {
    const auto n = static_cast<std::size_t>(std::lround(near));
    const auto part = [&](const Grid& whole) {
      return Grid(whole.begin(),
                  whole.begin() + static_cast<std::ptrdiff_t>(std::min(cycles, whole.size())));
    };
    times_ = less_moving_mean(part(sight.late), n);
    swings_ = less_moving_mean(part(sight.amplitude), n);
    const double turns = static_cast<double>(times_.size()) / near;
    const double step = near / turns / static_cast<double>(bins); // a bin over the log
    const auto reach = static_cast<int>(bins / 2);
    for (int k = -reach; k <= reach; ++k)
      look_at(near + k * step);
  }

  [[nodiscard]] double score() const { return score_; }
  [[nodiscard]] const Waits& place() const { return place_; }

private:
  void look_at(double periods) {
    const auto late = folded_at(times_, periods, bins_), swing = folded_at(swings_, periods, bins_);
    const Sought sought = few_shapes(bins_);
    for (std::size_t first = 0; first < bins_; ++first) {
      const double score = sight_.in_noise(
          explained(late, first, sought),
          sight_.has_swing() ? explained(swing, first, in_amplitudes(sought)) : 0.0);
      const double mean = score / static_cast<double>(bins_);
      if (!(mean > score_)) continue;
      score_ = mean;
      place_ = {periods, (static_cast<double>(first) + 1.0) * periods / static_cast<double>(bins_)};
    }
  }

  const Sight& sight_;
  std::size_t bins_;
  Grid times_, swings_; // without their slow parts
  double score_ = 0.0;  // of the squares explained, in units of the noise
  Waits place_{0.0, 0.0};
};

// Whether two lines or more belong to the interval and fall with their order no faster than those
// of a saw-tooth, or of a hump, in proportion to its square. A wheel that is not round has one
// line, and weak overtones at most.
bool has_overtones(double periods, std::span<const Wheel> lines, double T0_s) {
  constexpr double tolerance = 0.02;  // turns
  constexpr double least_share = 0.4; // of the strongest line's size times its order
  double strongest = 0.0, strongest_order = 0.0;
  const auto each = [&](auto take) {
    for (const Wheel& line : lines) {
      const double turns = periods * T0_s / line.turn_s, order = std::round(turns);
      if (order >= 1.0 && std::abs(turns - order) < tolerance) take(order, order * line.late_s);
    }
  };
  each([&](double order, double size) {
    if (size > strongest) strongest = size, strongest_order = order;
  });
  bool found = false;
  each([&](double order, double size) {
    found = found || (order != strongest_order && size > least_share * strongest);
  });
  return found;
}

// The interval that explains most, near those of the strongest lines or few times as long.
double likeliest_interval(const Sight& sight, std::span<const Wheel> lines, double T0_s) {
  constexpr std::size_t most_lines = 4, cycles = 20'000,
                        bins = 64;       // enough to tell one from another
  constexpr double merged_share = 0.003; // of one interval: nearer intervals are looked at together
  double best = 0.0, score = 0.0;
  std::vector<double> looked_at;
  for (const Wheel& line : lines.first(std::min(most_lines, lines.size())))
    for (const double times : {1.0, 2.0, 3.0, 4.0, 5.0}) {
      const double near = times * line.turn_s / T0_s;
      const double fewest = near * static_cast<double>(least_cycles);
      if (near < 2.0 || near > longest_looked_at ||
          fewest > static_cast<double>(sight.late.size()) ||
          std::any_of(looked_at.begin(), looked_at.end(),
                      [&](double other) { return std::abs(other / near - 1.0) < merged_share; }))
        continue;
      looked_at.push_back(near);
      const WaitingSearch search(sight, near, cycles, bins);
      if (search.score() > score) score = search.score(), best = near;
    }
  return best;
}

// Values without their slow part, which goes on straight at the ends of the log.
Grid without_slow(const Grid& values, std::size_t n) {
  Grid left = less_moving_mean(values, n);
  const auto is_known = [](double value) { return std::isfinite(value); };
  const auto first = std::find_if(left.begin(), left.end(), is_known) - left.begin();
  const auto last = left.rend() - std::find_if(left.rbegin(), left.rend(), is_known) - 1;
  const auto step = static_cast<std::ptrdiff_t>(n);
  if (last - first < step) return left;
  const auto slow = [&](std::ptrdiff_t i) {
    return values[static_cast<std::size_t>(i)] - left[static_cast<std::size_t>(i)];
  };
  const auto go_on = [&](std::ptrdiff_t from, std::ptrdiff_t inner, std::ptrdiff_t i) {
    const double share = static_cast<double>(i - from) / static_cast<double>(inner - from);
    left[static_cast<std::size_t>(i)] =
        values[static_cast<std::size_t>(i)] - std::lerp(slow(from), slow(inner), share);
  };
  for (std::ptrdiff_t i = 0; i < first; ++i)
    go_on(first, first + step, i);
  for (std::ptrdiff_t i = last + 1; i < static_cast<std::ptrdiff_t>(values.size()); ++i)
    go_on(last, last - step, i);
  return left;
}

// Moves single pushes by a swing, where that explains the times and amplitudes clearly better.
class PushMover {
public:
  PushMover(const Sight& sight, const ImpulseCycle& pushes)
      : sight_(sight), periods_(pushes.periods), times_(without_slow(sight.late, usual(pushes))),
        swings_(without_slow(straightened(sight.amplitude), usual(pushes))),
        late_(pushes.kick.value, pushes.lateness.value / height_of_hump(pushes.periods),
              pushes.middle.value),
        swing_(pushes.amplitude_step ? pushes.amplitude_step->value : 0.0, 0.0,
               pushes.amplitude_middle) {}

  // Whether any was moved.
  bool move(std::vector<double>& pushes) const {
    constexpr double least_move_gain = 9.0; // of chi^2: three sigma
    bool moved = false;
    for (std::size_t j = 1; j + 1 < pushes.size(); ++j) {
      double least = misfit(pushes, j) - least_move_gain;
      double best = pushes[j];
      for (const double by : {-1.0, 1.0}) {
        std::vector<double> three{pushes[j - 1], pushes[j] + by, pushes[j + 1]};
        if (three[1] - three[0] < 2.0 || three[2] - three[1] < 2.0) continue;
        if (const double there = misfit(three, 1); there < least) least = there, best = three[1];
      }
      moved = moved || best != pushes[j];
      pushes[j] = best;
    }
    return moved;
  }

private:
  static std::size_t usual(const ImpulseCycle& pushes) {
    return static_cast<std::size_t>(std::lround(pushes.periods));
  }
  // Of the intervals before and after push j, in squares of the noise, at the level that suits
  // best.
  [[nodiscard]] double misfit(const std::vector<double>& pushes, std::size_t j) const {
    Scatter late, swing;
    for (std::size_t end = j; end <= j + 1; ++end) {
      const double from = pushes[end - 1], n = pushes[end] - from;
      for (double m = 1.0; m <= n; ++m) {
        const double at = from + m;
        if (at < 0.0 || at > static_cast<double>(times_.size()) - 1.0) continue;
        const auto i = static_cast<std::size_t>(at);
        Shapes shapes = shapes_of(m, n);
        shapes(tooth_shape) = static_cast<double>(end - j) - (at - pushes[j]) / periods_;
        late.add(times_[i] - late_.dot(shapes));
        if (sight_.has_swing()) swing.add(swings_[i] - swing_.dot(shapes));
      }
    }
    return sight_.in_noise(late.squares(), swing.squares());
  }

  // The squares about the mean of the known values.
  struct Scatter {
    double n = 0.0, sum = 0.0, sum2 = 0.0;
    void add(double value) {
      if (std::isfinite(value)) ++n, sum += value, sum2 += value * value;
    }
    [[nodiscard]] double squares() const { return n > 0.0 ? sum2 - sum * sum / n : 0.0; }
  };

  const Sight& sight_;
  double periods_;
  Grid times_, swings_; // without their slow parts
  Shapes late_, swing_;
};

// Begins with pushes to a quarter of a swing at both ends of the log.
std::optional<Candidate> waiting_candidate(const Sight& sight, double near, double price) {
  constexpr int most_rounds = 8;
  const auto length = static_cast<double>(sight.late.size());
  const auto bins = static_cast<std::size_t>(std::lround(bins_per_swing * near));
  std::vector<double> pushes =
      pushes_after(WaitingSearch(sight, near, sight.late.size(), bins).place(), length);
  auto best = irregular_candidate(sight, pushes, near, price);
  for (int round = 0; best && round < most_rounds; ++round) {
    if (!PushMover(sight, best->pushes).move(pushes)) break;
    auto moved = irregular_candidate(sight, pushes, near, price);
    if (!moved || moved->squares < best->squares) break;
    best = std::move(moved);
  }
  return best;
}

// In units of the noise, per cycle.
double squares_of(const Sight& sight, const Wheel& wheel) {
  return sight.in_noise(0.5 * wheel.late_s * wheel.late_s,
                        0.5 * wheel.amplitude_rad * wheel.amplitude_rad);
}

} // namespace

std::optional<ImpulseCycle> find_waiting_pushes(const TimingData& data,
                                                const std::vector<Wheel>& lines) {
  const Sight sight = seen(data, searched_cycles);
  if (lines.empty() || sight.late.size() == searched_cycles) return {};
  const double near = likeliest_interval(sight, lines, data.reference_period_s);
  if (near == 0.0 || near > longest_wait || !has_overtones(near, lines, data.reference_period_s))
    return {};
  // Places to a quarter of a swing at both ends of the log, near each line.
  const double places = std::pow(bins_per_swing * near, 2) * static_cast<double>(lines.size());
  auto best = waiting_candidate(sight, near, 2.0 * std::log(places));
  double sine = 0.0;
  for (const Wheel& line : lines)
    sine = std::max(sine, squares_of(sight, line));
  if (!best || best->pushes.gain < least_gain || best->squares < sine) return {};
  if (sight.has_swing() && !(best->pushes.amplitude_step->value > 0.0)) return {};
  return std::move(best->pushes);
}

} // namespace goingrate
