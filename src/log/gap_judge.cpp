#include "gap_judge.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace goingrate {

namespace {

// Over a gap as long as the log, the rate is assumed to wander by 1e-6 (a tenth of a second a day)
// at least, since the log is too short to show less. Over shorter gaps proportionally less.
constexpr double unknown_wander = 1e-6;
// Beats used on each side: over eight times the gap's length the period is known well enough.
constexpr double stretch_per_cycle = 8.0, shortest_stretch = 32.0, longest_stretch = 4096.0;
// Relative uncertainty of the period before the first beat of a stretch.
constexpr double unknown_period_share = 0.02;

std::size_t stretch_for(double cycles) {
  return static_cast<std::size_t>(
      std::clamp(stretch_per_cycle * cycles, shortest_stretch, longest_stretch));
}

// The share of breaks, among those after which the beats had to be looked for afresh, that are
// stops of the clock or jumps of the reference: one in 5000 for each beat of their length, up to
// one in ten from 500 beats on, since a clock is seldom restarted within minutes. If the beats were
// not lost the share is zero: then only a false beat next to the gap can be displaced.
double displaced_share(double cycles) { return std::min(2e-4 * cycles, 0.1); }

} // namespace

bool GapJudge::beyond_belief(double cycles) const {
  return !(cycles <= 10.0 * static_cast<double>(longest_run_));
}

double GapJudge::probability(double misfit, double sigma, double share) const {
  constexpr double largest_sigma_periods =
      3.0; // periods: beyond, no count has a probability of 0.14
  if (!(sigma < largest_sigma_periods)) return 0.0;
  // Likelihoods relative to the nearest count, so that a misfit of many sigmas does not give 0 / 0.
  double counts = 0.0;
  const double reach = std::ceil(8.0 * sigma) + 2.0; // beyond, nothing adds 1e-14
  for (double k = -reach; k <= reach; ++k)
    counts += std::exp(-0.5 * k * (k + 2.0 * misfit) / (sigma * sigma));
  if (share == 0.0) return 1.0 / counts;
  const double at_any_phase =
      sigma * std::sqrt(2.0 * std::numbers::pi) * std::exp(0.5 * misfit * misfit / (sigma * sigma));
  return (1.0 - share) / ((1.0 - share) * counts + share * at_any_phase);
}

// The duration of a gap, given the periods on both sides.
GapJudge::Bridge GapJudge::bridge_over(const ClockFilter& before, const ClockFilter& after,
                                       double n, double rate_walk2) const {
  const auto foreseen = before.after(n, rate_walk2);
  const auto& seen = after.covariance();
  const double tt = foreseen.tt + seen.tt;
  const double tp = foreseen.tp - seen.tp; // the backward filter's time runs backwards
  const double pp = foreseen.pp + seen.pp;
  const double shown = std::min(1.0, n / static_cast<double>(longest_run_));
  const double wander = unknown_wander * shown * n * period_;
  return {tp / pp, std::sqrt(std::max(0.0, tt - tp * tp / pp) + wander * wander)};
}

GapCount GapJudge::judge(const ClockFilter& before, const ClockFilter& after, double elapsed_s,
                         bool lost) const {
  // The backward filter's offset counts backwards in time.
  const double elapsed = elapsed_s - before.offset() - after.offset();
  const double change = after.period() - before.period();
  const double mean = 0.5 * (before.period() + after.period());
  const double n = std::max(1.0, std::round(elapsed / mean));
  if (beyond_belief(n)) return {static_cast<std::int64_t>(std::min(n, 1e15)), 0.0, false};
  // A rate that walked makes the period change by r sqrt(n); where it changed by more, this gap hid
  // a step or a drift, and the walk that explains it leaves as much doubt as a step at any moment.
  const double known = before.covariance().pp + after.covariance().pp;
  const double r2 = std::max(noise_.rate_walk2, (change * change - known) / n);
  const auto bridge = bridge_over(before, after, n, r2);
  const double expected = n * before.period() + bridge.per_change * change;
  const double shift = std::round((elapsed - expected) / mean);
  const double misfit = (elapsed - expected) / mean - shift;
  const double sigma = bridge.sigma_s / mean;
  GapCount count;
  count.cycles = static_cast<std::int64_t>(std::max(1.0, n + shift));
  count.probability = probability(misfit, sigma, lost ? displaced_share(n) : 0.0);
  count.displaced = lost && count.probability < 0.5 && std::abs(misfit) > 3.0 * sigma;
  return count;
}

