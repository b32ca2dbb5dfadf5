#include "interruptions.hpp"

#include "base/special_values.hpp"
#include "fit/timing_noise.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>

namespace goingrate::timing_model {

namespace {

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
    return {}; // at an end of the scan: no curvature shows
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
  result.shorter_window_s = result.longer_window_s = not_known;
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
  recovery->shorter_window_s = shorter ? shorter->time_constant_s : not_known;
  recovery->longer_window_s = longer ? longer->time_constant_s : not_known;
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

} // namespace

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

} // namespace goingrate::timing_model
