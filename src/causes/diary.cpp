#include "goingrate/causes/diary.hpp"

#include "change_kinds.hpp"
#include "facts.hpp"
#include "interruptions.hpp"
#include "reading_changes.hpp"
#include "slope_jumps.hpp"

#include "base/special_values.hpp"
#include "fit/timing_noise.hpp"
#include "goingrate/base/errors.hpp"
#include "goingrate/causes/diagnosis.hpp"
#include "goingrate/log/rates.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

namespace goingrate {

namespace {

using timing_model::Jumps;
using timing_model::slope_jumps;
using timing_model::slope_of;
using timing_model::Track;

// Windows after a change in which relaxation bends rate and amplitude.
constexpr std::size_t wake = 8;

bool is_before(const Change& a, const Change& b) { return a.cycle < b.cycle; }

std::vector<Change> strongest_first(std::vector<Change> changes) {
  std::stable_sort(changes.begin(), changes.end(), [](const Change& a, const Change& b) {
    return a.significance > b.significance;
  });
  return changes;
}

// Residual sum of squares of a broken line with its corner at point k, over [from, to).
double broken_line_misfit(const Track& track, std::size_t from, std::size_t to, std::size_t k) {
  const auto n = static_cast<Eigen::Index>(to - from);
  Eigen::MatrixXd design(n, 3);
  Eigen::VectorXd value(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::size_t p = from + static_cast<std::size_t>(i);
    const double t = track.time[p] - track.time[k];
    design.row(i) << 1.0, t, std::max(0.0, t);
    value[i] = track.value[p] - track.value[k];
  }
  return (value - design * design.colPivHouseholderQr().solve(value)).squaredNorm();
}

class Search {
public:
  Search(std::span<const Beat> beats, double nominal_period_s,
         const std::vector<Displacement>& displaced, const DiaryOptions& options)
      : options_(options) {
    auto error = clock_error(beats, nominal_period_s);
    for (const Displacement& at : displaced)
      for (std::size_t i = at.beat; i < error.size(); ++i)
        error[i] += at.late_s;
    for (std::size_t i = 0; i < beats.size(); ++i) {
      error_.time.push_back(beats[i].time - beats[0].time);
      error_.value.push_back(error[i]);
      cycle_.push_back(beats[i].cycle);
    }
    fill_amplitudes(beats);
    rate_jumps_ =
        slope_jumps(error_, options.window, options.least_rate_change / options.least_significance);
    if (!has_amplitude()) return;
    const double per_window = options.least_amplitude_change / options.least_significance;
    const double seconds = static_cast<double>(options.window) * nominal_period_s;
    swing_jumps_ =
        slope_jumps(amplitude_, options.window, per_window * amplitude_.value.front() / seconds);
  }

  // The larger of the two jumps at beat i, in units of their scatter.
  [[nodiscard]] double significance(std::size_t i) const {
    const double rate = rate_jumps_.score(i);
    return has_amplitude() ? std::max(rate, swing_jumps_.score(i)) : rate;
  }

  [[nodiscard]] bool has_amplitude() const { return !amplitude_.time.empty(); }
  [[nodiscard]] const Track& amplitude() const { return amplitude_; }
  [[nodiscard]] const std::vector<std::int64_t>& cycle() const { return cycle_; }

  [[nodiscard]] std::vector<std::size_t> places() const {
    const std::size_t n = error_.time.size();
    std::vector<double> score(n, 0.0);
    for (std::size_t i = 0; i < n; ++i)
      score[i] = significance(i);
    std::vector<std::size_t> found;
    while (found.size() < options_.most_changes) {
      const auto best = std::max_element(score.begin(), score.end());
      if (*best < options_.least_significance) break;
      const auto at = static_cast<std::size_t>(best - score.begin());
      const double here = *best;
      if (!in_the_wake(at, here, found)) found.push_back(at);
      // A change raises the score within a window on each side; a second change must have its own
      // maximum.
      const std::size_t from = at > options_.window ? at - options_.window : 0;
      std::fill(score.begin() + static_cast<std::ptrdiff_t>(from),
                score.begin() + static_cast<std::ptrdiff_t>(std::min(n, at + options_.window + 1)),
                0.0);
    }
    std::sort(found.begin(), found.end());
    return found;
  }

  // After a step, rate and amplitude relax along a bend. A change with less than a fifth of the
  // significance of another within eight windows is taken to be that bend.
  [[nodiscard]] bool in_the_wake(std::size_t at, double score,
                                 const std::vector<std::size_t>& found) const {
    return std::any_of(found.begin(), found.end(), [&](std::size_t other) {
      const std::size_t apart = at > other ? at - other : other - at;
      return apart <= wake * options_.window && score < 0.2 * significance(other);
    });
  }

