#include "log/angle_samples.hpp"
#include "base/special_values.hpp"

#include "swing_shape.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

namespace goingrate {

namespace {

double quantile(std::vector<double> values, double part) {
  const auto at = static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

// A change of sign: the last sample beyond the threshold on one side, the first on the other.
struct Passage {
  std::size_t before;
  std::size_t after;
  Edge edge;
};

// Changes of sign of angle - rest that go beyond `fraction` of the swing. The swing is the largest
// deviation so far, which for ring-downs decays by `fade` per sample.
std::vector<Passage> passages(std::span<const AngleSample> samples, double rest, double swing,
                              double fade) {
  constexpr double fraction =
      0.2; // beyond the noise of any useful log, within reach of every swing
  std::vector<Passage> found;
  int side = 0;
  std::size_t last = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double deviation = samples[i].angle - rest;
    swing = std::max(std::abs(deviation), swing * (1.0 - fade));
    if (std::abs(deviation) < fraction * swing) continue;
    const int now = deviation > 0.0 ? 1 : -1;
    if (side != 0 && now != side) found.push_back({last, i, now > 0 ? Edge::up : Edge::down});
    side = now;
    last = i;
  }
  return found;
}

double period_between(std::span<const AngleSample> samples, const std::vector<Passage>& found) {
  std::vector<double> steps;
  for (std::size_t k = 2; k < found.size(); ++k)
    steps.push_back(samples[found[k].before].time - samples[found[k - 2].before].time);
  if (steps.empty()) return 0.0;
  // If samples are few, a step is a whole number of them, so the mean of the steps of one period is
  // taken.
  const double middle = median(steps);
  std::erase_if(steps, [&](double step) { return std::abs(step - middle) > middle / 3.0; });
  return std::accumulate(steps.begin(), steps.end(), 0.0) / static_cast<double>(steps.size());
}

// The samples within `half_width` of `centre`, found from one of them.
std::span<const AngleSample> around(std::span<const AngleSample> samples, std::size_t start,
                                    const Instant& centre, double half_width) {
  std::size_t begin = start, end = start;
  while (begin > 0 && centre - samples[begin - 1].time <= half_width)
    --begin;
  while (begin < samples.size() && centre - samples[begin].time > half_width)
    ++begin;
  end = std::max(begin, end);
  while (end < samples.size() && samples[end].time - centre <= half_width)
    ++end;
  return samples.subspan(begin, end - begin);
}

// The usual time between two samples, which may be irregular.
double usual_step(std::span<const AngleSample> samples) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < samples.size(); ++i)
    steps.push_back(samples[i].time - samples[i - 1].time);
  return median(std::move(steps));
}

// A polynomial of second order in x through points near 0, by least squares: its course
// at 0.
class LocalParabola {
public:
  void add(double x, double y) {
    const Eigen::Vector3d row(1.0, x, x * x);
    normal_ += row * row.transpose();
    moment_ += row * y;
    ++points_;
  }
  struct Course {
    double slope, bend; // its first and second derivative
  };
  [[nodiscard]] std::optional<Course> course() const {
    constexpr int fewest_samples = 5; // two more than its terms
    if (points_ < fewest_samples) return {};
    const Eigen::Vector3d terms = normal_.ldlt().solve(moment_);
    return terms.allFinite() ? std::optional(Course{terms[1], 2.0 * terms[2]}) : std::nullopt;
  }

private:
  Eigen::Matrix3d normal_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d moment_ = Eigen::Vector3d::Zero();
  int points_ = 0;
};

// Swings through the samples around each passage.
class SwingFinder {
public:
  SwingFinder(std::span<const AngleSample> samples, std::vector<Passage> found, double period_s,
              bool in_rad)
      : samples_(samples), passages_(std::move(found)), period_s_(period_s), in_rad_(in_rad),
        samples_per_period_(period_s / usual_step(samples)),
        local_(passages_.size(), {period_s, 0.0, 0.0}) {}

  // The rest angle: the middle of the swings, except for the unknown decay within each.
  [[nodiscard]] double middle() {
    fit_all({});
    return middle_of_fits();
  }

  // `rest` is the angle of the pendulum at rest, if that is known.
  SampledSwings find(std::optional<double> rest) {
    constexpr int rounds = 3; // each takes an error of the overtones down to a hundredth
    for (int round = 0; round < rounds; ++round) {
      fit_all({});
      look_at_neighbours();
    }
    const double level = rest.value_or(middle_of_fits());
    fit_all(level);
    return told(level);
  }

private:
  struct Swing {
    Instant centre;
    double root_s = 0.0, amplitude = 0.0, middle = 0.0;
    double unit_sigma_s = 0.0; // of the root, for samples of variance one
    double residual2 = 0.0, freedom = 0.0;
    bool is_whole = false; // samples all over a quarter of a period on both sides
    [[nodiscard]] double time_after(const Swing& other) const {
      return (centre - other.centre) + (root_s - other.root_s);
    }
  };
  struct Local {
    double period_s, decay;  // of the swing's size, 1/s
    double quickening = 0.0; // of the angular frequency, rad/s^2
  };

