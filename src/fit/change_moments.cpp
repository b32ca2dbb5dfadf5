#include "change_moments.hpp"

#include "fit_starts.hpp"
#include "model_fit.hpp"
#include "held.hpp"
#include "rivals.hpp"

#include "base/workers.hpp"
#include "fit/timing_noise.hpp"

#include <algorithm>

namespace goingrate::timing_model {

namespace {

// Peaks are compared by L: a hundredth is accurate enough.
constexpr SearchLimits scan_limits{.iterations = 20, .least_gain = 1e-2};
constexpr SearchLimits peak_limits{.iterations = 60, .least_gain = 1e-2};

// The usable entries of a row that lie below both neighbours.
std::vector<Minimum> local_minima(const std::vector<Minimum>& row) {
  std::vector<Minimum> dips;
  for (std::size_t i = 0; i < row.size(); ++i) {
    const bool below_last = i == 0 || !by_value(row[i - 1], row[i]);
    const bool below_next = i + 1 == row.size() || !by_value(row[i + 1], row[i]);
    if (row[i].usable && below_last && below_next) dips.push_back(row[i]);
  }
  return dips;
}

// Scans the moment of one event: on a grid of moments, L is minimised over the clock. Returns the
// local minima along the grid, the best first. `held` holds the noise, because otherwise a misfit
// would be taken for noise. `found`: the event comes from a search.
std::vector<Minimum> dips_of_moment(const FitProblem& held, const Slot& moment, bool found,
                                    const std::vector<double>& x) {
  // The effect of a change on the phase reverses within half a cycle of the swing.
  constexpr double spacing_cycles = 0.125;
  // A date that was given is that of the crossing nearest to the change; one from a search may be
  // off by a cycle.
  const int to_each_side = found ? 12 : 4;
  std::vector<Minimum> row(static_cast<std::size_t>(2 * to_each_side) + 1);
  std::vector<double> others = x;
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(moment.index));
  share(row.size(), [&](std::size_t i) {
    const double at = spacing_cycles * (static_cast<double>(i) - to_each_side);
    row[i] = minimise(with_held(held, moment.index, at), others, scan_limits);
    row[i].x.insert(row[i].x.begin() + static_cast<std::ptrdiff_t>(moment.index), at);
  });
  std::vector<Minimum> dips = local_minima(row);
  std::sort(dips.begin(), dips.end(), by_value);
  return dips;
}

// Scans the moments of one event after another, each with the earlier ones at their best. The
// amplitude and phase that a change of the push leaves behind depend on where in the swing it came,
// so the likelihood has several peaks. Returns the peaks along the moment of the last event, at
// most four.
std::vector<std::vector<double>> scanned_moments(const FitProblem& problem,
                                                 const FitOptions& options,
                                                 const std::vector<double>& x) {
  FitProblem held = with_noise_held(problem, x);
  const std::size_t clock = held.parameters.free_count;
  std::erase_if(held.priors, [&](const CoordinatePrior& p) { return p.index >= clock; });
  std::vector<Minimum> found(1);
  found.front().x.assign(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(clock));
  for (const Slot& slot : held.parameters.slots) {
    if (slot.quantity != Quantity::moment || !slot.free) continue;
    auto dips = dips_of_moment(held, slot, options.events[slot.event - 1].movable, found.front().x);
    if (!dips.empty()) found = std::move(dips);
  }
  constexpr std::size_t most_peaks = 4;
  if (found.size() > most_peaks) found.resize(most_peaks);
  std::vector<std::vector<double>> places;
  for (const Minimum& dip : found) {
    places.push_back(x);
    std::copy(dip.x.begin(), dip.x.end(), places.back().begin());
  }
  return places;
}

// Every point at which the searches behind a fit ended, in the coordinates of the problem.
std::vector<std::vector<double>> end_points(const Fitted& fitted, const FitProblem& problem) {
  std::vector<std::vector<double>> places;
  if (!fitted.minimum.usable) return places;
  places.push_back(fitted.minimum.x);
  for (const Rival& rival : fitted.rivals)
    places.push_back(rival.x);
  places.insert(places.end(), fitted.ends.begin(), fitted.ends.end());
  const Parameters& parameters = problem.parameters;
  const Slot* jitter = parameters.find(Quantity::jitter_rms);
  for (std::vector<double>& place : places) {
    place = carried_over(fitted.problem.parameters, place, parameters,
                         std::vector<double>(parameters.free_count, 0.0));
    if (jitter->free) // the earlier searches took the leap at the change for jitter
      place[jitter->index] = jitter->coordinate_of(guess_noise(*fitted.problem.data).jitter_s);
  }
  return places;
}

// The peaks of the likelihood near every point at which a search ended, the best first.
std::vector<Minimum> peaks_of_moments(const Fitted& fitted, const Fitted& other,
                                      FitProblem& problem, const FitOptions& options) {
  constexpr std::size_t scanned_beats = 400; // enough to tell peaks apart
  const TimingData scanned_data = thinned(*problem.data, problem.parameters, scanned_beats);
  FitProblem scanned = problem.on(scanned_data);
  std::vector<std::vector<double>> starts;
  for (const Fitted* search : {&fitted, &other})
    for (const std::vector<double>& place : end_points(*search, problem)) {
      scanned.priors = make_priors(options, problem.parameters, place);
      for (auto& peak : scanned_moments(scanned, options, place))
        starts.push_back(std::move(peak));
    }
  std::vector<Minimum> peaks(starts.size());
  share(starts.size(), [&](std::size_t i) {
    FitProblem own = problem;
    own.priors = make_priors(options, own.parameters, starts[i]);
    peaks[i].x = starts[i];
    settle(own, peaks[i], peak_limits);
  });
  std::erase_if(peaks, [](const Minimum& m) { return !m.usable; });
  std::sort(peaks.begin(), peaks.end(), by_value);
  if (!peaks.empty()) problem.priors = make_priors(options, problem.parameters, peaks.front().x);
  drop_duplicates(problem, peaks);
  return peaks;
}

} // namespace

