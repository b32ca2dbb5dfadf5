#include "goingrate/causes/diary.hpp"

#include "change_kinds.hpp"
#include "facts.hpp"

#include "fit/timing_noise.hpp"
#include "goingrate/base/errors.hpp"
#include "goingrate/log/rates.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <limits>
#include <numbers>

namespace goingrate {

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

// Windows after a change in which relaxation bends rate and amplitude.
constexpr std::size_t wake = 8;

bool is_before(const Change& a, const Change& b) { return a.cycle < b.cycle; }

std::vector<Change> strongest_first(std::vector<Change> changes) {
  std::stable_sort(changes.begin(), changes.end(), [](const Change& a, const Change& b) {
    return a.significance > b.significance;
  });
  return changes;
}

// A series against time.
struct Track {
  std::vector<double> time;
  std::vector<double> value;
};

// Prefix sums give the least-squares slope of any stretch in constant time.
class Slopes {
public:
  explicit Slopes(const Track& track) {
    const double offset = track.value[track.value.size() / 2]; // any typical value keeps sums small
    for (std::size_t i = 0; i < track.time.size(); ++i) {
      const double t = track.time[i];
      const double v = track.value[i] - offset;
      t_.push_back(t_.back() + t);
      v_.push_back(v_.back() + v);
      tt_.push_back(tt_.back() + t * t);
      tv_.push_back(tv_.back() + t * v);
    }
  }

