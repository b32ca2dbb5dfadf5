#include "log/angle_samples.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>

namespace goingrate {

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

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
// deviation so far, fading by `fade` a sample, for ring-downs.
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
  // Where samples are few a step is a whole number of them: the mean of those that hold one period.
  const double middle = median(steps);
  std::erase_if(steps, [&](double step) { return std::abs(step - middle) > middle / 3.0; });
  return std::accumulate(steps.begin(), steps.end(), 0.0) / static_cast<double>(steps.size());
}

// A least-squares polynomial in u = (t - centre) / half_width.
template <int Terms> class LocalFit {
public:
  using Vector = Eigen::Matrix<double, Terms, 1>;

  LocalFit(std::span<const AngleSample> samples, const Instant& centre, double half_width,
           double level)
      : half_width_(half_width) {
    Eigen::Matrix<double, Terms, Terms> normal = Eigen::Matrix<double, Terms, Terms>::Zero();
    Vector moment = Vector::Zero();
    double sum2 = 0.0;
    for (const AngleSample& sample : samples) {
      const Vector row = powers((sample.time - centre) / half_width);
      const double value = sample.angle - level;
      normal += row * row.transpose();
      moment += row * value;
      sum2 += value * value;
    }
    inverse_ = normal.inverse();
    coefficients = inverse_ * moment;
    residual2 = std::max(0.0, sum2 - coefficients.dot(moment));
    freedom = static_cast<double>(samples.size()) - Terms;
  }

  [[nodiscard]] double value(double u) const { return coefficients.dot(powers(u)); }
  [[nodiscard]] double slope(double u) const {
    double sum = 0.0;
    for (int k = Terms - 1; k >= 1; --k)
      sum = sum * u + k * coefficients[k];
    return sum;
  }
  /// Variance of value(u) for samples of variance one.
  [[nodiscard]] double variance(double u) const {
    const Vector row = powers(u);
    return row.dot(inverse_ * row);
  }
  [[nodiscard]] double half_width() const { return half_width_; }

  Vector coefficients;
  double residual2 = 0.0;
  double freedom = 0.0;

private:
  static Vector powers(double u) {
    Vector row;
    double power = 1.0;
    for (int k = 0; k < Terms; ++k, power *= u)
      row[k] = power;
    return row;
  }
  double half_width_;
  Eigen::Matrix<double, Terms, Terms> inverse_;
};

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

using Cubic = LocalFit<4>;

// The root of the cubic nearest its middle; NaN if Newton's steps leave the samples.
double root_of(const Cubic& fit) {
  double u = 0.0;
  for (int i = 0; i < 20; ++i) {
    const double step = fit.value(u) / fit.slope(u);
    u -= step;
    if (!(std::abs(u) <= 1.0)) return unknown;
    if (std::abs(step) < 1e-14) break;
  }
  return u;
}

class SwingFinder {
public:
  SwingFinder(std::span<const AngleSample> samples, std::vector<Passage> found, double period_s,
              double rest, bool in_rad)
      : samples_(samples), passages_(std::move(found)), period_s_(period_s), rest_(rest),
        in_rad_(in_rad) {}

  SampledSwings find() {
    SampledSwings swings;
    swings.rest_angle = rest_;
    swings.period_s = period_s_;
    const std::vector<double> turns = turning_angles();
    double residual2 = 0.0, freedom = 0.0;
    for (std::size_t k = 0; k < passages_.size(); ++k) {
      const auto fit = fit_passage(passages_[k]);
      const double u = fit ? root_of(*fit) : unknown;
      if (std::isnan(u)) {
        ++swings.unfitted;
        continue;
      }
      residual2 += fit->residual2;
      freedom += fit->freedom;
      // The noise comes later, when all fits are pooled.
      const double sigma =
          std::sqrt(fit->variance(u)) * fit->half_width() / std::abs(fit->slope(u));
      swings.crossings.push_back({centre_ + u * fit->half_width(), sigma, swing_at(turns, k),
                                  passages_[k].edge, samples_[passages_[k].before].line});
    }
    swings.noise = freedom > 0.0 ? std::sqrt(residual2 / freedom) : 0.0;
    for (SampledCrossing& crossing : swings.crossings)
      crossing.sigma_s *= swings.noise;
    return swings;
  }

