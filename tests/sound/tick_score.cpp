#include "sound/tick_score.hpp"

#include "base/robust.hpp"

#include <algorithm>
#include <cmath>

namespace goingrate::test {

namespace {

constexpr double near_s = 5e-3;

// Which true beat is the nearest.
std::size_t nearest(const std::vector<Tick>& truth, double at) {
  const auto after = std::lower_bound(truth.begin(), truth.end(), at,
                                      [](const Tick& tick, double x) { return tick.at < x; });
  const auto i = static_cast<std::size_t>(after - truth.begin());
  if (i == 0) return 0;
  if (i == truth.size()) return i - 1;
  return truth[i].at - at < at - truth[i - 1].at ? i : i - 1;
}

} // namespace

TickScore score(const ClockSound& clock, std::optional<double> nominal_period_s) {
  const Recorded recorded = record(clock);
  const TickTrain train = find_ticks(recorded.sound(clock.rate_hz), nominal_period_s);
  TickScore result;
  result.beats = recorded.truth.size();
  result.period_s = train.period / clock.rate_hz;
  std::vector<double> errors[2], sigmas[2];
  std::vector<bool> taken(result.beats, false);
  int swapped = -1;
  for (const Tick& tick : train.ticks) {
    if (recorded.truth.empty()) {
      ++result.false_beats;
      continue;
    }
    const std::size_t i = nearest(recorded.truth, tick.at);
    const double error = (tick.at - recorded.truth[i].at) / clock.rate_hz;
    if (std::abs(error) > near_s || taken[i]) {
      ++result.false_beats;
      continue;
    }
    taken[i] = true;
    ++result.found;
    const int kind = recorded.truth[i].is_tock ? 1 : 0;
    errors[kind].push_back(error);
    sigmas[kind].push_back(tick.sigma / clock.rate_hz);
    const int now = tick.is_tock == recorded.truth[i].is_tock ? 0 : 1;
    if (swapped >= 0 && now != swapped) result.swaps = true;
    swapped = now;
  }
  std::vector<double> sizes;
  for (int kind = 0; kind < 2; ++kind) {
    if (errors[kind].empty()) continue;
    std::vector<double> work = errors[kind];
    result.bias_s[kind] = median(work);
    for (std::size_t i = 0; i < errors[kind].size(); ++i) {
      const double off = std::abs(errors[kind][i] - result.bias_s[kind]);
      sizes.push_back(off);
      result.within68 += off < sigmas[kind][i] ? 1 : 0;
      result.within95 += off < 1.96 * sigmas[kind][i] ? 1 : 0;
    }
  }
  if (sizes.empty()) return result;
  result.scatter_s = 1.4826 * median(sizes);
  std::vector<double> stated = sigmas[0];
  stated.insert(stated.end(), sigmas[1].begin(), sigmas[1].end());
  result.sigma_s = median(stated);
  return result;
}

} // namespace goingrate::test
