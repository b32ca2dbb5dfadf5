#include "linear_rates.hpp"

#include "gain_spread.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace goingrate::timing_model {

namespace {

double mean_of(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// Whether the last beats scatter as if the pendulum no longer reached the switching angle.
bool comes_to_a_stand(std::span<const double> rates) {
  constexpr std::size_t tail_beats = 30;
  constexpr double outlier_sigma = 4.0;           // standard deviations of the earlier differences
  constexpr std::size_t outliers_of_a_change = 3; // a bad beat may give one or two
  if (rates.size() < 2 * tail_beats) return false;
  const std::size_t tail = rates.size() - tail_beats;
  double before = 0.0;
  std::size_t large = 0;
  for (std::size_t i = 1; i < tail; ++i)
    before += std::pow(rates[i] - rates[i - 1], 2) / static_cast<double>(tail - 1);
  for (std::size_t i = tail; i < rates.size(); ++i)
    large += std::pow(rates[i] - rates[i - 1], 2) > outlier_sigma * outlier_sigma * before ? 1 : 0;
  return large >= outliers_of_a_change;
}

// The Kalman prediction of the slow part of each drive value from the values before it, and its
// variance. (Any other prediction would be correlated with the amplitude and shift the constant.)
class Prediction {
public:
  Prediction(const RateComponents& drive, double period_s)
      : memory_(std::exp(-period_s / drive.memory_s)), white_(drive.fast2),
        fresh_(-std::expm1(-2.0 * period_s / drive.memory_s) * drive.slow2),
        variance_(drive.slow2) {}

  // Squared difference of a drive value from its prediction, scaled to the variance of the white
  // part.
  double take(double d) {
    const double off = d - expected_, all = variance_ + white_;
    expected_ = memory_ * (expected_ + variance_ / all * off);
    variance_ = memory_ * memory_ * variance_ * white_ / all + fresh_;
    return off * off * white_ / all;
  }

private:
  double memory_, white_, fresh_, variance_, expected_ = 0.0;
};

// The share of jitter in the variance of the rate from beat to beat.
double share_of_jitter(const RateComponents& drive, const DriveResponse& response,
                       double period_s) {
  const double jitter = 2.0 * drive.jitter2 / (period_s * period_s);
  return jitter / (jitter + drive.fast2 * response.fast_gain * response.fast_gain);
}

class Recursion {
public:
  Recursion(std::span<const double> rates, double period_s, const DriveResponse& response,
            const RateComponents& drive)
      : rates_(rates), linear_(rates.size()), response_(response), x0_(response.amplitude2),
        phi2_(response.switching_angle * response.switching_angle),
        escapement_(response.fast_gain * x0_ / std::sqrt(x0_ - phi2_)),
        relaxing_(-std::expm1(-period_s / relaxation_s(response))), prediction_(drive, period_s),
        jitter_share_(share_of_jitter(drive, response, period_s)),
        mean_drive_rms_(mean_shift(drive, response, static_cast<double>(rates.size()) * period_s)) {
    asks_white_part_ = equations_error() < mean_drive_rms_;
  }

  // Finds the constant and its uncertainty.
  void run() {
    const double middle = escapement_ * std::sqrt(x0_ - phi2_) / x0_ - x0_ / 16.0 - mean_of(rates_);
    const double sigma = std::abs(response_.slow_gain) * mean_drive_rms_;
    constexpr double reach = 3.0;
    constexpr int steps = 4; // of the grid, on each side
    double best = middle, lowest = std::numeric_limits<double>::infinity();
    for (int i = -steps; i <= steps; ++i) {
      const double constant = middle + reach * sigma * i / steps;
      if (const double here = at(constant); here < lowest) lowest = here, best = constant;
    }
    constexpr int rounds = 3; // of parabolas, each a quarter as wide as the last
    double step = reach * sigma / steps;
    Parabola near = parabola(best, step);
    for (int round = 1; round < rounds; ++round, step *= 0.25) {
      best += near.vertex;
      near = parabola(best, 0.25 * step);
    }
    best += near.vertex;
    if (asks_white_part_ && near.rise > 0.0)
      mean_drive_rms_ =
          std::min(mean_drive_rms_, std::hypot(near.mean_drive_rms, equations_error()));
    (void)at(best);
  }

  [[nodiscard]] bool holds() const {
    // The share of beats at which the amplitude may be held, for a clock that nearly stalls and
    // recovers.
    constexpr double largest_held_share = 1e-3;
    return std::isfinite(mean_drive_) &&
           static_cast<double>(held_) <= largest_held_share * static_cast<double>(rates_.size());
  }
  [[nodiscard]] LinearRates result() const {
    LinearRates result{linear_, mean_drive_rms_};
    const double mean = mean_of(linear_);
    for (double& rate : result.rates)
      rate -= mean;
    return result;
  }

private:
  // -log L of the rates with this constant, or of the mean drive alone where the white part is not
  // used; infinite where the amplitude diverges. The density of the rates is that of the drive over
  // the derivatives d(rate)/dd, and the drive is white about its prediction.
  double at(double constant) {
    constexpr double least_x = 1.01, most_x = 4.0; // in units of phi0^2 and of x0
    const double direction = response_.slow_gain > 0.0 ? 1.0 : -1.0;
    const std::size_t n = rates_.size();
    // Slopes are about 1 each, so one logarithm is taken of the product of this many.
    constexpr std::size_t slopes_per_log = 32;
    double x = x0_, sum = 0.0, squares = 0.0, slopes = 1.0, log_slopes = 0.0;
    Prediction prediction = prediction_;
    held_ = 0;
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t i = direction > 0.0 ? k : n - 1 - k;
      if (x < least_x * phi2_) x = least_x * phi2_, ++held_;
      if (!(x < most_x * x0_)) {
        mean_drive_ = std::numeric_limits<double>::infinity();
        return mean_drive_;
      }
      double half = 0.0, gain = 0.0, d = 0.0, middle = x;
      // The second pass uses the amplitude in mid period that the first finds.
      for (int pass = 0; pass < 2; ++pass) {
        middle = std::max(x + half, least_x * phi2_);
        gain = escapement_ * std::sqrt(middle - phi2_) / middle;
        d = (rates_[i] + constant + middle / 16.0) / gain - 1.0;
        half = 0.5 * direction * relaxing_ * (x0_ * (1.0 + d) - x);
      }
      const double bend =
          (1.0 + d) * gain * (0.5 / (middle - phi2_) - 1.0 / middle) - 1.0 / 16.0; // d(rate)/dx
      slopes *= (gain + 0.5 * direction * relaxing_ * x0_ * bend) / response_.fast_gain;
      if (k % slopes_per_log == 0 || k + 1 == n)
        log_slopes += std::log(std::abs(slopes)), slopes = 1.0;
      squares += prediction.take(d);
      sum += d;
      linear_[i] = response_.fast_gain * d +
                   (response_.slow_gain - response_.fast_gain) * (middle / x0_ - 1.0);
      x += 2.0 * half;
    }
    const double count = static_cast<double>(n);
    mean_drive_ = sum / count;
    if (!asks_white_part_) return 0.5 * std::pow(mean_drive_ / mean_drive_rms_, 2);
    return 0.5 * count * std::log(squares / count) + log_slopes;
  }

  // The parabola through three values of -log L.
  struct Parabola {
    double vertex = 0.0;         // offset from the middle value, at most one step
    double rise = 0.0;           // the curvature times the step squared; 0 without a minimum
    double mean_drive_rms = 0.0; // change of the mean drive as -log L rises by 1/2
  };
  Parabola parabola(double middle, double step) {
    const double here = at(middle), above = at(middle + step), mean_above = mean_drive_;
    const double below = at(middle - step), mean_below = mean_drive_;
    const double rise = above + below - 2.0 * here;
    if (!std::isfinite(rise) || !(rise > 0.0)) return {};
    return {std::clamp(0.5 * step * (below - above) / rise, -step, step), rise,
            0.5 * std::abs(mean_above - mean_below) / std::sqrt(rise)};
  }

  // The smallest error of a mean drive found from the white part. The averaged equations hold for
  // small swings, up to terms of lambda^2, and the slope of log g_fast over log x may be steeper by
  // as much. Jitter, which is independent of g_fast, makes the observed slope less steep by its
  // share. Either imitates another amplitude, off by the change of slope divided by the second
  // derivative.
  [[nodiscard]] double equations_error() const {
    const double y2 = x0_ - phi2_;
    const double slope = 0.5 * x0_ / y2 - 1.0, curvature = 0.5 * x0_ * phi2_ / (y2 * y2);
    return std::hypot(x0_, jitter_share_ * slope) / curvature;
  }

  std::span<const double> rates_;
  std::vector<double> linear_;
  const DriveResponse& response_;
  double x0_, phi2_, escapement_;
  // Share of its distance from the stationary value that the amplitude covers in a period.
  double relaxing_;
  Prediction prediction_; // in its state before the first beat
  double jitter_share_;   // of the variance from beat to beat
  double mean_drive_rms_, mean_drive_ = 0.0;
  bool asks_white_part_ = false;
  std::size_t held_ = 0; // how often the amplitude was limited to avoid a stall
};

} // namespace

