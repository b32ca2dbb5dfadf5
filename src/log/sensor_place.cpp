// Estimates the sensor's angle from the two half-periods, or from times that vary with the
// amplitude.
#include "goingrate/log/amplitude.hpp"

#include "typical_period.hpp"

#include "base/scaled_time.hpp"
#include "base/special_values.hpp"

#include <algorithm>
#include <boost/math/special_functions/jacobi_elliptic.hpp>
#include <cmath>
#include <optional>
#include <vector>

namespace goingrate {

namespace {

// One whole swing: how late the upward crossings are against the downward one between them.
struct Swing {
  std::size_t up;   // the upward beat that begins it
  std::size_t down; // the downward one within
  std::size_t next; // the upward one that ends it
  double late_s;    // from the vertical to the sensor
};

// The angle that a free pendulum of this amplitude (rad) passes `late_s` after the vertical:
// sin(alpha/2) = k sn(2 pi late/T0, k), k = sin(A/2). The harmonic A sin(2 pi late/T0) is A^2/24
// too large.
double angle_passed(double amplitude, double late_s, double T0_s) {
  const double k = std::sin(0.5 * amplitude);
  return 2.0 * std::asin(k * boost::math::jacobi_sn(k, two_pi * late_s / T0_s));
}

// The amplitude of the pendulum that passes the angle then.
double amplitude_passing(double angle, double late_s, double T0_s) {
  double amplitude = angle / std::sin(two_pi * late_s / T0_s);
  for (int round = 0; round < 3; ++round) { // each gains a factor of A^2/24
    if (!(amplitude > 0.0 && amplitude < std::numbers::pi)) break;
    amplitude *= angle / angle_passed(amplitude, late_s, T0_s);
  }
  return amplitude;
}

// Passes swings on, less what the course of the period makes the second half shorter or longer than
// the first: a quarter of the change from swing to swing, by the swings on both sides.
template <class Take> class WithoutCourse {
public:
  explicit WithoutCourse(Take& take) : take_(take) {}
  void add(const Swing& swing, double period_s) {
    const bool follows = has_one_ && swing_.next == swing.up;
    if (has_one_) pass(follows ? period_s : not_known);
    before_s_ = follows ? period_s_ : not_known;
    period_s_ = period_s;
    swing_ = swing;
    has_one_ = true;
  }
  void finish() {
    if (has_one_) pass(not_known);
  }

private:
  void pass(double after_s) {
    const double from = std::isnan(before_s_) ? period_s_ : before_s_;
    const double to = std::isnan(after_s) ? period_s_ : after_s;
    const double swings = (std::isnan(before_s_) ? 0.0 : 1.0) + (std::isnan(after_s) ? 0.0 : 1.0);
    if (swings > 0.0) swing_.late_s -= 0.25 * 0.25 * (to - from) / swings;
    take_(swing_);
  }

  Take& take_;
  Swing swing_{};
  bool has_one_ = false;
  double before_s_ = not_known, period_s_ = not_known; // of the swing before it, and of itself
};

// Passes each triple of an upward, a downward and the next upward crossing to `take`.
template <class Take> void for_each_swing(std::span<const Beat> beats, Take take) {
  WithoutCourse<Take> swings(take);
  std::size_t before = beats.size(), down = beats.size(); // none yet
  for (std::size_t i = 0; i < beats.size(); ++i) {
    const Beat& beat = beats[i];
    if (beat.flag == BeatFlag::down) {
      const bool next = before < beats.size() && beat.cycle == beats[before].cycle;
      down = next ? i : beats.size();
    }
    if (beat.flag != BeatFlag::good) continue;
    if (down < beats.size() && beat.cycle == beats[before].cycle + 1 &&
        beat.segment == beats[before].segment) {
      const double right = beats[down].time - beats[before].time;
      const double left = beat.time - beats[down].time;
      swings.add(Swing{before, down, i, 0.25 * (left - right)}, left + right);
    }
    before = i;
    down = beats.size();
  }
  swings.finish();
}

// Mean of the values within five robust standard deviations, and its standard error.
SensorEstimate robust_mean(const std::vector<double>& values) {
  std::vector<double> sorted = values; // the median reorders
  const double centre = median(sorted);
  std::vector<double> deviations;
  for (const double value : values)
    deviations.push_back(std::abs(value - centre));
  const double limit = 5.0 * 1.4826 * median(deviations);
  double sum = 0.0, sum2 = 0.0, count = 0.0;
  for (const double value : values) {
    if (std::abs(value - centre) > limit) continue;
    sum += value - centre;
    sum2 += (value - centre) * (value - centre);
    ++count;
  }
  const double mean = sum / count;
  const double variance = std::max(0.0, sum2 / count - mean * mean);
  return {centre + mean, std::sqrt(variance / std::max(1.0, count - 1.0))};
}

constexpr std::size_t fewest_swings = 3;

std::optional<SensorEstimate> offset_from_halves(std::span<const Beat> beats, double period_s) {
  std::vector<double> offsets;
  for_each_swing(beats, [&](const Swing& swing) {
    const double own = beats[swing.down].amplitude_rad;
    const double first = beats[swing.up].amplitude_rad, last = beats[swing.next].amplitude_rad;
    const double about = std::isnan(last) ? first : 0.5 * (first + last);
    const double amplitude = std::isnan(own) ? about : own;
    if (!std::isnan(amplitude)) offsets.push_back(angle_passed(amplitude, swing.late_s, period_s));
  });
  if (offsets.size() < fewest_swings) return {};
  return robust_mean(offsets);
}

// Second differences over consecutive upward beats of times and of asin(alpha/lambda) T0 / 2 pi.
struct Curvature {
  std::vector<double> time, shift, slope; // s; slope: of the shift against alpha, s/rad
};

Curvature curvature_at(std::span<const Beat> good, double alpha, double period_s) {
  Curvature result;
  const double scale = period_s / two_pi;
  for (std::size_t i = 1; i + 1 < good.size(); ++i) {
    const Beat &a = good[i - 1], &b = good[i], &c = good[i + 1];
    if (b.cycle != a.cycle + 1 || c.cycle != b.cycle + 1 || c.segment != a.segment) continue;
    const double limit = std::abs(alpha);
    if (!(a.amplitude_rad > limit && b.amplitude_rad > limit && c.amplitude_rad > limit)) continue;
    const auto shift = [&](const Beat& beat) {
      return scale * std::asin(alpha / beat.amplitude_rad);
    };
    const auto slope = [&](const Beat& beat) {
      return scale / std::sqrt(beat.amplitude_rad * beat.amplitude_rad - alpha * alpha);
    };
    result.time.push_back((c.time - b.time) - (b.time - a.time));
    result.shift.push_back(shift(a) - 2.0 * shift(b) + shift(c));
    result.slope.push_back(slope(a) - 2.0 * slope(b) + slope(c));
  }
  return result;
}

// Whether the amplitude scatters about its course from beat to beat rather than wandering: the
// steps of white scatter have a correlation of -1/2, those of a wander driven from beat to beat of
// 0.
bool amplitude_scatters(std::span<const Beat> good) {
  double variance = 0.0, next = 0.0;
  for (std::size_t i = 2; i < good.size(); ++i) {
    const double before = good[i - 1].amplitude_rad - good[i - 2].amplitude_rad;
    const double after = good[i].amplitude_rad - good[i - 1].amplitude_rad;
    variance += after * after;
    next += before * after;
  }
  return next < -0.3 * variance;
}

std::optional<SensorEstimate> offset_from_correlation(std::span<const Beat> good, double period_s) {
  if (!amplitude_scatters(good)) return {};
  SensorEstimate estimate;
  constexpr int most_steps = 20;
  constexpr std::size_t fewest_beats = 30; // a correlation of less says nothing
  for (int step = 0; step < most_steps; ++step) {
    const Curvature now = curvature_at(good, estimate.value, period_s);
    if (now.time.size() < fewest_beats) return {};
    std::vector<double> sizes;
    for (std::size_t i = 0; i < now.time.size(); ++i)
      sizes.push_back(std::abs(now.time[i] - now.shift[i]));
    const double limit = 5.0 * 1.4826 * median(sizes);
    double moment = 0.0, weight = 0.0, residual2 = 0.0, count = 0.0;
    for (std::size_t i = 0; i < now.time.size(); ++i) {
      const double residual = now.time[i] - now.shift[i];
      if (std::abs(residual) > limit) continue;
      moment += now.slope[i] * residual;
      weight += now.slope[i] * now.slope[i];
      residual2 += residual * residual;
      ++count;
    }
    if (!(weight > 0.0)) return {};
    const double change = moment / weight;
    estimate.value += change;
    // Second differences of white jitter are correlated (-4/6, 1/6): the slope's are alike, so the
    // variance of the sum is up to (1 + 2 (16 + 1)/36) times that of independent terms.
    estimate.sigma = std::sqrt(residual2 / count / weight * (1.0 + 34.0 / 36.0));
    if (!std::isfinite(estimate.value)) return {};
    if (std::abs(change) < 1e-3 * estimate.sigma) break;
  }
  return estimate;
}

} // namespace

std::optional<AmplitudeSummary> summarise_amplitudes(std::span<const Beat> good) {
  double sum = 0.0, sum2 = 0.0, count = 0.0;
  std::vector<double> sizes;
  for (std::size_t i = 0; i < good.size(); ++i) {
    if (std::isnan(good[i].amplitude_rad)) continue;
    sum += good[i].amplitude_rad;
    sum2 += good[i].amplitude_rad * good[i].amplitude_rad;
    ++count;
    if (i < 2) continue;
    const double bend =
        good[i].amplitude_rad - 2.0 * good[i - 1].amplitude_rad + good[i - 2].amplitude_rad;
    if (!std::isnan(bend)) sizes.push_back(std::abs(bend));
  }
  if (sizes.size() < 3) return {};
  return AmplitudeSummary{sum / count, std::sqrt(sum2 / count),
                          1.4826 * median(sizes) / std::sqrt(6.0)};
}

std::optional<SensorEstimate> beat_error(std::span<const Beat> beats) {
  std::vector<double> errors;
  for_each_swing(beats, [&](const Swing& swing) { errors.push_back(4.0 * swing.late_s); });
  if (errors.size() < fewest_swings) return {};
  return robust_mean(errors);
}

std::optional<SensorEstimate> sensor_offset(std::span<const Beat> beats, double period_s) {
  if (const auto halves = offset_from_halves(beats, period_s)) return halves;
  std::vector<Beat> good;
  for (const Beat& beat : beats)
    if (beat.flag == BeatFlag::good && !std::isnan(beat.amplitude_rad)) good.push_back(beat);
  return offset_from_correlation(good, period_s);
}

void set_amplitudes_from_halves(std::span<Beat> beats, double offset_rad, double period_s) {
  for_each_swing(beats, [&](const Swing& swing) {
    const double amplitude = amplitude_passing(offset_rad, swing.late_s, period_s);
    const bool real = amplitude > 0.0 && amplitude < std::numbers::pi;
    for (const std::size_t i : {swing.up, swing.down})
      if (real && std::isnan(beats[i].amplitude_rad)) beats[i].amplitude_rad = amplitude;
  });
}

} // namespace goingrate