  // Median of the middles of neighbouring turning angles; a swing that fades by the same part each
  // time has its middle in (a + 2 b + c) / 4.
  [[nodiscard]] double middle() const {
    const std::vector<double> turns = turning_angles();
    std::vector<double> middles;
    for (std::size_t k = 0; k + 2 < turns.size(); ++k) {
      const double middle = 0.25 * (turns[k] + 2.0 * turns[k + 1] + turns[k + 2]);
      if (!std::isnan(middle)) middles.push_back(middle);
    }
    return middles.empty() ? rest_ : median(std::move(middles));
  }

private:
  std::optional<Cubic> fit_passage(const Passage& passage) {
    const AngleSample& a = samples_[passage.before];
    const AngleSample& b = samples_[passage.after];
    if (b.time - a.time > 0.5 * period_s_) return {}; // the passage itself was not seen
    const double part = (rest_ - a.angle) / (b.angle - a.angle);
    centre_ = a.time + part * (b.time - a.time);
    constexpr std::size_t least_samples = 6; // two more than the cubic has terms
    for (const double width : {0.125, 0.167}) {
      const auto near = around(samples_, passage.before, centre_, width * period_s_);
      if (near.size() < least_samples) continue;
      const Cubic fit(near, centre_, width * period_s_, rest_);
      if (fit.coefficients.allFinite()) return fit;
    }
    return {};
  }

  // The extreme between passage k and the next; NaN where it cannot be fitted.
  [[nodiscard]] double turning_angle(std::size_t k) const {
    const std::size_t begin = passages_[k].after, end = passages_[k + 1].before + 1;
    const double side = passages_[k].edge == Edge::up ? 1.0 : -1.0;
    const auto extreme = std::max_element(samples_.begin() + static_cast<std::ptrdiff_t>(begin),
                                          samples_.begin() + static_cast<std::ptrdiff_t>(end),
                                          [side](const AngleSample& a, const AngleSample& b) {
                                            return side * a.angle < side * b.angle;
                                          });
    const auto at = static_cast<std::size_t>(extreme - samples_.begin());
    const double width =
        period_s_ / 12.0; // half an hour on the dial of a swing: a parabola, almost
    const auto near = around(samples_, at, extreme->time, width);
    if (near.size() < 4) return extreme->angle;
    const LocalFit<3> fit(near, extreme->time, width, rest_);
    const auto& c = fit.coefficients;
    if (!(c[2] * side < 0.0)) return extreme->angle;
    const double u = std::clamp(-0.5 * c[1] / c[2], -1.0, 1.0);
    // The fourth derivative of a pendulum that turns at A is sin A cos A in scaled time; a parabola
    // fitted over +-W lies 3 W^4/35 of the fourth-order term too low in the middle.
    const double reach = 2.0 * std::numbers::pi * width / period_s_, turn = fit.value(u);
    const double fourth = in_rad_ ? std::sin(turn) * std::cos(turn) : turn;
    return rest_ + turn + 3.0 / 35.0 * std::pow(reach, 4) / 24.0 * fourth;
  }

  [[nodiscard]] std::vector<double> turning_angles() const {
    std::vector<double> turns;
    for (std::size_t k = 0; k + 1 < passages_.size(); ++k) {
      const double wait =
          samples_[passages_[k + 1].before].time - samples_[passages_[k].after].time;
      turns.push_back(wait > period_s_ ? unknown : turning_angle(k));
    }
    return turns;
  }

  [[nodiscard]] double swing_at(const std::vector<double>& turns, std::size_t k) const {
    if (k == 0 || k >= turns.size()) return unknown; // one turn alone is half a swing early or late
    return 0.5 * (std::abs(turns[k - 1] - rest_) + std::abs(turns[k] - rest_));
  }

  std::span<const AngleSample> samples_;
  std::vector<Passage> passages_;
  double period_s_;
  double rest_;
  bool in_rad_;
  Instant centre_{};
};

// Few samples a period: sines through several of them.
class SineFinder {
public:
  SineFinder(std::span<const AngleSample> samples, std::vector<Passage> found, double period_s,
             bool in_rad)
      : samples_(samples), passages_(std::move(found)), period_s_(period_s), in_rad_(in_rad),
        decay_(passages_.size(), 0.0) {}