  // The corner of the broken lines that fits both series best within half a window of `at`.
  [[nodiscard]] std::size_t refined(std::size_t at) const {
    const std::size_t n = error_.time.size();
    const std::size_t w = options_.window;
    const std::size_t from = at > w ? at - w : 0;
    const std::size_t to = std::min(n, at + w + 1);
    const double error_scale =
        std::max(local_white_noise(std::span(error_.value).subspan(from, to - from)), 1e-15);
    const double amplitude_scale =
        has_amplitude()
            ? std::max(local_white_noise(std::span(amplitude_.value).subspan(from, to - from)),
                       1e-15)
            : 1.0;
    std::size_t best = at;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = std::max(from + 3, at - std::min(at, w / 2));
         k + 3 < to && k <= at + w / 2; ++k) {
      double misfit = broken_line_misfit(error_, from, to, k) / (error_scale * error_scale);
      if (has_amplitude())
        misfit += broken_line_misfit(amplitude_, from, to, k) / (amplitude_scale * amplitude_scale);
      if (misfit < least) {
        least = misfit;
        best = k;
      }
    }
    return best;
  }

  [[nodiscard]] Change change_at(std::size_t k, std::size_t before, std::size_t after) const {
    Change change;
    change.cycle = cycle_[k];
    change.at_s = error_.time[k];
    change.rate_change = slope_of(error_, k, after) - slope_of(error_, before, k);
    change.amplitude_slope_change = not_known;
    change.significance = significance(k);
    if (!has_amplitude()) return change;
    change.amplitude_slope_change =
        slope_of(amplitude_, k, after) - slope_of(amplitude_, before, k);
    return change;
  }

private:
  // Gives both series the same indices: a missing amplitude takes the value before it. If more than
  // a tenth are missing, the amplitudes are not used.
  void fill_amplitudes(std::span<const Beat> beats) {
    std::size_t blank = 0;
    double last = not_known;
    for (const Beat& beat : beats) {
      blank += std::isnan(beat.amplitude_rad) ? 1 : 0;
      if (std::isnan(last)) last = beat.amplitude_rad;
    }
    if (10 * blank > beats.size()) return;
    for (const Beat& beat : beats) {
      if (!std::isnan(beat.amplitude_rad)) last = beat.amplitude_rad;
      amplitude_.value.push_back(last);
    }
    amplitude_.time = error_.time;
  }

  DiaryOptions options_;
  Track error_, amplitude_;
  Jumps rate_jumps_, swing_jumps_;
  std::vector<std::int64_t> cycle_;
};

bool is_in(const Interruption& event, const Change& change) {
  return change.at_s >= event.begin.at_s && change.at_s <= event.end.at_s;
}

// The bend of the relaxation after a change may be found as another change. It is dropped if the
// log gives it no kind besides the stronger change.
void drop_bends(const TimingData& data, const DiaryOptions& options, Diary& diary) {
  const double near_s = wake * static_cast<double>(options.window) * data.reference_period_s;
  std::vector<Change> kept;
  for (const Change& change : strongest_first(diary.changes)) {
    const bool told = std::any_of(diary.interruptions.begin(), diary.interruptions.end(),
                                  [&](const Interruption& event) { return is_in(event, change); });
    const bool is_near = std::any_of(kept.begin(), kept.end(), [&](const Change& other) {
      return std::abs(other.at_s - change.at_s) < near_s;
    });
    if (told || !is_near || timing_model::has_kind(data, change.at_s, kept))
      kept.insert(std::upper_bound(kept.begin(), kept.end(), change, is_before), change);
  }
  diary.changes = std::move(kept);
}

} // namespace

Diary keep_diary(std::span<const Beat> beats, double nominal_period_s,
                 const DiaryOptions& options) {
  if (options.window < 4)
    throw ArgumentError("window", static_cast<double>(options.window), "at least 4");
  Diary diary;
  if (beats.size() < 4 * options.window) return diary; // too short to compare slopes
  const TimingData times = timing_data(beats);
  // A displacement of the times is not a change of the rate.
  const timing_model::Undisplaced undisplaced(times);
  const Search search(beats, nominal_period_s, undisplaced.displaced(), options);
  std::vector<std::size_t> knots;
  for (const std::size_t place : search.places()) {
    const std::size_t k = search.refined(place);
    // Two places within a window are the same change, found in the rate and in the amplitude.
    if (!knots.empty() && k < knots.back() + options.window) {
      if (search.significance(k) > search.significance(knots.back())) knots.back() = k;
    } else {
      knots.push_back(k);
    }
  }
  for (std::size_t j = 0; j < knots.size(); ++j) {
    const std::size_t k = knots[j];
    const std::size_t before = std::max(j == 0 ? 0 : knots[j - 1], k - std::min(k, options.window));
    const std::size_t after =
        std::min(j + 1 < knots.size() ? knots[j + 1] : beats.size(), k + options.window);
    diary.changes.push_back(search.change_at(k, before, after));
  }
  if (search.has_amplitude())
    diary.interruptions =
        timing_model::interruptions_among(diary.changes, knots, search.amplitude(), options);
  drop_bends(undisplaced.data(), options, diary);
  timing_model::judge_changes(beats, undisplaced.data(), diary.changes);
  timing_model::put_rates(beats, nominal_period_s, diary.changes);
  for (Change& change : diary.changes)
    for (Interruption& event : diary.interruptions)
      for (Change* end : {&event.begin, &event.end})
        if (std::abs(change.at_s - end->at_s) <
            static_cast<double>(options.window) * nominal_period_s) {
          change.at_s = end->at_s; // dated by the amplitudes, and too short to be judged alone
          change.cycle = end->cycle;
          change.kind = ChangeKind::drive;
          *end = change;
        }
  return diary;
}

