#include "goingrate/log/angle_samples.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

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
  return steps.empty() ? 0.0 : median(std::move(steps));
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
              double rest)
      : samples_(samples), passages_(std::move(found)), period_s_(period_s), rest_(rest) {}

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
    constexpr std::size_t least = 6; // two more than the cubic has terms
    for (const double width : {0.125, 0.167}) {
      const auto near = around(samples_, passage.before, centre_, width * period_s_);
      if (near.size() < least) continue;
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
    return rest_ + fit.value(u);
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
    double sum = 0.0, count = 0.0;
    for (const std::size_t i : {k - 1, k}) {
      if (i >= turns.size() || std::isnan(turns[i])) continue; // k - 1 of 0 is beyond all
      sum += std::abs(turns[i] - rest_);
      ++count;
    }
    return count > 0.0 ? sum / count : unknown;
  }

  std::span<const AngleSample> samples_;
  std::vector<Passage> passages_;
  double period_s_;
  double rest_;
  Instant centre_{};
};

} // namespace

SampledSwings crossings_of_samples(std::span<const AngleSample> samples,
                                   std::optional<double> rest_angle) {
  SampledSwings none;
  constexpr std::size_t fewest = 18; // six samples for each of three swings
  if (samples.size() < fewest) return none;
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
  for (int round = 0; round < 2; ++round) { // the second with the rest angle of the first
    found = passages(samples, rest, 0.0, fade);
    period_s = period_between(samples, found);
    if (!(period_s > 0.0) || rest_angle) break;
    rest = SwingFinder(samples, found, period_s, rest).middle();
  }
  if (!(period_s > 0.0)) return none;
  return SwingFinder(samples, std::move(found), period_s, rest).find();
}

} // namespace goingrate