  // `rest` is where the pendulum hangs, if that is known.
  SampledSwings find(std::optional<double> rest) {
    fit_all({}); // for the amplitudes, which tell how the swing fades, the middle and the period
    refine_period();
    fit_all({});
    for (std::size_t k = 0; k < fits_.size(); ++k)
      decay_[k] = decay_near(k);
    if (!rest) rest = middle();
    fit_all(rest);
    fit_all(rest); // with the harmonic of the amplitudes just found
    SampledSwings swings;
    swings.period_s = period_s_;
    swings.rest_angle = rest.value_or(0.0);
    double residual2 = 0.0, freedom = 0.0;
    for (std::size_t k = 0; k < fits_.size(); ++k) {
      if (!fits_[k]) {
        ++swings.unfitted;
        continue;
      }
      const Sine& sine = *fits_[k];
      residual2 += sine.residual2;
      freedom += sine.freedom;
      swings.crossings.push_back({sine.centre + sine.root_s, sine.unit_sigma_s, sine.amplitude,
                                  passages_[k].edge, samples_[passages_[k].before].line});
    }
    swings.noise = freedom > 0.0 ? std::sqrt(residual2 / freedom) : 0.0;
    for (SampledCrossing& crossing : swings.crossings)
      crossing.sigma_s *= swings.noise;
    return swings;
  }

private:
  struct Sine {
    Instant centre;
    double root_s = 0.0, amplitude = 0.0, middle = 0.0;
    double unit_sigma_s = 0.0; // of the root, for samples of variance one
    double residual2 = 0.0, freedom = 0.0;
  };

  void fit_all(std::optional<double> rest) {
    const std::vector<std::optional<Sine>> before = std::move(fits_);
    fits_.clear();
    for (std::size_t k = 0; k < passages_.size(); ++k)
      fits_.push_back(
          fit(passages_[k], decay_[k], rest, k < before.size() ? before[k] : std::nullopt));
  }

  // What a pendulum's swing has beside its sine: A^2/192 of it at three times the frequency (next
  // order of Lindstedt's expansion; Landau and Lifshitz, Mechanics, 28), so that the turning angle
  // is A. Only of an angle in rad, as amplitudes are.
  static double harmonic(const Sine& sine, double from_root, double w, double side) {
    const double A = sine.amplitude, share = A * A / 192.0;
    return side * A * share * (std::sin(w * from_root) + std::sin(3.0 * w * from_root));
  }

  // The period of the fitted crossings: that of the passages is known to a sample only.
  void refine_period() {
    std::vector<double> steps;
    for (std::size_t k = 0; k + 2 < fits_.size(); ++k) {
      const auto &a = fits_[k], &b = fits_[k + 2];
      if (a && b) steps.push_back(b->centre - a->centre + b->root_s - a->root_s);
    }
    if (!steps.empty()) period_s_ = median(std::move(steps));
  }