bool are_few_readings(const TimingData& data) {
  return data.reference_period_s > longest_swing_s &&
         std::max(data.size(), data.as_read.elapsed_s.size()) < least_diagnosed_beats;
}

Diary diary_of_readings(std::span<const Beat> beats, double nominal_period_s,
                        const TimingData& data) {
  Diary diary;
  for (const timing_model::ReadingChange& found : timing_model::changes_among_readings(data)) {
    if (!found.is_of_rate) continue;
    Change change;
    change.cycle = beats.front().cycle + cycle_at(beats, found.at_s);
    change.at_s = found.at_s;
    change.rate_change = found.size;
    change.amplitude_slope_change = change.rate_change_sigma = not_known;
    change.gain = found.gain;
    change.significance = std::sqrt(found.gain);
    diary.changes.push_back(change);
  }
  const auto level = without_displacements(beats, data);
  timing_model::put_rates(level ? *level : beats, nominal_period_s, diary.changes);
  return diary;
}

void join_changes_across_gaps(std::span<const Beat> beats, Diary& diary) {
  // A change may be dated some beats from the edge of a gap.
  constexpr double most_present = 0.1;      // of the beats between two dates
  constexpr std::int64_t shortest_gap = 20; // cycles
  const auto are_one = [&](const Change& a, const Change& b) {
    const std::int64_t cycles = b.cycle - a.cycle;
    const auto present = std::count_if(beats.begin(), beats.end(), [&](const Beat& beat) {
      return beat.cycle > a.cycle && beat.cycle < b.cycle;
    });
    return cycles > shortest_gap &&
           static_cast<double>(present) < most_present * static_cast<double>(cycles);
  };
  std::vector<Change> joined;
  for (const Change& change : diary.changes) {
    const bool is_same =
        !joined.empty() && !joined.back().noted && !change.noted && are_one(joined.back(), change);
    if (!is_same) {
      joined.push_back(change);
      continue;
    }
    Change both = change.significance > joined.back().significance ? change : joined.back();
    both.at_s = 0.5 * (joined.back().at_s + change.at_s);
    both.cycle = (joined.back().cycle + change.cycle) / 2;
    both.rate_before = joined.back().rate_before;
    both.rate_before_sigma = joined.back().rate_before_sigma;
    both.rate_after = change.rate_after;
    both.rate_after_sigma = change.rate_after_sigma;
    both.rate_change = both.rate_after - both.rate_before;
    both.rate_change_sigma = std::hypot(both.rate_after_sigma, both.rate_before_sigma);
    joined.back() = both;
    // Opposite steps at the two ends: the clock goes on as before.
    constexpr double least_sigmas = 3.0;
    if (std::abs(both.rate_change) < least_sigmas * both.rate_change_sigma) joined.pop_back();
  }
  diary.changes = std::move(joined);
}

std::optional<std::vector<Beat>> without_displacements(std::span<const Beat> beats,
                                                       const TimingData& data) {
  if (data.displaced.empty()) return {};
  std::vector<Beat> level(beats.begin(), beats.end());
  for (const Displacement& at : data.displaced)
    for (std::size_t i = at.beat; i < level.size(); ++i)
      level[i].time = level[i].time + (-at.late_s);
  return level;
}

void put_rates(std::span<const Beat> beats, double nominal_period_s, Diary& diary) {
  timing_model::put_rates(beats, nominal_period_s, diary.changes);
}

std::vector<Change> strongest_changes(const Diary& diary, std::size_t most, bool stand_out) {
  std::vector<Change> changes = strongest_first(diary.changes);
  std::erase_if(changes, [&](const Change& change) { return change.stands_out != stand_out; });
  if (changes.size() > most) changes.resize(most);
  std::sort(changes.begin(), changes.end(), is_before);
  return changes;
}

} // namespace goingrate
