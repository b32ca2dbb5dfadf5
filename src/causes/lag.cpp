#include "lag.hpp"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <cstdint>

namespace goingrate::timing_model {

namespace {

constexpr double lag_step = 1.3; // ratio of successive lags: a response changes little over it

// The cubic through four neighbours (Catmull and Rom), `part` of the way from the second to the
// third; at the ends the outermost is repeated.
double between(std::span<const double> x, std::size_t i, double part) {
  const double a = x[i > 0 ? i - 1 : 0], b = x[i], c = x[std::min(i + 1, x.size() - 1)],
               d = x[std::min(i + 2, x.size() - 1)];
  return b +
         0.5 * part *
             (c - a + part * (2.0 * a - 5.0 * b + 4.0 * c - d + part * (3.0 * (b - c) + d - a)));
}

} // namespace

std::vector<double> lagged(std::span<const double> value, double block_s, double lag_s) {
  if (lag_s == 0.0) return {value.begin(), value.end()};
  constexpr int parts = 8; // of a block, in each of which the series is taken as linear
  const double step_s = block_s / parts, kept = std::exp(-step_s / lag_s);
  std::vector<double> result{value.front()};
  double state = value.front(), from = value.front();
  for (std::size_t i = 0; i + 1 < value.size(); ++i) {
    for (int k = 1; k <= parts; ++k) {
      const double to = between(value, i, static_cast<double>(k) / parts);
      const double behind = (to - from) * lag_s / step_s; // of a straight course, in the end
      state = to - behind + (state - from + behind) * kept;
      from = to;
    }
    result.push_back(state);
  }
  return result;
}

std::vector<double> memory(std::size_t blocks, double block_s, double lag_s) {
  std::vector<double> result;
  for (std::size_t i = 0; i < blocks; ++i)
    result.push_back(std::exp(-block_s / lag_s * static_cast<double>(i)));
  return result;
}

std::vector<double> lags_to_try(std::size_t blocks, double block_s) {
  std::vector<double> lags;
  const double longest_s = 0.3 * block_s * static_cast<double>(blocks);
  for (double lag_s = block_s; lag_s < longest_s; lag_s *= lag_step)
    lags.push_back(lag_s);
  return lags;
}

double refined_lag(double coarse_s, const std::function<double(double)>& deviance) {
  constexpr int bits = 12; // of the logarithm: far more accurate than its σ
  const auto of_log = [&](double log_lag) { return deviance(std::exp(log_lag)); };
  const double at = std::log(coarse_s), step = std::log(lag_step);
  std::uintmax_t most_steps = 20;
  return std::exp(
      boost::math::tools::brent_find_minima(of_log, at - step, at + step, bits, most_steps).first);
}

} // namespace goingrate::timing_model