GapCount GapJudge::count(std::span<const Beat> beats, std::size_t first, std::size_t before,
                         std::size_t after, std::size_t last, bool lost) const {
  const double guess = std::max(1.0, (beats[after].time - beats[before].time) / period_);
  const std::size_t most = stretch_for(guess);
  const auto good = [&](std::size_t i) { return beats[i].flag == BeatFlag::good; };
  std::size_t from = before, seen = 1;
  while (from > first && seen < most)
    if (good(--from)) ++seen;
  while (!good(from))
    ++from;
  std::size_t to = after;
  seen = 1;
  while (to + 1 < last && seen < most)
    if (good(++to)) ++seen;
  while (!good(to))
    --to;
  const auto follow = [](ClockFilter& filter, const Beat& a, const Beat& b) {
    const double n = std::abs(static_cast<double>(b.cycle - a.cycle));
    filter.follow(filter.error(std::abs(b.time - a.time), n), n, filter.after(n));
  };
  ClockFilter forward(noise_, period_), backward(noise_, period_);
  forward.start(unknown_period_share * period_);
  backward.start(unknown_period_share * period_);
  for (std::size_t i = from, k = from + 1; k <= before; ++k)
    if (good(k)) follow(forward, beats[std::exchange(i, k)], beats[k]);
  for (std::size_t i = to, k = to; k-- > after;)
    if (good(k)) follow(backward, beats[std::exchange(i, k)], beats[k]);
  const double elapsed = beats[after].time - beats[before].time;
  GapCount count = judge(forward, backward, elapsed, lost);
  count.reference_set = lost && reference_was_set(forward, backward, elapsed);
  return count;
}

// Whether the next beat came one period and some whole hours after the last: clocks are set from
// one zone to another far more often than a break ends by chance after exactly so long.
bool GapJudge::reference_was_set(const ClockFilter& before, const ClockFilter& after,
                                 double elapsed_s) const {
  constexpr double hour = 3600.0;
  constexpr double longest_swing_s = 60.0; // readings and strokes come whole hours apart anyway
  if (period_ > longest_swing_s) return false;
  const double period = 0.5 * (before.period() + after.period());
  const double hours = std::round((elapsed_s - period) / hour);
  if (hours == 0.0) return false;
  const double error = elapsed_s - hours * hour - period - before.offset() - after.offset();
  const double variance = before.after(1.0).tt + after.covariance().tt;
  // Six sigmas, a thousandth of the period in a log without noise, and never so wide that one break
  // in ten would do.
  const double limit = std::clamp(6.0 * std::sqrt(variance), 1e-3 * period_, 0.05 * period_);
  return std::abs(error) <= limit;
}

std::int64_t GapJudge::longest_countable(double least_probability) const {
  const auto countable = [&](double n) {
    if (beyond_belief(n)) return false;
    ClockFilter filter(noise_, period_);
    filter.start(unknown_period_share * period_);
    const auto most = std::min(stretch_for(n), static_cast<std::size_t>(longest_run_) / 2);
    for (std::size_t k = 1; k < most; ++k)
      filter.follow(0.0, 1.0, filter.after(1.0));
    const double sigma = bridge_over(filter, filter, n, noise_.rate_walk2).sigma_s / period_;
    return sigma < 0.25 && probability(2.0 * sigma, sigma, displaced_share(n)) >= least_probability;
  };
  std::int64_t low = 1, high = 2;
  while (countable(static_cast<double>(high))) {
    low = high;
    high *= 2;
  }
  while (high - low > 1) {
    const std::int64_t middle = low + (high - low) / 2;
    (countable(static_cast<double>(middle)) ? low : high) = middle;
  }
  return low - 1;
}

} // namespace goingrate