bool forgets_its_start(const DriveResponse& response) {
  constexpr double least_gain_ratio = 0.02; // amplitude errors die out in fifty relaxations
  return std::abs(response.slow_gain) > least_gain_ratio * std::abs(response.fast_gain);
}

std::optional<LinearRates> linear_rates(std::span<const double> rates, double period_s,
                                        const DriveResponse& response,
                                        const RateComponents& drive) {
  // With a smaller spread, the gains vary by less than their uncertainty.
  constexpr double least_spread = 0.01;
  if (!(amplitude_spread(drive, response) > least_spread) || !(drive.fast2 > 0.0)) return {};
  if (!forgets_its_start(response)) return {};
  if (comes_to_a_stand(rates)) return {};
  LinearRates result;
  RateComponents known = drive;
  constexpr int rounds = 2; // the second uses the drive found in the first
  for (int round = 0; round < rounds; ++round) {
    Recursion recursion(rates, period_s, response, known);
    recursion.run();
    if (!recursion.holds()) return {};
    result = recursion.result();
    if (round + 1 < rounds) known = ComponentFit(result.rates, period_s, response).best();
    if (!(known.fast2 > 0.0) || !(known.slow2 > 0.0)) return {};
  }
  return result;
}

} // namespace goingrate::timing_model