  // Half the width of the samples for one passage, periods. With a quarter no two passages share a
  // sample, and their errors are independent. Fewer than ten samples per period need a larger
  // width.
  [[nodiscard]] double reach() const {
    constexpr double fewest_samples = 5.0, widest = 0.6; // widest: the fewest leave a freedom still
    return std::clamp(0.5 * fewest_samples / samples_per_period_, 0.25, widest);
  }

  // Whether each swing is fitted with a middle of its own, because dry friction moves it to and
  // fro. With a larger width there are too few samples for that.
  [[nodiscard]] bool has_own_middle() const { return reach() == 0.25; }

  void fit_all(std::optional<double> level) {
    const std::vector<std::optional<Swing>> before = std::move(fits_);
    fits_.clear();
    for (std::size_t k = 0; k < passages_.size(); ++k)
      fits_.push_back(fit(k, level, k < before.size() ? before[k] : std::nullopt));
  }

  // The time at which passage k is looked for: its last fit, or between the samples on either side.
  [[nodiscard]] Instant centre_of(std::size_t k, const std::optional<Swing>& before) const {
    if (before) return before->centre + before->root_s;
    const AngleSample &a = samples_[passages_[k].before], &b = samples_[passages_[k].after];
    return a.time + 0.5 * (b.time - a.time);
  }

  // exp(-decay t) (a cos wt + b sin wt) + middle by least squares; the overtones are those of
  // `before`, the last fit. The root is where it is at `level`, or at its middle without one; the
  // middle is `level` where a swing has none of its own.
  [[nodiscard]] std::optional<Swing> fit(std::size_t k, std::optional<double> level,
                                         const std::optional<Swing>& before) const {
    const AngleSample &a = samples_[passages_[k].before], &b = samples_[passages_[k].after];
    const double period = local_[k].period_s;
    if (b.time - a.time > 0.95 * period) return {}; // there may be three crossings between the two
    Swing swing{.centre = centre_of(k, before)};
    const auto near = around(samples_, passages_[k].before, swing.centre, reach() * period);
    const Eigen::Index terms = level && !has_own_middle() ? 2 : 3;
    if (static_cast<Eigen::Index>(near.size()) < terms) return {};
    SwingShape shape{2.0 * std::numbers::pi / period, local_[k].decay,
                     passages_[k].edge == Edge::up ? 1.0 : -1.0};
    shape.quickening = local_[k].quickening;
    shape.square_share = square_share_;
    if (before) shape.amplitude = before->amplitude;
    if (before && in_rad_) shape.overtones = Overtones(before->amplitude);
    const double zero = level.value_or(0.0);
    const SwingSums sums(near, shape, swing.centre, zero);
    const Eigen::Matrix3d inverse = sums.inverse(terms);
    const Eigen::Vector3d c = inverse * sums.moment;
    swing.amplitude = std::hypot(c[0], c[1]);
    if (!std::isfinite(swing.amplitude) || swing.amplitude == 0.0) return {};
    swing.middle = zero + c[2];
    swing.root_s = -std::atan2(shape.side * c[0], shape.side * c[1]) / shape.w;
    if (level) swing.root_s = shape.zero_of(c, swing.root_s);
    constexpr double farthest_periods = 0.1; // periods, from where it was looked for
    if (!(std::abs(swing.root_s) < std::max(0.5 * (b.time - a.time), farthest_periods * period)))
      return {};
    const Eigen::Vector3d at_root = shape.row(swing.root_s);
    swing.unit_sigma_s = std::sqrt(at_root.dot(inverse * at_root)) / (swing.amplitude * shape.w);
    swing.residual2 = std::max(0.0, sums.sum2 - c.dot(sums.moment));
    swing.freedom = static_cast<double>(near.size()) - static_cast<double>(terms);
    const double least = period * (0.25 - 2.0 / samples_per_period_);
    swing.is_whole =
        swing.centre - near.front().time > least && near.back().time - swing.centre > least;
    return swing;
  }

  // The period and the decay about each passage, from its neighbours: both change as a swing dies
  // away, and a period that is wrong by one per cent makes an amplitude wrong by half a per cent.
  void look_at_neighbours() {
    constexpr std::size_t neighbour_count = 12; // passages either way
    const std::vector<double> half_swings = count_half_swings();
    for (std::size_t k = 0; k < fits_.size(); ++k) {
      if (!fits_[k]) continue;
      LocalParabola time, size;
      const std::size_t end = std::min(fits_.size(), k + neighbour_count + 1);
      for (std::size_t i = k > neighbour_count ? k - neighbour_count : 0; i < end; ++i) {
        if (!fits_[i]) continue;
        const double after = fits_[i]->time_after(*fits_[k]);
        time.add(half_swings[i] - half_swings[k], after);
        size.add(after, std::log(fits_[i]->amplitude));
      }
      constexpr double farthest_share =
          0.2; // of the period; else there is a false passage among them
      const auto half = time.course();
      if (half && std::abs(2.0 * half->slope / period_s_ - 1.0) < farthest_share) {
        local_[k].period_s = 2.0 * half->slope;
        local_[k].quickening = -std::numbers::pi * half->bend / std::pow(half->slope, 3);
      }
      if (const auto fall = size.course()) local_[k].decay = -fall->slope;
    }
    square_share_ = share_of_square_law();
  }

