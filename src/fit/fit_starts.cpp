#include "fit_starts.hpp"

#include "change_starts.hpp"
#include "inference.hpp"
#include "ridge.hpp"

#include "base/workers.hpp"
#include "fit/timing_noise.hpp"

#include <algorithm>

namespace goingrate::timing_model {

FitProblem make_problem(const TimingData& data, const FitOptions& options,
                        const ModelChoice& model) {
  FitProblem problem;
  problem.data = &data;
  problem.parameters = make_parameters(options, data, model);
  problem.bounds = make_bounds(problem.parameters, data);
  return problem;
}

FitProblem with_noise_held(const FitProblem& problem, std::span<const double> start) {
  FitProblem held = problem;
  std::size_t place = 0;
  for (Slot& slot : held.parameters.slots) {
    if (!slot.free) continue;
    if (is_noise(slot.quantity)) {
      slot.fixed_value = slot.value(start);
      slot.free = false;
    } else {
      slot.index = place++;
    }
  }
  held.parameters.free_count = place;
  held.bounds = make_bounds(held.parameters, *held.data);
  return held;
}

namespace {

// The times are nearly linear in T0, so the growth of the residuals gives it in one step.
void match_mean_rate(const FitProblem& problem, std::vector<double>& x) {
  const Slot& T0 = *problem.parameters.find(Quantity::T0);
  if (!T0.free) return;
  const TimingData ends = ends_of_stretches(*problem.data, {});
  if (const auto late = late_after_first(problem.parameters, ends, x))
    x[T0.index] += late->back() / problem.data->cycle.back() / T0.scale;
}

} // namespace

std::vector<Minimum> screened(const FitProblem& problem,
                              const std::vector<std::vector<double>>& points) {
  std::vector<Minimum> tried(points.size());
  share(points.size(), [&](std::size_t i) {
    std::vector<double> matched = points[i];
    match_mean_rate(problem, matched);
    Minimum& start = tried[i]; // as it is, or with the mean rate of the log
    for (const auto& x : {matched, points[i]}) {
      const auto value = minus_log_likelihood(problem, x);
      if (!value || !(*value < start.value)) continue;
      start.value = *value;
      start.x = x;
    }
  });
  std::erase_if(tried, [](const Minimum& start) { return !std::isfinite(start.value); });
  std::sort(tried.begin(), tried.end(), by_value);
  return tried;
}

namespace {

// The start given by the options, completed from the log; without one, all of the log's own starts.
std::vector<std::vector<double>> starts_of(const FitOptions& options, const Parameters& parameters,
                                           const TimingData& data, const NoiseGuess& noise) {
  auto points = starting_points(parameters, data, noise);
  if (options.start.empty() || points.empty()) return points;
  std::vector<double> given = points.front();
  for (const Slot& slot : parameters.slots) {
    const auto named = options.start.find(parameters.name_of(slot));
    if (!slot.free || named == options.start.end()) continue;
    const double x = slot.coordinate_of(named->second);
    if (std::isfinite(x)) given[slot.index] = x;
  }
  return {given};
}

} // namespace

void drop_duplicates(const FitProblem& problem, std::vector<Minimum>& places, double share) {
  if (places.size() < 2) return;
  if (places.front().x.empty()) return places.resize(1); // every parameter is held
  const auto at = evaluate(problem, places.front().x);
  if (!at) return;
  Certainty known = certainty(problem, places.front().x, *at, {});
  known.factor *= std::sqrt(share); // the sigma for all beats
  std::vector<Minimum> kept;
  for (const Minimum& place : places)
    if (std::all_of(kept.begin(), kept.end(),
                    [&](const Minimum& k) { return known.tells_apart(k.x, place.x); }))
      kept.push_back(place);
  places = std::move(kept);
}

namespace {

// Whether the valley of the best minimum bends, so that it has several: that of a change does,
// while without a change all lie in one flat valley. Where a date may still move, its error may
// make them.
bool has_bent_valley(const FitOptions& options) {
  return !options.events.empty() &&
         std::none_of(options.events.begin(), options.events.end(),
                      [](const FitEvent& event) { return event.movable; });
}

// Other minima in the valley of the best one.
std::vector<Minimum> others_in_the_valley(const FitProblem& problem, const Minimum& best) {
  constexpr double largest_rise = 300.0; // of L on few beats, to a pass between two of them
  const auto there = best.x.empty() ? std::nullopt : evaluate(problem, best.x);
  if (!there) return {};
  const Certainty known = certainty(problem, best.x, *there, {});
  std::vector<Minimum> others;
  for (auto& hollow : hollows_along_most_open({problem, best, known}, largest_rise))
    others.push_back(minimise(problem, std::move(hollow), {60, 1e-2}));
  return others;
}

} // namespace

std::vector<Minimum> finalists(FitProblem problem, const FitOptions& options,
                               const NoiseGuess& noise) {
  constexpr std::size_t thinned_beats = 160; // beats that tell which valley a start lies in
  constexpr std::size_t to_score = 10;
  const TimingData& all = *problem.data;
  const TimingData data = thinned(all, problem.parameters, thinned_beats);
  problem.data = &data;
  const auto points = starts_of(options, problem.parameters, data, noise);
  problem = with_noise_held(problem, points.front());
  std::vector<std::vector<double>> clock_points;
  for (const auto& point : points)
    clock_points.emplace_back(
        point.begin(), point.begin() + static_cast<std::ptrdiff_t>(problem.parameters.free_count));
  std::vector<Minimum> tried = screened(problem, clock_points);
  if (tried.size() > to_score) tried.resize(to_score);
  if (options.start.empty() && !tried.empty()) {
    for (const auto& stretch : starts_by_change(problem.parameters, all, tried.front().x))
      if (auto along = screened(problem, stretch); !along.empty())
        tried.push_back(std::move(along.front()));
  }
  const auto score = [&](int iterations) {
    share(tried.size(), [&](std::size_t i) {
      if (tried[i].converged) return;
      FitProblem own = problem;
      own.priors = make_priors(options, own.parameters, tried[i].x);
      tried[i] = minimise(own, tried[i].x, {iterations, 1e-2, 1e4});
    });
  };
  const auto keep_usable = [&] {
    std::erase_if(tried, [](const Minimum& m) { return !m.usable; });
    std::sort(tried.begin(), tried.end(), by_value);
    if (!tried.empty()) problem.priors = make_priors(options, problem.parameters, tried.front().x);
    drop_duplicates(problem, tried,
                    static_cast<double>(data.size()) / static_cast<double>(all.size()));
  };
  score(8);
  keep_usable();
  score(60);
  keep_usable();
  if (options.start.empty() && !tried.empty() && has_bent_valley(options)) {
    for (Minimum& other : others_in_the_valley(problem, tried.front()))
      tried.push_back(std::move(other));
    keep_usable();
  }
  return tried;
}

std::vector<std::vector<double>> noise_variants(const std::vector<std::vector<double>>& points,
                                                const Parameters& parameters,
                                                const TimingData& data) {
  const Slot* drive = parameters.find(Quantity::drive_rms);
  const Slot* slow = parameters.find(Quantity::slow_rms);
  const Slot* memory = parameters.find(Quantity::slow_time);
  std::vector<std::vector<double>> variants;
  for (const auto& point : points) {
    for (const double factor : {1.0, 0.5, 2.0}) {
      std::vector<double> x = point;
      if (drive != nullptr && drive->free) x[drive->index] += std::log(factor);
      if (slow == nullptr || !slow->free || !memory->free) {
        variants.push_back(x);
        continue;
      }
      if (factor != 1.0) continue;
      // A memory longer than the log looks like one that is as long as the log.
      for (const double periods : {30.0, 300.0, 3000.0, 30000.0})
        for (const double size : {0.03, 0.2, 1.0}) {
          const double whole = data.elapsed_s.back(), length = periods * data.reference_period_s;
          if (length > whole && periods > 30.0) continue;
          x[memory->index] = std::log(std::min(length, whole));
          x[slow->index] =
              (drive != nullptr && drive->free ? x[drive->index] : std::log(0.1)) + std::log(size);
          variants.push_back(x);
        }
    }
  }
  return variants;
}

} // namespace goingrate::timing_model