  // Slope of the points [from, to).
  [[nodiscard]] double slope(std::size_t from, std::size_t to) const {
    const auto n = static_cast<double>(to - from);
    const long double t = t_[to] - t_[from];
    const long double stt = tt_[to] - tt_[from] - t * t / n;
    const long double stv = tv_[to] - tv_[from] - t * (v_[to] - v_[from]) / n;
    return static_cast<double>(stv / stt);
  }

private:
  std::vector<long double> t_{0}, v_{0}, tt_{0}, tv_{0}; // precise in sums of 1e7 squares
};

double robust_scatter(std::vector<double> values) {
  if (values.empty()) return 0.0;
  for (double& v : values)
    v = std::abs(v);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return 1.4826 * *middle; // sigma of a normal deviate about zero
}

// Slope jump at every point (0 within a window of the ends) and its robust scatter over the log.
struct Jumps {
  std::vector<double> jump;
  double scatter = 0.0;
  [[nodiscard]] double score(std::size_t i) const { return std::abs(jump[i]) / scatter; }
};

// A smooth bend gives a small jump at every point. The jump predicted from the neighbours two
// windows away (their mean or, near an end, the straight line or parabola through those on one
// side) is subtracted where that makes the jump smaller. A sudden change, which its neighbours do
// not predict, is left unchanged.
double without_bend(const std::vector<double>& jump, std::size_t i, std::size_t window) {
  const std::size_t reach = 2 * window;
  const auto at = [&](std::ptrdiff_t k) {
    const std::ptrdiff_t place =
        static_cast<std::ptrdiff_t>(i) + k * static_cast<std::ptrdiff_t>(reach);
    const auto w = static_cast<std::ptrdiff_t>(window);
    const bool inside = place >= w && place + w < static_cast<std::ptrdiff_t>(jump.size());
    return inside ? jump[static_cast<std::size_t>(place)]
                  : std::numeric_limits<double>::quiet_NaN();
  };
  double least = jump[i];
  const auto consider = [&](double foretold) {
    const double left = jump[i] - foretold;
    if (std::isnan(left)) return;
    if (left * jump[i] <= 0.0)
      least = 0.0;
    else if (std::abs(left) < std::abs(least))
      least = left;
  };
  consider(0.5 * (at(-1) + at(1)));
  if (std::isnan(at(-1) + at(1))) {
    for (const std::ptrdiff_t side : {-1, 1}) {
      consider(2.0 * at(side) - at(2 * side));
      consider(3.0 * at(side) - 3.0 * at(2 * side) + at(3 * side));
    }
  }
  return least;
}

Jumps slope_jumps(const Track& track, std::size_t window, double least_scatter) {
  const Slopes slopes(track);
  Jumps jumps;
  jumps.jump.assign(track.time.size(), 0.0);
  for (std::size_t i = window; i + window < track.time.size(); ++i)
    jumps.jump[i] = slopes.slope(i, i + window) - slopes.slope(i - window, i);
  const std::vector<double> plain = jumps.jump;
  for (std::size_t i = window; i + window < plain.size(); ++i)
    jumps.jump[i] = without_bend(plain, i, window);
  jumps.scatter = robust_scatter({plain.begin() + static_cast<std::ptrdiff_t>(window),
                                  plain.end() - static_cast<std::ptrdiff_t>(window)});
  // Smaller changes are not reported; otherwise a log without noise would be full of them.
  jumps.scatter = std::max(jumps.scatter, least_scatter);
  return jumps;
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
         const std::vector<timing_model::Displacement>& displaced, const DiaryOptions& options)
      : options_(options) {
    auto error = clock_error(beats, nominal_period_s);
    for (const timing_model::Displacement& at : displaced)
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
    const Slopes error(error_);
    change.cycle = cycle_[k];
    change.at_s = error_.time[k];
    change.rate_change = error.slope(k, after) - error.slope(before, k);
    change.amplitude_slope_change = unknown;
    change.significance = significance(k);
    if (!has_amplitude()) return change;
    const Slopes amplitude(amplitude_);
    change.amplitude_slope_change = amplitude.slope(k, after) - amplitude.slope(before, k);
    return change;
  }

private:
  // Gives both series the same indices: a missing amplitude takes the value before it. If more than
  // a tenth are missing, the amplitudes are not used.
  void fill_amplitudes(std::span<const Beat> beats) {
    std::size_t blank = 0;
    double last = unknown;
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

// Relaxation of the points [from, to): a search over the rate, as all other parameters are linear.
std::optional<Relaxation> relax(const Track& track, std::size_t from, std::size_t to,
                                bool to_zero) {
  if (to < from + 20) return {};
  const auto n = static_cast<Eigen::Index>(to - from);
  const double span = track.time[to - 1] - track.time[from];
  Eigen::MatrixXd design(n, to_zero ? 1 : 2);
  Eigen::VectorXd value(n), time(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    value[i] = track.value[from + static_cast<std::size_t>(i)];
    time[i] = track.time[from + static_cast<std::size_t>(i)] - track.time[from];
  }
  Eigen::VectorXd linear;
  const auto misfit = [&](double rate) {
    design.col(0) = (-rate * time.array()).exp();
    if (!to_zero) design.col(1).setOnes();
    linear = design.colPivHouseholderQr().solve(value);
    return Eigen::VectorXd(value - design * linear);
  };
  // The rate is scanned from a hundredth to a hundred per span, then refined.
  double best = 1.0 / span;
  for (double r = 0.01 / span; r < 100.0 / span; r *= 1.2)
    if (misfit(r).squaredNorm() < misfit(best).squaredNorm()) best = r;
  constexpr int bits = 26; // half the digits, as the minimum is flat
  const double rate =
      boost::math::tools::brent_find_minima([&](double r) { return misfit(r).squaredNorm(); },
                                            best / 1.2, best * 1.2, bits)
          .first;
  const Eigen::VectorXd residual = misfit(rate);
  if (rate < 0.011 / span || rate > 90.0 / span || linear.size() == 0)
    return {}; // at an end of the scan: no visible curve
  Eigen::MatrixXd jacobian(n, design.cols() + 1);
  jacobian.leftCols(design.cols()) = design;
  jacobian.col(design.cols()) = -linear[0] * time.array() * design.col(0).array();
  const double variance = residual.squaredNorm() / static_cast<double>(n - jacobian.cols());
  const Eigen::MatrixXd covariance = (jacobian.transpose() * jacobian).inverse() * variance;
  const std::span<const double> white(residual.data(), static_cast<std::size_t>(n));
  Relaxation result;
  result.time_constant_s = 1.0 / rate;
  result.sigma_s =
      std::sqrt(covariance(design.cols(), design.cols()) * correlation_time(white)) / (rate * rate);
  result.window_s = span;
  result.limit_rad = to_zero ? 0.0 : linear[1];
  result.rms_rad = std::sqrt(residual.squaredNorm() / static_cast<double>(n));
  result.shorter_window_s = result.longer_window_s = unknown;
  if (!(result.sigma_s < result.time_constant_s)) return {};
  return result;
}

std::size_t first_after(const Track& track, double time_s) {
  return static_cast<std::size_t>(std::upper_bound(track.time.begin(), track.time.end(), time_s) -
                                  track.time.begin());
}

// The relaxation over the window, and over a shorter and a longer one: a single exponential gives
// the same time constant in all three.
std::optional<Relaxation> recovery_after(const Track& track, std::size_t from, double window_s) {
  const auto over = [&](double part) {
    return relax(track, from, first_after(track, track.time[from] + part * window_s), false);
  };
  auto recovery = over(1.0);
  if (!recovery) return {};
  const auto shorter = over(0.75);
  const auto longer = over(1.25);
  recovery->shorter_window_s = shorter ? shorter->time_constant_s : unknown;
  recovery->longer_window_s = longer ? longer->time_constant_s : unknown;
  // The three fits share their data, so that their time constants may differ by twice the sigma of
  // one; this is doubled for safety.
  const double apart = recovery->longer_window_s - recovery->shorter_window_s;
  recovery->exponential = !(std::abs(apart) > 4.0 * recovery->sigma_s);
  return recovery;
}

double mean_value(const Track& track, std::size_t from, std::size_t to) {
  double sum = 0.0;
  for (std::size_t i = from; i < to; ++i)
    sum += track.value[i];
  return sum / static_cast<double>(to - from);
}

// A loss of drive slows the clock at once and lets the amplitude fall; its return does the reverse.
bool begins_interruption(const Change& change) {
  return change.rate_change < 0.0 && change.amplitude_slope_change < 0.0;
}

bool ends_interruption(const Change& begin, const Change& end) {
  const bool returns = end.rate_change > 0.0 && end.amplitude_slope_change > 0.0;
  return returns &&
         std::abs(end.rate_change + begin.rate_change) < 0.5 * std::abs(begin.rate_change);
}

std::vector<Interruption> interruptions_among(const std::vector<Change>& changes,
                                              const std::vector<std::size_t>& knots,
                                              const Track& amplitude, const DiaryOptions& options) {
  std::vector<Interruption> found;
  for (std::size_t j = 0; j < changes.size(); ++j) {
    if (!begins_interruption(changes[j])) continue;
    std::size_t k = j + 1;
    while (k < changes.size() && !ends_interruption(changes[j], changes[k]))
      ++k;
    if (k == changes.size()) continue;
    const std::size_t from = knots[j], to = knots[k];
    Interruption event;
    event.begin = changes[j];
    event.end = changes[k];
    event.amplitude_before_rad =
        mean_value(amplitude, from - std::min<std::size_t>(from, 20), from);
    event.amplitude_after_rad = mean_value(amplitude, to - std::min<std::size_t>(to - from, 5), to);
    event.rate_change = changes[j].rate_change;
    event.decay = relax(amplitude, from, to, true);
    event.recovery = recovery_after(amplitude, to, options.recovery_window_s);
    found.push_back(event);
    j = k;
  }
  return found;
}

bool is_in(const Interruption& event, const Change& change) {
  return change.at_s >= event.begin.at_s && change.at_s <= event.end.at_s;
}

// The bend of the relaxation after a change may be found as another change. It is dropped if the
// log gives it no kind beside the stronger change.
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
  // A displacement of the times is not a change of the rate.
  TimingData data = timing_data(beats);
  constexpr std::size_t most_displaced = 8;
  const Search search(beats, nominal_period_s,
                      timing_model::take_displacements(data, most_displaced), options);
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
    diary.interruptions = interruptions_among(diary.changes, knots, search.amplitude(), options);
  drop_bends(data, options, diary);
  timing_model::judge_changes(beats, data, diary.changes);
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
