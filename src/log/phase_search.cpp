#include "phase_search.hpp"

#include "typical_period.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

namespace goingrate {

namespace {

constexpr std::size_t most_tried = 40; // three events per period

// How many cycles after `start` have an event on its grid, and how far off these are, rms.
struct Agreement {
  int cycles = 0;
  double off_s = 0.0;
};

Agreement agreement(std::span<const Beat> events, std::size_t start, const PhaseSearch& search) {
  const double period_s = search.period_s;
  Agreement agreed{1, 0.0};
  // The grid follows half of each event's offset, because the period here may differ from the
  // typical
  // one.
  double grid = 0.0;
  for (std::size_t i = start + 1; i < events.size() && i < start + 2 * most_tried; ++i) {
    if (!may_be_up(events[i])) continue;
    const double elapsed = events[i].time - events[start].time;
    if (elapsed > search.window * period_s) break;
    const double n = std::round((elapsed - grid) / period_s);
    const double off = elapsed - grid - n * period_s;
    if (n < 1.0 || std::abs(off) > search.tolerance_s) continue;
    ++agreed.cycles;
    agreed.off_s += off * off; // squared: a false start is far off its first neighbours
    grid = elapsed - 0.5 * off;
  }
  agreed.off_s = std::sqrt(agreed.off_s / agreed.cycles);
  return agreed;
}

// The steps from one event to the next that have the commonest length, in their order: the largest
// set whose members differ by at most a tenth; swings differ less from their neighbours. Among sets
// of one size, the one nearest to the typical period.
std::vector<double> commonest(const std::vector<double>& steps, double typical_s) {
  constexpr double spread = 0.1;
  std::vector<double> best;
  double best_off = 0.0;
  for (const double least : steps) {
    std::vector<double> alike;
    std::copy_if(steps.begin(), steps.end(), std::back_inserter(alike),
                 [&](double s) { return s >= least && s <= least * (1.0 + spread); });
    const double off = std::abs(least * (1.0 + 0.5 * spread) - typical_s);
    if (alike.size() < best.size() || (alike.size() == best.size() && off >= best_off)) continue;
    best = std::move(alike);
    best_off = off;
  }
  return best;
}

} // namespace

double local_period(std::span<const Beat> events, std::size_t from, const PhaseSearch& search) {
  const double period_s = search.period_s;
  // In periods: a swing of 140 degrees takes 1.5 small ones, and longer steps span two swings.
  constexpr double shortest_ratio = 1.0 / 1.5, longest_ratio = 1.5;
  constexpr std::size_t fewest_steps = 4, most_steps = 5; // so few that a period changes little
  std::vector<double> all;
  const Beat* before = nullptr;
  for (std::size_t i = from; i < events.size(); ++i) {
    if (!may_be_up(events[i])) continue;
    if (events[i].time - events[from].time > longest_ratio * search.window * period_s) break;
    const double step = before == nullptr ? 0.0 : events[i].time - before->time;
    if (step > shortest_ratio * period_s && step < longest_ratio * period_s) all.push_back(step);
    before = &events[i];
  }
  std::vector<double> steps = commonest(all, period_s);
  if (steps.size() < fewest_steps) return period_s;
  steps.resize(std::min(steps.size(), most_steps));
  const double here = median(std::span(steps));
  const auto count = static_cast<double>(steps.size());
  for (double& step : steps)
    step = std::abs(step - here);
  // The standard error of a median of normal values, from their median deviation.
  const double error = 1.25 * 1.4826 * median(std::span(steps)) / std::sqrt(count);
  return std::abs(here - period_s) > 4.0 * error ? here : period_s; // beyond chance
}

int events_before_absence(std::span<const Beat> events, std::size_t from,
                          const PhaseSearch& search) {
  int count = 0;
  std::size_t last = from;
  for (std::size_t i = from; i < events.size() && count < 4; ++i) {
    if (!may_be_up(events[i])) continue;
    if (count > 0 && events[i].time - events[last].time > search.absence * search.period_s) break;
    last = i;
    ++count;
  }
  return count;
}

std::optional<std::size_t> find_steady_beat(std::span<const Beat> events, std::size_t from,
                                            const PhaseSearch& search) {
  const double period_s = search.period_s, tolerance_s = search.tolerance_s;
  std::vector<std::size_t> tried;
  std::vector<Agreement> agreed;
  for (std::size_t i = from; i < events.size() && tried.size() < most_tried; ++i) {
    if (!may_be_up(events[i])) continue;
    if (!tried.empty() && events[i].time - events[tried.front()].time > search.window * period_s)
      break;
    tried.push_back(i);
    agreed.push_back(agreement(events, i, search));
  }
  if (tried.empty()) return {};
  const auto best =
      std::max_element(agreed.begin(), agreed.end(),
                       [](const Agreement& a, const Agreement& b) { return a.cycles < b.cycles; });
  if (best->cycles < events_before_absence(events, from, search)) return {};
  // The first on the winner's grid; if several fit the same cycle, the nearest to the others.
  const Beat& winner = events[tried[static_cast<std::size_t>(best - agreed.begin())]];
  std::optional<std::size_t> first;
  double first_cycle = 0.0, first_off = 0.0;
  for (std::size_t k = 0; k < tried.size(); ++k) {
    const double elapsed = events[tried[k]].time - winner.time;
    const double cycle = std::round(elapsed / period_s);
    const double off = std::abs(elapsed - cycle * period_s);
    if (off > tolerance_s) continue;
    if (first && cycle > first_cycle) break;
    if (first && agreed[k].off_s >= first_off) continue;
    first = tried[k];
    first_cycle = cycle;
    first_off = agreed[k].off_s;
  }
  return first;
}

} // namespace goingrate