void scan_moments(Fitted& fitted, const Fitted& other, const FitOptions& options) {
  constexpr std::size_t trial_beats = 3000; // thinned() keeps the beats just after the changes
  const TimingData& data = *fitted.problem.data;
  const TimingData trial_data = thinned(data, fitted.problem.parameters, trial_beats);
  Fitted start;
  start.model = fitted.model;
  start.model.moments = ModelChoice::Moments::fitted;
  start.problem = make_problem(trial_data, options, start.model);
  if (start.problem.parameters.free_count > most_parameters) return;
  const std::vector<Minimum> peaks = peaks_of_moments(fitted, other, start.problem, options);
  if (peaks.empty()) return;
  start.minimum = peaks.front();
  Fitted best = fit_from(start, options, start.model, &data);
  if (!best.minimum.usable) return;
  constexpr double largest_deficit = 4.5;             // of L: three sigma
  constexpr double largest_first_order_error = 100.0; // of L, as in find_rivals()
  for (const Minimum& peak : peaks) {
    const double behind = peak.value - peaks.front().value;
    auto place = moved_along(peak.x, peaks.front().x, best.minimum.x);
    if (&peak != &peaks.front() && behind < largest_first_order_error) best.ends.push_back(place);
    if (behind < largest_deficit) best.rivals.push_back({std::move(place), behind});
  }
  fitted = std::move(best);
}

bool leaps_at_changes(const Fitted& fitted, const FitOptions& options, double beyond_chance) {
  if (options.events.empty() || fitted.model.moments == ModelChoice::Moments::fitted) return false;
  FitOptions open = options;
  for (FitEvent& event : open.events)
    event.at_crossing = false;
  ModelChoice model = fitted.model;
  model.moments = ModelChoice::Moments::loose;
  FitProblem problem = make_problem(*fitted.problem.data, open, model);
  if (problem.parameters.free_count > most_parameters) return false;
  problem.parameters.start_ratio = fitted.problem.parameters.start_ratio;
  problem.correction = on_every_beat(fitted.problem).correction; // both use every beat of the data
  const std::vector<double> none(problem.parameters.free_count, 0.0);
  const auto x =
      carried_over(fitted.problem.parameters, fitted.minimum.x, problem.parameters, none);
  problem.priors = make_priors(open, problem.parameters, x);
  const auto at = evaluate(problem, x);
  return at &&
         at->projected.squaredNorm() > beyond_chance * static_cast<double>(options.events.size());
}

} // namespace goingrate::timing_model