  // exp(-decay t) (a cos wt + b sin wt) + middle, the middle free unless `rest` is known.
  // `before`: the last fit, whose harmonic is taken off.
  std::optional<Sine> fit(const Passage& passage, double decay, std::optional<double> rest,
                          const std::optional<Sine>& before) const {
    const AngleSample &a = samples_[passage.before], &b = samples_[passage.after];
    const double wait = b.time - a.time;
    if (wait > 0.95 * period_s_) return {}; // there may be three crossings between the two
    Sine sine;
    sine.centre = a.time + 0.5 * wait;
    constexpr double reach = 0.6; // periods: the fewest samples leave a freedom even so
    const auto near = around(samples_, passage.before, sine.centre, reach * period_s_);
    const Eigen::Index terms = rest ? 2 : 3;
    if (static_cast<Eigen::Index>(near.size()) < terms) return {};
    const double w = 2.0 * std::numbers::pi / period_s_;
    Eigen::MatrixXd rows(near.size(), terms);
    Eigen::VectorXd values(near.size());
    for (Eigen::Index i = 0; i < rows.rows(); ++i) {
      const AngleSample& sample = near[static_cast<std::size_t>(i)];
      const double t = sample.time - sine.centre, size = std::exp(-decay * t);
      rows(i, 0) = size * std::cos(w * t);
      rows(i, 1) = size * std::sin(w * t);
      if (!rest) rows(i, 2) = 1.0;
      values(i) = sample.angle - rest.value_or(0.0);
      if (before && in_rad_)
        values(i) -=
            size * harmonic(*before, t - before->root_s, w, passage.edge == Edge::up ? 1.0 : -1.0);
    }
    const Eigen::MatrixXd inverse = (rows.transpose() * rows).inverse();
    const Eigen::VectorXd c = inverse * (rows.transpose() * values);
    sine.amplitude = std::hypot(c[0], c[1]);
    if (!std::isfinite(sine.amplitude) || sine.amplitude == 0.0) return {};
    // Rising, the sine is amplitude * sin(w (t - root)).
    const double side = passage.edge == Edge::up ? 1.0 : -1.0;
    sine.root_s = -std::atan2(side * c[0], side * c[1]) / w;
    if (std::abs(sine.root_s) > 0.5 * wait) return {};
    const double u = w * sine.root_s;
    const double slope = sine.amplitude * w;
    const Eigen::Vector2d at_root(std::cos(u), std::sin(u));
    sine.unit_sigma_s = std::sqrt(at_root.dot(inverse.topLeftCorner<2, 2>() * at_root)) / slope;
    sine.middle = rest ? *rest : c[2];
    sine.residual2 = (values - rows * c).squaredNorm();
    sine.freedom = static_cast<double>(near.size()) - static_cast<double>(terms);
    return sine;
  }

  // How fast the amplitude falls about passage k, 1/s: the slope of its logarithm.
  [[nodiscard]] double decay_near(std::size_t k) const {
    constexpr std::size_t reach = 12; // passages either way
    double n = 0.0, t = 0.0, y = 0.0, tt = 0.0, ty = 0.0;
    const std::size_t end = std::min(fits_.size(), k + reach + 1);
    for (std::size_t i = k > reach ? k - reach : 0; i < end; ++i) {
      if (!fits_[i] || !fits_[k]) continue;
      const double at = fits_[i]->centre - fits_[k]->centre, log = std::log(fits_[i]->amplitude);
      ++n, t += at, y += log, tt += at * at, ty += at * log;
    }
    const double spread = n * tt - t * t;
    return n > 2.0 && spread > 0.0 ? -(n * ty - t * y) / spread : 0.0;
  }

  [[nodiscard]] double middle() const {
    std::vector<double> middles;
    for (const auto& fit : fits_)
      if (fit) middles.push_back(fit->middle);
    return middles.empty() ? 0.0 : median(std::move(middles));
  }

  std::span<const AngleSample> samples_;
  std::vector<Passage> passages_;
  double period_s_;
  bool in_rad_;
  std::vector<double> decay_; // one a passage
  std::vector<std::optional<Sine>> fits_;
};

// Of irregular samples the usual time between two.
double usual_step(std::span<const AngleSample> samples) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < samples.size(); ++i)
    steps.push_back(samples[i].time - samples[i - 1].time);
  return median(std::move(steps));
}

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
  // A swing's memory: half of it is lost in five periods, faster than any ring-down worth timing.
  const double fade = std::min(0.1, 0.14 * step_s / period_s);
  constexpr double samples_for_cubics = 32.0; // eight in a quarter of a period
  const double step_between = usual_step(samples);
  const double samples_per_period = period_s / step_between;
  const bool coarse = samples_per_period < samples_for_cubics;
  for (int round = 0; round < 2; ++round) { // the second with the rest angle of the first
    found = passages(samples, rest, 0.0, fade);
    period_s = period_between(samples, found);
    if (!(period_s > 0.0) || rest_angle || coarse) break;
    rest = SwingFinder(samples, found, period_s, rest, in_rad).middle();
  }
  if (!(period_s > 0.0)) return none;
  SampledSwings swings;
  if (!coarse)
    swings = SwingFinder(samples, std::move(found), period_s, rest, in_rad).find();
  else if (samples_per_period >= fewest_samples_per_period)
    swings = SineFinder(samples, std::move(found), period_s, in_rad).find(rest_angle);
  swings.samples_per_period =
      swings.period_s > 0.0 ? swings.period_s / step_between : samples_per_period;
  return swings;
}

} // namespace goingrate
