#include "slope_jumps.hpp"

#include <algorithm>
#include <limits>

namespace goingrate::timing_model {

namespace {

double robust_scatter(std::vector<double> values) {
  if (values.empty()) return 0.0;
  for (double& v : values)
    v = std::abs(v);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return 1.4826 * *middle; // sigma of a normal deviate about zero
}

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
  const auto consider = [&](double predicted) {
    const double left = jump[i] - predicted;
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

} // namespace

double slope_of(const Track& track, std::size_t from, std::size_t to) {
  const std::size_t middle = from + (to - from) / 2;
  const double t0 = track.time[middle], v0 = track.value[middle];
  double st = 0.0, sv = 0.0, stt = 0.0, stv = 0.0;
  for (std::size_t i = from; i < to; ++i) {
    const double t = track.time[i] - t0, v = track.value[i] - v0;
    st += t;
    sv += v;
    stt += t * t;
    stv += t * v;
  }
  const auto n = static_cast<double>(to - from);
  return (stv - st * sv / n) / (stt - st * st / n);
}

Jumps slope_jumps(const Track& track, std::size_t window, double least_scatter) {
  const std::size_t n = track.time.size();
  std::vector<double> after(n, 0.0); // slope over the window that begins at each point
  for (std::size_t i = 0; i + window < n; ++i)
    after[i] = slope_of(track, i, i + window);
  Jumps jumps;
  jumps.jump.assign(n, 0.0);
  for (std::size_t i = window; i + window < n; ++i)
    jumps.jump[i] = after[i] - after[i - window];
  const std::vector<double> plain = jumps.jump;
  for (std::size_t i = window; i + window < plain.size(); ++i)
    jumps.jump[i] = without_bend(plain, i, window);
  jumps.scatter = robust_scatter({plain.begin() + static_cast<std::ptrdiff_t>(window),
                                  plain.end() - static_cast<std::ptrdiff_t>(window)});
  // Without a lower bound, rounding errors would count as changes in a log without noise.
  jumps.scatter = std::max(jumps.scatter, least_scatter);
  return jumps;
}

} // namespace goingrate::timing_model
