#include "rivals.hpp"

#include "reference_run.hpp"
#include "refinement.hpp"
#include "ridge.hpp"
#include "twin.hpp"

#include "base/workers.hpp"

#include <algorithm>

namespace goingrate::timing_model {

namespace {

constexpr double largest_deficit = 4.5; // of L: three sigma

} // namespace

bool find_rivals(Fitted& fitted, const std::vector<std::vector<double>>& others) {
  if (others.empty() && knows_its_clock(fitted)) return false;
  constexpr std::size_t compared_beats = 3000; // beats: thinning makes the check stricter
  const TimingData data = thinned(*fitted.problem.data, fitted.problem.parameters, compared_beats);
  const FitProblem check =
      fitted.problem.on(data); // a condensed log is accurate near one minimum only
  const Minimum home = minimise(check, fitted.minimum.x, {60, 1e-3});
  if (!home.usable) return false;
  const auto there = evaluate(check, home.x);
  if (!there) return false;
  const Certainty known = certainty(check, home.x, *there, {});
  std::vector<std::vector<double>> starts = others;
  if (!all_but_known(check, known, home.x))
    for (auto& point : hollows_along_most_open({check, home, known}, largest_deficit))
      starts.push_back(std::move(point));
  std::vector<Minimum> found(starts.size());
  constexpr double largest_first_order_error =
      100.0; // of L, 14 sigma: the error that first order may make
  share(starts.size(), [&](std::size_t i) {
    found[i] = minimise(check, starts[i], {60, 1e-3});
    // A search that has not converged may still be on its way to the best minimum.
    if (found[i].usable && !found[i].converged &&
        found[i].value < home.value + largest_first_order_error)
      found[i] = minimise(check, found[i].x, {200, 1e-3});
  });
  found.insert(found.begin(), home);
  Minimum best = home;
  for (const Minimum& end : found)
    if (end.usable && end.converged && end.value < best.value) best = end;
  constexpr double least_gain = 0.5; // of L
  const bool moved = best.value < home.value - least_gain;
  if (moved) fitted.minimum.x = best.x;
  const std::vector<double>& here = moved ? best.x : home.x;
  for (const Minimum& other : found)
    if (other.usable && other.converged && other.value < best.value + largest_deficit)
      fitted.rivals.push_back({other.x, other.value - best.value});
  // Without a change all minima lie in one flat valley, which first order describes as well.
  for (const Minimum& other : found)
    if (other.usable && other.converged && other.value < best.value + largest_first_order_error &&
        known.tells_apart(other.x, here) && !check.parameters.event_cycles.empty())
      fitted.ends.push_back(other.x);
  for (Rival& rival : fitted.rivals)
    rival.x = moved_along(rival.x, here, fitted.minimum.x);
  return moved;
}

Fitted on_few_beats(const Fitted& fitted, const FewBeats& few) {
  Fitted there = fitted;
  there.problem = fitted.problem.on(few.data);
  there.rivals.clear();
  there.ends.clear();
  const auto start = with_noise_of_blocks(there.problem.parameters, fitted.minimum.x, few.together);
  if (fitted.dynamics != FitDynamics::averaged1) {
    auto correction = difference_to(fitted.dynamics, there.problem, start);
    there.problem.correction = correction ? std::move(*correction) : Correction{};
  }
  there.minimum = minimise(there.problem, start, {100});
  if (there.minimum.usable) finish(there);
  return there;
}

namespace {

// The fit started from a twin of its minimum and brought to convergence with its own dynamics.
// Not usable if that leads back to the same minimum or to a much worse one.
Fitted twin_fit(const Fitted& home, const std::vector<double>& start) {
  Fitted twin = home;
  twin.minimum.x = start;
  if (home.dynamics != FitDynamics::averaged1) extend(twin.problem, start);
  constexpr double largest_start_deficit =
      100.0; // of L: a density of continuous time says only roughly what one of cycles does
  const auto there = minus_log_likelihood(twin.problem, start);
  if (!there || *there > home.minimum.value + largest_start_deficit) return {};
  settle(twin.problem, twin.minimum, {});
  if (!twin.minimum.usable || !refine(twin, home.dynamics)) return {};
  const bool is_near = twin.minimum.value < home.minimum.value + largest_deficit;
  const auto at = evaluate(home.problem, home.minimum.x);
  const bool is_other =
      at &&
      certainty(home.problem, home.minimum.x, *at, {}).tells_apart(twin.minimum.x, home.minimum.x);
  return is_near && is_other ? twin : Fitted{};
}

using Twins = std::vector<std::optional<std::vector<double>>>;

// The fits of the twins that the log may come from, at their places in the list.
std::vector<Fitted> twin_fits(const Fitted& home, const Twins& twins) {
  std::vector<Fitted> fits(twins.size());
  share(twins.size(), [&](std::size_t i) {
    if (twins[i]) fits[i] = twin_fit(home, *twins[i]);
  });
  return fits;
}

// Whether a twin needs something that no clock has, such as a drive that varies by more than its
// mean. Its search begins at the bound with a poor likelihood, but may end close to the fit's.
bool is_beyond_bounds(const FitProblem& problem, std::span<const double> x) {
  for (std::size_t k = 0; k < problem.bounds.size(); ++k)
    if (x[k] < problem.bounds[k][0] || x[k] > problem.bounds[k][1]) return true;
  return false;
}

// The end of a search on some of the beats as a starting point on others. The jitter is the fit's,
// because beats at a stride do not show it.
std::vector<double> moved_to(const Fitted& to, const Fitted& from, const Fitted& end) {
  std::vector<double> place = moved_along(end.minimum.x, from.minimum.x, to.minimum.x);
  const Slot* jitter = to.problem.parameters.find(Quantity::jitter_rms);
  if (jitter != nullptr && jitter->free) place[jitter->index] = to.minimum.x[jitter->index];
  return place;
}

// The twins without those that some of the beats distinguish from the fit, since all beats would do
// so, too. The number of beats grows step by step, so that a search that begins at a bound has come
// close before all beats are used.
Twins not_told_apart_by_some(const Fitted& fitted, Twins twins) {
  constexpr std::size_t fewest_beats = 3000, growth = 8;
  const TimingData& data = *fitted.problem.data;
  if (fitted.problem.condensed != nullptr || twins.empty()) return twins;
  Fitted before;
  std::vector<Fitted> ends;
  // The twins of a fit, those beyond the bounds moved to where the last search ended.
  const auto starts_on = [&](const Fitted& home, Twins starts) {
    starts.resize(twins.size());
    for (std::size_t i = 0; i < twins.size(); ++i) {
      if (!twins[i])
        starts[i].reset();
      else if (!ends.empty() && (!starts[i] || is_beyond_bounds(home.problem, *starts[i])))
        starts[i] = moved_to(home, before, ends[i]);
    }
    return starts;
  };
  for (std::size_t beats = fewest_beats; data.size() > 3 * beats; beats *= growth) {
    const FewBeats few = few_beats(data, fitted.problem.parameters.event_cycles, beats);
    Fitted home = on_few_beats(fitted, few);
    if (!home.minimum.usable) return {};
    ends = twin_fits(home, starts_on(home, twins_of(home.problem, home.minimum.x)));
    for (std::size_t i = 0; i < twins.size(); ++i)
      if (!ends[i].minimum.usable) twins[i].reset();
    before = std::move(home);
  }
  return starts_on(fitted, twins);
}

} // namespace

void look_at_the_twins(Fitted& fitted) {
  const Twins twins = not_told_apart_by_some(fitted, twins_of(fitted.problem, fitted.minimum.x));
  for (Fitted& twin : twin_fits(fitted, twins)) {
    if (!twin.minimum.usable) continue;
    if (by_value(twin.minimum, fitted.minimum)) {
      twin.rivals = fitted.rivals;
      std::swap(twin, fitted);
    }
    fitted.rivals.push_back({twin.minimum.x, twin.minimum.value - fitted.minimum.value});
  }
}

} // namespace goingrate::timing_model
