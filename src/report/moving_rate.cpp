#include "moving_rate.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <vector>

namespace goingrate {

std::string moving_rate(const Analysis& data, const Wording& words) {
  constexpr std::size_t fewest_beats = 32; // eight in a quarter
  constexpr double least_step_sigma = 3.0; // of each of three steps in one direction
  if (data.beats.size() < fewest_beats) return {};
  const Instant first = data.beats.front().time;
  const double whole_s = data.beats.back().time - first;
  const std::vector<Instant> cuts{first + 0.25 * whole_s, first + 0.5 * whole_s,
                                  first + 0.75 * whole_s};
  const auto quarters = rates_between(data.beats, cuts, data.rate.nominal_period_s);
  if (quarters.size() != cuts.size() + 1) return {};
  const RateSummary &begin = quarters.front().rate, &end = quarters.back().rate;
  const double direction = std::copysign(1.0, end.rate_excess - begin.rate_excess);
  for (std::size_t k = 1; k < quarters.size(); ++k) {
    const RateSummary &before = quarters[k - 1].rate, &after = quarters[k].rate;
    const double step = direction * (after.rate_excess - before.rate_excess);
    const double sigma = std::hypot(before.rate_excess_sigma, after.rate_excess_sigma);
    if (!(step > least_step_sigma * sigma)) return {};
  }
  return fmt::format(
      "the rate has moved in one direction throughout this log, from {} in its first "
      "quarter to {} in its last",
      words.rate(begin.rate_excess, begin.rate_excess_sigma),
      words.rate(end.rate_excess, end.rate_excess_sigma));
}

} // namespace goingrate