  // The power of the amplitude with which the decay goes over the log: 0 for linear friction, 1 for
  // the square law. What friction takes that does not depend on the speed is in a swing's middle.
  [[nodiscard]] double share_of_square_law() const {
    double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
    for (std::size_t k = 0; k < fits_.size(); ++k) {
      if (!fits_[k] || !(local_[k].decay > 0.0)) continue;
      const double size = std::log(fits_[k]->amplitude), decay = std::log(local_[k].decay);
      ++n, x += size, y += decay, xx += size * size, xy += size * decay;
    }
    const double spread = n * xx - x * x;
    return spread > 0.0 ? std::clamp((n * xy - x * y) / spread, 0.0, 1.0) : 0.0;
  }

  // The number of half swings from the first passage to each; some passages may be missing.
  [[nodiscard]] std::vector<double> count_half_swings() const {
    std::vector<double> counts(fits_.size(), 0.0);
    const Swing* last = nullptr;
    double count = 0.0;
    for (std::size_t k = 0; k < fits_.size(); ++k) {
      if (!fits_[k]) continue;
      if (last != nullptr) count += std::round(fits_[k]->time_after(*last) / (0.5 * period_s_));
      last = &*fits_[k];
      counts[k] = count;
    }
    return counts;
  }

  [[nodiscard]] double middle_of_fits() const {
    std::vector<double> middles;
    for (const auto& fit : fits_)
      if (fit) middles.push_back(fit->middle);
    return middles.empty() ? 0.0 : median(std::move(middles));
  }

  // The crossings from the last fits, with a sigma from the noise of all fits.
  [[nodiscard]] SampledSwings told(double level) const {
    SampledSwings swings;
    swings.rest_angle = level;
    double residual2 = 0.0, freedom = 0.0;
    std::vector<double> periods;
    for (std::size_t k = 0; k < fits_.size(); ++k) {
      if (!fits_[k]) {
        ++swings.unfitted;
        continue;
      }
      const Swing& swing = *fits_[k];
      residual2 += swing.residual2;
      freedom += swing.freedom;
      if (k > 1 && fits_[k - 2]) periods.push_back(swing.time_after(*fits_[k - 2]));
      swings.crossings.push_back({swing.centre + swing.root_s, swing.unit_sigma_s,
                                  swing.is_whole ? swing.amplitude : not_known, passages_[k].edge,
                                  samples_[passages_[k].before].line});
    }
    swings.period_s = periods.empty() ? period_s_ : median(std::move(periods));
    swings.samples_per_period = swings.period_s / usual_step(samples_);
    swings.noise = freedom > 0.0 ? std::sqrt(residual2 / freedom) : 0.0;
    for (SampledCrossing& crossing : swings.crossings)
      crossing.sigma_s *= swings.noise;
    return swings;
  }

  std::span<const AngleSample> samples_;
  std::vector<Passage> passages_;
  double period_s_;
  bool in_rad_;
  double samples_per_period_;
  std::vector<Local> local_;  // one a passage
  double square_share_ = 0.0; // of the friction
  std::vector<std::optional<Swing>> fits_;
};

} // namespace

SampledSwings crossings_of_samples(std::span<const AngleSample> samples,
                                   std::optional<double> rest_angle, bool in_rad) {
  SampledSwings none;
  constexpr std::size_t fewest_samples = 8; // three swings of the fewest samples
  if (samples.size() < fewest_samples) return none;
  std::vector<double> angles;
  for (const AngleSample& sample : samples)
    angles.push_back(sample.angle);
  const double low = quantile(angles, 0.05), high = quantile(angles, 0.95);
  double rest = rest_angle.value_or(0.5 * (low + high));
  const double swing = 0.5 * (high - low);
  if (!(swing > 0.0)) return none;
  auto found = passages(samples, rest, swing, 0.0);
  double period_s = period_between(samples, found);
  if (!(period_s > 0.0)) return none;
  const double step_s =
      (samples.back().time - samples.front().time) / static_cast<double>(samples.size() - 1);
  // The decay of the estimated swing: half in five periods, faster than any ring-down worth timing.
  const double fade = std::min(0.1, 0.14 * step_s / period_s);
  for (int round = 0; round < 2; ++round) { // the second with the rest angle of the first
    found = passages(samples, rest, 0.0, fade);
    period_s = period_between(samples, found);
    if (!(period_s > 0.0)) return none;
    none.samples_per_period = period_s / usual_step(samples);
    if (none.samples_per_period < fewest_samples_per_period) return none;
    if (rest_angle) break;
    if (round == 0) rest = SwingFinder(samples, found, period_s, in_rad).middle();
  }
  return SwingFinder(samples, std::move(found), period_s, in_rad).find(rest_angle);
}

} // namespace goingrate
